# SPDX-License-Identifier: Apache-2.0
"""The table of all options of a vibe (one run of the method), and its conversion to command lines and back.

The table is the only source of the command lines of `vibe` and of the Blender process, the table in the documents,
the checks (`checks`), the message to the engine (`Options`), Blender's properties, and the options in a
manifest of `vibe batch`. A new option is one row: a field of `Options` if the engine has to know it, else a row of
`TASK` or `SUPPORT`.
"""

import argparse
from collections.abc import Iterable
from dataclasses import dataclass, field, fields, replace
from typing import Any, Self, TypeVar

from ..errors import VibeError
from ..limits import BUDGETS, LARGEST_SEED, LONGEST_PROMPT, NUMBERS, STANDARD
from ..parameters import GROUPS

T = TypeVar("T")

HEADINGS = {  # group of options -> its title in the help; in the order of the help
    "task": "",
    "shots": "shots that share a look: each scene, through each camera, at each frame, and one set of values for all",
    "moments": "moments: a look at each of several frames, and keyframes from one to the next",
    "effort": "effort",
    "picture": "a reference image",
    "reach": "what may change",
    "engine": "engine",
    "render": "render",
}


@dataclass(frozen=True)
class Panel:
    """The appearance of an option as a property in Blender."""

    title: str  # its label
    description: str  # its tooltip
    bounds: tuple[int, int] | None = None  # least and greatest number there, if not those of the option
    length: int = 0  # most characters of a text; 0 for any number
    default: str = ""  # default of a text or a choice in Blender
    live: bool = False  # whether a text takes effect with each typed character
    suggestions: tuple[str, ...] = ()  # texts to choose from; others can be typed
    path: bool = False  # whether a text is the path of a file
    preferences: bool = False  # whether it is kept in the add-on's preferences, and not in the scene


@dataclass(frozen=True)
class Option:
    """A row of the table: one option."""

    name: str  # in Python and in a manifest; on a command line with hyphens
    # of the option's type: a bool that is True is turned off by --no-NAME, a tuple is an option that can be repeated
    default: int | str | bool | tuple[str, ...]
    help: str  # for the command line and the documents; the default of a number is added to it
    heading: str  # its group, a key of `HEADINGS`
    unit: str = "N"  # what a value is called in the help: N, NAME, DIR
    bounds: tuple[int, int] | None = None  # least and greatest number
    choices: tuple[str, ...] = ()  # all allowed texts; empty if any text is
    manifest: tuple[str, ...] = ("options",)  # tables of a manifest that may have it: "options", "scene", "shots"
    blender: bool = True  # whether the Blender process takes it on its command line
    panel: Panel | None = None  # how it looks in Blender; None if it is not there

    @property
    def flag(self) -> str:
        """The option on a command line: "--check-every", or "--no-anchor" for a bool with the default True."""
        return f"--{'no-' if self.default is True else ''}{self.name.replace('_', '-')}"

    @property
    def command_default(self) -> Any:
        """The value if a command line lacks the option: its default, or None for a number that the effort decides."""
        if self.name in NUMBERS:
            return None
        return list(self.default) if isinstance(self.default, tuple) else self.default

    def text(self, default: Any) -> str:
        """The help text; for a number it ends with the `default`, and None is shown as "the effort's"."""
        if type(self.default) is not int:
            return self.help
        shown = "the effort's" if default is None else default
        return f"{self.help} (default: {shown})"


def option(default: T, help: str, heading: str, **facts: Any) -> T:
    """A dataclass field for `Options` that is also a row of the table; `facts` are more fields of `Option`."""
    return field(default=default, metadata={"option": Option("", default, help, heading, **facts)})  # type: ignore[arg-type]


STAGES = ("none", "floor", "cyclorama")  # stages that a mesh file without a scene can be put on
TRAITS = ("light", "grade", "palette", "air", "materials")
"""Traits to take over from a reference image; materials only if it shows the same scene, or if they are named."""


@dataclass(frozen=True)
class Options:
    """The options of a vibe that the engine takes."""

    # fmt: off
    rounds: int = option(STANDARD.rounds, "number of rounds: the plan is made anew in each", "effort", bounds=(1, 1000),
        panel=Panel("Rounds", "Number of rounds: the plan is made anew in each", (1, 100)))
    steps: int = option(
        STANDARD.steps, "steps in each round: images of the proxy that the search looks at", "effort",
        bounds=(1, 10000), panel=Panel("Steps", "Refinements in each round", (1, 1000)))
    starts: int = option(STANDARD.starts, "starting points of the coarse search", "effort", bounds=(1, 1000))
    variants: int = option(
        1, "different looks to find for the same words, as images to choose from", "effort", bounds=(1, 12),
        panel=Panel("Variants", "Different looks for the same words, as images to choose from", (1, 8)))
    top_k: int = option(8, "parameters that a round may optimize", "effort", bounds=(1, 10000),
        panel=Panel("Parameters per Round", "How many parameters a round may refine", (1, 64)))
    seed: int = option(0, "the same seed gives the same look", "effort", bounds=(0, LARGEST_SEED), manifest=(),
        panel=Panel("Seed", "Another seed finds another look"))
    grade_each: bool = option(False, "each shot gets an exposure and a grade of its own, and a .blend of its own",
        "shots", manifest=("shots",))
    groups: tuple[str, ...] = option(
        (), f"only these may change: {', '.join(GROUPS)} (default: all but the camera, which a bare mesh "
        "leaves free)", "reach", unit="A,B")
    lock: tuple[str, ...] = option((), "leave this alone: a group, light/Key, or */roughness; can be given several "
        "times", "reach", unit="PATTERN",
        panel=Panel("Locked (Patterns)", "Values that must stay, separated by commas: light/Key, material/*/metallic, "
            "film/exposure"))
    target: tuple[str, ...] = option((), 'what a word describes, where it is taken for something else: copper=Cup, '
        'warm="key light", gold="not used"; can be given several times', "reach", unit="WORD=TARGET")
    new_lights: bool = option(True, "light the scene with its own lights alone: add none", "reach",
        panel=Panel("Add Lights", "Add the lights that a lighting word needs and the scene lacks, in a collection Vibe "
            "Lights. Revert removes them. Off: your own lights play all parts"))
    encoder: str = option("", "an open_clip model such as ViT-B-32-256/datacomp_s34b_b86k, or a local checkpoint "
        "(default: the embedded one)", "engine", unit="TAG|PATH",
        panel=Panel("Encoder", "An open_clip model's tag or a checkpoint that guides the look. Empty: the one that "
            "comes with it", preferences=True))
    device: str = option("auto", "auto, cpu, cuda, cuda:1 (default: auto)", "engine", unit="NAME",
        panel=Panel("Device", "What the engine computes on: Auto (a graphics card if there is one), CPU, CUDA, CUDA:1, "
            "MPS", default="Auto", suggestions=("Auto", "CPU", "CUDA", "MPS"), preferences=True))
    vlm_model: str = option("", "a vision-language model that plans and judges, such as qwen2.5vl:7b or gpt-5-mini; "
        "off for none (default: VIBE_VLM_MODEL, else none)", "engine", unit="NAME",
        panel=Panel("Model", "A vision-language model that reads the prompt and the image, and plans. Empty: none (or "
            "the one that the environment variable VIBE_VLM_MODEL names)", length=200, preferences=True))
    vlm_url: str = option("", "base URL of its OpenAI-compatible endpoint, such as http://localhost:11434/v1 for "
        "Ollama (default: VIBE_VLM_URL, else OPENAI_BASE_URL, else OpenAI's); its key is read from VIBE_VLM_KEY or "
        "OPENAI_API_KEY only", "engine", unit="URL",
        panel=Panel("Endpoint", "Base URL of the model's OpenAI-compatible server. Empty: OPENAI_BASE_URL, or OpenAI's",
            length=500, preferences=True))
    anchor: bool = option(True, "skip the Cycles corrections: faster, less accurate", "engine",
        panel=Panel("Correct with Cycles", "Between rounds, render a small image with Cycles that corrects the "
            "prediction: closer to the final render, but Blender pauses for about a second each time"))
    like: str = option("", "a reference image, whose look is copied: a still, a photograph, a painting, an HDRI for "
        "its light; a prompt has priority", "picture", unit="FILE",
        panel=Panel("Reference Image", "File of an image whose look is copied: a still, a photograph, a painting, an "
            "HDRI for its light", path=True))
    goals: str = option("", "goals in a file, in the place of a prompt: of `vibe explain --goals`, of a report, or of "
        "a preset that has some", "picture", unit="FILE")
    like_only: tuple[str, ...] = option(
        (), f"what to take over from that image: {', '.join(TRAITS)} (default: all; materials only of the "
        "same scene)", "picture", unit="A,B")
    like_same: bool = option(False, "the image shows the same scene through this camera: compare it pixel by pixel "
        "(default: found automatically)", "picture",
        panel=Panel("Same Scene", "The image shows the same scene through this camera. Usually this is found "
            "automatically"))
    size: int = option(
        STANDARD.size, "longer side of the images in pixels; the search uses smaller ones",
        "render", bounds=(32, 8192), panel=Panel("Preview Size", "Longer side of the preview, in pixels", (64, 2048)))
    figures: bool = option(False, "also write mask.png, where the subject is, and measure two predictions that are not "
        "shown: without the last anchor, and without any", "render")
    # fmt: on
    camera: bool = False  # whether the camera may be optimized though `groups` does not name it
    goes_on: bool = False  # whether the prompt is a further sentence, see `schema.sentences`
    online: bool = True  # whether other computers may be reached; a model on this one always may

    @classmethod
    def from_dict(cls, raw: dict[str, Any]) -> Self:
        """Options from their JSON form; missing ones keep their defaults. Raises VibeError for an unknown name."""
        defaults = {f.name: f.default for f in fields(cls)}
        if strange := sorted(set(raw) - set(defaults)):
            raise VibeError(f"Unknown option {strange[0]!r}.", f"Use one of: {', '.join(sorted(defaults))}.")
        typed: dict[str, Any] = {k: tuple(v) if isinstance(defaults[k], tuple) else v for k, v in raw.items()}
        return cls(**typed)


def rows(message: type[Options]) -> tuple[Option, ...]:
    """The rows of the table that are fields of `message`, the class `Options`, with the fields' names."""
    known = (f for f in fields(message) if "option" in f.metadata)
    return tuple(replace(f.metadata["option"], name=f.name) for f in known)


_EFFORT = "; ".join(f"{name}: {b.rounds} rounds of {b.steps} steps, {b.summary}" for name, b in BUDGETS.items())

# fmt: off
TASK = (  # options of the task, which the Blender process turns into a job for the engine
    Option("subject", (), "object or collection that the image is about; can be given several times (default: found "
           "automatically)", "task", unit="NAME", manifest=("scene", "shots")),
    Option("prompt", "", 'the look: "misty, cool blue fog, vignette"', "task", unit="TEXT", manifest=(),
           panel=Panel("Prompt", "The mood in your own words, for example: misty tree silhouette, cool blue "
                       "fog, vignette", length=LONGEST_PROMPT, live=True)),
    Option("then", (), 'a further sentence, which goes on from the last result: "a bit warmer"; without '
           "--prompt, from the one in the .blend; can be given several times", "task", unit="TEXT", manifest=()),
    Option("stage", "cyclorama", "what a bare mesh is put on (default: cyclorama)", "task", choices=STAGES,
           manifest=("scene",)),
    Option("cameras", (), "names of cameras (default: the scene's own)", "shots", unit="A,B", manifest=("shots",)),
    Option("frames", "", "frames, as in 1,50,100-102 (default: the one that the scene was saved at); what is "
           "animated stays so", "shots", unit="1,50,100", manifest=("shots",)),
    Option("check_every", 0, "after the search, measure every N-th frame of the scene, and list those where a word is no "
           "longer visible", "shots", bounds=(0, 10000), manifest=()),
    Option("steady", False, "after --check-every, search one look for the frames too where a word was no longer visible",
           "shots", manifest=()),
    Option("moments", "", 'frames and their looks, instead of --prompt: "1: noon; 120: golden hour; 200: moonlit night"',
           "moments", unit="TEXT", manifest=()),
    Option("markers", False, "the names of the scene's timeline markers are the looks at their frames", "moments",
           manifest=()),
    Option("offset_keys", False, "values with keyframes of your own may change, too: all keys of each move by as much",
           "moments", panel=Panel("Offset My Keyframes", "Values with keyframes of your own may change, too. Their keyframes "
                                  "are set aside until Keep, which moves all of them by as much as the look changes the value")),
    Option("effort", "standard", f"{_EFFORT} (default: standard)", "effort", choices=tuple(BUDGETS),
           panel=Panel("Effort", "How long the search may take", default="STANDARD")),
)

SUPPORT = (  # options of the processes around the engine
    Option("vocabulary", "", "a .toml with words of your own (default: vocabulary.toml in your "
           "configuration folder, if there is one)", "reach", unit="FILE",
           blender=False),  # processes find it in their environment
    Option("samples", 128, "Cycles samples of the images (the one before: 16 at most)", "render", bounds=(1, 65536)),
    Option("light_mix", False, "also write lights.exr: a layer of the Cycles render for each light, for the world and "
           "for emitting materials, linear, before exposure, grade and view transform", "render",
           panel=Panel("Light Mix", "Render the light layers as soon as a vibe is in the scene. Blender pauses "
                       "for the render")),
)
# fmt: on

TABLE = (*TASK, *rows(Options), *SUPPORT)


def named(name: str, table: Iterable[Option] = TABLE) -> Option:
    """The row of the table with an option's name."""
    return next(row for row in table if row.name == name)


def add_option(container: argparse._ActionsContainer, option: Option, **changes: Any) -> None:
    """Adds one option to a parser; `changes` replace its `default`, `required` or `help` in this command."""
    default = changes.get("default", option.command_default)
    keywords: dict[str, Any] = {"dest": option.name, "default": default, "help": option.text(default)}
    if isinstance(option.default, bool):
        keywords["action"] = "store_false" if option.default else "store_true"
    elif isinstance(option.default, tuple):
        keywords |= {"action": "append", "metavar": option.unit}
    elif isinstance(option.default, int):
        keywords |= {"type": int, "metavar": option.unit}
    else:
        keywords |= {"choices": option.choices} if option.choices else {"metavar": option.unit}
    container.add_argument(option.flag, **(keywords | changes))


def add_options(parser: argparse.ArgumentParser, headings: Iterable[str], table: Iterable[Option] = TABLE) -> None:
    """Adds the options of a table to a parser: those under the given keys of `HEADINGS`, each group with its title."""
    table = tuple(table)
    for heading in headings:
        title = HEADINGS[heading]
        container = parser.add_argument_group(title) if title else parser
        for option in table:
            if option.heading == heading:
                add_option(container, option)


def to_arguments(given: argparse.Namespace, table: Iterable[Option] = TABLE) -> list[str]:
    """The parsed options `given` as arguments for the Blender process, without `effort` and options not set."""
    arguments: list[str] = []
    for option in table:
        value = getattr(given, option.name, None)
        if not option.blender or option.name == "effort" or value is None:
            continue
        if isinstance(option.default, bool):
            arguments += [option.flag] if value is not option.default else []
        elif isinstance(option.default, tuple):
            arguments += [f"{option.flag}={one}" for one in value]
        elif value != "":
            arguments.append(f"{option.flag}={value}")
    return arguments


def engine_options(given: argparse.Namespace, camera: bool, online: bool) -> Options:
    """The engine's options from a parsed command line; `camera` and `online` are the fields of `Options`."""
    chosen = {row.name: getattr(given, row.name) for row in rows(Options)}
    return Options.from_dict({**chosen, "camera": camera, "online": online})
