# SPDX-License-Identifier: Apache-2.0
"""`vibe explain`: what a prompt would do to a scene, or to a plain one."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ..goals import written
from ..goals.resolve import Goals, goals_or_why
from ..planning.advice import OfflineAdvisor
from ..planning.explanation import as_dict, explain
from ..planning.types import PlanContext
from ..prompt.binding.reader import PromptReader
from ..prompt.binding.why import why
from ..prompt.lexicon.rigs import rig_table
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.parser import prepared
from ..prompt.types import SceneWords
from ..prompt.understood import Understood
from ..rigs.chosen import chosen_rig
from ..scene.plain import plain_instances
from ..schema import VibeError
from ..schema.messages import Options
from ..schema.options import checks
from ..schema.spec import Region

if TYPE_CHECKING:
    from ..optimize.shots import ShotState
    from ..optimize.stage import StagedScenes

_LIGHTS = (("Key", "AREA", "key"), ("Fill", "AREA", "fill"), ("Rim", "AREA", "rim"))
_MATERIALS: dict[str, Region] = {"Subject": "subject", "Surroundings": "surroundings"}
_LOOK = 96  # longer side of the picture that is looked at, in pixels


def account(
    prompt: str,
    as_json: bool,
    scene: Path | None = None,
    subject: Sequence[str] = (),
    with_reasons: bool = False,
    target: Sequence[str] = (),
    as_goals: bool = False,
) -> str:
    """What the words mean, readable or as JSON.

    Args:
        as_json: For programs.
        scene: A .blend or a mesh, which Blender reads; None for a subject, its surroundings and three lights.
        subject: Arguments that say what in the scene is the subject: "--subject=Cup".
        with_reasons: Say why each look word is bound as it is, and nothing else.
        target: "copper=Cup": what words describe, where they are taken for something else.
        as_goals: Give the goals alone, as `vibe run --goals` reads them.
    """
    with ExitStack() as stack:
        stage, shot = (
            stack.enter_context(_exported(prompt, scene, subject, target)) if scene else (None, None)
        )
        if stage:
            words, goals = stage.understood.scene, stage.goals
        else:
            words = SceneWords(materials=dict(_MATERIALS))
            goals = goals_or_why(Understood(prompt, words, target))
        if with_reasons:
            return _reasons(prompt, words, target)
        if as_goals:
            if isinstance(goals, VibeError):
                raise goals
            return json.dumps(written.as_json(goals), indent=2, ensure_ascii=False)
        if stage and shot:
            advice = shot.advised(stage.advisor, shot.vector.encode({}))
        else:
            instances = plain_instances(_LIGHTS, _MATERIALS.items())
            context = PlanContext(light_types={name: kind for name, kind, _ in _LIGHTS})
            advice = OfflineAdvisor(goals).advise(None, instances, context)
    decided = advice.goals, advice.prompts, advice.plan
    light = _light(advice.goals, stage)
    if as_json:
        return json.dumps({**as_dict(*decided), "light": light}, indent=2, ensure_ascii=False)
    return "\n".join([explain(*decided), *(["", "Light", *(f"  {line}" for line in light)] if light else [])])


def _light(goals: Goals, stage: StagedScenes | None) -> list[str]:
    """The rig that the words ask for, and who plays its parts in the scene; without one, what each of its lights is."""
    if stage:
        return list(stage.lighting.notes) if stage.lighting else []
    chosen = chosen_rig(goals, rig_table(), default_vocabulary())
    if chosen is None:
        return []
    lights = (
        f"{x.part.capitalize()}: {x.type.lower()}, {x.azimuth:.0f}° from the camera, {x.elevation:.0f}° high, "
        f"{x.color or f'{x.kelvin:.0f} K'}, {x.stops:+.1f} stops"
        for x in chosen.rig.lights
    )
    return [f"Light: {chosen.rig.says}", *lights]


def _reasons(prompt: str, words: SceneWords, target: Sequence[str]) -> str:
    """What the reader chose among, and why."""
    vocabulary = default_vocabulary()
    reader = PromptReader(vocabulary, words, told=checks.targets(target))
    reader.read(prepared(prompt, words, vocabulary))
    return why(reader)


@contextmanager
def _exported(
    prompt: str, scene: Path, subject: Sequence[str], target: Sequence[str]
) -> Iterator[tuple[StagedScenes, ShotState]]:
    """A scene as the first round of a vibe has it, while its export lasts."""
    from ..blender.launch import launch
    from ..blender.meshes import prepared
    from ..blender.progress import VibeProgress

    with tempfile.TemporaryDirectory(prefix="vibe-explain-") as folder, prepared(scene) as place:
        launch(["export", str(place), f"--out={folder}", *subject], scene, VibeProgress(sys.stderr))
        from ..optimize.shots import ShotInput, gathered, picture_size
        from ..optimize.stage import set_stage
        from ..render.proxy import Proxy
        from ..scene import load_scene

        stage = set_stage([load_scene(Path(folder))], prompt, target=target)
        options = Options(camera=scene.suffix.lower() != ".blend")
        _, (shot,) = gathered(
            [ShotInput(stage.scenes[0])],
            options,
            lambda data: Proxy(data, picture_size(data.resolution, _LOOK), device="cpu", seed=0),
        )
        yield stage, shot
