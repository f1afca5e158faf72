# SPDX-License-Identifier: Apache-2.0
"""Messages between Blender and the engine: JSON objects, each ended by a NUL byte.

Every class below is one message; its wire form is its fields plus "type", its name. The engine's first message and every request
carry the hash of the parameter table: versions that disagree about it refuse to work together.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, BinaryIO, get_args

from .errors import VibeError
from .options.table import Options as Options
from .parameters import schema_hash


def _typed(message: Any, name: str, kind: type) -> None:
    """Gives the rows of a message their class: those that come over the wire are plain objects."""
    rows = [row if isinstance(row, kind) else kind(**row) for row in getattr(message, name)]
    object.__setattr__(message, name, rows)


@dataclass(frozen=True)
class Ready:
    """Engine → Blender, at once on starting. `schema` is the engine's schema hash."""

    schema: str
    version: str


@dataclass(frozen=True)
class Shot:
    """One of several cameras, frames or scenes that are to share a look."""

    job: str  # its job folder
    name: str  # for people
    file: str  # names its .blend


@dataclass(frozen=True)
class Vibe:
    """Blender → engine: work on the scene in the folder `job`."""

    schema: str  # Blender's schema hash
    job: str  # the job folder: of the first shot, if there are several
    prompt: str  # what the artist typed
    options: dict[str, Any] = field(default_factory=dict)  # the fields of `Options`
    # the model's key from the add-on's preferences; it goes through the pipe and nowhere else
    vlm_key: str = field(default="", repr=False)
    shots: list[Shot] = field(default_factory=list)  # all of several shots; empty for a single one
    looks: bool = False  # whether to send looks before the result, see `LookSoFar`

    def __post_init__(self) -> None:
        _typed(self, "shots", Shot)


@dataclass(frozen=True)
class Glance:
    """Blender → engine: only what the plan gives for these words, quickly; a `Glanced` answers, after a `Stop` an empty one."""

    schema: str  # Blender's schema hash
    job: str  # the job folder; the engine keeps its scene for the next glance
    prompt: str  # what the artist has typed so far
    options: dict[str, Any] = field(default_factory=dict)  # the fields of `Options`


@dataclass(frozen=True)
class AskReadings:
    """Blender → engine: how are these words understood? `Readings` answer in a blink, whatever else the engine does."""

    schema: str  # Blender's schema hash
    prompt: str  # what the artist has typed so far
    job: str = ""  # the job folder, with or without surfaces and textures; "" where nothing can be exported
    # where there is no job: object that a render shows -> names of its materials
    objects: dict[str, list[str]] = field(default_factory=dict)
    lights: dict[str, str] = field(default_factory=dict)  # Likewise: light -> its type, "AREA" and so on
    target: tuple[str, ...] = ()  # "copper=Cup": what the artist says that words describe


@dataclass(frozen=True)
class WordReading:
    """A word of a prompt, as it is understood."""

    text: str  # as the prompt says it
    state: str  # "understood", "guessed" or "left out"
    meaning: str = ""  # what is made of it, in words for the artist: "describes Vase"
    others: list[str] = field(default_factory=list)  # known words that may be meant instead, likeliest first
    key: str = ""  # what a target calls it: "red#2" for the second one
    # names of what it may describe, the one that it is taken for first, then the likeliest; see `targets`
    candidates: list[str] = field(default_factory=list)
    targets: list[str] = field(default_factory=list)  # what else it can describe


@dataclass(frozen=True)
class Readings:
    """Engine → Blender: the answer to an `AskReadings`; of several, only the newest is answered."""

    prompt: str  # the words that it is about
    words: list[WordReading] = field(default_factory=list)  # its look words and what is left out, in order
    note: str = ""  # why nothing is understood, in a sentence for the artist; "" where something is

    def __post_init__(self) -> None:
        _typed(self, "words", WordReading)


@dataclass(frozen=True)
class LookSoFar:
    """Engine → Blender: values on the way to the result, to be seen in the scene until there are better ones."""

    values: dict[str, list[float]]  # as those of `Result`
    picture: str = ""  # the proxy's picture of them, a file name in the job folder; "" before it is drawn
    words: dict[str, bool] = field(default_factory=dict)  # word to whether the picture shows it


@dataclass(frozen=True)
class Glanced(LookSoFar):
    """Engine → Blender: the answer to a `Glance`."""

    before: str = ""  # the picture of the artist's own values, a file name in the job folder


@dataclass(frozen=True)
class Stage:
    """Engine → Blender: what is going on outside the loop, for a status line."""

    name: str
    # when the loop begins: the artist's own values, a file name in the job folder; else "". With looks it comes
    # twice: the second is corrected by an anchor
    picture: str = ""
    lit: bool = True  # False if that picture is black, and would be with all that the words ask for


@dataclass(frozen=True)
class Progress:
    """Engine → Blender: how far the loop is. Rounds and steps count from 1."""

    round: int
    rounds: int
    step: int
    steps: int
    loss: float
    seconds_left: float
    preview: str = ""  # a picture in the job folder, replaced atomically about once a second; "" at first


@dataclass(frozen=True)
class Anchor:
    """Engine → Blender: render the scene at these values, small, for the engine to correct itself by."""

    number: int  # counts the requests of a vibe
    values: dict[str, list[float]]  # parameter key to its components, of what differs from the scene's
    size: int  # longer side of the picture, pixels
    samples: int  # most samples in a pixel
    seed: int = 0  # of the sampling pattern
    shot: int = 0  # which of several shots to render, from 0


@dataclass(frozen=True)
class Anchored:
    """Blender → engine: the answer to an `Anchor`, at most one to each."""

    number: int  # of the request
    # a multilayer EXR of 32-bit floats in the job folder, scene-linear; "" if there is none. Its layers are
    # "Combined" (denoised), "Noisy Image" (the same, not denoised; missing in a Blender that has no denoiser, whose
    # "Combined" is noisy) and "Combined_…" of every group
    picture: str = ""
    groups: dict[str, str] = field(default_factory=dict)  # light group -> its light: "light/NAME" or "world"
    seconds: float = 0.0  # how long it took
    error: str = ""  # why there is no picture


VARIANTS = "variants.png"  # the sheet of all variants, a file name in the job folder


@dataclass(frozen=True)
class Variant:
    """One of several looks for the same words."""

    values: dict[str, list[float]]  # as those of `Result`
    picture: str  # its prediction, a file name in the job folder
    score: float  # its loss; smaller is better
    reasons: dict[str, str] = field(default_factory=dict)  # why they changed, by key


@dataclass(frozen=True)
class Result:
    """Engine → Blender: the values found."""

    values: dict[str, list[float]]  # parameter key to its components, of all that differs from the scene's
    report: dict[str, Any]  # the fields of report.json that the engine knows
    prediction: str  # the proxy's picture of the values, a file name in the job folder
    stopped: bool = False  # whether a stop message ended the loop early
    # if several were asked for: those found, the best first, whose values are `values`
    variants: list[Variant] = field(default_factory=list)
    # of several shots: the values of each, under its own names; `values` are the first's
    shots: list[dict[str, list[float]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        _typed(self, "variants", Variant)


@dataclass(frozen=True)
class Stop:
    """Blender → engine: end the loop now with the best so far (a Result follows)."""


@dataclass(frozen=True)
class Finish:
    """Blender → engine: measure and compose, now that Cycles has rendered."""

    before: str  # Cycles' picture of the original scene, a PNG path
    after: str  # Cycles' picture of the result
    compare_out: str  # where to write before | prediction | after
    shot: int = 0  # which of several shots, from 0; those before it are on `compare_out` as well


@dataclass(frozen=True)
class Finished:
    """Engine → Blender: how well the prediction held and the words are met."""

    # how far predictions are from `after`, in CIEDE2000: the one that is "shown", and with the option `figures` what
    # would have been predicted "before_last_anchor" and "unanchored". Each has the `mean` and `p95` over the pixels,
    # and the mean over the `subject`, if it can be seen
    prediction: dict[str, dict[str, float]]
    similarity: dict[str, float]  # {"before": s, "after": s}, cosine of picture and prompt
    # a vision-language model's verdict on before and after: winner, reason and what it cost, or error; empty if no
    # model is configured
    judge: dict[str, Any] = field(default_factory=dict)
    # what every word claims of the picture, and whether it holds; rows of `claims.verdict`
    claims: list[dict[str, Any]] = field(default_factory=list)
    verdicts: list[dict[str, str]] = field(default_factory=list)  # on every word; rows of `engine.report`


@dataclass(frozen=True)
class Check:
    """Blender → engine: measure the words of the last vibe at another frame, from the job that was exported there with the look."""

    job: str
    before: str  # Cycles' picture of the frame without the look, a PNG path
    after: str  # with it


@dataclass(frozen=True)
class Checked:
    """Engine → Blender: whether the words are visible at a frame."""

    verdicts: list[dict[str, str]]  # as in `Finished`


@dataclass(frozen=True)
class Error:
    """Engine → Blender: the request failed; the engine is still there for another one."""

    message: str
    remedy: str = ""
    unexpected: bool = False


@dataclass(frozen=True)
class Quit:
    """Blender → engine: end the process. The end of the stream means the same."""


Message = (
    Ready | Vibe | Glance | AskReadings | Readings | Stage | LookSoFar | Glanced | Progress | Anchor | Anchored | Result
    | Stop | Finish | Finished | Check | Checked | Error | Quit
)  # fmt: skip

_TYPES: dict[str, type] = {message.__name__: message for message in get_args(Message)}


def encode(message: Message) -> bytes:
    """The wire form: UTF-8 JSON and a NUL byte."""
    body = {"type": type(message).__name__, **asdict(message)}
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode() + b"\0"


def decode(raw: bytes | str) -> Message:
    """Inverse of `encode`, with or without the NUL byte."""
    text = raw.decode(errors="replace") if isinstance(raw, bytes) else raw
    try:
        body = json.loads(text.rstrip("\0"))
        return _TYPES[body.pop("type")](**body)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        problem = f"The engine and Blender do not understand each other: {text[:80]!r}."
        raise VibeError(problem, "Install the same version of vibe-render for both.") from error


def read(stream: BinaryIO) -> Iterator[Message]:
    """Messages of a stream as they arrive, until it ends. A message that was cut off is dropped."""
    pending = b""
    while chunk := stream.read1(65536):  # type: ignore[attr-defined]
        *whole, pending = (pending + chunk).split(b"\0")
        yield from map(decode, whole)


def check_schema(theirs: str, who: str) -> None:
    """Makes sure that the other process has this process's parameter table."""
    if theirs != schema_hash():
        problem = f"The {who} has another parameter table ({theirs or 'none'} instead of {schema_hash()})."
        raise VibeError(problem, "Install the same version of vibe-render for Blender and for the engine.")


ClaimVerdict = Mapping[str, Any]  # a row of the report's `claims`, see `proxy_renderer.claims.claim`


def word_states(rows: Sequence[ClaimVerdict]) -> dict[str, str]:
    """Word with claims -> "missed" if one is, "unmeasured" if judges do not see what one tells, "visible", or "already" so before."""
    states: dict[str, str] = {}
    for row in rows:
        held = "already" if row["already"] else "visible"
        mine = "missed" if not row["holds"] else held if row["sure"] else "unmeasured"
        for word in words_of(row) if row["holds"] is not None else ():
            states[word] = min(mine, states.get(word, mine), key=_STRONGEST.index)
    return states


def words_of(row: ClaimVerdict) -> tuple[str, ...]:
    """The words of the prompt that stand or fall with a claim; none for what every image has to satisfy."""
    return tuple(word for word in (row["word"], *row.get("also", ())) if word)


_STRONGEST = ("missed", "unmeasured", "visible", "already")
