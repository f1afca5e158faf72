# SPDX-License-Identifier: Apache-2.0
"""`vibe explain`: what a prompt would do to a scene, or to a plain one."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..goals import written
from ..goals.resolve import Goals, goals_or_why
from ..planning.advice import OfflineAdvisor, as_dict, explain
from ..prompt.binding.reader import PromptReader
from ..prompt.binding.why import why
from ..prompt.lexicon.rigs import rig_table
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.parser import prepared
from ..prompt.types import SceneDescription
from ..prompt.understood import Understood
from ..rigs.chosen import chosen_rig
from ..scene.plain import plain_instances
from ..schema import Instance, VibeError
from ..schema.options import checks
from ..schema.spec import Region

if TYPE_CHECKING:
    from ..engine.additions import Addition

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
    instances, known, addition = _read(prompt, scene, subject, target) if scene else (*_plain(), None)
    if with_reasons:
        return _reasons(prompt, known, target)
    goals = addition.goals if addition else goals_or_why(Understood(prompt, known, target))
    if as_goals:
        if isinstance(goals, VibeError):
            raise goals
        return json.dumps(written.as_json(goals), indent=2, ensure_ascii=False)
    advice = OfflineAdvisor(goals, addition.plan if addition else None).advise(None, instances, known)
    decided = advice.goals, advice.prompts, advice.plan
    light = _light(advice.goals, addition)
    if as_json:
        return json.dumps({**as_dict(*decided), "light": light}, indent=2, ensure_ascii=False)
    return "\n".join([explain(*decided), *(["", "Light", *(f"  {line}" for line in light)] if light else [])])


def _light(goals: Goals, addition: Addition | None) -> list[str]:
    """The rig that the words ask for, and who plays its parts in the scene; without one, what each of its lights is."""
    if addition:
        return list(addition.lighting.notes) if addition.lighting else []
    chosen = chosen_rig(goals, rig_table(), default_vocabulary())
    if chosen is None:
        return []
    lights = (
        f"{x.part.capitalize()}: {x.type.lower()}, {x.azimuth:.0f}° from the camera, {x.elevation:.0f}° high, "
        f"{x.color or f'{x.kelvin:.0f} K'}, {x.stops:+.1f} stops"
        for x in chosen.rig.lights
    )
    return [f"Light: {chosen.rig.says}", *lights]


def _reasons(prompt: str, known: SceneDescription, target: Sequence[str]) -> str:
    """What the reader chose among, and why."""
    vocabulary = default_vocabulary()
    reader = PromptReader(vocabulary, known, told=checks.targets(target))
    reader.read(prepared(prompt, known, vocabulary))
    return why(reader)


def _read(
    prompt: str, scene: Path, subject: Sequence[str], target: Sequence[str]
) -> tuple[dict[str, Instance], SceneDescription, Addition]:
    """A scene as the first round of a vibe sees it: its names, its parameters, and the picture that they give."""
    from ..blender.launch import launch
    from ..blender.meshes import prepared
    from ..blender.progress import VibeProgress

    with tempfile.TemporaryDirectory(prefix="vibe-explain-") as folder, prepared(scene) as place:
        launch(["export", str(place), f"--out={folder}", *subject], scene, VibeProgress(sys.stderr))
        from ..engine.additions import with_additions
        from ..optimize import context
        from ..optimize.drawing import draw
        from ..optimize.plan import lock
        from ..optimize.vector import ParameterVector
        from ..render.proxy import Proxy
        from ..scene import load_scene

        addition = with_additions([load_scene(Path(folder))], prompt, told=target)
        data = addition.scenes[0]
        vector = ParameterVector(lock(data.instances, (), (), scene.suffix.lower() != ".blend"))
        proxy = Proxy(data, context.picture_size(data.resolution, _LOOK), device="cpu", seed=0)
        u = vector.encode({})
        now = context.described_now(
            addition.understood.scene, proxy, vector.values(u), draw(proxy, vector, u)
        )
        return dict(vector.instances), now, addition


def _plain() -> tuple[dict[str, Instance], SceneDescription]:
    return plain_instances(_LIGHTS, _MATERIALS.items()), SceneDescription(materials=dict(_MATERIALS))
