# SPDX-License-Identifier: GPL-3.0-or-later
"""Fluid simulations in a Blender that is a Python module: it cannot run them. They abort it, or write caches beside the scene."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, nullcontext

import bpy

from ..core import compat

_off: list[tuple[str, str, bool, bool]] = []
"""Of the open file: object and modifier that are switched off, whether the viewport and renders showed it."""


@contextmanager
def left_out() -> Iterator[None]:
    """Switches the fluids off in the file that is opened inside the block, before Blender evaluates any of it."""
    _off.clear()
    with _at("load_post", _switch_off) if compat.IS_MODULE else nullcontext():
        yield


@contextmanager
def as_opened() -> Iterator[None]:
    """Saves the file inside the block with its fluids as the artist has them.

    Every operator evaluates the scene before and after, so they must be back for no longer than the writing.
    """
    with _at("save_pre", _restore), _at("save_post", _hide):
        yield


@contextmanager
def _at(moment: str, act: Callable[[], None]) -> Iterator[None]:
    """Calls a function whenever Blender reaches a moment inside the block."""
    handlers = getattr(bpy.app.handlers, moment)
    handler = bpy.app.handlers.persistent(lambda *_: act())  # others go when a file is opened
    handlers.append(handler)
    try:
        yield
    finally:
        handlers.remove(handler)


def note() -> str:
    """Which fluids of the open file are left out, in words for the artist; "" without any."""
    names = ", ".join(dict.fromkeys(f'"{thing}"' for thing, *_ in _off))
    return names and f"The fluid simulation of {names} is left out of the pictures: vibe it inside Blender."


def _switch_off() -> None:
    for thing in bpy.data.objects:
        for modifier in thing.modifiers:
            if modifier.type == "FLUID" and (modifier.show_viewport or modifier.show_render):
                _off.append((thing.name, modifier.name, modifier.show_viewport, modifier.show_render))
    _hide()


def _hide() -> None:
    _show((thing, modifier, False, False) for thing, modifier, _, _ in _off)


def _restore() -> None:
    _show(_off)


def _show(rows: Iterable[tuple[str, str, bool, bool]]) -> None:
    for thing, name, viewport, renders in rows:
        found = bpy.data.objects.get(thing)
        if found and (modifier := found.modifiers.get(name)):
            modifier.show_viewport, modifier.show_render = viewport, renders
