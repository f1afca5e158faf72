# SPDX-License-Identifier: Apache-2.0
"""One vibe in the engine: from job folders to values, and the measure of what Cycles made of them."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from PIL import Image

from ..claims.claim import ShotClaims
from ..goals.written import read
from ..guidance import regions
from ..guidance.encoder import Encoder, load_encoder
from ..optimize import pipeline
from ..optimize.known_picture import KnownPicture
from ..optimize.progress import Observer
from ..optimize.rounds.method import load_method
from ..optimize.rounds.search import Search
from ..optimize.shots import BlenderPictures, ShotInput, picture_size
from ..optimize.stage import linked, set_stage
from ..render.proxy import Proxy
from ..scene import load_scene
from ..schema import VibeError, messages
from ..vlm import judge
from ..vlm.advisor import ModelAdvisor
from ..vlm.client import Client
from ..vlm.endpoint import find_endpoint
from . import pictures, report
from .report import word_verdicts

_PREDICTED = 320  # the longer side of a prediction, pixels; the panel shows no more
_FURTHER = 2  # the most rounds of a further sentence: it begins where its image is nearly as wanted


def pick_device(name: str) -> str:
    """The torch device for a name; "auto" is a CUDA card where there is one. Raises VibeError if torch does not have it here."""
    if name in ("", "auto"):
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError) as error:
        remedy = "Use --device cpu, or run `vibe doctor`."
        raise VibeError(f"There is no device {name!r} here.", remedy) from error
    return name


class EngineSession:
    """A vibe's state between its result and its measure; images are written to the job folders of its shots."""

    def __init__(
        self,
        shots: Sequence[messages.Shot],
        prompt: str,
        options: messages.Options,
        observer: Observer,
        vlm_key: str = "",
        known: KnownPicture | None = None,
    ) -> None:
        self.shots, self.prompt, self.options, self._observer = shots, prompt, options, observer
        self._known = known  # the picture that the vibe before has ended with
        self._method = load_method()
        self._encoder: Encoder | None = None
        self._outcome: pipeline.Outcome | None = None
        endpoint = find_endpoint(options, vlm_key)
        self._model = Client(endpoint, observer.stopped) if endpoint else None
        self._predicted: list[tuple[list[str], Image.Image]] = []  # of each shot, see `pictures.predict`
        self._claims: list[ShotClaims] = []  # of each shot
        self._rows: list[list[tuple[str, Image.Image]]] = []  # of compare.png: one for each shot

    def run(self) -> messages.Result:
        """Finds the values and reports how; its images are there after `draw`. Raises VibeError for a bad job, prompt or encoder."""
        options, observer, clock = self.options, self._observer, _Stopwatch()
        observer.stage("loading the encoder")
        device = pick_device(options.device)
        encoder = self._encoder = load_encoder(options.encoder or None, device)
        clock.lap("load encoder")

        observer.stage("loading the scene")
        scenes = [load_scene(Path(shot.job)) for shot in self.shots]
        observer.stage("setting the light")
        written = read(Path(options.goals)) if options.goals else None
        self.prompt = written.prompt if written else self.prompt
        stage = set_stage(scenes, self.prompt, options.new_lights, options.target, written, options.goes_on)
        stage = linked(stage, options)
        if options.goes_on:
            options = replace(options, rounds=min(options.rounds, _FURTHER))
        clock.lap("load scene")

        advisor = None  # the offline planner; or else the model as parser and confiner
        if self._model is not None and self.prompt.strip():
            advisor = ModelAdvisor(stage.understood, stage.goals, self._model, observer.stage, stage.plan)
        scenes = stage.scenes
        blenders = [BlenderPictures(s, observer.ask, options.seed, n) for n, s in enumerate(scenes)]
        rows_of_shots = zip(scenes, blenders, self.shots, strict=True)
        views = [
            ShotInput(s, b if options.anchor else None, shot.file, self._known)
            for s, b, shot in rows_of_shots
        ]
        search = Search(views, stage, options, encoder, observer, advisor, self._method)
        outcome = self._outcome = pipeline.run(search)
        clock.lap("loop", {"wait for Blender": sum(blender.waited for blender in blenders)})

        self._claims = report.claims_about(outcome)
        values = [report.changed_values(outcome, shot) for shot in outcome.shots]
        variants = []
        for number, look in enumerate(outcome.variants, start=1):
            changed = report.changed_values(look, look.shots[0])
            reasons = {key: look.plan[key].reason for key in changed if key in look.plan}
            file = pictures.variant_file(number)
            variants.append(messages.Variant(changed, file, round(look.loss, 4), reasons))
        rows: dict[str, Any] = {"prompt": self.prompt, "encoder": encoder.name, "seed": options.seed}
        rows |= report.search_facts(outcome, stage.understood.words)
        if stage.lighting:
            rows["light"] = list(stage.lighting.notes)
        if advisor:
            rows["vlm"] = advisor.account()
        if options.anchor:
            rows |= report.anchored(outcome, blenders)
        if variants:
            rows["variants"] = [{"score": v.score, "values": v.values} for v in variants]
        claims = report.foreseen(outcome, self._claims)
        verdicts = word_verdicts(outcome, claims, self._claims[0].after)
        rows |= {"claims": claims, "verdicts": verdicts, "timings": clock.laps}
        several = values if len(values) > 1 else []
        return messages.Result(values[0], rows, pictures.PREDICTION, outcome.stopped, variants, several)

    @property
    def last_picture(self) -> KnownPicture | None:
        """The picture of Cycles that the vibe has ended with; None where there is none, or there are several shots."""
        shots = self._outcome.shots if self._outcome else ()
        return shots[0].known_picture() if len(shots) == 1 else None

    def _last(self, verb: str) -> tuple[pipeline.Outcome, Encoder]:
        """The outcome of the last `run`, and its encoder; raises VibeError if there was none."""
        if self._outcome is None or self._encoder is None:
            raise VibeError(f"There is nothing to {verb}.", "Send a vibe first.")
        return self._outcome, self._encoder

    def draw(self) -> None:
        """Draws the prediction and the variants of every shot; raises VibeError if there was no `run` before."""
        outcome, encoder = self._last("draw")
        rows: list[list[tuple[str, Image.Image]]] = []  # a column for each variant
        for number, (shot, state) in enumerate(zip(self.shots, outcome.shots, strict=True)):
            longest = self.options.size if self.options.figures else min(self.options.size, _PREDICTED)
            size, job = picture_size(state.scene.resolution, longest), Path(shot.job)
            proxy = Proxy(state.scene, size, str(encoder.device), self.options.seed, self.options.figures)
            self._predicted.append(pictures.predict(proxy, outcome, number, job, self.options.figures))
            drawn = pictures.predict_variants(proxy, outcome, number, job)
            rows.append([(_label(str(place), shot), image) for place, image in enumerate(drawn, 1)])
        if outcome.variants:
            sheet = pictures.compare(rows, self.prompt, Path(outcome.shots[0].scene.film.fonts))
            pictures.save_image(sheet, Path(self.shots[0].job) / messages.VARIANTS)

    def finish(self, request: messages.Finish) -> messages.Finished:
        """Measures and composes Cycles' pictures of a shot, in the order of shots; raises VibeError if there was no `run` before."""
        outcome, encoder = self._last("finish")
        before, after = (pictures.load_picture(p) for p in (request.before, request.after))
        shape, shot = (after.shape[1], after.shape[0]), self.shots[request.shot]
        names, mask = self._predicted[request.shot]
        files = {name: Path(shot.job) / pictures.PICTURES[name] for name in names}
        shown = pictures.load_picture(files["shown"], shape)

        panels = [("before", before), ("the proxy's prediction", shown), ("after (Cycles)", after)]
        if outcome.reference:
            panels.insert(1, (outcome.reference.name, outcome.reference.picture.display))
        row = [(_label(name, shot), pictures.as_image(torch.from_numpy(p))) for name, p in panels]
        self._rows = [*self._rows[: request.shot], row]
        sheet = pictures.compare(self._rows, self.prompt, Path(outcome.shots[0].scene.film.fonts))
        pictures.save_image(sheet, Path(request.compare_out))

        subject = np.asarray(mask, np.float32) / 255.0
        rendered = pictures.load_picture(request.after, mask.size)
        likeness = partial(_similarity, encoder, outcome.prompts.whole or self.prompt)
        rows = self._claims[request.shot].verdicts(*map(torch.from_numpy, (before, shown, after)))
        return messages.Finished(
            prediction={
                name: pictures.difference(pictures.load_picture(file), rendered, subject)
                for name, file in files.items()
            },
            similarity={"before": likeness(before), "after": likeness(after)},
            judge=self._judge(row[0][1], row[-1][1]),
            claims=rows,
            verdicts=word_verdicts(outcome, rows, self._claims[0].after),
        )

    def check(self, request: messages.Check) -> messages.Checked:
        """Measures Cycles' pictures of another frame by the words of this vibe; raises VibeError if there was no `run` before."""
        outcome, encoder = self._last("check")
        scene = load_scene(Path(request.job))
        before, after = (torch.from_numpy(pictures.load_picture(p)) for p in (request.before, request.after))
        size = after.shape[1], after.shape[0]
        seen = Proxy(scene, size, str(encoder.device), self.options.seed).gbuffer({})
        rows = ShotClaims(outcome.claims, seen, seen).verdicts(before, after, after)
        return messages.Checked(word_verdicts(outcome, rows, seen))

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


def _label(name: str, shot: messages.Shot) -> str:
    return f"{name} · {shot.name}" if shot.name else name


@torch.no_grad()
def _similarity(encoder: Encoder, caption: str, picture: np.ndarray) -> float:
    """Cosine of an image (H, W, 3) and a caption (equation 2)."""
    batch = torch.from_numpy(picture).permute(2, 0, 1)[None].to(encoder.device)
    features = encoder.encode_images(regions.whole(batch, encoder.size))
    return round(float((features @ encoder.encode_texts([caption]).T).item()), 4)


class _Stopwatch:
    """Seconds by the names of laps."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.monotonic()

    def lap(self, name: str, within: Mapping[str, float] | None = None) -> None:
        """Notes the seconds since the last lap; those that belong to others are noted as theirs."""
        now, others = time.monotonic(), within or {}
        self.laps |= {name: round(now - self._last - sum(others.values()), 3)}
        self.laps |= {other: round(seconds, 3) for other, seconds in others.items()}
        self._last = now
