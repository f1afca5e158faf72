# SPDX-License-Identifier: Apache-2.0
"""`vibe explain`: the changes that a prompt would make to a given scene, or to a plain one."""

import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..goals import written
from ..goals.resolve import Goals, goals_or_why
from ..planning.advice import OfflineAdvisor, as_dict, explain
from ..rigs.chosen import chosen_rig
from ..scene.data import plain_instances
from ..schema import Instance, VibeError
from ..schema.options import checks
from ..schema.parameters import Region
from ..words.lexicon.rigs import rig_table
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.parser import Understood, prepared, why
from ..words.reader import read_words
from ..words.types import SceneDescription

if TYPE_CHECKING:
    from ..optimize.stage import StagedScenes

_LIGHTS = (("Key", "AREA", "key"), ("Fill", "AREA", "fill"), ("Rim", "AREA", "rim"))
_MATERIALS: dict[str, Region] = {"Subject": "subject", "Surroundings": "surroundings"}
_SIZE = 96  # pixels of the longer side: no picture is drawn, rays only find what the camera sees


def account(
    prompt: str, form: str = "text", scene: Path | None = None, subject: Sequence[str] = (), target: Sequence[str] = ()
) -> str:
    """The text that `vibe explain` prints: the meaning of a prompt for a scene.

    Args:
        form: "text", "json", "goals" for the goals alone, as `vibe run --goals` reads them, or "why" for the reasons
            why each look word is bound as it is.
        scene: A .blend or a mesh, which Blender reads; None for a subject, its surroundings and three lights.
        subject: Names of the subject's objects and collections.
        target: Targets that the artist has chosen for words: "copper=Cup".
    """
    if scene:
        stage, instances, known = _read(prompt, scene, subject, target)
        goals, plan = stage.goals, stage.plan
    else:
        known = SceneDescription(materials=dict(_MATERIALS))
        stage, instances, plan = None, plain_instances(_LIGHTS, _MATERIALS.items()), None
        goals = goals_or_why(Understood(prompt, known, target))
    if form == "why":
        vocabulary = default_vocabulary()
        words = read_words(prepared(prompt, known, vocabulary), known, vocabulary, targets=checks.targets(target))
        return why(words)
    if form == "goals":
        if isinstance(goals, VibeError):
            raise goals
        return json.dumps(written.as_json(goals), indent=2, ensure_ascii=False)
    advice = OfflineAdvisor(goals, plan).advise(None, instances, known)
    decided = advice.goals, advice.prompts, advice.plan
    light = _light(advice.goals, stage)
    if form == "json":
        return json.dumps({**as_dict(*decided), "light": light}, indent=2, ensure_ascii=False)
    return "\n".join([explain(*decided), *(["", "Light", *(f"  {line}" for line in light)] if light else [])])


def _light(goals: Goals, stage: "StagedScenes | None") -> list[str]:
    """Lines on the rig that the words ask for: the light for each of its parts, or, without `stage`, their settings."""
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


def _read(
    prompt: str, scene: Path, subject: Sequence[str], target: Sequence[str]
) -> tuple["StagedScenes", dict[str, Instance], SceneDescription]:
    """A scene before the first round of a vibe: its stage, its parameter instances and its description, without a render."""
    from ..blender.launch import VibeProgress, launch
    from ..blender.meshes import prepared

    with tempfile.TemporaryDirectory(prefix="vibe-explain-") as folder, prepared(scene) as place:
        arguments = ["export", str(place), f"--out={folder}", "--names-only", *(f"--subject={s}" for s in subject)]
        launch(arguments, scene, VibeProgress(sys.stderr))
        from ..optimize.scene_facts import described_now
        from ..optimize.shots import lock, picture_size
        from ..optimize.stage import set_stage
        from ..optimize.vector import ParameterVector
        from ..render.proxy import Proxy
        from ..scene import load_scene

        stage = set_stage([load_scene(Path(folder))], prompt, target=target)
        data = stage.scenes[0]
        vector = ParameterVector(lock(data.instances, (), (), scene.suffix.lower() != ".blend"))
        proxy = Proxy(data, picture_size(data.resolution, _SIZE), device="cpu", seed=0)
        now = described_now(stage.understood.scene, proxy, vector.values(vector.encode({})), None)
        return stage, dict(vector.instances), now
