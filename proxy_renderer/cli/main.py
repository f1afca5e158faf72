# SPDX-License-Identifier: Apache-2.0
"""The command `vibe`. Nothing heavy is imported before the arguments have been found good."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from .. import __version__
from ..batch.options import add_batch_options
from ..bench.options import BENCHES
from ..options import check
from ..options.arguments import (
    Help,
    Parser,
    add_render_options,
    add_scene,
    add_shots,
    add_vibe_options,
    add_vocabulary,
    shot_arguments,
    vibe_arguments,
)
from ..schema import VibeError

DEMO_PROMPT = "Glossy teal on a pale sand background, warm soft light, slight vignette"


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command and returns its exit code: 0, or 2 with one clear line for what the user can mend."""
    arguments = _arguments(argv)
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


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """The command line; a scene that may be left out is also found behind options, where argparse looks no more."""
    top = parser()
    arguments, left = top.parse_known_args(argv)
    if left and getattr(arguments, "scene", None) == "" and not left[0].startswith("-"):
        arguments.scene = left.pop(0)
    if left:
        top.error(f"unrecognized arguments: {' '.join(left)}")
    return arguments


def parser() -> argparse.ArgumentParser:
    """The command line, with its help."""
    top = Parser(
        prog="vibe",
        description="Type a vibe, get Blender node values that render it.",
        epilog="Start with `vibe demo`. Each command explains itself: `vibe run --help`.",
    )
    top.add_argument("--version", action="version", version=f"vibe-render {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=Parser)

    def command(name: str, act: Callable[[argparse.Namespace], int], summary: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=summary, description=summary, formatter_class=Help)
        sub.set_defaults(command=act)
        return sub

    run = command("run", _run, "Give a scene the look that the words describe.")
    add_scene(run)
    run.add_argument("more", nargs="*", metavar="SCENE", help="more .blends that are to have the same look")
    run.add_argument(
        "--prompt", required=True, metavar="TEXT", help='the look: "misty, cool blue fog, vignette"'
    )
    run.add_argument(
        "--out", required=True, type=Path, metavar="DIR", help="folder for pictures, .blend and report"
    )
    run.add_argument("--stage", choices=check.STAGES, help="what a bare mesh is put on (default: cyclorama)")
    add_shots(run)
    add_vibe_options(run)

    demo = command("demo", _demo, "See it work on a scene that it builds itself.")
    demo.add_argument("--prompt", default=DEMO_PROMPT, metavar="TEXT", help="the look (default: %(default)s)")
    demo.add_argument(
        "--out", type=Path, default=Path("demo"), metavar="DIR", help="folder (default: %(default)s)"
    )
    add_vibe_options(demo)

    batch = command("batch", _batch, "Give many scenes many looks, on this machine or on a cluster.")
    add_batch_options(batch)

    flamenco = command("flamenco", _flamenco, "Install the job type that brings looks to a Flamenco farm.")
    flamenco.add_argument(
        "action", choices=("install",), metavar="install", help="the only thing to do with it"
    )
    flamenco.add_argument(
        "--scripts", required=True, type=Path, metavar="DIR", help="folder `scripts` of your Flamenco Manager"
    )

    apply = command("apply", _apply, "Give a scene the look that a preset holds, and render it.")
    apply.add_argument(
        "preset", metavar="PRESET", help="a preset.json that `vibe run` has written, or a name: noir"
    )
    add_scene(apply)
    apply.add_argument(
        "--out", required=True, type=Path, metavar="DIR", help="folder for pictures and .blend"
    )
    add_render_options(apply)

    revert = command("revert", _revert, "Take every vibe out of a .blend again, exactly.")
    revert.add_argument(
        "scene", metavar="FILE.blend", help="a file that `vibe run` has written; it is changed in place"
    )

    explain = command("explain", _explain, "Say what the words mean to Vibe Render, and to a scene.")
    explain.add_argument("prompt", metavar="TEXT", help="the look")
    add_scene(explain, optional=True)
    add_vocabulary(explain)
    explain.add_argument("--json", action="store_true", help="for programs")

    command("doctor", _doctor, "Check what is installed, and say what to fix.")

    bench = command("bench", _bench, "Measure, and write DIR/results.json.")
    benches = bench.add_subparsers(
        title="measurements", metavar="NAME", dest="bench", required=True, parser_class=Parser
    )
    for name, (summary, add_options) in BENCHES.items():
        sub = benches.add_parser(name, help=summary, description=summary, formatter_class=Help)
        sub.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the results")
        add_options(sub)

    extension = command("extension", _extension, "Build the Blender extension, or install it.")
    extension.add_argument(
        "action", choices=("build", "install"), help="make a .zip to install from disk, or install it at once"
    )
    extension.add_argument(
        "--out", type=Path, default=Path("dist"), metavar="DIR", help="build: folder (default: %(default)s)"
    )
    extension.add_argument(
        "--blender", default="", metavar="PATH", help="install: into this Blender (default: the PATH's)"
    )
    return top


def _run(a: argparse.Namespace) -> int:
    scene = check.scene(a.scene)
    if a.stage and scene.suffix.lower() == ".blend":
        raise VibeError("--stage is for bare meshes; a .blend brings its own.", "Leave --stage out.")
    stage = [f"--stage={a.stage}"] if a.stage else []
    scenes = check.shots([scene, *map(check.scene, a.more)], a)
    return _vibe(a, ["run", *map(str, scenes), *stage, *_subjects(a), *shot_arguments(a)])


def _subjects(a: argparse.Namespace) -> list[str]:
    return [f"--subject={name}" for name in a.subject]


def _demo(a: argparse.Namespace) -> int:
    return _vibe(a, ["demo"])


def _vibe(a: argparse.Namespace, what: list[str]) -> int:
    """Checks everything that can be checked without Blender, then starts it."""
    check.prompt(a.prompt)
    check.vocabulary(a.vocabulary)
    if not check.model(a):
        check.words(a.prompt)
    check.numbers(a)
    groups = check.groups(a.groups)
    check.locks(a.lock)
    check.device(a.device)
    out = check.folder(a.out)
    from ..blender.launch import launch

    return launch([*what, f"--prompt={a.prompt}", f"--out={out}", *vibe_arguments(a, groups)], out)


def _batch(a: argparse.Namespace) -> int:
    from ..batch.command import run

    return run(a)


def _flamenco(a: argparse.Namespace) -> int:
    from ..batch.flamenco import install

    print(f"Written: {install(a.scripts)}. Restart the Manager, then refresh the job types in Blender.")
    return 0


def _apply(a: argparse.Namespace) -> int:
    from ..blender.launch import launch

    check.numbers(a)
    preset, scene = check.preset(a.preset), check.scene(a.scene)
    out = check.folder(a.out)
    render = [f"--size={a.size}", f"--samples={a.samples}"]
    return launch(["apply", preset, str(scene), f"--out={out}", *_subjects(a), *render], out)


def _revert(a: argparse.Namespace) -> int:
    from ..blender.launch import launch

    scene = check.scene(a.scene)
    if scene.suffix.lower() != ".blend":
        raise VibeError(
            f"{a.scene} is not a .blend.", "Revert takes the vibed.blend that a vibe has written."
        )
    return launch(["revert", str(scene)], scene)


def _explain(a: argparse.Namespace) -> int:
    from .explain import account

    check.prompt(a.prompt)
    check.vocabulary(a.vocabulary)
    scene = check.scene(a.scene) if a.scene else None
    print(account(a.prompt, a.json, scene, _subjects(a)))
    return 0


def _doctor(a: argparse.Namespace) -> int:
    from .doctor import examine

    return examine()


def _bench(a: argparse.Namespace) -> int:
    from importlib import import_module

    check.numbers(a)
    out = check.folder(a.out)
    print(f"Measuring {a.bench} …", flush=True)
    options = {k: v for k, v in vars(a).items() if k not in ("command", "bench", "out")}
    results = import_module(f"..bench.{a.bench}", __package__).run(out, **options)
    print(f"Written: {out / 'results.json'}")
    return 1 if results.get("failed") else 0


def _extension(a: argparse.Namespace) -> int:
    from ..blender.extension import build, install

    print(install(a.blender) if a.action == "install" else f"Written: {build(a.out)}")
    return 0
