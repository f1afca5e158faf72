# SPDX-License-Identifier: Apache-2.0
"""One job: its scene is built, vibed and kept; what has been made already is read again."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from lab.bench import blender
from lab.bench.paper import finished
from lab.bench.paper.measures import FOG
from lab.bench.sealed.judge import Evidence, judged
from lab.bench.sealed.prompts import SealedJob
from lab.bench.sealed.rules import rule
from lab.bench.wild import product
from lab.methods import OURS, Variation
from proxy_renderer.schema import atomic
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary


@dataclass(frozen=True)
class SealedTrial:
    """A job to be carried out.

    Attributes:
        job: The prompt and the scene.
        folder: Gets "scene.blend", "sight.npz", "built.json", "ended.json", "log.txt", and in "out" what `vibe run` writes.
        size: Longer side of the pictures, pixels.
        samples: Of Cycles.
        variation: How it is searched.
    """

    job: SealedJob
    folder: Path
    size: int
    samples: int
    variation: Variation = OURS

    def row(self) -> dict[str, Any]:
        """Its result: from the folder if it has been carried out, always judged anew."""
        subject = [f"--subject={name}" for name in self._subject()]
        budget = [f"--size={self.size}", f"--samples={self.samples}", "--vlm-model=off", "--figures"]
        scene, prompt = self.folder / "scene.blend", self.job.prompt
        ended = product.vibe_once(scene, prompt, self.folder, [*subject, *budget], self.variation)
        return {"prompt": prompt, **ended, **(self._verdict() if ended["code"] == 0 else {})}

    def _subject(self) -> list[str]:
        """Names of the subject's objects; the scene is built if it is not there."""
        built = self.folder / "built.json"
        if not built.is_file():
            self.folder.mkdir(parents=True, exist_ok=True)
            drawn = self.folder / "drawn.json"
            atomic.write_text(drawn, json.dumps(self.job.scene.plain, indent=1))
            told = blender.command("sealed", "build", drawn, self.folder, self.job.number)
            atomic.write_text(built, json.dumps(told["subject"]))
        subject: list[str] = json.loads(built.read_text(encoding="utf-8"))
        return subject

    def _verdict(self) -> dict[str, Any]:
        report = json.loads((self.folder / "out" / "report.json").read_text("utf-8"))
        before, after = (self._picture(which) for which in ("before", "after"))
        evidence = Evidence(before, after, report["parameters"])
        claims = [row["holds"] for row in report["claims"] if row["holds"] is not None]
        return {
            "asks": [
                {
                    "kind": ask.kind,
                    "words": ask.words,
                    "part": ask.part,
                    "new_color": ask.kind == "color" and ask.words not in default_vocabulary().colors,
                    "holds": holds,
                    "found": [asdict(each) for each in found],
                }
                for ask, holds, found in judged(self.job, evidence)
            ],
            "seen": evidence.subject_is_seen,
            "loop_seconds": report["timings"]["engine: loop"],
            "claims_held": sum(claims),
            "claims": len(claims),
            "ignored": report["understood"]["ignored"],
        }

    def _picture(self, which: str) -> finished.FinishedPicture:
        """The camera of a .blend stays where it is: both pictures show the same things in the same places."""
        out = self.folder / "out"
        clear = self._clear() if which == "after" else None
        return finished.read(out / f"{which}.png", out / "mask.png", self.folder / "sight.npz", clear)

    def _clear(self) -> Path | None:
        """The finished picture without its fog, which is rendered if it is not there; None where no fog is asked for."""
        if all(rule(name).measure != FOG for ask in self.job.asks for name in ask.shows):
            return None
        out, picture = self.folder / "out", self.folder / "out" / "clear.png"
        if not picture.is_file():
            blender.command("sealed", "clear", out / "vibed.blend", picture, self.size, self.samples)
        return picture
