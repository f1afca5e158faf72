# SPDX-License-Identifier: Apache-2.0
"""The measurements and their options. Nothing heavy here."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from lab.methods import METHODS
from proxy_renderer.schema.options.table import add_option, named

HALVES = ("development", "held-out", "all")
"""Of a corpus of scenes: where faults may be looked for, where not, and both."""


def _speed(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--mitsuba", action="store_true", help="beside Mitsuba 3 too, where it is installed: time and error"
    )
    _eevee(sub)


def _time(sub: argparse.ArgumentParser) -> None:
    _pictures_of(sub, size=512, samples=128)
    sub.add_argument("--only", default="*", metavar="GLOB", help='only scenes with such names: "*fog*"')
    sub.add_argument(
        "--scenes", default="", metavar="DIR", help="a folder of .blend files (default: four scenes of ours)"
    )


def _scale(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--only", default="*", metavar="GLOB", help='only sizes with such names: "lights"')
    sub.add_argument(
        "--limit",
        type=int,
        default=300,
        metavar="N",
        help="seconds: a size grows no further after a scene that took longer (default: 300)",
    )


def _fidelity(sub: argparse.ArgumentParser) -> None:
    _pictures(sub, size=256, samples=512)
    sub.add_argument("--quick", action="store_true", help="128 pixels and 128 samples, for a first look")
    sub.add_argument("--seed", type=int, default=0, metavar="N", help="another set of the same kind (default: 0)")
    _eevee(sub)


def _rendered(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--count", type=int, default=500, metavar="N", help="so many scenes (default: 500)")
    sub.add_argument("--seed", type=int, default=0, metavar="N", help="other scenes (default: 0)")
    sub.add_argument("--only", default="*", metavar="GLOB", help='only such names: "*portal*"')
    _pictures_of(sub, size=160, samples=32)


def _eevee(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--eevee",
        dest="eevee_blender",
        default="",
        metavar="BLENDER",
        help="measure EEVEE too, with this Blender, which needs a display",
    )


def _gradients(sub: argparse.ArgumentParser) -> None:
    _pictures(sub, size=96, samples=128)


def _pictures(sub: argparse.ArgumentParser, size: int, samples: int) -> None:
    """The options of every measurement against Cycles."""
    _pictures_of(sub, size, samples)
    sub.add_argument("--only", default="*", metavar="GLOB", help='only scenes with such names: "*fog*"')
    sub.add_argument(
        "--cache",
        dest="cache_folder",
        default="",
        metavar="DIR",
        help="where Cycles' pictures are kept (default: the folder in VIBE_CACHE, or your cache)",
    )


def _paper(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--quick", action="store_true", help="few steps, small pictures, one seed: a first look")
    sub.add_argument("--seeds", type=int, default=None, metavar="N", help="how many (default: 3, or 1 with --quick)")
    sub.add_argument("--only", default="*", metavar="GLOB", help='only pairs with such names: "*duck*"')
    sub.add_argument(
        "--meshes",
        dest="mesh_folder",
        default="",
        metavar="DIR",
        help="where the paper's dolphin.obj, teapot.obj and tree.obj are (default: shared/meshes beside the clone)",
    )


def _batch(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--jobs", type=int, default=8, metavar="N", help="real vibes for each number of workers (default: 8)"
    )
    sub.add_argument("--workers", default="1,2,4", metavar="N,N", help="numbers of workers (default: 1,2,4)")
    sub.add_argument(
        "--simulated",
        default="10,100,1000",
        metavar="N,N",
        help="numbers of simulated jobs, up to 100000 (default: 10,100,1000)",
    )


def _encoder(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--encoder", default="embedded", metavar="NAME", help="as for a vibe (default: embedded)")
    sub.add_argument(
        "--views", type=int, default=96, metavar="N", help="views of shapes that training lacks (default: 96)"
    )
    sub.add_argument(
        "--pairs", type=int, default=240, metavar="N", help="pairs of Cycles pictures; 0 for none (default: 240)"
    )
    sub.add_argument(
        "--cache",
        dest="cache_folder",
        default="",
        metavar="DIR",
        help="where pictures are kept (default: the folder in VIBE_CACHE, or your cache)",
    )


def _wild(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--scenes", required=True, metavar="DIR", help="folder of .blend, .glb and other scenes")
    sub.add_argument(
        "--half",
        default="development",
        choices=HALVES,
        help="which scenes; the hash of a name says to which half it belongs (default: development)",
    )
    sub.add_argument(
        "--list", dest="listed", default="", metavar="FILE", help="only the paths in this file, one a line"
    )
    sub.add_argument("--prompt", default="", metavar="TEXT", help="for all scenes (default: one of eight each)")
    sub.add_argument("--only", default="*", metavar="GLOB", help='only paths like this: "*car*"')
    sub.add_argument("--size", type=int, default=256, metavar="N", help="longer side of the pictures (default: 256)")


def _ladder(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--baselines", action="store_true", help="the baselines at several rates instead of the method's parts"
    )
    sub.add_argument("--only", default="*", metavar="GLOB", help='only pairs with such names: "*duck*"')
    sub.add_argument("--rungs", default="*", metavar="GLOB", help='only rungs with such names: "*sharing"')
    sub.add_argument("--seeds", type=int, default=1, metavar="N", help="times that all is done (default: 1)")
    sub.add_argument("--size", type=int, default=160, metavar="N", help="side of the pictures (default: 160)")
    sub.add_argument("--rounds", type=int, default=3, metavar="N", help="most rounds of a run (default: 3)")


def _sealed(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--jobs", type=int, default=24, metavar="N", help="how many prompts (default: 24)")
    sub.add_argument(
        "--seed",
        dest="drawn_from",
        default="",
        metavar="TEXT",
        help="draw from this (default: the hash of the clone's commit)",
    )
    sub.add_argument(
        "--long", action="store_true", help="prompts of three to five asks, as the paper's (default: one to three)"
    )
    sub.add_argument(
        "--rival",
        default="",
        choices=[name for name in METHODS if name],
        help="another method for the same jobs, a baseline with as many seconds; who shows more is counted "
        "(default: none)",
    )
    sub.add_argument(
        "--rate",
        type=int,
        default=0,
        metavar="N",
        help="a baseline's greatest step, in thousandths of a range (default: its own)",
    )
    _small_pictures(sub)


def _like(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--tasks", dest="count", type=int, default=4, metavar="N", help="how many of each part (default: 4)"
    )
    sub.add_argument(
        "--parts",
        default="recovery,lamps,materials,transfer,filters",
        metavar="A,B",
        help="recovery, lamps, materials, transfer, filters (default: all)",
    )
    sub.add_argument("--seed", dest="drawn_from", default="like", metavar="TEXT", help="draw from this (default: like)")
    sub.add_argument(
        "--words", action="store_true", help="vibe in words as well where a look is recovered, for the time"
    )
    add_option(sub, named("effort"))
    _small_pictures(sub)


def _binding(sub: argparse.ArgumentParser) -> None:
    read = sub.add_mutually_exclusive_group(required=True)
    read.add_argument("--sentences", default="", metavar="DIR", help="folder of scenes.toml and sentences_NN.toml")
    read.add_argument(
        "--captions",
        default="",
        metavar="FILE",
        help="captions by others instead: T2I-CompBench's .txt, GenEval's .jsonl, PartiPrompts' .tsv",
    )
    sub.add_argument("--kind", default="", metavar="NAME", help="only sentences of this kind: lamps")
    sub.add_argument("--misses", action="store_true", help="show each mistaken sentence, with what was wanted")
    sub.add_argument(
        "--folds",
        type=int,
        default=0,
        metavar="N",
        help="read each of N parts of the scenes with weights fitted to the others (default: those in use)",
    )


def _materials(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--only", default="*", metavar="GLOB", help='only such names: "*plastic*"')
    sub.add_argument("--draw", type=int, default=0, metavar="N", help="so many of them, at random (default: all)")
    _small_pictures(sub)


def _small_pictures(sub: argparse.ArgumentParser) -> None:
    _pictures_of(sub, size=160, samples=32)


def _pictures_of(sub: argparse.ArgumentParser, size: int, samples: int) -> None:
    sub.add_argument("--size", type=int, default=size, metavar="N", help=f"side of the pictures (default: {size})")
    sub.add_argument(
        "--samples", type=int, default=samples, metavar="N", help=f"of Cycles' pictures (default: {samples})"
    )


AddOptions = Callable[[argparse.ArgumentParser], None]

BENCHES: dict[str, tuple[str, AddOptions]] = {
    "speed": ("How long a step of the renderer takes, forward and backward.", _speed),
    "time": ("How long a vibe takes, phase by phase, and each phase's share of the processor's time.", _time),
    "scale": ("How time and memory grow with triangles, lights, materials, pixels and shots.", _scale),
    "fidelity": ("How near the proxy is to Cycles, scene by scene and feature by feature.", _fidelity),
    "paper": ("Whether words are followed better than by a similarity alone: the paper's experiments.", _paper),
    "ladder": ("What each part of the method adds, on the development pairs.", _ladder),
    "batch": ("What a batch costs beside its vibes: by workers, and by jobs.", _batch),
    "encoder": ("How well the encoder reads looks off shapes that it never saw, and in other words.", _encoder),
    "wild": ("How a vibe fares on a folder of other people's scenes.", _wild),
    "sealed": ("Whether pictures show what was asked for, by prompts and scenes that nobody could tune to.", _sealed),
    "like": ("How well a picture serves as the words: hidden looks, other scenes, photo filters.", _like),
    "materials": ("Whether names of measured materials and lamps give what was measured.", _materials),
    "binding": ("Whether look words of labeled sentences are bound to what they describe.", _binding),
    "rendered": (
        "Whether predictions show what Cycles renders, where things hide, replace or multiply: scenes at random.",
        _rendered,
    ),
    "gradients": ("Whether the proxy's gradients point where Cycles' pictures go.", _gradients),
}
"""By name: a summary, and what declares the options, which are the keywords of its module's `run`."""
