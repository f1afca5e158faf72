# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's state while Blender runs: the engine, the vibe, Live, the readings of words."""

from pathlib import Path

import bpy

from ..core import background, preferences
from ..core.schema_import import schema
from ..engine.process import Engine
from ..scene.steps import Change
from .light_mix import RenderedMix
from .live import Live, WordReadings
from .session import Session


class AddonState:
    """The engine, the session (one vibe) that runs or ran last, Live (looks while one types), and the light mix."""

    def __init__(self) -> None:
        self.session: Session | None = None  # the newest; its images stay until the next one, Keep or Revert
        self.running = False  # True while the session runs
        self.failure: schema.VibeError | None = None  # that ended the session; kept until dismissed
        self.live: Live | None = None  # looks of the words so far; None if Live is off
        self.readings = WordReadings()  # the engine's readings of the words that are typed
        self.mix: RenderedMix | None = None  # the light layers of the newest render; None until one is rendered
        self._engine: Engine | None = None
        self._engine_choice: tuple[str, Path] | None = None

    def begin(self, context: bpy.types.Context, ask: bool = False, change: Change | None = None) -> Session:
        """Starts a session, to which Live hands its look, and returns the session; arguments as for `Session`."""
        self.forget()
        self.forget_mix()
        self.session, self.running = Session(context, self.engine(context), ask, change), True
        if self.live and self.live.scene == self.session.scene:
            self.live.hand_over(self.session)
        return self.session

    def live_for(self, context: bpy.types.Context) -> Live:
        """The `Live` of the context's scene, made if there is none; one of another scene is ended."""
        if self.live is None or self.live.scene != context.scene.name:
            self.end_live()
            self.live = Live(context, self.engine(context))
        return self.live

    def live_job(self, scene: bpy.types.Scene) -> Path | None:
        """The job folder to which Live has exported the scene; None without one, or if the scene has changed since."""
        return self.live.job if self.live and self.live.scene == scene.name else None

    def end_live(self) -> None:
        """Ends Live, and takes its look out of the scene."""
        if self.live:
            self.live.close()
        self.live = None

    @property
    def has_engine(self) -> bool:
        """True if there is an `Engine`, whether its process has been started or not."""
        return self._engine is not None

    @property
    def engine_runs(self) -> bool:
        """True if the engine's process runs, so that requests can be sent."""
        return self._engine is not None and self._engine.alive

    def engine(self, context: bpy.types.Context) -> Engine:
        """The engine of the last call; if the preferences have changed, a new one that is not started yet."""
        choice = preferences.engine_choice(context), preferences.cache_folder(context)
        if self._engine is None or choice != self._engine_choice:
            self.close_engine()
            self._engine, self._engine_choice = Engine(choice[0], cache=choice[1]), choice
        return self._engine

    def warm_up(self, context: bpy.types.Context) -> None:
        """Starts the engine in the background; if that fails, the next vibe reports the reason."""
        background.begin(self.engine(context).start)

    def end(self, failure: schema.VibeError | None = None) -> None:
        """Ends the session; with a failure the session is canceled, which restores the scene."""
        if self.session:
            if failure:
                self.session.cancel()
            self.session.checking = False
        self.running, self.failure = False, failure

    def cancel(self) -> None:
        """Cancels a running vibe, and restores the scene; or cancels a check of frames, and leaves the result in it."""
        checking = self.session and self.session.checking
        if self.session and self.running:
            self.session.cancel()
        self.end()
        if not checking:
            self.forget()

    def forget(self) -> None:
        """Drops the last session with its images, and its failure."""
        if self.session:
            self.session.discard()
        self.session, self.failure = None, None

    def forget_mix(self) -> None:
        """Drops the light layers, which no longer fit the scene."""
        if self.mix:
            self.mix.discard()
        self.mix = None

    def close_engine(self) -> None:
        """Ends the engine."""
        if self._engine:
            self._engine.stop(patience=0.5)
        self._engine = None
        self.readings.forget()

    def leave_file(self) -> None:
        """Ends the session, the light mix and Live, which belong to the open file."""
        self.cancel()
        self.forget()
        self.forget_mix()
        self.end_live()

    def close(self) -> None:
        """Ends session and engine, when the add-on is switched off or Blender ends."""
        self.leave_file()
        self.close_engine()


addon_state = AddonState()
