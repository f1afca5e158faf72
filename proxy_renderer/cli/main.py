# SPDX-License-Identifier: Apache-2.0
"""The command `vibe`: for each command its summary, its options, and the function that carries it out."""

# Everything heavy is imported inside the functions, after the arguments have been found good.
import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from .. import __version__
from ..inputs import check
from ..schema import VibeError, errors, limits
from ..schema.limits import MESH_FORMATS
from ..schema.options import checks
from ..schema.options.table import add_option, add_options, named, to_arguments
from ..schema.sentences import about_steps, plain

DEMO_PROMPT = "Glossy teal on a pale sand background, warm soft light, slight vignette"
_HOW = ("picture", "effort", "reach", "engine", "render")  # groups of options that apply to any scene


def _add_scene(parser: argparse.ArgumentParser, optional: bool = False) -> None:
    count: dict[str, Any] = {"nargs": "?", "default": ""} if optional else {}
    parser.add_argument("scene", metavar="SCENE", help=f"a .blend, or a mesh: {' '.join(MESH_FORMATS)}", **count)
    add_option(parser, named("subject"))


def _add_out(parser: argparse.ArgumentParser, help: str, default: str = "") -> None:
    given = Path(default) if default else None
    parser.add_argument("--out", required=not default, default=given, type=Path, metavar="DIR", help=help)


def _run_options(parser: argparse.ArgumentParser) -> None:
    _add_scene(parser)
    parser.add_argument("more", nargs="*", metavar="SCENE", help="more .blends that are to have the same look")
    add_option(parser, named("prompt"))
    add_option(parser, named("then"))
    _add_out(parser, "folder for images, .blend and report")
    add_option(parser, named("stage"), default="")
    add_options(parser, ("shots", "moments", *_HOW))


def _run(a: argparse.Namespace) -> int:
    scene = check.scene(a.scene)
    if a.stage and scene.suffix.lower() == ".blend":
        raise VibeError("--stage is for bare meshes; a .blend brings its own.", "Leave --stage out.")
    return carry_out(a, "run", check.shots([scene, *map(check.scene, a.more)], a))


def _demo_options(parser: argparse.ArgumentParser) -> None:
    shown = f"the look (default: {DEMO_PROMPT}; with a reference image: none)"
    add_option(parser, named("prompt"), default=None, help=shown)
    add_option(parser, named("then"))
    _add_out(parser, "folder (default: %(default)s)", "demo")
    add_options(parser, _HOW)


def _demo(a: argparse.Namespace) -> int:
    if a.prompt is None:  # a picture or goals replace the demo's own words
        a.prompt = "" if a.like or a.goals else DEMO_PROMPT
    return carry_out(a, "demo")


def carry_out(a: argparse.Namespace, what: str, scenes: Sequence[Path] = ()) -> int:
    """Checks everything that can be checked without Blender, then runs command `what` in it; returns the exit code."""
    looks = [look for _, look in checks.moments(a)]
    if not (looks or getattr(a, "markers", False)):
        checks.prompt(a.prompt, a.like, a.goals, a.then)
    checks.numbers(a)
    a.groups = checks.groups(a.groups)
    checks.locks(a.lock)
    checks.targets(a.target)
    a.like_only = checks.traits(a.like_only, a.like)
    a.like = str(check.file(a.like, "picture")) if a.like else ""
    check.device(a.device)
    from ..blender.launch import launch
    from ..blender.meshes import prepared

    with ExitStack() as stack:
        places = [str(stack.enter_context(prepared(scene))) for scene in scenes]
        check.vocabulary(a.vocabulary)  # after the meshes: it takes as long as they do
        a.goals = check.goals(a.goals)
        for words in filter(str.strip, (*looks, a.prompt)):
            check.words(words, a)
        for sentence in a.then:
            if about_steps(sentence) is None:
                check.words(plain(sentence)[0], a)
        out = checks.folder(a.out)  # last: a mistake leaves no folder
        return launch([what, *places, f"--out={out}", *to_arguments(a)], out)


def _batch_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    manifest = "scenes, shots that share a look, prompts, seeds and options"
    add("manifest", type=Path, metavar="MANIFEST.toml", help=manifest)
    _add_out(parser, "folder for all results")
    add("--dry-run", action="store_true", help="only say what would be done, and how long it takes")
    final = "then render these frames of every result with Cycles (without A-B: the scene's own frames)"
    add("--final", nargs="?", const="", metavar="A-B", help=final)
    workers = "jobs at a time (default: as many as cores, memory and graphics cards hold)"
    add("--workers", type=int, default=0, metavar="N", help=workers)
    ray = "on the Ray cluster at this address; without one, on the cluster that this machine belongs to"
    add("--ray", nargs="?", const="auto", default="", metavar="ADDRESS", help=ray)


def _batch(a: argparse.Namespace) -> int:
    from ..batch.command import run

    return run(a)


def _flamenco_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("action", choices=("install",), metavar="install", help="the only thing to do with it")
    add("--scripts", required=True, type=Path, metavar="DIR", help="folder `scripts` of your Flamenco Manager")


def _flamenco(a: argparse.Namespace) -> int:
    from ..batch.command import install_job_type

    print(f"Written: {install_job_type(a.scripts)}. Restart the Manager, then refresh the job types in Blender.")
    return 0


def _apply_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("preset", metavar="PRESET", help="a preset.json that `vibe run` has written, or a name: noir")
    _add_scene(parser)
    _add_out(parser, "folder for pictures and .blend")
    render = parser.add_argument_group("render")
    add_option(render, named("size"), default=limits.STANDARD.size)
    add_option(render, named("samples"))


def _apply(a: argparse.Namespace) -> int:
    from ..blender.launch import launch
    from ..blender.meshes import prepared

    checks.numbers(a)
    preset, scene = check.preset(a.preset), check.scene(a.scene)
    out = checks.folder(a.out)
    with prepared(scene) as place:
        return launch(["apply", preset, str(place), f"--out={out}", *to_arguments(a)], out)


def _revert_options(parser: argparse.ArgumentParser) -> None:
    scene = "a file that `vibe run` has written; it is changed in place"
    parser.add_argument("scene", metavar="FILE.blend", help=scene)


def _revert(a: argparse.Namespace) -> int:
    from ..blender.launch import launch

    scene = check.scene(a.scene)
    if scene.suffix.lower() != ".blend":
        raise VibeError(f"{a.scene} is not a .blend.", "Revert takes the vibed.blend that a vibe has written.")
    return launch(["revert", str(scene)], scene)


def _explain_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("prompt", metavar="TEXT", help="the look")
    _add_scene(parser, optional=True)
    add_option(parser, named("vocabulary"))
    add_option(parser, named("target"))
    why = "what each look word may be bound to, with scores and the facts that decided"
    parser.add_argument("--why", action="store_true", help=why)
    goals = "what the words wish for, as JSON that `vibe run --goals` reads"
    parser.add_argument("--goals", action="store_true", help=goals)
    parser.add_argument("--json", action="store_true", help="for programs")


def _explain(a: argparse.Namespace) -> int:
    from .explain import account

    checks.prompt(a.prompt)
    check.vocabulary(a.vocabulary)
    checks.targets(a.target)
    scene = check.scene(a.scene) if a.scene else None
    form = next((form for form in ("why", "goals", "json") if getattr(a, form)), "text")
    print(account(a.prompt, form, scene, a.subject, a.target))
    return 0


def _vocabulary_options(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True, dest="action")
    add = actions.add_parser("add", help="write an entry or a color into your vocabulary")
    add.add_argument("name", metavar="NAME", help="the word")
    add.add_argument("--color", metavar="#RRGGBB", default="", help="it is a color, and this is it")
    add.add_argument("--slot", default="material", help="kind of look word (default: material)")
    add.add_argument("--words", default="", help="other ways to say it, comma separated")
    wish = 'what it wishes for: a class ("finish is glossy"), an effect or a claim; may be repeated'
    add.add_argument("--wish", action="append", default=[], metavar="TEXT", help=wish)
    add.add_argument("--means", default="", help="the same said in plain look words")
    test = actions.add_parser("test", help="say how a prompt is read with it")
    test.add_argument("text", metavar="TEXT", help="the look")
    listed = actions.add_parser("list", help="list entries and colors")
    listed.add_argument("part", metavar="TEXT", nargs="?", default="", help="only those with this in a wording")
    for action in (add, test, listed):
        add_option(action, named("vocabulary"))


def _vocabulary(a: argparse.Namespace) -> int:
    from ..folders import config_folder
    from ..words.lexicon import vocabulary

    if a.action == "add":
        if bool(a.color) == bool(a.wish or a.means):
            raise VibeError(f"'{a.name}' needs a color, or what it does.", "Give --color, or --wish, or --means.")
        path = Path(a.vocabulary).expanduser() if a.vocabulary else config_folder() / "vocabulary.toml"
        if a.color:
            vocabulary.add_color(path, a.name, a.color)
        else:
            vocabulary.add_look(path, a.name, {"slot": a.slot, "words": a.words, "wishes": a.wish, "means": a.means})
        print(f"'{a.name}' is in {path} now.")
        return 0
    check.vocabulary(a.vocabulary)
    if a.action == "test":
        from .explain import account

        print(account(a.text))
    else:
        known, part = vocabulary.default_vocabulary(), a.part.lower()
        for entry in known.entries.values():
            if any(part in word for word in entry.words):
                others = ", ".join(word for word in entry.words if word != entry.name)
                print(f"{entry.name} ({entry.slot}){': ' + others if others else ''}")
        print("\n".join(f"{name} (color)" for name in known.colors if part in name))
    return 0


def _doctor(a: argparse.Namespace) -> int:
    from .doctor import examine

    return examine()


def _extension_options(parser: argparse.ArgumentParser) -> None:
    action = (
        "make a .zip to install from disk, install it at once, or make a .zip with the index that Blender subscribes to"
    )
    parser.add_argument("action", choices=("build", "install", "repository"), help=action)
    _add_out(parser, "build, repository: folder (default: %(default)s)", "dist")
    blender = "install: into this Blender (default: the PATH's)"
    parser.add_argument("--blender", default="", metavar="PATH", help=blender)


def _extension(a: argparse.Namespace) -> int:
    from ..blender.extension import build, install, repository

    if a.action == "install":
        print(install(a.blender))
    else:
        print(f"Written: {(build if a.action == 'build' else repository)(a.out)}")
    return 0


class Command(NamedTuple):
    """A command: its line in the help, a function that adds its options, and one that returns its exit code."""

    summary: str
    add_options: Callable[[argparse.ArgumentParser], None]
    act: Callable[[argparse.Namespace], int]


COMMANDS = {  # in the order of the help
    "run": Command("Give a scene the look that words describe, or a reference image has.", _run_options, _run),
    "demo": Command("Build a small test scene and give it a look.", _demo_options, _demo),
    "batch": Command("Give many scenes many looks, on this machine or on a cluster.", _batch_options, _batch),
    "flamenco": Command("Install the job type that brings looks to a Flamenco farm.", _flamenco_options, _flamenco),
    "apply": Command("Give a scene the look of a preset, and render it.", _apply_options, _apply),
    "revert": Command("Restore a .blend to its state before the first vibe.", _revert_options, _revert),
    "explain": Command("Show how a prompt is understood and what it would change.", _explain_options, _explain),
    "vocabulary": Command(
        "Add words of your own, try them, and list what words there are.", _vocabulary_options, _vocabulary
    ),
    "doctor": Command("Check what is installed, and say what to fix.", lambda parser: None, _doctor),
    "extension": Command(
        "Build the Blender extension, install it, or publish it in a repository.", _extension_options, _extension
    ),
}


class Parser(argparse.ArgumentParser):
    """A parser that reports mistakes in one line, as `main` does."""

    program = "vibe"

    def error(self, message: str) -> NoReturn:
        """Prints the message and exits with code 2."""
        self.exit(2, f"{self.program}: {message[:1].upper()}{message[1:]}. See `{self.prog} --help`.\n")


Help = partial(argparse.HelpFormatter, max_help_position=28, width=100)  # a column wide enough for the option names


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, 1 for a failure, 2 for what the user can fix, 130 for Ctrl-C."""
    arguments = _arguments(argv)
    try:
        return arguments.act(arguments)
    except VibeError as error:
        print(f"vibe: {error}", file=sys.stderr)
        return 1 if isinstance(error, errors.UnexpectedError) else 2
    except KeyboardInterrupt:
        print("vibe: stopped.", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 1
    except Exception as error:
        print(f"vibe: {errors.to_show(error, 'carrying out the command')}", file=sys.stderr)
        return 1


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    """The parsed command line; an optional scene is found after options too, where argparse does not look for it."""
    top = parser()
    arguments, left = top.parse_known_args(argv)
    if left and getattr(arguments, "scene", None) == "" and not left[0].startswith("-"):
        arguments.scene = left.pop(0)
    if left:
        top.error(f"unrecognized arguments: {' '.join(left)}")
    return arguments


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line, with its help."""
    top = Parser(
        prog="vibe",
        description="Type a vibe, get Blender node values that render it.",
        epilog="Start with `vibe demo`. Each command explains itself: `vibe run --help`.",
    )
    top.add_argument("--version", action="version", version=f"vibe-render {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True, parser_class=Parser)
    for name, command in COMMANDS.items():
        sub = commands.add_parser(name, help=command.summary, description=command.summary, formatter_class=Help)
        sub.set_defaults(act=command.act)
        command.add_options(sub)
    return top
