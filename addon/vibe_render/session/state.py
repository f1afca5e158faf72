# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on holds while Blender runs."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..core.schema_import import schema
from ..engine.process import Engine
from . import preferences
from .session import Session


class AddonState:
    """What the add-on holds while Blender runs: a warm engine, and the vibe that runs or ran last.

    Attributes:
        session: The newest vibe; its preview outlives it.
        running: Whether it is on its way.
        failure: Why it failed, until that has been dismissed.
    """

    def __init__(self) -> None:
        self.session: Session | None = None
        self.running = False
        self.failure: schema.VibeError | None = None
        self._engine: Engine | None = None
        self._engine_choice: tuple[str, Path] | None = None

    def begin(self, context: bpy.types.Context, ask: bool = False) -> Session:
        """Starts a vibe; the engine is the one of the last, unless the preferences have changed since.

        Args:
            context: Blender's.
            ask: Whether somebody is there to answer questions.
        """
        self.forget()
        choice = engine_choice(context)
        if self._engine is None or choice != self._engine_choice:
            self.close_engine()
            self._engine, self._engine_choice = Engine(choice[0], cache=choice[1]), choice
        self.session, self.running = Session(context, self._engine, ask), True
        return self.session

    def end(self, failure: schema.VibeError | None = None) -> None:
        """The vibe is over; of one that failed, nothing is left."""
        if self.session and failure:
            self.session.cancel()
        self.running, self.failure = False, failure

    def cancel(self) -> None:
        """Gives the vibe up; the scene is as it was."""
        if self.session and self.running:
            self.session.cancel()
        self.end()
        self.forget()

    def forget(self) -> None:
        """Drops what is left of the last vibe."""
        if self.session:
            self.session.discard()
        self.session, self.failure = None, None

    def close_engine(self) -> None:
        """Ends the engine."""
        if self._engine:
            self._engine.stop(patience=0.5)
        self._engine = None

    def close(self) -> None:
        """Gives everything back, when the add-on is switched off or Blender ends."""
        self.cancel()
        self.close_engine()


def engine_choice(context: bpy.types.Context) -> tuple[str, Path]:
    """What the preferences say about the engine: where it is, and where it keeps things."""
    return preferences.engine_choice(context), preferences.cache_folder(context)


addon_state = AddonState()
