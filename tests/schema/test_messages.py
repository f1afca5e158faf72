# SPDX-License-Identifier: Apache-2.0
"""The messages between Blender and the engine survive the wire, and nonsense is refused."""

import io

import pytest

from proxy_renderer.schema import VibeError, messages, schema_hash

ALL = [
    messages.Ready(schema_hash(), "0.1.0"),
    messages.Vibe(schema_hash(), "/a job/ü", "glossy teal dolphin", {"rounds": 2, "lock": ["light/Key"]}),
    messages.Stage("loading encoder"),
    messages.Progress(1, 6, 2, 40, 0.5, 12.0, "preview.png"),
    messages.Anchor(2, {"film/contrast": [1.2]}, 192, 32, 7),
    messages.Anchored(2, "anchor-2.exr", {"Vibe 0": "light/Key"}, 1.25),
    messages.Anchored(3, error="Blender is busy"),
    messages.Result({"film/contrast": [1.2]}, {"seed": 1}, "prediction.png", True),
    messages.Result({}, {}, "p.png", variants=[messages.Variant({"film/gamma": [1.1]}, "variant-1.png", 0.5)]),
    messages.Stop(),
    messages.Finish("b.png", "a.png", "c.png"),
    messages.Finished({"shown": {"mean": 1.5, "p95": 4.0}}, {"before": 0.1, "after": 0.4}),
    messages.Error("No.", "Do that."),
    messages.Quit(),
]


@pytest.mark.parametrize("message", ALL, ids=lambda m: type(m).__name__)
def test_round_trip(message):
    raw = messages.encode(message)
    assert raw[-1:] == b"\0"
    assert raw.count(b"\0") == 1
    assert messages.decode(raw) == message


class Dribble(io.BytesIO):
    """A pipe that hands over three bytes at a time."""

    def read1(self, size=-1):
        return super().read1(3)


def test_stream_is_cut_at_nul_bytes():
    raw = b"".join(map(messages.encode, ALL))
    assert list(messages.read(Dribble(raw))) == ALL


def test_cut_off_message_is_dropped():
    raw = messages.encode(ALL[0]) + messages.encode(ALL[1])[:-5]
    assert list(messages.read(io.BytesIO(raw))) == ALL[:1]


@pytest.mark.parametrize(
    "raw", [b"hello\0", b"[1]\0", b'{"type": "dance"}\0', b'{"type": "Stop", "now": 1}\0', b"{}\0"]
)
def test_nonsense_is_refused_with_a_remedy(raw):
    with pytest.raises(VibeError) as caught:
        messages.decode(raw)
    assert caught.value.remedy


def test_not_a_number_never_travels():
    with pytest.raises(ValueError, match="JSON compliant"):
        messages.encode(messages.Result({"film/contrast": [float("nan")]}, {}, "p.png"))


def test_another_parameter_table_is_refused():
    messages.check_schema(schema_hash(), "engine")
    with pytest.raises(VibeError, match="another parameter table"):
        messages.check_schema("0123456789abcdef", "engine")


def test_options_from_json_and_unknown_ones():
    options = messages.Options.from_dict({"rounds": 2, "lock": ["light"]})
    assert (options.rounds, options.lock) == (2, ("light",))
    with pytest.raises(VibeError, match="speeed"):
        messages.Options.from_dict({"speeed": 1})
