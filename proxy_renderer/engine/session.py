# SPDX-License-Identifier: Apache-2.0
"""One vibe in the engine: from job folders to values, and the verdicts on Cycles' renders of them."""

import time
from collections.abc import Sequence
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
_FURTHER = 2  # most rounds of a further sentence, whose image is nearly as wanted from the start


def pick_device(name: str) -> str:
    """The torch device for a name; "auto" is a CUDA card where there is one. Raises VibeError if torch does not have it here."""
    if name in ("", "auto"):
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError) as error:
        raise VibeError(f"There is no device {name!r} here.", "Use --device cpu, or run `vibe doctor`.") from error
    return name


class EngineSession:
    """A vibe's state from its search to the verdicts on its renders; images go to the job folders of its shots."""

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
        self._known = known  # the last anchor of the previous vibe
        self._encoder: Encoder  # set by `run`, as is `_outcome`
        self._outcome: pipeline.Outcome
        endpoint = find_endpoint(options, vlm_key)
        self._model = Client(endpoint, observer.stopped) if endpoint else None
        self._predicted: list[tuple[list[str], Image.Image]] = []  # of each shot, see `pictures.predict`
        self._claims: list[ShotClaims] = []  # of each shot
        self._rows: list[list[tuple[str, Image.Image]]] = []  # of compare.png: one for each shot

    def run(self) -> messages.Result:
        """Searches for values and reports on them; `draw` makes the images. Raises VibeError for unusable input."""
        options, observer, began = self.options, self._observer, time.monotonic()
        observer.stage("loading the encoder")
        encoder = self._encoder = load_encoder(options.encoder or None, pick_device(options.device))
        loaded = time.monotonic()
        observer.stage("loading the scene")
        scenes = [load_scene(Path(shot.job)) for shot in self.shots]
        observer.stage("setting the light")
        written = read(Path(options.goals)) if options.goals else None
        self.prompt = written.prompt if written else self.prompt
        stage = set_stage(scenes, self.prompt, options.new_lights, options.target, written, options.goes_on)
        stage = linked(stage, options)
        if options.goes_on:
            options = replace(options, rounds=min(options.rounds, _FURTHER))
        staged = time.monotonic()

        advisor = None  # the offline planner, unless a model is parser and confiner
        if self._model is not None and self.prompt.strip():
            advisor = ModelAdvisor(stage.understood, stage.goals, self._model, observer.stage, stage.plan)
        scenes = stage.scenes
        blenders = [BlenderPictures(s, observer.ask, options.seed, n) for n, s in enumerate(scenes)]
        rows_of_shots = zip(scenes, blenders, self.shots, strict=True)
        views = [ShotInput(s, b if options.anchor else None, shot.file, self._known) for s, b, shot in rows_of_shots]
        outcome = self._outcome = pipeline.run(Search(views, stage, options, encoder, observer, advisor, load_method()))
        ended, waited = time.monotonic(), sum(blender.waited for blender in blenders)
        timings = {"load encoder": loaded - began, "load scene": staged - loaded}
        timings |= {"loop": ended - staged - waited, "wait for Blender": waited}

        self._claims = report.claims_about(outcome)
        values = [report.changed_values(outcome, shot) for shot in outcome.shots]
        variants = []
        for number, look in enumerate(outcome.variants, start=1):
            changed = report.changed_values(look, look.shots[0])
            reasons = {key: look.plan[key].reason for key in changed if key in look.plan}
            file = pictures.VARIANT.format(number)
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
        rows |= {"claims": claims, "verdicts": verdicts}
        rows["timings"] = {name: round(seconds, 3) for name, seconds in timings.items()}
        several = values if len(values) > 1 else []
        return messages.Result(values[0], rows, pictures.PICTURES["shown"], outcome.stopped, variants, several)

    @property
    def last_picture(self) -> KnownPicture | None:
        """The last anchor of the vibe; None if it has none, or several shots."""
        shots = self._outcome.shots
        return shots[0].known_picture() if len(shots) == 1 else None

    def draw(self) -> None:
        """Draws the prediction and the variants of every shot, after `run`."""
        outcome, encoder = self._outcome, self._encoder
        rows: list[list[tuple[str, Image.Image]]] = []  # a column for each variant
        for number, (shot, state) in enumerate(zip(self.shots, outcome.shots, strict=True)):
            longest = self.options.size if self.options.figures else min(self.options.size, _PREDICTED)
            size, job = picture_size(state.scene.resolution, longest), Path(shot.job)
            proxy = Proxy(state.scene, size, str(encoder.device), self.options.seed, self.options.figures)
            self._predicted.append(pictures.predict(proxy, outcome, number, job, self.options.figures))
            drawn = pictures.predict_variants(proxy, outcome, number, job)
            rows.append([(_label(str(place), shot), image) for place, image in enumerate(drawn, 1)])
        if outcome.variants:
            pictures.save_image(self._sheet(rows), Path(self.shots[0].job) / messages.VARIANTS)

    def finish(self, request: messages.Finish) -> messages.Finished:
        """Verdicts on Cycles' renders of a shot; writes the sheet that compares them. After `draw`, shot by shot."""
        outcome, encoder = self._outcome, self._encoder
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
        pictures.save_image(self._sheet(self._rows), Path(request.compare_out))

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
        """Verdicts, by this vibe's claims, on Cycles' renders of another frame. Call after `run`."""
        before, after = (torch.from_numpy(pictures.load_picture(p)) for p in (request.before, request.after))
        scene, size = load_scene(Path(request.job)), (after.shape[1], after.shape[0])
        seen = Proxy(scene, size, str(self._encoder.device), self.options.seed).gbuffer({})
        rows = ShotClaims(self._outcome.claims, seen, seen).verdicts(before, after, after)
        return messages.Checked(word_verdicts(self._outcome, rows, seen))

    def _sheet(self, rows: Sequence[Sequence[tuple[str, Image.Image]]]) -> Image.Image:
        fonts = Path(self._outcome.shots[0].scene.film.fonts)
        return pictures.compare(rows, self.prompt, fonts)

    def _judge(self, before: Image.Image, after: Image.Image) -> dict[str, Any]:
        """The model's verdict on Cycles' two renders, or its error; {} without a model or a prompt."""
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
    """Cosine similarity of an image (H, W, 3) and a caption in the encoder's space (equation 2)."""
    batch = torch.from_numpy(picture).permute(2, 0, 1)[None].to(encoder.device)
    features = encoder.encode_images(regions.whole(batch, encoder.size))
    return round(float((features @ encoder.encode_texts([caption]).T).item()), 4)
