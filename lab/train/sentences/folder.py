# SPDX-License-Identifier: Apache-2.0
"""Reads a folder of labeled sentences: sentences_NN.toml, and scenes.toml in it or in `development` beside it."""

from __future__ import annotations

import re
from pathlib import Path

from lab.train.sentences.labels import (
    LIGHT_TYPES,
    ROLES,
    SCENE_KINDS,
    SENTENCE_KINDS,
    TARGETS,
    LabeledLight,
    LabeledScene,
    LabeledSentence,
    LabelTarget,
    LookWord,
)
from lab.train.sentences.tables import CheckedTable
from proxy_renderer.batch.manifest import TomlSource
from proxy_renderer.schema import VibeError

SCENES, SENTENCES = "scenes.toml", "sentences_*.toml"
_SHARED = "development"
"""Folder whose scenes those beside it are about, where they have none of their own."""
_LETTER = re.compile(r"[^\W\u2e80-\uffff]")
"""A letter of a script that puts spaces between words."""
_SCENE = (
    "name", "kind", "subject", "objects", "collections", "parents", "places", "lights", "glows", "sky",
)  # fmt: skip
_LIGHT = ("name", "type", "role", "turn", "lights")
_NAME = re.compile(r"[a-z0-9_]+")
_PLACE = ((-1.0, 1.0), (0.0, 1.0), (0.0, 1.0))
_LIGHT_PREFIX = "light:"


def read_folder(folder: Path) -> list[LabeledSentence]:
    """All sentences of a folder, in the order of its files.

    Raises:
        VibeError: A file is missing, or not of the format; names the place.
    """
    places = (folder / SCENES, folder.parent / _SHARED / SCENES)
    known = next((path for path in places if path.is_file()), None)
    if known is None:
        raise VibeError(f"There is no {SCENES} in {folder}.", "Name a folder of labeled sentences.")
    scenes = read_scenes(known)
    found: dict[str, LabeledSentence] = {}
    for path in sorted(folder.glob(SENTENCES)):
        for row in CheckedTable.listed(TomlSource(path), "sentence", ("scene", "kind", "text", "words")):
            sentence = _sentence(row, scenes)
            if sentence.text in found:
                raise row.problem("This sentence is there twice.", "Delete one of the two.", sentence.text)
            found[sentence.text] = sentence
    if not found:
        raise VibeError(f"There is no {SENTENCES} with a sentence in {folder}.", "Write [[sentence]] tables.")
    return list(found.values())


def read_scenes(path: Path) -> dict[str, LabeledScene]:
    """The scenes of a file by name.

    Raises:
        VibeError: It cannot be read, or is not of the format; names the place.
    """
    scenes: dict[str, LabeledScene] = {}
    for row in CheckedTable.listed(TomlSource(path), "scene", _SCENE):
        scene = _scene(row)
        if not _NAME.fullmatch(scene.name) or scene.name in scenes:
            raise row.problem(f"'{scene.name}' is there twice, or no lower-case word.", "Rename the scene.")
        scenes[scene.name] = scene
    return scenes


def _scene(row: CheckedTable) -> LabeledScene:
    worn = row.table("objects")
    objects = {name: row.checked_names(name, value) for name, value in worn.items()}
    bare = next((name for name, materials in objects.items() if not materials), "")
    if bare or not objects:
        raise row.problem(f"'{bare or 'objects'}' is empty.", 'Write OBJECT = ["MATERIAL"].', bare)
    if not row.content.get("subject"):
        raise row.problem("The scene has no subject.", 'Write subject = ["OBJECT"].')
    materials = {name for worn in objects.values() for name in worn}
    parents = row.table("parents", objects)
    row.checked_names("parents", list(parents.values()))
    return LabeledScene(
        name=row.text("name"),
        kind=row.one_of("kind", SCENE_KINDS),
        subject=row.names("subject", objects),
        objects=objects,
        collections={name: row.checked_names(name, value, objects) for name, value in row.table("collections").items()},
        parents=parents,
        places={name: _place(row, name, value) for name, value in row.table("places", objects).items()},
        lights=_lights(row, objects),
        glows=row.names("glows", sorted(materials)),
        sky=row.flag("sky"),
    )


def _place(row: CheckedTable, name: str, value: object) -> tuple[float, float, float]:
    x, y, size = row.numbers(name, value, _PLACE)
    return x, y, size


def _lights(row: CheckedTable, objects: dict[str, tuple[str, ...]]) -> tuple[LabeledLight, ...]:
    lights = []
    for content in row.content.get("lights", []):
        table = CheckedTable(row.source, row.keys, content)
        table.check_keys(_LIGHT)
        light = LabeledLight(
            table.text("name"),
            table.one_of("type", LIGHT_TYPES),
            table.one_of("role", ROLES),
            table.number("turn", -360.0, 360.0),
            table.names("lights", objects),
        )
        lights.append(light)
    if len({light.name for light in lights}) < len(lights) or sum(x.role == "key" for x in lights) > 1:
        raise row.problem("Two lights have one name, or both are the key.", "Change one of them.")
    return tuple(lights)


def _sentence(row: CheckedTable, scenes: dict[str, LabeledScene]) -> LabeledSentence:
    scene, text, end = scenes[row.one_of("scene", scenes)], row.text("text"), 0
    pairs = row.content.get("words")
    if not isinstance(pairs, list):
        raise row.problem("'words' is no list, or missing.", 'Write words = [["WORD", "TARGET"]].')
    words = []
    for pair in pairs:
        if not isinstance(pair, list) or len(row.checked_names("words", pair)) != 2:
            raise row.problem(f"{pair} is no pair.", 'Write ["WORD", "TARGET"].')
        said, target = pair
        start = _place_of(said, text, end)
        if start < 0:
            raise row.problem(
                f"'{said}' does not stand in the text, or not after the word before it.",
                "Write words as they are in the text, in its order.",
                said,
            )
        end = start + len(said)
        targets = tuple(_target(row, part.strip(), scene) for part in target.split(" | "))
        words.append(LookWord(said, start, targets))
    return LabeledSentence(scene, row.one_of("kind", SENTENCE_KINDS), text, tuple(words))


def _place_of(said: str, text: str, start: int) -> int:
    """Place of a word in a text, from a place on; -1 where it does not."""
    place = text.find(said, start)
    while place >= 0 and (_is_cut(text, place) or _is_cut(text, place + len(said))):
        place = text.find(said, place + 1)
    return place


def _is_cut(text: str, place: int) -> bool:
    """True if a place of a text is within a word."""
    around = text[place - 1 : place + 1] if place else ""
    return len(around) == 2 and all(map(_LETTER.match, around))


def _target(row: CheckedTable, text: str, scene: LabeledScene) -> LabelTarget:
    """A target as it is written; with materials, a glow is one of them: "light:Neon + Mirror"."""
    if text in TARGETS:
        return LabelTarget(text)
    parts = [part.strip() for part in text.split(" + ")]
    lit = all(part.startswith(_LIGHT_PREFIX) for part in parts)
    lights = (*(light.name for light in scene.lights), *scene.glows)
    for part in parts:
        name = part.removeprefix(_LIGHT_PREFIX)
        known = (lights if lit else scene.glows) if name != part else scene.materials
        if name not in known:
            raise row.problem(f"'{part}' is not in '{scene.name}'.", f"Use: {', '.join((*known, *TARGETS))}.", text)
    names = frozenset(part.removeprefix(_LIGHT_PREFIX) for part in parts)
    return LabelTarget("lights" if lit else "materials", names)
