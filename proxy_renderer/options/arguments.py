# SPDX-License-Identifier: Apache-2.0
"""The options that commands share. Those of a vibe have the names and defaults of `messages.Options`."""

from __future__ import annotations

import argparse
from typing import NoReturn

from ..schema import BUDGETS, GROUPS, budgets
from ..schema.messages import Options

_DEFAULTS = Options()
_OPTIONAL = ("encoder", "baseline", "vlm_model", "vlm_url")
_BUDGET = {
    "rounds": "times that the plan is made",
    "steps": "gradient steps in each round",
    "starts": "points that a coarse first pass tries",
    "variants": "different looks to find for the same words, as pictures to choose from",
    "top_k": "parameters that a round may optimize",
    "seed": "the same seed gives the same look",
}
_EFFORT = "; ".join(
    f"{name}: {b.rounds} rounds of {b.steps} steps, {b.summary}" for name, b in BUDGETS.items()
)

_SIZE = "longer side of the pictures in pixels; the loop itself works with smaller ones"
_GROUPS = (
    f"only these may change: {', '.join(GROUPS)} (default: all but the camera, which a bare mesh leaves free)"
)
_SUBJECT = (
    "object or collection that the picture is about; can be given several times (default: found by itself)"
)
_LOCK = "leave this alone: a group, light/Key, or */roughness; can be given several times"
_VOCABULARY = (
    "a .toml with words of your own (default: vocabulary.toml in your configuration folder, if there is one)"
)
_ENCODER = "an open_clip model such as ViT-B-32-256/datacomp_s34b_b86k, or a local checkpoint (default: the embedded one)"
_ANCHOR = "do not let small Cycles pictures correct the prediction meanwhile: quicker, and less exact"

_CAMERAS = "names of cameras (default: the scene's own)"
_FRAMES = (
    "frames, as in 1,50,100-102 (default: the one that the scene was saved at); what is animated stays so"
)
_GRADE = "each shot gets an exposure and a grade of its own, and a .blend of its own"

_MODEL = (
    "a vision-language model that plans and judges, such as qwen2.5vl:7b or gpt-5-mini; off for none "
    "(default: VIBE_VLM_MODEL, else none)"
)
_URL = (
    "base URL of its OpenAI-compatible endpoint, such as http://localhost:11434/v1 for Ollama (default: "
    "VIBE_VLM_URL, else OPENAI_BASE_URL, else OpenAI's); its key is read from VIBE_VLM_KEY or OPENAI_API_KEY only"
)


class Parser(argparse.ArgumentParser):
    """Argument mistakes in one line, like every other mistake."""

    def error(self, message: str) -> NoReturn:
        """Exits with code 2."""
        self.exit(2, f"vibe: {message[:1].upper()}{message[1:]}. See `{self.prog} --help`.\n")


class Help(argparse.HelpFormatter):
    """Help texts in a column wide enough for the option names."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=28, width=100)


def add_scene(sub: argparse.ArgumentParser, optional: bool = False) -> None:
    """The scene, and what in it is the subject."""
    count: dict[str, str] = {"nargs": "?", "default": ""} if optional else {}
    sub.add_argument("scene", metavar="SCENE", help="a .blend, or a mesh: .obj .glb .gltf .ply .stl", **count)  # type: ignore[arg-type]
    sub.add_argument("--subject", action="append", default=[], metavar="NAME", help=_SUBJECT)


def add_shots(sub: argparse.ArgumentParser) -> None:
    """Several cameras, frames and scenes for one look."""
    shots = sub.add_argument_group(
        "shots that share a look: each scene, through each camera, at each frame, and one set of values for all"
    )
    shots.add_argument("--cameras", action="append", default=[], metavar="A,B", help=_CAMERAS)
    shots.add_argument("--frames", default="", metavar="1,50,100", help=_FRAMES)
    shots.add_argument("--grade-each", action="store_true", help=_GRADE)


def shot_arguments(a: argparse.Namespace) -> list[str]:
    """The same options again, for the command line of Blender's side."""
    options = [f"--cameras={names}" for names in a.cameras]
    options += [f"--frames={a.frames}"] if a.frames else []
    return options + ["--grade-each"] * a.grade_each


def add_vocabulary(sub: argparse._ActionsContainer) -> None:
    """The artist's own words."""
    sub.add_argument("--vocabulary", default="", metavar="FILE", help=_VOCABULARY)


def add_vibe_options(sub: argparse.ArgumentParser) -> None:
    """Budget, reach, engine and render."""
    budget = sub.add_argument_group("budget")
    budget.add_argument(
        "--budget", choices=BUDGETS, default="standard", help=f"{_EFFORT} (default: standard)"
    )
    for name, text in _BUDGET.items():
        _add_number(budget, name, _default(name), text)
    reach = sub.add_argument_group("reach")
    reach.add_argument("--groups", action="append", default=[], metavar="A,B", help=_GROUPS)
    reach.add_argument("--lock", action="append", default=[], metavar="PATTERN", help=_LOCK)
    add_vocabulary(reach)
    engine = sub.add_argument_group("engine")
    engine.add_argument("--encoder", default="", metavar="TAG|PATH", help=_ENCODER)
    engine.add_argument(
        "--device", default=_DEFAULTS.device, metavar="NAME", help="auto, cpu, cuda, cuda:1 (default: auto)"
    )
    engine.add_argument("--vlm-model", default="", metavar="NAME", help=_MODEL)
    engine.add_argument("--vlm-url", default="", metavar="URL", help=_URL)
    engine.add_argument("--no-anchor", dest="anchor", action="store_false", help=_ANCHOR)
    engine.add_argument(
        "--baseline",
        choices=("clip-only",),
        default="",
        help="the paper's baseline instead: one similarity, all parameters",
    )
    add_render_options(sub, _default("size"))


def add_render_options(sub: argparse.ArgumentParser, size: int | None = _DEFAULTS.size) -> None:
    """Size (None for the budget's) and samples of what Cycles renders."""
    render = sub.add_argument_group("render")
    _add_number(render, "size", size, _SIZE)
    _add_number(render, "samples", 128, "Cycles samples of the pictures")


def vibe_arguments(a: argparse.Namespace, groups: list[str]) -> list[str]:
    """The same options again, for the command line of Blender's side."""
    names = (*_BUDGET, "size", "samples", "device", *(n for n in _OPTIONAL if getattr(a, n)))
    options = [f"--{name.replace('_', '-')}={getattr(a, name)}" for name in names]
    options += [f"--groups={','.join(groups)}"] if groups else []
    options += [] if a.anchor else ["--no-anchor"]
    return options + [f"--lock={pattern}" for pattern in a.lock]


def _default(name: str) -> int | None:
    """None for what the budget decides."""
    return None if name in budgets.NUMBERS else getattr(_DEFAULTS, name)


def _add_number(group: argparse._ArgumentGroup, name: str, default: int | None, text: str) -> None:
    option = f"--{name.replace('_', '-')}"
    said = "the budget's" if default is None else default
    group.add_argument(option, type=int, default=default, metavar="N", help=f"{text} (default: {said})")
