# SPDX-License-Identifier: GPL-3.0-or-later
"""A sequence that is checked: frames of the scene with a look, and the words that are no longer visible there."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bpy.types import Scene

from ..core.schema_import import messages, schema
from ..export import reading
from ..export.analysis import SceneAnalysis
from ..render import final_render
from ..scene import bindings, keyframes, own_keys
from ..scene.steps import Steps
from ..scene.subject import SubjectChoice
from .driver import Driver
from .notes import words_of

_SIZE, _SAMPLES = 256, 16  # longer side in pixels, and samples, of the images
_MOST = 4  # frames that a look is searched for besides its own


@dataclass(frozen=True)
class CheckedFrame:
    """A frame that was checked."""

    frame: int
    # words that are visible where the look was found, and not here
    lost: list[str] = field(default_factory=list)
    verdicts: list[dict[str, str]] = field(default_factory=list)  # as in `messages.Finished`
    note: str = ""  # why nothing could be measured
    picture: Path | None = None  # with the look


class SequenceDriver(Driver):
    """A driver that measures the words of its result at other frames."""

    sequence: tuple[CheckedFrame, ...] = ()  # the frames that were checked

    def _check_frames(
        self,
        scene: Scene,
        frames: Iterable[int],
        seen: Iterable[str],
        choice: SubjectChoice,
        seed: int,
        first: SceneAnalysis | None = None,
    ) -> Generator[str]:
        """Renders frames with and without the look, and measures the words; nothing in the scene changes.

        `seen` are the words that are visible where the look was found, `first` is the analysis there.
        """
        self.sequence, start, shown = (), scene.frame_current, keyframes.are_shown(scene)
        try:
            for frame in frames:
                self._show_frame(frame)
                yield self.stage
                scene.frame_set(frame)
                folder = self._job / f"frame-{frame}"
                before, after = folder / "before.png", folder / "after.png"
                try:
                    reading.export_scene(scene, folder, choice, first)
                except schema.VibeError as error:  # the subject is hidden
                    self.sequence += (CheckedFrame(frame, note=error.message),)
                    continue
                steps = Steps.of(scene)
                with own_keys.as_before(scene), bindings.trial(scene, steps.base, (), steps.pivot):
                    final_render.render_picture(scene, before, _SIZE, _SAMPLES, seed)
                final_render.render_picture(scene, after, _SIZE, _SAMPLES, seed)
                if shown:
                    keyframes.bring_back(scene)
                self._ask(messages.Check(str(folder), str(before), str(after)))
                checked = yield from self._answer(messages.Checked)
                lost = [word for word in words_of(checked.verdicts, "missed") if word in seen]
                self.sequence += (CheckedFrame(frame, lost, checked.verdicts, picture=after),)
        finally:
            if shown:
                keyframes.bring_back(scene)
            scene.frame_set(start)

    def _show_frame(self, frame: int) -> None:
        self.stage = f"Checking frame {frame}"


def lost_frames(checked: Sequence[CheckedFrame]) -> list[int]:
    """Frames where a word is no longer visible: at most `_MOST`, evenly spread, as the search has all in memory."""
    lost = [each.frame for each in checked if each.lost]
    return lost[:: -(-len(lost) // _MOST)] if lost else []


def steady_line(checked: Sequence[CheckedFrame]) -> str:
    """The line for people on frames that all show the same words; "" if some do not."""
    same = bool(checked) and not any(map(frame_line, checked))
    return f"At all {len(checked)} checked frames the same words are visible." if same else ""


def frame_line(checked: CheckedFrame) -> str:
    """A line for people on a frame that could not be checked, or where a word is no longer visible; else ""."""
    lost = f"no longer visible: {', '.join(checked.lost)}." if checked.lost else ""
    return f"Frame {checked.frame}: {checked.note or lost}" if checked.note or lost else ""
