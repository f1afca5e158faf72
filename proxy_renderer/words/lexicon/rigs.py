# SPDX-License-Identifier: Apache-2.0
"""Rigs: setups of lights for lighting words, read from `rigs.toml`. The head of that file explains the rows."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from ...color.floats import is_hex
from ...folders import config_folder
from ...schema import VibeError
from ...schema.added_lights import PARTS, PATTERNS
from .entries import Effect, at_line, listed, normalize, parse_effect, temperature

SOURCES = {"point": "POINT", "spot": "SPOT", "area": "AREA", "sun": "SUN"}
REACHES = ("subject", "pool", "background", "all")
THROUGH = ("", "window")
KINDS = ("source", "style", "time", "film", "season", "mood", "hour", "place")
TIMES = ("time", "season", "hour")  # kinds of rigs that have a sky
_DISTANCES = {"POINT": 1.8, "SPOT": 5.0, "AREA": 3.0, "SUN": 0.0}
_SIZES = {"POINT": 0.1, "SPOT": 0.08, "AREA": 1.2, "SUN": 0.5}
_KELVINS = (1000.0, 20000.0)
_DARK_SKY = -3.0  # stops of a sky from which it is night


@dataclass(frozen=True)
class RigLight:
    """One light of a rig, as the head of `rigs.toml` explains it; angles in degrees, lengths in the subject's radii."""

    part: str
    type: str  # Blender's type
    azimuth: float
    elevation: float
    mirrored: bool = True  # whether it may also stand on the mirrored side
    distance: float = 0.0
    size: float = 0.0
    kelvin: float = 0.0  # 0 where `color` is given, or the light of the scene keeps its own
    color: str = ""  # "#rrggbb"; "" where `kelvin` is given
    stops: float = 0.0
    reach: str = "subject"
    names: frozenset[str] = frozenset()
    own: str = ""  # name of the scene's light that takes its place, if a prompt names one; else ""
    through: str = ""
    pattern: str = ""
    worn: frozenset[str] = frozenset()  # materials of the lamp (an object) that it burns in, if a prompt names one

    @property
    def is_warm(self) -> bool:
        """True if its color temperature is one that people call warm."""
        return 0.0 < self.kelvin < 4200.0


@dataclass(frozen=True)
class Rig:
    """A lighting setup, as the head of `rigs.toml` explains it; None and "" leave a value as it is."""

    name: str
    words: tuple[str, ...]
    entries: tuple[str, ...]
    says: str
    kind: str = "source"
    adds: bool = False
    exposure: float = 0.0
    own: float = -6.0
    world: float | None = None
    world_color: str = ""
    sky: float | None = None
    sky_color: str = ""
    air: float | None = None
    grade: tuple[Effect, ...] = ()
    lights: tuple[RigLight, ...] = ()  # its lights, the key first
    under_sky: bool = False  # whether its sky is that of an hour that the prompt names too

    @property
    def has_dark_sky(self) -> bool:
        """True if its sky is that of a night."""
        return self.sky is not None and self.sky <= _DARK_SKY

    @property
    def has_signs(self) -> bool:
        """True if its lights have several colors of their own, as neon signs do."""
        return len({light.color for light in self.lights} - {""}) > 1

    @property
    def is_overcast(self) -> bool:
        """True if it is a weather by day without a sun, as rain."""
        return self.kind in TIMES and not self.has_dark_sky and self.lights[0].type != "SUN"

    @property
    def keeps_own_light(self) -> bool:
        """True if the scene stays lit as it is, and lights are only added to that."""
        return self.own == 0.0 and all(light.part != "key" for light in self.lights)


@dataclass(frozen=True)
class Modifier:
    """Changes that a word makes to the lights of a rig."""

    azimuth: float | None = None  # degrees from the camera; None to leave it
    elevation: float | None = None  # Degrees; None to leave it
    size: float = 1.0  # factor
    kelvin: float = 0.0  # color temperature; 0 to leave it
    exposure: float = 0.0  # stops that are added to the exposure
    contrast: float = 0.0  # stops that are added to all lights but the key, and to the world
    distance: float = 1.0  # factor
    both: bool = False  # whether the other side gets such a light too

    def change(self, light: RigLight, strength: float) -> RigLight:
        """A light with these changes; the factors on size and distance are raised to the power `strength`."""
        light = replace(light, size=light.size * self.size**strength, distance=light.distance * self.distance**strength)
        if self.azimuth is not None:
            light = replace(light, azimuth=self.azimuth, mirrored=False, through="")
        if self.elevation is not None:
            light = replace(light, elevation=self.elevation)
        tints = self.kelvin and not light.color
        return replace(light, kelvin=self.kelvin, color="") if tints else light

    @property
    def aspects(self) -> tuple[str, ...]:
        """Aspects of light that it changes, of "direction", "color" and "contrast"."""
        directed = self.azimuth is not None or self.elevation is not None
        each = {"direction": directed, "color": self.kelvin, "contrast": self.contrast < 0}
        return tuple(name for name, says in each.items() if says)

    def reversed(self) -> Modifier:
        """The modifier of the negated word: opposite exposure and contrast, reciprocal size, and no other changes."""
        return Modifier(size=1 / self.size, exposure=-self.exposure, contrast=-self.contrast)


@dataclass(frozen=True)
class RigTable:
    """All rigs and modifiers."""

    rigs: Mapping[str, Rig]  # vocabulary entry -> the rig that it stands for
    modifiers: Mapping[str, Modifier]  # vocabulary entry -> what it changes
    luminaries: frozenset[str] = frozenset()  # words in names of times and hours that are lights

    def modifier(self, entry: str) -> Modifier | None:
        """The changes to lights that a vocabulary entry or a color temperature, "3200 kelvin", stands for; None if none."""
        kelvin = temperature(entry)
        return Modifier(kelvin=kelvin) if kelvin else self.modifiers.get(entry)

    def parts(self, entry: str) -> tuple[str, ...]:
        """Parts of the lights that a word adds to another setup: ("kicker",) for "kicker light"; () for other words."""
        rig = self.rigs.get(entry)
        return tuple(light.part for light in rig.lights) if rig and rig.adds else ()

    def is_a_light(self, entry: str, word: str) -> bool:
        """True if a word for a setup names a light: "candle" and "low sun" do, "night" does not."""
        rig = self.rigs.get(entry)
        if rig is None or not rig.lights:
            return False
        if rig.kind == "source":
            return entry not in self.modifiers
        return rig.kind in TIMES and not self.luminaries.isdisjoint(word.split())

    @property
    def plain(self) -> Rig:
        """The rig for words that only describe a quality or a direction of light."""
        return self.rigs["plain key"]


@cache
def rig_table() -> RigTable:
    """The shipped rigs and modifiers, with the user's `rigs.toml` on top. Raises VibeError if a file is wrong."""
    folder, own = Path(__file__).parent, config_folder() / "rigs.toml"
    every = read((folder / "rigs.toml").read_text("utf-8"), "rigs.toml")
    if own.is_file():
        every |= read(own.read_text("utf-8"), str(own))
    rigs: dict[str, Rig] = {}
    for rig in every.values():
        for entry in rig.entries:
            if entry in rigs:
                problem = f"Rigs: '{entry}' is in '{rigs[entry].name}' and in '{rig.name}'."
                raise VibeError(problem, "Keep one.")
            rigs[entry] = rig
    rows = tomllib.loads((folder / "modifiers.toml").read_text("utf-8"))
    modifiers = {normalize(name): Modifier(**row) for name, row in rows["modifier"].items()}
    return RigTable(rigs, modifiers, frozenset(listed(rows["luminaries"])))


def read(text: str, place: str) -> dict[str, Rig]:
    """Name -> rig, from the text of a .toml file, which errors call `place`. Raises VibeError if the text is wrong."""
    try:
        rows = tomllib.loads(text).get("rig", {})
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"{place} cannot be read: {error}.", "Correct that line.") from error
    found = {}
    for name, row in rows.items():
        try:
            found[normalize(name)] = _rig(normalize(name), row)
        except (VibeError, TypeError, ValueError) as error:
            remedy = error.remedy if isinstance(error, VibeError) else "Compare with the head of rigs.toml."
            said = error.message if isinstance(error, VibeError) else str(error)
            problem = f"rig '{name}': {said.rstrip('.')}"
            raise at_line(place, text.replace('"', ""), problem, remedy, f"[rig.{name}]") from error
    return found


_RIG_NUMBERS, _RIG_COLORS = ("exposure", "own", "world", "sky", "air"), ("world_color", "sky_color")
_ROWS = (*_RIG_NUMBERS, *_RIG_COLORS, "words", "entries", "says", "kind", "adds", "grade", "lights")
_CHOICES = {"part": PARTS, "source": tuple(SOURCES), "reach": REACHES, "through": THROUGH, "pattern": ("", *PATTERNS)}
"""Row of a light -> what it may be."""
_LIGHT_NUMBERS = ("distance", "size", "kelvin", "stops")
_LIGHT_ROWS = (*_CHOICES, *_LIGHT_NUMBERS, "from", "side", "color", "names")


def _rig(name: str, row: dict[str, Any]) -> Rig:
    _check("row", row, _ROWS)
    _check("kind", [row.get("kind", "source")], KINDS)
    if not row.get("lights") and not row.get("entries"):
        raise VibeError("it has no light.", "Give it a row lights = [...].")
    if "says" not in row:
        raise VibeError("it lacks the row says.", "Add it.")
    values: dict[str, Any] = {key: row[key] for key in ("says", "kind", "adds") if key in row}
    values |= {key: float(row[key]) for key in _RIG_NUMBERS if key in row}
    values |= {key: _color(row.get(key, "")) for key in _RIG_COLORS}
    words, entries = (name, *listed(row.get("words", ""))), listed(f"{name}, {row.get('entries', '')}")
    grade, lights = tuple(map(parse_effect, row.get("grade", ()))), tuple(map(_light, row.get("lights", ())))
    return Rig(name, words, entries, grade=grade, lights=lights, **values)


def _light(row: dict[str, Any]) -> RigLight:
    _check("row", row, _LIGHT_ROWS)
    texts = {"part": "key", "source": "area", **{key: row[key] for key in _CHOICES if key in row}}
    for what, text in texts.items():
        _check(what, [text], _CHOICES[what])
    if "from" not in row:
        raise VibeError("it lacks the row from = [azimuth, elevation].", "Add it.")
    kind, color = SOURCES[texts.pop("source")], _color(row.get("color", ""))
    numbers = {"distance": _DISTANCES[kind], "size": _SIZES[kind], "kelvin": 0.0 if color else 5600.0}
    numbers |= {what: float(row[what]) for what in _LIGHT_NUMBERS if what in row}
    if numbers["kelvin"] and not _KELVINS[0] <= numbers["kelvin"] <= _KELVINS[1]:
        raise VibeError(f"{numbers['kelvin']:g} K is no color of light.", "Write 1000 to 20000.")
    azimuth, elevation = map(float, row["from"])
    mirrored, names = row.get("side", "either") == "either", frozenset(listed(row.get("names", "")))
    given: dict[str, Any] = {**numbers, **texts}
    return RigLight(
        type=kind, azimuth=azimuth, elevation=elevation, mirrored=mirrored, color=color, names=names, **given
    )


def _color(text: str) -> str:
    if text and not is_hex(text):
        raise VibeError(f"'{text}' is no color.", 'Write "#rrggbb".')
    return text


def _check(what: str, values: Iterable[str], known: Sequence[str]) -> None:
    for value in values:
        if value not in known:
            raise VibeError(f"'{value}' is no {what}.", f"Use one of: {', '.join(filter(None, known))}.")
