# SPDX-License-Identifier: Apache-2.0
"""One vibe in the engine: from job folders to values, and the measure of what Cycles made of them."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from PIL import Image

from ..claims.verdict import ShotClaims
from ..goals.written import as_json, read
from ..guidance import augment
from ..guidance.encoder import Encoder, load_encoder
from ..optimize import pipeline
from ..optimize.anchoring import BlenderPictures
from ..optimize.progress import Observer
from ..optimize.rounds.method import VARIABLE, load_method
from ..optimize.shots import ShotInput, picture_size
from ..optimize.stage import Stage, set_stage
from ..prompt.understood import Understood
from ..reference.like import Reference
from ..render.proxy import Proxy
from ..scene import load_scene
from ..schema import VibeError, messages
from ..vlm import judge
from ..vlm.advisor import ModelAdvisor
from ..vlm.client import Client
from ..vlm.endpoint import find_endpoint
from . import predictions, report
from .claimed import claims_about, foreseen
from .pictures import compare, load_picture, save_image


def pick_device(name: str) -> str:
    """The torch device for a name; "auto" is a CUDA card where there is one.

    Raises:
        VibeError: If torch does not have it here.
    """
    if name in ("", "auto"):
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError) as error:
        raise VibeError(
            f"There is no device {name!r} here.", "Use --device cpu, or run `vibe doctor`."
        ) from error
    return name


class EngineSession:
    """A vibe's state between its result and its measure.

    Args:
        shots: The job folders that the scene was exported to, one or several; pictures are written there too.
        vlm_key: The vision-language model's key from the preferences; "" for the environment's.
    """

    def __init__(
        self,
        shots: Sequence[messages.Shot],
        prompt: str,
        options: messages.Options,
        observer: Observer,
        vlm_key: str = "",
    ) -> None:
        self.shots, self.prompt, self.options, self._observer = shots, prompt, options, observer
        self._method = load_method()
        self._caption = prompt
        self._understood: Understood | None = None
        self._encoder: Encoder | None = None
        self._outcome: pipeline.Outcome | None = None
        endpoint = find_endpoint(options, vlm_key)
        self._model = Client(endpoint, observer.stopped) if endpoint else None
        self._predicted: list[predictions.Predicted] = []  # of each shot
        self._reference: Reference | None = None
        self._claims: list[ShotClaims] = []  # one for each shot
        self._rows: list[list[tuple[str, Image.Image]]] = []  # of compare.png: one for each shot

    def run(self) -> messages.Result:
        """Finds the values and says how it went; the pictures that it names are there after `draw`.

        Raises:
            VibeError: The job cannot be read, the words name no look, or the encoder cannot be loaded.
        """
        clock = _Laps()
        self._observer.stage("loading the encoder")
        device = pick_device(self.options.device)
        encoder = self._encoder = load_encoder(self.options.encoder or None, device)
        clock.lap("load encoder")
        self._observer.stage("loading the scene")
        found = [load_scene(Path(shot.job)) for shot in self.shots]
        self._observer.stage("setting the light")
        written = read(Path(self.options.goals)) if self.options.goals else None
        self.prompt = written.prompt if written else self.prompt
        addition = set_stage(found, self.prompt, self.options.new_lights, self.options.target, written)
        scenes, self._understood = addition.scenes, addition.understood
        clock.lap("load scene")
        advisor = self._advisor(addition)
        ask, seed = self._observer.ask, self.options.seed
        blenders = [BlenderPictures(scene, ask, seed, number) for number, scene in enumerate(scenes)]
        views = [
            ShotInput(scene, blender if self.options.anchor else None, shot.file)
            for scene, blender, shot in zip(scenes, blenders, self.shots, strict=True)
        ]
        outcome = pipeline.run(
            views, self.prompt, self.options, encoder, self._observer, advisor, addition, self._method
        )
        clock.lap("loop", {"wait for Blender": sum(blender.waited for blender in blenders)})
        self._outcome = outcome
        variants = _variants(outcome)
        self._claims, self._reference = claims_about(outcome), outcome.reference
        self._caption = outcome.prompts.whole or self.prompt
        values = [report.changed_values(outcome, shot) for shot in outcome.shots]
        return messages.Result(
            values=values[0],
            report={
                **self._facts(outcome, encoder),
                **({"light": list(addition.lighting.notes)} if addition.lighting else {}),
                **({"vlm": advisor.account()} if advisor else {}),
                **(report.anchored(outcome, blenders) if self.options.anchor else {}),
                **(
                    {"variants": [{"score": v.score, "values": v.values} for v in variants]}
                    if variants
                    else {}
                ),
                "claims": foreseen(outcome, self._claims),
                "timings": clock.laps,
            },
            prediction=predictions.PREDICTION,
            stopped=outcome.stopped,
            variants=variants,
            shots=values if len(values) > 1 else [],
        )

    def draw(self) -> None:
        """Draws the prediction and the variants of every shot.

        Raises:
            VibeError: There was no `run` before.
        """
        outcome, encoder = self._outcome, self._encoder
        if outcome is None or encoder is None:
            raise VibeError("There is nothing to draw.", "Send a vibe first.")
        rows: list[list[tuple[str, Image.Image]]] = []  # a column for each variant
        for number, (shot, seen) in enumerate(zip(self.shots, outcome.shots, strict=True)):
            size = picture_size(seen.scene.resolution, self.options.size)
            proxy = Proxy(seen.scene, size, str(encoder.device), self.options.seed, fine=True)
            self._predicted.append(
                predictions.predict(proxy, outcome, number, Path(shot.job), self.options.figures)
            )
            pictures = predictions.variants(proxy, outcome, number, Path(shot.job))
            rows.append(
                [
                    (f"{place} · {shot.name}" if shot.name else f"{place}", p)
                    for place, p in enumerate(pictures, 1)
                ]
            )
        if outcome.variants:
            sheet = compare(rows, self.prompt, self._fonts())
            save_image(sheet, Path(self.shots[0].job) / messages.VARIANTS)

    def _fonts(self) -> Path:
        """The folder of Blender's fonts."""
        assert self._outcome
        return Path(self._outcome.shots[0].scene.film.fonts)

    def finish(self, request: messages.Finish) -> messages.Finished:
        """Measures Cycles' pictures against the prediction and the words, and composes them.

        Args:
            request: One shot's pictures; several shots come in their order.

        Raises:
            VibeError: There was no `run` before.
        """
        if self._encoder is None:
            raise VibeError("There is nothing to finish.", "Send a vibe first.")
        before, after = (load_picture(Path(p)) for p in (request.before, request.after))
        shape, shot = (after.shape[1], after.shape[0]), self.shots[request.shot]
        job = Path(shot.job)
        found = self._predicted[request.shot]
        drawn = {n: _drawn(job / predictions.PICTURES[n], shape) for n in found.names}
        predicted = drawn["shown"]
        panels = [("before", before), ("the proxy's prediction", predicted), ("after (Cycles)", after)]
        if reference := self._reference:
            panels.insert(1, (reference.name, reference.picture.display))
        images = [
            (
                f"{label} · {shot.name}" if shot.name else label,
                Image.fromarray((p * 255.0 + 0.5).astype(np.uint8)),
            )
            for label, p in panels
        ]
        self._rows = [*self._rows[: request.shot], images]
        save_image(compare(self._rows, self.prompt, self._fonts()), Path(request.compare_out))
        subject = np.asarray(found.mask.resize(shape, Image.Resampling.LANCZOS), np.float32) / 255.0
        return messages.Finished(
            prediction={name: predictions.apart(each, after, subject) for name, each in drawn.items()},
            similarity={"before": self._similarity(before), "after": self._similarity(after)},
            judge=self._judge(images[0][1], images[-1][1]),
            claims=self._claims[request.shot].verdicts(*map(torch.from_numpy, (before, predicted, after))),
        )

    def _advisor(self, addition: Stage) -> ModelAdvisor | None:
        """The model as parser and confiner; None for the offline planner."""
        if self._model is None or not self.prompt.strip():
            return None
        return ModelAdvisor(
            addition.understood, addition.goals, self._model, self._observer.stage, addition.plan
        )

    def _judge(self, before: Image.Image, after: Image.Image) -> dict[str, Any]:
        """The model's verdict on Cycles' two pictures, or why there is none."""
        if self._model is None or not self.prompt.strip():
            return {}
        self._observer.stage("asking the judge")
        model = Client(self._model.endpoint)
        column = judge.Column("The scene", self.prompt, after, before)
        try:
            verdict = asdict(judge.judge(model, [column], judge.BEFORE_AFTER))
        except VibeError as error:
            verdict = {"error": str(error)}
        return {"model": model.endpoint.model, **verdict, **model.usage.account()}

    def _similarity(self, picture: np.ndarray) -> float:
        """Cosine of a picture (H, W, 3) and the caption of the whole (equation 2)."""
        encoder = self._encoder
        assert encoder is not None
        with torch.no_grad():
            batch = torch.from_numpy(picture).permute(2, 0, 1)[None].to(encoder.device)
            features = encoder.encode_images(augment.whole(batch, encoder.size))
            return round(float((features @ encoder.encode_texts([self._caption]).T).item()), 4)

    def _facts(self, outcome: pipeline.Outcome, encoder: Encoder) -> dict[str, Any]:
        """The fields of report.json that the engine knows."""
        goals, prompts = outcome.goals, outcome.prompts
        return {
            "prompt": self.prompt,
            "encoder": encoder.name,
            "seed": self.options.seed,
            "method": os.environ.get(VARIABLE, ""),
            "goals": as_json(goals),
            "parameters": report.parameter_records(outcome),
            "rounds": outcome.rounds,
            "understood": {
                "subject": prompts.subject,
                "surroundings": prompts.surroundings,
                "whole": prompts.whole,
                "classes": goals.classes,
                "ignored": goals.parsed.ignored,
                "guesses": goals.parsed.guesses,
                "words": [word.row() for word in self._understood.words] if self._understood else [],
                "notes": list(dict.fromkeys([*goals.parsed.notes, *outcome.plan.notes])),
            },
            "versions": report.versions(),
        }


def _variants(outcome: pipeline.Outcome) -> list[messages.Variant]:
    """The looks to choose from."""
    return [_variant(look, number) for number, look in enumerate(outcome.variants, start=1)]


def _variant(look: pipeline.Outcome, number: int) -> messages.Variant:
    values = report.changed_values(look, look.shots[0])
    reasons = {key: look.plan[key].reason for key in values if key in look.plan}
    return messages.Variant(values, predictions.variant(number), round(look.loss, 4), reasons)


def _drawn(path: Path, shape: tuple[int, int]) -> np.ndarray:
    """A prediction (H, W, 3) at another width and height."""
    with Image.open(path) as image:
        resized = image.convert("RGB").resize(shape, Image.Resampling.LANCZOS)
    return np.asarray(resized, np.float32) / 255.0


class _Laps:
    """A stopwatch."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.monotonic()

    def lap(self, name: str, within: Mapping[str, float] | None = None) -> None:
        """Notes the seconds since the last lap; those that belong to others are noted as theirs."""
        now, others = time.monotonic(), within or {}
        self.laps |= {name: round(now - self._last - sum(others.values()), 3)}
        self.laps |= {other: round(seconds, 3) for other, seconds in others.items()}
        self._last = now
