# SPDX-License-Identifier: Apache-2.0
"""The model's client against a real local server: refusals, failures, patience, limits, cache, secrets."""

import json
import socket
import threading
import time

import pytest
from model_server import KEY, MODEL, has_picture, refuses, says, serving

from proxy_renderer.cli import doctor
from proxy_renderer.cli.doctor import try_model
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.messages import Options
from proxy_renderer.vlm.client import Cache, Client, Question
from proxy_renderer.vlm.endpoint import OPENAI, Endpoint, find_endpoint
from proxy_renderer.vlm.transport import LARGEST, ModelError

SCHEMA = {
    "type": "object",
    "properties": {"color": {"type": "string"}},
    "required": ["color"],
    "additionalProperties": False,
}
QUESTION = Question("Say a color.", "now", b"\xff\xd8jpeg", SCHEMA)
RED = {"color": "red"}


@pytest.fixture(autouse=True)
def hurry(monkeypatch, tmp_path):
    monkeypatch.setattr("openai._base_client.INITIAL_RETRY_DELAY", 0.01)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def asking(model, seconds=5.0, **more):
    return Client(Endpoint(MODEL, model.url, KEY, seconds), **more)


def failure(behave, question=QUESTION, seconds=5.0):
    """The error that this behavior leads to, and the server's record."""
    with serving(behave) as model, pytest.raises(ModelError) as caught:
        asking(model, seconds).ask(question)
    error = caught.value
    assert error.message
    assert "\n" not in str(error)
    assert KEY not in str(error)
    return error, model


def test_a_strict_answer_and_what_it_costs(monkeypatch):
    monkeypatch.setenv("OPENAI_ORG_ID", "org-mine")
    with serving(lambda body, n: says(RED)) as model:
        client = Client(Endpoint(MODEL, model.url, KEY, 5.0, (2.0, 10.0)))
        assert client.ask(QUESTION) == RED
    body = model.asked[0]
    assert body["response_format"]["json_schema"]["strict"] is True
    assert body["response_format"]["json_schema"]["schema"] == SCHEMA
    assert body["messages"][1]["content"][1]["image_url"]["url"].startswith("data:image/jpeg;base64,/9hq")
    assert model.headers[0]["authorization"] == f"Bearer {KEY}"
    assert "org-mine" not in str(model.headers)
    account = client.usage.account()
    assert (account["calls"], account["cached"]) == (1, 0)
    assert account["tokens"] == {"read": 100, "written": 20}
    assert account["cost_usd"] == pytest.approx(0.0004)


def test_what_a_server_refuses_is_left_out():
    def picky(body, n):
        kind = body.get("response_format", {}).get("type")
        if "temperature" in body:
            return refuses(400, "Unsupported value: 'temperature' does not support 0 with this model.")
        if "max_completion_tokens" in body:
            return refuses(400, "Unrecognized request argument supplied: max_completion_tokens")
        if kind == "json_schema":
            return refuses(400, "response_format json_schema is not supported")
        if kind == "json_object":
            return refuses(400, "'response_format.type' must be 'json_schema' or 'text'")
        if has_picture(body):
            return refuses(500, "image input is not supported - hint: you may need to provide the mmproj")
        assert json.dumps(SCHEMA, separators=(",", ":")) in body["messages"][0]["content"]
        return says('Sure!\n```json\n{"color": "red"}\n```\nAnything else?')

    with serving(picky) as model:
        client = asking(model)
        assert client.ask(QUESTION) == RED
        assert (client.dialect.format, client.dialect.pictures) == ("text", False)
        before = len(model.asked)
        client.ask(Question("Another.", "now", b"jpeg", SCHEMA))
        assert len(model.asked) == before + 1  # it has learned


def test_a_refusal_without_a_reason():
    def mute(body, n):
        return (400, b"", {}) if "response_format" in body or has_picture(body) else says(RED)

    with serving(mute) as model:
        assert asking(model).ask(QUESTION) == RED


def test_one_that_refuses_everything():
    error, model = failure(lambda body, n: refuses(400, "no"))
    assert "400" in error.message
    assert len(model.asked) <= 6


def test_a_question_about_a_picture_needs_it():
    blind = Question("Look.", "now", b"jpeg", must_see=True)
    error, model = failure(lambda body, n: refuses(400, "image_url is not supported"), blind)
    assert "image_url" in error.message
    assert len(model.asked) == 1


@pytest.mark.parametrize(
    ("answer", "words", "lasting"),
    [
        (refuses(401, f"Incorrect API key provided: {KEY}."), ["refuses the key", "vibe doctor"], True),
        (refuses(404, "model 'eyes:7b' not found, try pulling it first"), ["does not have the model", MODEL], True),
        (refuses(402, "Insufficient balance"), ["paid", "balance"], True),
        (refuses(400, "This model's maximum context length is 4096 tokens"), ["does not fit", "16384"], True),
        ((302, b"", {"Location": "http://127.0.0.1:1/v1"}), ["elsewhere"], True),
        ((200, b"<html>Welcome</html>", {}), ["not a chat completion", "/v1"], False),
        ((200, {"choices": []}, {}), ["not a chat completion"], False),
        ((200, b"[" * 100_000, {}), ["not a chat completion"], False),
        ((200, b"\x00\xff" * 99, {}), ["not a chat completion"], False),
    ],
)
def test_failures_that_asking_again_does_not_mend(answer, words, lasting):
    error, model = failure(lambda body, n: answer)
    for word in words:
        assert word in str(error)
    assert error.lasting == lasting
    assert len(model.asked) == 1


@pytest.mark.parametrize(
    "content",
    ['{"color": "re', "I think red.", "", "{" * 5000, '{"hue": "red"}', "[1, 2]", '{"color": NaN}', '{"a":' * 3000],
)
def test_an_answer_that_cannot_be_read_is_asked_for_once_more(content):
    error, model = failure(lambda body, n: says(content))
    assert "answer" in error.message
    assert len(model.asked) == 2
    assert len(model.asked[1]["messages"]) == 4
    with serving(lambda body, n: says(content) if n == 1 else says(RED)) as model:
        assert asking(model).ask(QUESTION) == RED


def test_an_answer_that_was_cut_off():
    error, _ = failure(lambda body, n: says('{"color": "red"}', finish="length"))
    assert "cut off" in error.message


@pytest.mark.parametrize(
    "content",
    [
        '<think>{"color": "blue"} or…</think>{"color": "red"}',
        'Here: {"note": 1} {"color": "red"}',
        '\ufeff{"color": "red"}',
    ],
)
def test_json_among_other_words(content):
    with serving(lambda body, n: says(content)) as model:
        assert asking(model).ask(QUESTION) == RED


def test_busy_servers_are_asked_again_when_they_say():
    def busy(body, n):
        return refuses(429, "slow down", {"Retry-After": "0.4"}) if n == 1 else says(RED)

    with serving(busy) as model:
        start = time.monotonic()
        assert asking(model).ask(QUESTION) == RED
        assert 0.4 <= time.monotonic() - start < 3.0
    assert len(model.asked) == 2


@pytest.mark.parametrize("status", [500, 502, 503, 429])
def test_patience_has_an_end(status):
    error, model = failure(lambda body, n: refuses(status, "out of order"))
    assert not error.lasting
    assert len(model.asked) == 4


def test_a_quota_that_is_used_up_is_no_matter_of_waiting():
    error, _ = failure(lambda body, n: refuses(429, "You exceeded your current quota", code="insufficient_quota"))
    assert error.lasting
    assert "paid" in error.message


def test_a_wait_longer_than_the_time_limit_is_not_waited_for():
    start = time.monotonic()
    error, model = failure(lambda body, n: refuses(429, "slow down", {"Retry-After": "900"}))
    assert time.monotonic() - start < 2.0
    assert "900 s" in error.message
    assert len(model.asked) == 1


def slow(handler):
    """A byte now and then: no read ever times out."""
    handler.send_response(200)
    handler.send_header("Content-Length", "1000")
    handler.end_headers()
    for _ in range(200):
        handler.wfile.write(b" ")
        handler.wfile.flush()
        time.sleep(0.1)


def test_the_time_limit_holds_for_a_byte_at_a_time():
    start = time.monotonic()
    error, _ = failure(lambda body, n: slow, seconds=1.0)
    assert time.monotonic() - start < 3.0
    assert "1 s" in error.message
    assert "VIBE_VLM_TIMEOUT" in error.remedy


def test_stop_is_heard_while_waiting():
    stop = threading.Event()
    threading.Timer(0.3, stop.set).start()
    start = time.monotonic()
    with serving(lambda body, n: slow) as model, pytest.raises(ModelError, match="stopped"):
        asking(model, 60.0, stop=stop.is_set).ask(QUESTION)
    assert time.monotonic() - start < 2.0


@pytest.mark.parametrize("status", [200, 500])
def test_a_huge_answer_is_not_read(status):
    sent = []

    def flood(handler):
        handler.send_response(status)
        handler.send_header("Transfer-Encoding", "chunked")
        handler.end_headers()
        for _ in range(20 * LARGEST // 65536):
            handler.wfile.write(b"10000\r\n" + b" " * 65536 + b"\r\n")
            sent.append(65536)

    error, _ = failure(lambda body, n: flood)
    assert "more than 2 MB" in error.message
    assert sum(sent) < 10 * LARGEST


def hang_up(handler):
    handler.send_response(200)
    handler.send_header("Content-Length", "1000")
    handler.end_headers()
    handler.wfile.write(b'{"choices": [{"mess')
    handler.close_connection = True


def test_a_server_that_hangs_up_in_the_middle():
    error, model = failure(lambda body, n: hang_up)
    assert "cannot be reached" in error.message
    assert len(model.asked) == 4


def test_nobody_there():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    with pytest.raises(ModelError, match="cannot be reached") as caught:
        Client(Endpoint(MODEL, f"http://127.0.0.1:{port}/v1")).ask(QUESTION)
    assert "Start the server" in caught.value.remedy


def test_an_answer_is_paid_for_once(tmp_path):
    with serving(lambda body, n: says(RED)) as model:
        assert asking(model).ask(QUESTION) == RED
        again = asking(model)
        assert again.ask(QUESTION) == RED
        assert (again.usage.calls, again.usage.cached) == (0, 1)
        assert len(model.asked) == 1
        asking(model).ask(Question("Say a color.", "now", b"other jpeg", SCHEMA))
        Client(Endpoint("other", model.url)).ask(QUESTION)
        assert len(model.asked) == 3
        for path in Cache().folder.iterdir():
            path.write_text('{"answer"')  # broken
        assert asking(model).ask(QUESTION) == RED
        assert len(model.asked) == 4


def test_a_cache_that_cannot_be_written(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with serving(lambda body, n: says(RED)) as model:
        assert asking(model).ask(QUESTION) == RED


def test_the_cache_is_pruned(tmp_path, monkeypatch):
    monkeypatch.setattr("proxy_renderer.vlm.client._MOST", 3)
    cache = Cache(tmp_path / "few")
    for n in range(6):
        cache.write(str(n), n)
        time.sleep(0.01)
    assert [cache.read(str(n)) for n in range(6)] == [None, None, None, 3, 4, 5]
    assert len(list((tmp_path / "few").iterdir())) == 3


def test_the_key_is_nowhere(tmp_path):
    """Not even where the server sends it back, in disguise."""
    sneaky = '{"color": "' + "".join(f"\\u{ord(c):04x}" for c in KEY) + f'", "{KEY}": "{KEY}"}}'
    with serving(lambda body, n: says(sneaky)) as model:
        client = asking(model)
        assert KEY not in str(client.ask(QUESTION))
        assert KEY not in repr(client.endpoint)
    files = [p for p in tmp_path.rglob("*") if p.is_file()]
    assert files
    for path in files:
        text = path.read_text()
        assert KEY not in text
        assert KEY not in json.dumps(json.loads(text))


class TestEndpoint:
    def test_no_model_is_asked_unless_one_is_named(self):
        assert find_endpoint(Options(), environment={"OPENAI_API_KEY": KEY}) is None
        assert find_endpoint(Options(vlm_model="off"), environment={"VIBE_VLM_MODEL": "m"}) is None
        assert find_endpoint(Options(), environment={"VIBE_VLM_MODEL": "m", "OPENAI_API_KEY": KEY}).url == OPENAI

    def test_openai_s_key_goes_to_openai_only(self):
        env = {"OPENAI_API_KEY": KEY}
        local = Options(vlm_model="m", vlm_url="http://localhost:11434/v1/")
        assert find_endpoint(local, environment=env).key == ""
        assert find_endpoint(local, environment={**env, "VIBE_VLM_KEY": "mine"}).key == "mine"
        theirs = {**env, "OPENAI_BASE_URL": "https://example.org/v1"}
        assert find_endpoint(Options(vlm_model="m"), environment=theirs).key == KEY
        with pytest.raises(VibeError, match="needs a key"):
            find_endpoint(Options(vlm_model="m", vlm_url=OPENAI), environment=theirs)

    @pytest.mark.parametrize(
        ("url", "word"),
        [
            ("localhost:11434", "http://"),
            ("ftp://host/v1", "http://"),
            ("http://", "http://"),
            ("http://host:99999/v1", "http://"),
            ("http://me:pass@host/v1", "VIBE_VLM_KEY"),
            ("http://host/v1?key=abc", "VIBE_VLM_KEY"),
        ],
    )
    def test_urls_that_are_none(self, url, word):
        with pytest.raises(VibeError) as caught:
            find_endpoint(Options(vlm_model="m", vlm_url=url), environment={})
        assert word in caught.value.remedy
        assert "pass" not in str(caught.value)

    @pytest.mark.parametrize(
        "env",
        [
            {},
            {"OPENAI_API_KEY": KEY, "VIBE_VLM_TIMEOUT": "soon"},
            {"OPENAI_API_KEY": KEY, "VIBE_VLM_TIMEOUT": "0"},
            {"OPENAI_API_KEY": KEY, "VIBE_VLM_PRICE": "cheap"},
            {"OPENAI_API_KEY": "sk-ключ"},
            {"OPENAI_API_KEY": "sk-a\nb"},
        ],
    )
    def test_mistakes_have_a_remedy(self, env):
        with pytest.raises(VibeError) as caught:
            find_endpoint(Options(vlm_model="m"), environment=env)
        assert caught.value.remedy

    def test_blender_s_online_access(self):
        for url in ("http://localhost:8080/v1", "http://127.0.0.1:1234/v1", "http://[::1]:8000/v1"):
            assert find_endpoint(Options(vlm_model="m", vlm_url=url, online=False), environment={})
        for url in ("http://192.168.1.5:8000/v1", "https://localhost.example.org/v1", "http://127.evil.org/v1"):
            with pytest.raises(VibeError, match="online access"):
                find_endpoint(Options(vlm_model="m", vlm_url=url, online=False), environment={})


def test_doctor_says_whether_a_model_is_configured(monkeypatch):
    monkeypatch.delenv("VIBE_VLM_MODEL", raising=False)
    assert "VIBE_VLM_MODEL" in doctor._model()
    monkeypatch.setenv("VIBE_VLM_MODEL", MODEL)
    with serving(lambda body, n: says({"color": "red"})) as model:
        monkeypatch.setenv("VIBE_VLM_URL", model.url)
        assert f"{MODEL} at 127.0.0.1" in doctor._model()
    with pytest.raises(VibeError, match="cannot be reached"):
        doctor._model()


@pytest.mark.parametrize(
    ("color", "words"),
    [("Red", ["sees pictures", "strict JSON"]), ("unseen", ["does NOT see"]), ("\x1b[2Jred\u202e", ["'[2Jred'"])],
)
def test_doctor_tries_the_model(color, words):
    with serving(lambda body, n: says({"color": color})) as model:
        said = try_model(Endpoint(MODEL, model.url, KEY))
        try_model(Endpoint(MODEL, model.url, KEY))
    assert len(model.asked) == 2  # never from the cache
    for word in words:
        assert word in said
