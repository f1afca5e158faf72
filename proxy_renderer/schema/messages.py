# SPDX-License-Identifier: Apache-2.0
"""What Blender and the engine say to each other: JSON objects, each ended by a NUL byte.

Every class below is one message; its wire form is its fields plus "type". The first message of the
engine carries the hash of its parameter table, and so does every request, so that two versions
that disagree about a parameter refuse to work together instead of writing nonsense into a scene.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields
from typing import Any, BinaryIO, ClassVar, get_args

from .budgets import STANDARD
from .errors import VibeError
from .parameters import schema_hash


@dataclass(frozen=True)
class Options:
    """How a vibe is carried out.

    Attributes:
        rounds: Outer rounds of Algorithm 1: the plan is made anew in each.
        steps: Gradient steps in each round.
        size: Longer side of the prediction, pixels.
        top_k: How many parameters a round may optimise.
        seed: Seed of every random choice.
        groups: Parameter groups that may change; empty for all of them (the camera only if named).
        lock: Patterns of parameters that must not change: a group, "light/Key", or a glob.
        encoder: An open_clip hub tag or local checkpoint; "" for the embedded encoder.
        device: A torch device, or "auto".
        baseline: "" for the product, "clip-only" for the paper's baseline.
        camera: Whether the camera may be optimised though `groups` does not name it.
        vlm_model: A vision-language model that parses, plans and judges; "" for the environment's
            VIBE_VLM_MODEL (none if that is not set), "off" for none.
        vlm_url: Base URL of its OpenAI-compatible endpoint; "" for the environment's.
        online: Whether other computers may be reached; a model on this one always may.
        anchor: Whether Cycles renders small pictures meanwhile, which correct the proxy.
        starts: Points that a coarse first pass tries; 1 for the artist's scene alone. Variants raise it.
        variants: How many different looks to find for the same words.
    """

    rounds: int = STANDARD.rounds
    steps: int = STANDARD.steps
    size: int = STANDARD.size
    top_k: int = 8
    seed: int = 0
    groups: tuple[str, ...] = ()
    lock: tuple[str, ...] = ()
    encoder: str = ""
    device: str = "auto"
    baseline: str = ""
    camera: bool = False
    vlm_model: str = ""
    vlm_url: str = ""
    online: bool = True
    anchor: bool = True
    starts: int = STANDARD.starts
    variants: int = 1

    @classmethod
    def from_dict(cls, raw: dict[str, Any]) -> Options:
        """Options from their JSON form; raises VibeError for a name that is not one."""
        known = {f.name for f in fields(cls)}
        if strange := sorted(set(raw) - known):
            raise VibeError(f"Unknown option {strange[0]!r}.", f"Use one of: {', '.join(sorted(known))}.")
        lists: dict[str, Any] = {name: tuple(raw[name]) for name in ("groups", "lock") if name in raw}
        return cls(**{**raw, **lists})


@dataclass(frozen=True)
class Ready:
    """Engine → Blender, at once on starting. `schema` is the engine's schema hash."""

    type: ClassVar[str] = "ready"
    schema: str
    version: str


@dataclass(frozen=True)
class Vibe:
    """Blender → engine: work on the scene in the folder `job`. `schema` is Blender's schema hash.

    `vlm_key` is the model's key from the add-on's preferences; it goes through the pipe and nowhere else.
    """

    type: ClassVar[str] = "vibe"
    schema: str
    job: str
    prompt: str
    options: dict[str, Any] = field(default_factory=dict)
    vlm_key: str = field(default="", repr=False)


@dataclass(frozen=True)
class Stage:
    """Engine → Blender: what is going on outside the loop, for a status line.

    Attributes:
        picture: When the loop begins: the artist's own values, a file name in the job folder; else "".
    """

    type: ClassVar[str] = "stage"
    name: str
    picture: str = ""


@dataclass(frozen=True)
class Progress:
    """Engine → Blender: how far the loop is. Rounds and steps count from 1.

    Attributes:
        preview: A picture in the job folder, replaced atomically about once a second; "" before the first.
    """

    type: ClassVar[str] = "progress"
    round: int
    rounds: int
    step: int
    steps: int
    loss: float
    seconds_left: float
    preview: str = ""


@dataclass(frozen=True)
class Anchor:
    """Engine → Blender: render the scene at these values, small, for the engine to correct itself by.

    Attributes:
        number: Counts the requests of a vibe.
        values: Parameter key to its components, of what differs from the scene's.
        size: Longer side of the picture, pixels.
        samples: Most samples in a pixel.
        seed: Of the sampling pattern.
    """

    type: ClassVar[str] = "anchor"
    number: int
    values: dict[str, list[float]]
    size: int
    samples: int
    seed: int = 0


@dataclass(frozen=True)
class Anchored:
    """Blender → engine: the answer to an `Anchor`, at most one to each.

    Attributes:
        number: Of the request.
        picture: A multilayer EXR of 32-bit floats in the job folder, scene-linear; "" if there is none. Its layers
            are "Combined" (denoised), "Noisy Image" (the same, not denoised; missing in a Blender that has no
            denoiser, whose "Combined" is noisy) and "Combined_…" of every group.
        groups: Name of a light group to whose light it holds: "light/NAME" or "world".
        seconds: How long it took.
        error: Why there is no picture.
    """

    type: ClassVar[str] = "anchored"
    number: int
    picture: str = ""
    groups: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    error: str = ""


VARIANTS = "variants.png"
"""The sheet of all variants, a file name in the job folder."""


@dataclass(frozen=True)
class Variant:
    """One of several looks for the same words.

    Attributes:
        values: As those of `Result`.
        picture: Its prediction, a file name in the job folder.
        score: Its loss; smaller is better.
    """

    values: dict[str, list[float]]
    picture: str
    score: float


@dataclass(frozen=True)
class Result:
    """Engine → Blender: the values found.

    Attributes:
        values: Parameter key to its components, for every parameter whose value differs from the scene's.
        report: The fields of report.json that the engine knows.
        prediction: The proxy's picture of the values, a file name in the job folder.
        stopped: Whether a stop message ended the loop early.
        variants: If several were asked for: those found, the best first, whose values are `values`.
    """

    type: ClassVar[str] = "result"
    values: dict[str, list[float]]
    report: dict[str, Any]
    prediction: str
    stopped: bool = False
    variants: list[Variant] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Variants that come over the wire are plain objects."""
        plain = [v if isinstance(v, Variant) else Variant(**v) for v in self.variants]
        object.__setattr__(self, "variants", plain)


@dataclass(frozen=True)
class Stop:
    """Blender → engine: end the loop now with the best so far (a Result follows)."""

    type: ClassVar[str] = "stop"


@dataclass(frozen=True)
class Finish:
    """Blender → engine: measure and compose, now that Cycles has rendered.

    Attributes:
        before: Cycles' picture of the original scene, a PNG path.
        after: Cycles' picture of the result.
        compare_out: Where to write before | prediction | after.
        mask_out: Where to write the subject's mask at the size of `after`; "" for nowhere.
    """

    type: ClassVar[str] = "finish"
    before: str
    after: str
    compare_out: str
    mask_out: str = ""


@dataclass(frozen=True)
class Finished:
    """Engine → Blender: how well the prediction held and the words are met.

    Attributes:
        delta_e: Mean CIEDE2000 of the prediction against `after`.
        others: The same of what would have been predicted "before_last_anchor" and "unanchored".
        similarity: {"before": s, "after": s}, cosine of picture and prompt.
        judge: A vision-language model's verdict on before and after: winner, reason and what it cost, or
            error; empty if no model is configured.
    """

    type: ClassVar[str] = "finished"
    delta_e: float
    similarity: dict[str, float]
    judge: dict[str, Any] = field(default_factory=dict)
    others: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Error:
    """Engine → Blender: the request failed; the engine is still there for another one."""

    type: ClassVar[str] = "error"
    message: str
    remedy: str = ""


@dataclass(frozen=True)
class Quit:
    """Blender → engine: end the process. The end of the stream means the same."""

    type: ClassVar[str] = "quit"


Message = (
    Ready | Vibe | Stage | Progress | Anchor | Anchored | Result | Stop | Finish | Finished | Error | Quit
)
_TYPES: dict[str, type] = {m.type: m for m in get_args(Message)}


def encode(message: Message) -> bytes:
    """The wire form: UTF-8 JSON and a NUL byte. Raises ValueError for NaN or infinite numbers."""
    body = {"type": message.type, **asdict(message)}
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode() + b"\0"


def decode(raw: bytes | str) -> Message:
    """Inverse of `encode`, with or without the NUL byte. Raises VibeError for anything else."""
    text = raw.decode(errors="replace") if isinstance(raw, bytes) else raw
    try:
        body = json.loads(text.rstrip("\0"))
        return _TYPES[body.pop("type")](**body)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise VibeError(
            f"The engine and Blender do not understand each other: {text[:80]!r}.",
            "Install the same version of vibe-render for both.",
        ) from error


def read(stream: BinaryIO) -> Iterator[Message]:
    """Messages of a stream as they arrive, until it ends. A message that was cut off is dropped."""
    pending = b""
    while chunk := stream.read1(65536):  # type: ignore[attr-defined]
        *whole, pending = (pending + chunk).split(b"\0")
        yield from map(decode, whole)


def check_schema(theirs: str, who: str) -> None:
    """Raises VibeError unless the other process has this process's parameter table.

    Args:
        theirs: The hash in its message.
        who: "engine" or "add-on", the one that sent it.
    """
    if theirs != schema_hash():
        raise VibeError(
            f"The {who} has another parameter table ({theirs or 'none'} instead of {schema_hash()}).",
            "Install the same version of vibe-render for Blender and for the engine.",
        )
