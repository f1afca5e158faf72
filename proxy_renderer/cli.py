# SPDX-License-Identifier: Apache-2.0
"""The command `vibe`. Nothing heavy is imported before the arguments have been found good."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from . import __version__, check
from .schema import VibeError
from .schema.messages import Options

DEMO_PROMPT = "Glossy teal, warm soft light, misty blue surroundings, vignette"
BENCHES = ("speed",)
_DEFAULTS = Options()


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command and returns its exit code: 0, or 2 with one clear line for what the user can mend."""
    arguments = parser().parse_args(argv)
    try:
        return arguments.command(arguments)
    except VibeError as error:
        print(f"vibe: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("vibe: stopped.", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 1


def parser() -> argparse.ArgumentParser:
    """The command line, with its help."""
    top = _Parser(
        prog="vibe",
        description="Type a vibe, get Blender node values that render it.",
        epilog="Start with `vibe demo`. Each command explains itself: `vibe run --help`.",
    )
    top.add_argument("--version", action="version", version=f"vibe-render {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=_Parser)

    def command(name: str, act: Callable[[argparse.Namespace], int], summary: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=summary, description=summary, formatter_class=_Help)
        sub.set_defaults(command=act)
        return sub

    run = command("run", _run, "Give a scene the look that the words describe.")
    run.add_argument("scene", metavar="SCENE", help="a .blend, or a mesh: .obj .glb .gltf .ply .stl")
    run.add_argument(
        "--prompt", required=True, metavar="TEXT", help='the look: "misty, cool blue fog, vignette"'
    )
    run.add_argument(
        "--out", required=True, type=Path, metavar="DIR", help="folder for pictures, .blend and report"
    )
    run.add_argument("--stage", choices=check.STAGES, help="what a bare mesh is put on (default: cyclorama)")
    _add_options(run)

    demo = command("demo", _demo, "See it work on a scene that it builds itself.")
    demo.add_argument("--prompt", default=DEMO_PROMPT, metavar="TEXT", help="the look (default: %(default)s)")
    demo.add_argument(
        "--out", type=Path, default=Path("demo"), metavar="DIR", help="folder (default: %(default)s)"
    )
    _add_options(demo)

    apply = command("apply", _apply, "Give a scene the look that a preset holds, and render it.")
    apply.add_argument("preset", metavar="PRESET", help="a preset.json that `vibe run` has written")
    apply.add_argument("scene", metavar="SCENE", help="a .blend, or a mesh")
    apply.add_argument(
        "--out", required=True, type=Path, metavar="DIR", help="folder for pictures and .blend"
    )
    _add_render_options(apply)

    revert = command("revert", _revert, "Take every vibe out of a .blend again, exactly.")
    revert.add_argument(
        "scene", metavar="FILE.blend", help="a file that `vibe run` has written; it is changed in place"
    )

    explain = command("explain", _explain, "Say what the words mean to Vibe Render, without a scene.")
    explain.add_argument("prompt", metavar="TEXT", help="the look")

    command("doctor", _doctor, "Check what is installed, and say what to fix.")

    bench = command("bench", _bench, "Measure, and write DIR/results.json.")
    bench.add_argument("name", choices=BENCHES, metavar="NAME", help=f"one of: {', '.join(BENCHES)}")
    bench.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the results")

    extension = command("extension", _extension, "Build the Blender extension (a .zip to install from disk).")
    extension.add_argument(
        "--out", type=Path, default=Path("dist"), metavar="DIR", help="folder (default: %(default)s)"
    )
    return top


class _Parser(argparse.ArgumentParser):
    """Argument mistakes in one line, like every other mistake."""

    def error(self, message: str) -> NoReturn:
        """Exits with code 2."""
        self.exit(2, f"vibe: {message[:1].upper()}{message[1:]}. See `{self.prog} --help`.\n")


class _Help(argparse.HelpFormatter):
    """Help texts in a column wide enough for the option names."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=28, width=100)


def _add_options(sub: argparse.ArgumentParser) -> None:
    """The options of a vibe; their names and defaults are those of `messages.Options`."""
    d = _DEFAULTS
    budget = sub.add_argument_group("budget")
    budget.add_argument(
        "--rounds",
        type=int,
        default=d.rounds,
        metavar="N",
        help=f"times that the plan is made (default: {d.rounds})",
    )
    budget.add_argument(
        "--steps",
        type=int,
        default=d.steps,
        metavar="N",
        help=f"gradient steps in each round (default: {d.steps})",
    )
    budget.add_argument(
        "--top-k",
        type=int,
        default=d.top_k,
        metavar="K",
        help=f"parameters that a round may optimise (default: {d.top_k})",
    )
    budget.add_argument(
        "--seed",
        type=int,
        default=d.seed,
        metavar="N",
        help=f"the same seed gives the same look (default: {d.seed})",
    )
    reach = sub.add_argument_group("reach")
    reach.add_argument(
        "--groups",
        action="append",
        default=[],
        metavar="A,B",
        help="only these may change: camera, light, world, material, volume, film (default: all but the camera, which bare meshes free)",
    )
    reach.add_argument(
        "--lock",
        action="append",
        default=[],
        metavar="PATTERN",
        help="leave this alone: a group, light/Key, or */roughness; can be given several times",
    )
    engine = sub.add_argument_group("engine")
    engine.add_argument(
        "--encoder",
        default="",
        metavar="TAG|PATH",
        help="an open_clip model such as ViT-B-32-256/datacomp_s34b_b86k, or a local checkpoint (default: the embedded one)",
    )
    engine.add_argument(
        "--device", default=d.device, metavar="NAME", help="auto, cpu, cuda, cuda:1 (default: auto)"
    )
    engine.add_argument(
        "--baseline",
        choices=("clip-only",),
        default="",
        help="the paper's baseline instead: one similarity, all parameters",
    )
    _add_render_options(sub)


def _add_render_options(sub: argparse.ArgumentParser) -> None:
    render = sub.add_argument_group("render")
    render.add_argument(
        "--size",
        type=int,
        default=_DEFAULTS.size,
        metavar="PIXELS",
        help=f"longer side of the pictures (default: {_DEFAULTS.size})",
    )
    render.add_argument(
        "--samples", type=int, default=128, metavar="N", help="Cycles samples of the pictures (default: 128)"
    )


def _run(a: argparse.Namespace) -> int:
    scene = check.scene(a.scene)
    if a.stage and scene.suffix == ".blend":
        raise VibeError("--stage is for bare meshes; a .blend brings its own.", "Leave --stage out.")
    return _vibe(a, ["run", str(scene), *(["--stage", a.stage] if a.stage else [])])


def _demo(a: argparse.Namespace) -> int:
    return _vibe(a, ["demo"])


def _vibe(a: argparse.Namespace, what: list[str]) -> int:
    """Checks everything that can be checked without Blender, then starts it."""
    check.prompt(a.prompt)
    check.numbers(a)
    groups = check.groups(a.groups)
    check.locks(a.lock)
    check.device(a.device)
    out = check.folder(a.out)
    options = [
        f"--{name.replace('_', '-')}={getattr(a, name)}"
        for name in ("rounds", "steps", "top_k", "seed", "size", "samples", "device")
    ]
    options += [
        f"--{name}={value}" for name, value in (("encoder", a.encoder), ("baseline", a.baseline)) if value
    ]
    options += [f"--groups={','.join(groups)}"] if groups else []
    options += [f"--lock={pattern}" for pattern in a.lock]
    from .launch import launch

    return launch([*what, f"--prompt={a.prompt}", f"--out={out}", *options], out)


def _apply(a: argparse.Namespace) -> int:
    from .launch import launch

    check.numbers(a)
    preset, scene = check.file(a.preset, "preset"), check.scene(a.scene)
    out = check.folder(a.out)
    return launch(
        ["apply", str(preset), str(scene), f"--out={out}", f"--size={a.size}", f"--samples={a.samples}"], out
    )


def _revert(a: argparse.Namespace) -> int:
    from .launch import launch

    scene = check.scene(a.scene)
    if scene.suffix != ".blend":
        raise VibeError(
            f"{a.scene} is not a .blend.", "Revert takes the vibed.blend that a vibe has written."
        )
    return launch(["revert", str(scene)], scene.parent)


def _explain(a: argparse.Namespace) -> int:
    from .explain import explain

    check.prompt(a.prompt)
    print(explain(a.prompt))
    return 0


def _doctor(a: argparse.Namespace) -> int:
    from .doctor import examine

    return examine()


def _bench(a: argparse.Namespace) -> int:
    from importlib import import_module

    out = check.folder(a.out)
    print(f"Measuring {a.name} …", flush=True)
    import_module(f".bench.{a.name}", __package__).run(out)
    print(f"Written: {out / 'results.json'}")
    return 0


def _extension(a: argparse.Namespace) -> int:
    from .extension import build

    print(f"Written: {build(a.out)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
