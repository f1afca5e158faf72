# SPDX-License-Identifier: Apache-2.0
"""The contact sheet in a real browser, from disk and offline: what an art director would do with it."""

import shutil
from pathlib import Path

import pytest
from batch_parts import carry_out, plan_of

from proxy_renderer.batch.manifest import BatchPlan, Limits, SceneGroup

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
HOSTILE = "noir </script><script>document.title = 'broken'</script> & <b>bold</b>"
SCENES = ("shots/hall.blend", "shots/table.blend")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two scenes, three prompts, one of which fails."""
    out = tmp_path_factory.mktemp("sheet")
    carry_out(out, plan_of("misty", "fails", HOSTILE, scenes=SCENES, seeds=(3, 9)), Limits(free_gb=0, retries=0))
    return out


@pytest.fixture(scope="module")
def browser():
    sync = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if not found:
        pytest.skip("no Chromium on the PATH: `apt-get install chromium`")
    with sync.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def page(browser, folder):
    """The sheet, which asked for nothing but files beside it and made no error."""
    context = browser.new_context(viewport={"width": 1400, "height": 900}, offline=True)
    page = context.new_page()
    asked, errors = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(error))
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.goto((folder / "index.html").as_uri())
    yield page
    assert not errors
    assert all(url.startswith(folder.as_uri()) for url in asked)
    context.close()


def cards(page):
    return page.locator(".card")


def words(page):
    return page.locator(".card .words").all_inner_texts()


def test_it_shows_every_job_and_a_prompt_is_only_text(page):
    assert page.title() == "test: contact sheet"
    assert cards(page).count() == 12
    assert words(page)[4] == HOSTILE
    seen = "[...document.querySelectorAll('.after')].slice(0, 4).every(i => i.complete && i.naturalWidth > 0)"
    page.wait_for_function(seen)
    failed = page.locator(".card.failed").first.inner_text()
    assert "The camera is panoramic." in failed
    assert "Use another." in failed


def test_words_are_listed_by_what_the_render_shows_of_them(page):
    said = page.locator(".card .verdict").first.inner_text()
    assert said.splitlines() == ["Visible: misty", "Not visible: noir"]
    assert page.locator(".card.failed .verdict").count() == 0
    assert "match" not in page.locator("main").inner_text()


def test_filters(page):
    page.select_option("#scene", SCENES[1])
    assert cards(page).count() == 6
    page.select_option("#prompt", "misty")
    assert set(words(page)) == {"misty"}
    assert cards(page).count() == 2
    page.fill("#find", "no such thing")
    assert page.locator("#empty").is_visible()
    page.click("#clear")
    assert cards(page).count() == 12
    page.get_by_role("button", name="failed 4").click()
    assert set(words(page)) == {"fails"}


def test_sorting_and_grouping(page):
    page.select_option("#sort", "most words visible")
    assert words(page)[-4:] == ["fails"] * 4
    page.select_option("#group", "scene")
    assert page.locator("h2").all_inner_texts() == ["hall", "table"]


def cut(page, place):
    return page.locator(place).evaluate("e => e.style.getPropertyValue('--cut')")


def test_the_slider_follows_the_pointer(page):
    area = page.locator(".card .frame").first.bounding_box()
    page.mouse.move(area["x"] + area["width"] / 4, area["y"] + 50)
    assert cut(page, ".card:first-child .frame") == "25%"
    page.mouse.move(5, 5)
    assert cut(page, ".card:first-child .frame") == "0%"


def test_a_click_tells_parameters_and_reasons(page):
    cards(page).first.click()
    page.locator(".change").wait_for()
    said = page.locator("#facts").inner_text()
    for expected in ("hall · seed 3", "misty", "World: Strength", "0.3 → 0.1", "noir: a dark world", "1 left alone"):
        assert expected in said
    assert page.locator("#facts a").first.get_attribute("href").endswith("/vibed.blend")


def test_the_keyboard_does_everything(page):
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowDown")
    assert page.locator(".card.here").get_attribute("data-place") == "4"
    page.keyboard.press("Enter")
    assert HOSTILE in page.locator("#facts").inner_text()
    page.keyboard.press("Space")
    assert cut(page, "#view") == "100%"
    page.keyboard.press("Space")
    assert cut(page, "#view") == "0%"
    page.keyboard.press("p")
    page.keyboard.press("ArrowRight")
    assert "seed 9" in page.locator("#facts").inner_text()
    page.keyboard.press("Escape")
    assert not page.locator("#large").is_visible()
    page.get_by_role("button", name="picked 1").click()
    assert words(page) == [HOSTILE]
    page.keyboard.press("/")
    assert page.evaluate("document.activeElement.id") == "find"


def test_shots_that_share_a_look_are_all_shown_and_slide_together(browser, tmp_path):
    """A card with four pictures, and one slider for all of them."""
    shot = SceneGroup("kitchen", Path("a.blend"), "digest", ("noir",), (0,), ("--cameras=Wide,Close,Top,Door",))
    carry_out(tmp_path, BatchPlan([shot]), Limits(free_gb=0))
    page = browser.new_context(viewport={"width": 1400, "height": 900}, offline=True).new_page()
    page.goto((tmp_path / "index.html").as_uri())
    assert page.locator(".card .shots .name").all_inner_texts() == ["Wide", "Close", "Top", "Door"]
    page.wait_for_function("[...document.querySelectorAll('.after')].every(i => i.naturalWidth > 0)")
    assert [Path(i.get_attribute("src")).name for i in page.locator(".after").all()][1] == "after-2.jpg"
    cards(page).first.click()
    area = page.locator("#view .frame").nth(1).bounding_box()
    page.mouse.move(area["x"] + area["width"] * 0.75, area["y"] + 20)
    page.mouse.down()
    page.mouse.up()
    assert cut(page, "#view") == "75%"
    edge = "e => getComputedStyle(e).getPropertyValue('--cut')"
    assert {one.evaluate(edge) for one in page.locator("#view .frame").all()} == {"75%"}
    page.context.close()
    assert "Wide | Close | Top | Door" in (tmp_path / "results.csv").read_text()
