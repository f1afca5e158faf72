# SPDX-License-Identifier: Apache-2.0
"""Parameters and values as people read them: "Key light: Power", "120 W". Keys are for programs."""

import math
import re

from .light_links import LINKED, is_on, link_of
from .parameters import FAMILIES, Parameter, Values, split_key

GROUP_TITLES = {
    "camera": "Camera", "light": "Lights", "world": "World", "material": "Materials", "volume": "Fog",
    "film": "Color & Grade",
}  # fmt: skip
_NAMES = {"ior": "IOR", "fov": "Field of View"}
_LIGHT_WORDS = re.compile(r"light|lamp|sun|spot", re.IGNORECASE)
_CLOSE = 1e-5  # relative difference that rounding to 32-bit numbers may make
_UNITS = {unit: f" {unit}" for unit in ("W", "m", "K", "stops")}
_UNITS |= {"": "", "deg": "°", "W/m2": " W/m²", "1/m": " /m"}


def parameter(key: str) -> Parameter:
    """The schema row of the key of an instance or of a family."""
    group, _, name = split_key(key)
    family = f"{group}/{name}"
    return LINKED if family == LINKED.family else FAMILIES[family]


def words(name: str) -> str:
    """A parameter's name as people read it: "Base Color" for "base_color"."""
    return _NAMES.get(name, name.replace("_", " ").title())


def title(key: str) -> str:
    """An instance's name as people read it.

    >>> title("light/Key/power"), title("material/Clay/roughness"), title("volume/density"), title("film/saturation")
    ('Key light: Power', 'Clay: Roughness', 'Fog: Density', 'Saturation')
    >>> title("light/Rim (only on Bottle)/linked")
    'Rim light: only on Bottle'
    """
    group, owner, name = split_key(key)
    if group == "film":
        return words(name)
    link = link_of(key)
    owner = link.light if link else owner
    if group == "light" and owner and not _LIGHT_WORDS.search(owner):
        owner += " light"
    return f"{owner or GROUP_TITLES.get(group, group)}: {link or words(name)}"


def titles(keys: list[str], most: int = 3) -> str:
    """The titles of up to `most` keys, and the number of others: "Key light: Power, Key light: Color and 2 more"."""
    return ", ".join(map(title, keys[:most])) + (f" and {len(keys) - most} more" if len(keys) > most else "")


def text(key: str, values: Values) -> str:
    """A value as text with its unit, or three numbers for a color; `key` is that of an instance or a family.

    >>> text("light/Key/power", (120.0,)), text("film/exposure", (0.4,)), text("material/Clay/base_color", (1, 0.5, 0))
    ('120 W', '+0.4 stops', '1.00 0.50 0.00')
    """
    row = parameter(key)
    if row.kind == "color":
        return " ".join(f"{v:.2f}" for v in values)
    if row is LINKED:
        return "yes" if is_on(values) else "no"
    if row.unit == "stops":
        stops = round(values[0], 2)
        return f"{stops:+g} stops" if stops else "0 stops"
    # About three significant digits, without exponents.
    value = values[0] if abs(values[0]) >= 1e-4 else 0
    return f"{value:{'.0f' if abs(value) >= 100 else '.3g'}}{_UNITS[row.unit]}"


def bare(key: str, values: Values) -> str:
    """The `text` of a value without its unit, for a place before a value with the unit: the 400 of "400 → 160 W"."""
    return text(key, values).removesuffix(_UNITS[parameter(key).unit])


def same(key: str, before: Values, after: Values) -> bool:
    """True if two values have the same text or differ by 32-bit rounding only: such a change is not listed."""
    pairs = zip(before, after, strict=True)
    return text(key, before) == text(key, after) or all(math.isclose(a, b, rel_tol=_CLOSE) for a, b in pairs)
