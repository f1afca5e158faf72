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

VARIANTS = "variants.png"  # the sheet of all variants, a file name in the job folder


@dataclass(frozen=True)
class Ready:
    """Engine → Blender, at once on starting. `schema` is the engine's schema hash."""

    schema: str
    version: str


@dataclass(frozen=True)
class Shot:
    """One of several cameras, frames or scenes that share a look."""

    job: str  # its job folder
    name: str  # for people
    file: str  # names its .blend


@dataclass(frozen=True)
class Vibe:
    """Blender → engine: search for a prompt's look in the scene of the folder `job`; a `Result` answers."""

    schema: str  # Blender's schema hash
    job: str  # the job folder: of the first shot, if there are several
    prompt: str  # what the artist typed
    options: dict[str, Any] = field(default_factory=dict)  # the fields of `Options`
    # the model's key from the add-on's preferences; it goes through the pipe and nowhere else
    vlm_key: str = field(default="", repr=False)
    shots: list[Shot] = field(default_factory=list)  # all shots, if there are several; empty for a single one
    looks: bool = False  # whether to send intermediate values before the result, see `LookSoFar`


@dataclass(frozen=True)
class Glance:
    """Blender → engine: find values from the words alone, without a search; `Glanced` answers, empty if stopped."""

    schema: str  # Blender's schema hash
    job: str  # the job folder; the engine keeps its scene for the next glance
    prompt: str  # what the artist has typed so far
    options: dict[str, Any] = field(default_factory=dict)  # the fields of `Options`


@dataclass(frozen=True)
class AskReadings:
    """Blender → engine: ask how a prompt's words are understood; `Readings` answer at once, even during a search."""

    schema: str  # Blender's schema hash
    prompt: str  # what the artist has typed so far
    job: str = ""  # the job folder, which may lack meshes and textures; "" if nothing can be exported
    # without a job: object that a render shows -> names of its materials
    objects: dict[str, list[str]] = field(default_factory=dict)
    lights: dict[str, str] = field(default_factory=dict)  # without a job: light -> its type, such as "AREA"
    target: tuple[str, ...] = ()  # "copper=Cup": what the artist says that words describe


@dataclass(frozen=True)
class WordReading:
    """A word of a prompt, as it is understood."""

    text: str  # as the prompt says it
    state: str  # "understood", "guessed" or "left out"
    meaning: str = ""  # its effect in words for the artist: "describes Vase"
    others: list[str] = field(default_factory=list)  # known words that may be meant instead, likeliest first
    key: str = ""  # its name in a target: "red#2" for the second "red"
    # names of targets that it may describe: the chosen one first, then by probability; see `schema/targets.py`
    candidates: list[str] = field(default_factory=list)
    targets: list[str] = field(default_factory=list)  # names of all other targets that it can describe


@dataclass(frozen=True)
class Readings:
    """Engine → Blender: the answer to an `AskReadings`; if several wait, only the newest is answered."""

    prompt: str  # the prompt of the request
    words: list[WordReading] = field(default_factory=list)  # its look words and the words left out, in order
    note: str = ""  # why nothing is understood, in a sentence for the artist; "" if something is understood


@dataclass(frozen=True)
class LookSoFar:
    """Engine → Blender: intermediate values of a search, shown in the scene until better ones come."""

    values: dict[str, list[float]]  # as those of `Result`
    picture: str = ""  # the proxy's image of the values, a file name in the job folder; "" before it is drawn
    words: dict[str, bool] = field(default_factory=dict)  # word -> whether it is visible in the image


@dataclass(frozen=True)
class Glanced(LookSoFar):
    """Engine → Blender: the answer to a `Glance`."""

    before: str = ""  # the image of the artist's own values, a file name in the job folder


@dataclass(frozen=True)
class Stage:
    """Engine → Blender: the work of the engine outside the search loop, for a status line."""

    name: str
    # when the loop begins, the proxy's image of the artist's own values, a file name in the job folder; else "". If
    # `Vibe` asks for `looks`, this message comes twice: the second image is corrected by an anchor, a Cycles render
    picture: str = ""
    lit: bool = True  # False if that image is black, and stays black with all that the words ask for


@dataclass(frozen=True)
class Progress:
    """Engine → Blender: the progress of the search loop. Rounds and steps count from 1."""

    round: int
    rounds: int
    step: int
    steps: int
    loss: float
    seconds_left: float
    preview: str = ""  # an image in the job folder, replaced atomically about once a second; "" at first


@dataclass(frozen=True)
class Anchor:
    """Engine → Blender: render a small image of the scene at these values, by which the engine corrects its proxy."""

    number: int  # counts the requests of a vibe
    values: dict[str, list[float]]  # parameter key -> components, where they differ from the scene's
    size: int  # longer side of the image, pixels
    samples: int  # most samples in a pixel
    seed: int = 0  # of the sampling pattern
    shot: int = 0  # which of several shots to render, from 0


@dataclass(frozen=True)
class Anchored:
    """Blender → engine: the answer to an `Anchor`, at most one to each."""

    number: int  # of the request
    # a multilayer EXR of 32-bit floats in the job folder, scene-linear; "" if there is none. Its layers are
    # "Combined" (denoised), "Noisy Image" (not denoised) and "Combined_…" for every light group. A Blender without
    # a denoiser has no "Noisy Image", and a noisy "Combined"
    picture: str = ""
    groups: dict[str, str] = field(default_factory=dict)  # light group -> its light: "light/NAME" or "world"
    seconds: float = 0.0  # how long the render took
    error: str = ""  # why there is no image


@dataclass(frozen=True)
class Variant:
    """One of several looks for the same words."""

    values: dict[str, list[float]]  # as those of `Result`
    picture: str  # its prediction, a file name in the job folder
    score: float  # its loss; smaller is better
    reasons: dict[str, str] = field(default_factory=dict)  # why each value changed, by key


@dataclass(frozen=True)
class Result:
    """Engine → Blender: the values found."""

    values: dict[str, list[float]]  # parameter key -> components, where they differ from the scene's
    report: dict[str, Any]  # the fields of report.json that the engine knows
    prediction: str  # the proxy's image of the values, a file name in the job folder
    stopped: bool = False  # whether a stop message ended the loop early
    # if several were asked for: those found, the best first; `values` are those of the best
    variants: list[Variant] = field(default_factory=list)
    # of several shots: the values of each, by keys with the names in its scene; `values` are the first shot's
    shots: list[dict[str, list[float]]] = field(default_factory=list)


@dataclass(frozen=True)
class Stop:
    """Blender → engine: end the loop now with the best so far (a Result follows)."""


@dataclass(frozen=True)
class Finish:
    """Blender → engine: measure Cycles' renders, and compose the image that compares them."""

    before: str  # Cycles' render of the original scene, a PNG path
    after: str  # Cycles' render of the result, a PNG path
    compare_out: str  # path of the image to write: before | prediction | after
    shot: int = 0  # which of several shots, from 0; earlier ones are on `compare_out` too


@dataclass(frozen=True)
class Finished:
    """Engine → Blender: how close the prediction is, and whether the words are visible."""

    # CIEDE2000 between `after` and each prediction: "shown" and, with the option `figures`, the one without the last
    # anchor ("before_last_anchor") and the one without any ("unanchored"). Each has the `mean` and `p95` over all
    # pixels, and the mean over the `subject`, if it is visible
    prediction: dict[str, dict[str, float]]
    similarity: dict[str, float]  # {"before": s, "after": s}, cosine of image and prompt
    # a vision-language model's verdict on before and after: winner, reason and what it cost, or error; empty if no
    # model is configured
    judge: dict[str, Any] = field(default_factory=dict)
    # every claim and whether it is satisfied; rows of `ShotClaims.verdicts`
    claims: list[dict[str, Any]] = field(default_factory=list)
    verdicts: list[dict[str, str]] = field(default_factory=list)  # for each word, see `engine.report`


@dataclass(frozen=True)
class Check:
    """Blender → engine: measure the last vibe's words at another frame; `job` is an export of it, with the look."""

    job: str
    before: str  # Cycles' render of the frame without the look, a PNG path
    after: str  # the same with the look


@dataclass(frozen=True)
class Checked:
    """Engine → Blender: the answer to a `Check`."""

    verdicts: list[dict[str, str]]  # as in `Finished`


@dataclass(frozen=True)
class Error:
    """Engine → Blender: the request failed; the engine goes on, and takes another one."""

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
_ROWS = {"Vibe": ("shots", Shot), "Readings": ("words", WordReading), "Result": ("variants", Variant)}
"""Message -> (field that is a list of objects, the objects' class); in JSON these objects are dictionaries."""


def encode(message: Message) -> bytes:
    """The wire form of a message: UTF-8 JSON and a NUL byte."""
    body = {"type": type(message).__name__, **asdict(message)}
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode() + b"\0"


def decode(raw: bytes) -> Message:
    """The message of a wire form, with or without its NUL byte: inverse of `encode`. Raises VibeError for others."""
    text = raw.decode(errors="replace")
    try:
        body = json.loads(text.rstrip("\0"))
        kind = body.pop("type")
        if kind in _ROWS:
            name, row = _ROWS[kind]
            body[name] = [row(**each) for each in body.get(name, ())]
        return _TYPES[kind](**body)
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
    """Raises VibeError if `theirs`, the schema hash of the other process (named `who`), is not that of this process."""
    if theirs != schema_hash():
        problem = f"The {who} has another parameter table ({theirs or 'none'} instead of {schema_hash()})."
        raise VibeError(problem, "Install the same version of vibe-render for Blender and for the engine.")


def word_states(rows: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Word -> its state, for each word with a measured claim; `rows` are the `claims` of `Finished`.

    A claim is "missed" if it is not satisfied. Else it is "unmeasured" if judges do not see what its measure reads,
    "already" if it was satisfied before, and "visible" if the run satisfied it. Of the states of a word's claims, the
    first in `_STRONGEST` counts.
    """
    states: dict[str, str] = {}
    for row in rows:
        held = "already" if row["already"] else "visible"
        mine = "missed" if not row["holds"] else held if row["sure"] else "unmeasured"
        for word in words_of(row) if row["holds"] is not None else ():
            states[word] = min(mine, states.get(word, mine), key=_STRONGEST.index)
    return states


def words_of(row: Mapping[str, Any]) -> tuple[str, ...]:
    """The prompt's words that a claim, a row of `Finished`, belongs to; () for one that every image has to satisfy."""
    return tuple(word for word in (row["word"], *row.get("also", ())) if word)


_STRONGEST = ("missed", "unmeasured", "visible", "already")
