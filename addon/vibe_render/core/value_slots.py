# SPDX-License-Identifier: GPL-3.0-or-later
"""Value slots: objects that read and write one value in a scene, and know why it is locked, if it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from bpy.types import NodeSocket, bpy_struct

from .journal import Journal


class ValueSlot(Protocol):
    """A value in a scene, in the form that Blender stores: a number, a text, or a tuple for an array."""

    @property
    def locked(self) -> str:
        """The reason why the value must stay as it is; "" if it may change."""

    def get(self) -> Any:
        """The stored value."""

    def set(self, journal: Journal, raw: Any) -> None:
        """Writes a value in the form of `get`; does nothing if the slot has this value already."""


@dataclass
class PropertySlot:
    """A property of any Blender struct: a node socket's value, a light's energy."""

    owner: bpy_struct
    name: str
    locked: str = ""

    def get(self) -> Any:
        """As for `ValueSlot`."""
        raw = getattr(self.owner, self.name)
        return raw if isinstance(raw, bool | int | float | str) else tuple(raw)

    def set(self, journal: Journal, raw: Any) -> None:
        """As for `ValueSlot`; if the property has more components than `raw` (RGBA), the others keep their values."""
        old = getattr(self.owner, self.name)
        if isinstance(raw, tuple):
            raw = (*raw, *old[len(raw) :])
        if not same(raw, old):
            journal.set(self.owner, self.name, raw)


def socket_slot(socket: NodeSocket, locked: str = "") -> PropertySlot:
    """The slot of an unlinked socket's value: an input, or the output of a Value or RGB node."""
    return PropertySlot(socket, "default_value", locked)


@dataclass
class LazySlot:
    """A value of a node or object that Vibe Render adds only when a value other than `identity` is written."""

    find: Callable[[], ValueSlot | None]  # returns the slot; None if its node or object does not exist
    # adds the node or object and returns the slot; None if it must not be added for this value alone
    make: Callable[[Journal], ValueSlot | None]
    identity: Any  # the value at which the node or object has no effect
    locked: str = ""

    def get(self) -> Any:
        """The stored value, or `identity` if the node or object does not exist."""
        slot = self.find()
        return slot.get() if slot else self.identity

    def set(self, journal: Journal, raw: Any) -> None:
        """As for `ValueSlot`."""
        slot = self.find()
        if slot is None and not same(raw, self.identity):
            slot = self.make(journal)
        if slot is not None:
            slot.set(journal, raw)


@dataclass
class DerivedSlot:
    """A number that follows from the value of another slot."""

    inner: ValueSlot
    read: Callable[[Any], float]  # inner slot's value -> this number
    written: Callable[[Any, float], Any]  # (present inner value, new number) -> new inner value

    @property
    def locked(self) -> str:
        """As for `ValueSlot`."""
        return self.inner.locked

    def get(self) -> float:
        """As for `ValueSlot`."""
        return self.read(self.inner.get())

    def set(self, journal: Journal, raw: float) -> None:
        """As for `ValueSlot`."""
        if not same(raw, self.get()):
            self.inner.set(journal, self.written(self.inner.get(), raw))


@dataclass
class _JointSlot:
    slots: Sequence[ValueSlot]
    locked: str = ""

    def get(self) -> Any:
        return self.slots[0].get()

    def set(self, journal: Journal, raw: Any) -> None:
        for slot in self.slots:
            slot.set(journal, raw)


def together(slots: Sequence[ValueSlot]) -> ValueSlot | None:
    """A slot that reads the first unlocked slot and writes all unlocked ones.

    If all slots are locked, the first of them; None if there are none.
    """
    free = [slot for slot in slots if not slot.locked]
    if len(free) > 1:
        return _JointSlot(free)
    return free[0] if free else slots[0] if slots else None


def same(a: Any, b: Any) -> bool:
    """True if two numbers or sequences of numbers are equal as the 32-bit floats that Blender stores."""
    return bool(np.array_equal(np.float32(a), np.float32(b)))
