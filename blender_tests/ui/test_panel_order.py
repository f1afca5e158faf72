# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel from top to bottom, drawn into a layout that only writes down what is drawn."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from panel_layout import drawn
from PIL import Image
from results import FOUND, PIVOT, PROMPT
from small_scenes import studio
from vibe_render import ui
from vibe_render.run import result
from vibe_render.run.notes import CheckedFrame
from vibe_render.run.state import addon_state
from vibe_render.ui import panels, setup
from vibe_render.ui.engine_state import engine_state
from vibe_render.ui.result import ResultPanel

from proxy_renderer.schema import VibeError, messages

UI = Path(ui.__file__).parent
MISSED = {"state": "missed", "why": "", "unlock": ""}


def in_order(names, where):
    places = [where.index(name) for name in names]
    return places == sorted(places)


@pytest.fixture
def engineless(addon, monkeypatch):
    """A panel that looks for no engine, and starts none."""
    monkeypatch.setattr(engine_state, "search", lambda choice: None)
    monkeypatch.setattr(setup, "warm_up_soon", lambda: None)
    return addon


def test_inputs_stand_above_the_button(engineless):
    names = ("prompt", "vibe_reference_image", "effort", "variants", "vibe.run", "vibe_live")
    found = drawn(panels.MainPanel)
    assert in_order(names, found)
    assert "rounds" not in found
    engineless.vibe.effort = "CUSTOM"
    assert in_order(("effort", "rounds", "steps", "size", "variants"), drawn(panels.MainPanel))


def test_without_an_engine_one_line_says_what_is_missing(engineless, monkeypatch):
    monkeypatch.setattr(engine_state, "problem", VibeError("There is none.", ""))
    found = drawn(panels.MainPanel)
    below = found[found.index("vibe_live") + 1 :]
    assert " ".join(below[: below.index("vibe.setup_engine")]) == "No engine yet. Presets work without it"


def test_the_decision_comes_at_once_below_the_images(engineless, tmp_path, monkeypatch):
    """What a word lacks is two swatches, not two numbers; everything else is below."""
    studio(engineless)
    verdicts = [
        {"word": "fog", "missing": "", **MISSED, "state": "visible"},
        {"word": "red", "missing": "color of the vase is #4e3852, wanted #ac2712", **MISSED},
    ]
    report = {"parameters": {key: {"reason": "red"} for key in FOUND}, "verdicts": verdicts}
    found = messages.Result(FOUND, report, "after.png")
    result.apply(engineless, PROMPT, found, (), PIVOT)
    images = {name: tmp_path / f"{name}.png" for name in ("before", "preview")}
    for path in images.values():
        Image.new("RGB", (32, 18)).save(path)
    facts = {"scene": engineless.name, "report": report, "variants": [], "prediction_error": 0.5}
    session = SimpleNamespace(
        **images, **facts, warnings=[], discard=lambda: None, cancel=lambda: None,
        sequence=(CheckedFrame(21, ["red"]),), checking=False,
    )  # fmt: skip
    monkeypatch.setattr(addon_state, "session", session)
    seen = drawn(ResultPanel)
    first = seen.index("Before")
    decision = ["vibe.keep", "vibe.keyframe", "vibe.revert"]
    assert seen[first : first + 6] == ["Before", "image", "After, as predicted", *decision]
    rest = ("vibe.revert", "show_original", "strength", "Visible: fog", "further", "vibe_changes", "vibe.run")
    assert in_order((*rest, "vibe.preset_save"), seen)
    listed = next(text for text in seen if text.startswith("Frame 21: no longer"))
    assert in_order(("vibe.check_sequence", listed, "further"), seen)
    at = seen.index("Not visible: red")
    assert seen[at + 2 : at + 6] == ["color of the vase is ", "swatch", ", wanted ", "swatch"]


def test_panels_below_the_result_are_closed_at_first():
    order = [c for c in panels.CLASSES if c.__name__.startswith("VIBE_PT_") and c.bl_region_type == "UI"]
    assert [c.bl_label for c in order] == [
        *("Vibe Render", "Result", "Light Mix", "Presets", "Affect", "Individual Locks", "Advanced")
    ]
    assert all("DEFAULT_CLOSED" in c.bl_options for c in order[2:])


def test_signs_of_a_state_are_on_no_button():
    """One icon, one meaning: ticks and eyes say how something is, and buttons have others."""
    source = "\n".join(path.read_text("utf-8") for path in UI.glob("*.py"))
    buttons = re.findall(r"\.operator\([^)]*icon=\"(\w+)\"", source)
    assert len(buttons) > 20
    assert not {"CHECKMARK", "HIDE_ON", "HIDE_OFF", "QUESTION", "DOT", "ERROR", "INFO"} & set(buttons)
