# SPDX-License-Identifier: Apache-2.0
"""Without roles, the key light is the one that lights the subject most, whatever its type."""

import pytest

from proxy_renderer.planning.owners import Owners
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.schema.radiometry import unit_energy
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import LightDescription, SceneDescription

TYPES = ("SUN", "AREA", "SPOT", "POINT")


def instances(brighter: str) -> dict[str, Instance]:
    """One light of each type, all as bright on the subject but one that is 20 % brighter."""
    found = {}
    for distance, kind in enumerate(TYPES, 2):
        family = FAMILIES["light/strength" if kind == "SUN" else "light/power"]
        reference = 1.0 if kind == "SUN" else float(distance**2)
        energy = unit_energy(kind, distance) * (1.2 if kind == brighter else 1.0)
        instance = Instance(family, kind.title(), (energy,), reference)
        found[instance.key] = instance
    return found


@pytest.mark.parametrize("brighter", TYPES)
def test_the_brightest_light_is_the_key(brighter):
    context = SceneDescription(lights={kind.title(): LightDescription(kind) for kind in TYPES})
    assert Owners(parse("noir", SceneDescription()), instances(brighter), context).lights.key == [brighter.title()]


def test_a_lights_own_exposure_counts():
    context = SceneDescription(lights={k.title(): LightDescription(k, stops=float(k == "SPOT")) for k in TYPES})
    assert Owners(parse("noir", SceneDescription()), instances("SUN"), context).lights.key == ["Spot"]


def test_of_many_small_things_all_that_are_about_as_large_are_meant():
    titles = ("Dune", "Emma", "Ulysses", "Walden", "Ivanhoe", "Candide", "Persuasion", "Solaris", "Momo", "Faust")
    shares = dict.fromkeys(titles, 0.08) | {"Bookend": 0.1, "Screws": 0.002}
    family = FAMILIES["material/base_color"]
    books = {i.key: i for i in (Instance(family, name, (0.5,) * 3, 1.0, "subject") for name in shares)}
    parsed = parse("emerald green", SceneDescription(materials=dict.fromkeys(shares, "subject")))
    owners = Owners(parsed, books, SceneDescription(material_share=shares))
    (effect,) = (e for e in default_vocabulary().painted["subject"] if e.name == "base_color")
    painted = {i.owner for i in owners.of(effect, parsed.attributes[0])}
    assert painted == shares.keys() - {"Screws"}
