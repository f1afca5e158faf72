# SPDX-License-Identifier: Apache-2.0
"""A small folder of labeled sentences: a garage with a car, two lamps and a neon sign."""

from __future__ import annotations

from pathlib import Path

SCENES = """
[[scene]]
name = "garage"
kind = "car"
subject = ["Hull", "Seat"]
glows = ["NeonSign"]
sky = true
[scene.objects]
Hull = ["HullPaint"]
Seat = ["SeatCloth"]
Floor = ["Concrete"]
Crate = ["CrateWood"]
Sign = ["NeonSign"]
[scene.places]
Sign = [0.5, 0.9, 0.2]
[[scene.lights]]
name = "Ceiling"
type = "AREA"
role = "key"
turn = -40
[[scene.lights]]
name = "Desk Lamp"
type = "POINT"
role = "fill"
turn = 60
lights = ["Crate"]
"""
SENTENCES = """
[[sentence]]
scene = "garage"
kind = "list"
text = "red hull, warm light"
words = [
  ["red", "HullPaint"],
  ["warm", "light"],
]
"""


def write_folder(folder: Path, scenes: str = SCENES, sentences: str = SENTENCES) -> Path:
    """The folder, with one file of sentences."""
    (folder / "scenes.toml").write_text(scenes, encoding="utf-8")
    (folder / "sentences_01.toml").write_text(sentences, encoding="utf-8")
    return folder


def sentence(text: str, *words: tuple[str, str], kind: str = "list") -> str:
    """One [[sentence]] table about the garage."""
    rows = "".join(f'  ["{word}", "{target}"],\n' for word, target in words)
    return f'[[sentence]]\nscene = "garage"\nkind = "{kind}"\ntext = "{text}"\nwords = [\n{rows}]\n'
