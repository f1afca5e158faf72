# SPDX-License-Identifier: Apache-2.0
"""Asks a model, with a time limit and a cache; leaves out options that the server refuses, and counts the cost."""

from __future__ import annotations

import base64
import contextlib
import hashlib
import io
import json
import os
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from ..folders import cache_folder
from ..schema import atomic
from .endpoint import Endpoint
from .transport import Completion, ModelError, Transport, find_object, scrub

if TYPE_CHECKING:
    from torch import Tensor


_SMALLEST, _LARGEST = 384, 1536  # pixels of the longer side: sizes that models can cut into patches


def jpeg_of(picture: Tensor | Image.Image) -> bytes:
    """A JPEG of a display-referred tensor (H, W, 3) in [0, 1], or of a PIL image.

    The image is resized if its longer side has less than 384 or more than 1536 pixels.
    """
    if not isinstance(picture, Image.Image):
        picture = Image.fromarray((picture.detach().cpu().numpy().clip(0.0, 1.0) * 255.0 + 0.5).astype(np.uint8))
    longest = max(picture.size)
    factor = min(max(longest, _SMALLEST), _LARGEST) / longest
    width, height = (max(round(n * factor), 1) for n in picture.size)
    file = io.BytesIO()
    picture.resize((width, height), Image.Resampling.LANCZOS).convert("RGB").save(file, "JPEG", quality=90)
    return file.getvalue()


_FORMATS = ("json_schema", "json_object", "text")
_TEMPERATURE = re.compile(r"temperature", re.IGNORECASE)
_LIMIT = re.compile(r"max_(completion_)?tokens", re.IGNORECASE)
_FORMAT = re.compile(r"response_format|json_schema|json_object|schema|grammar|structured|json mode", re.IGNORECASE)
_PICTURE = re.compile(r"image|vision|multi-?modal|mmproj|content.{0,20}(part|type|array|list|string)", re.IGNORECASE)


@dataclass(frozen=True)
class Question:
    """A question to a model."""

    system: str  # instructions to the model
    text: str  # the data as one JSON document, or a plain text
    picture: bytes | None = None  # a JPEG; None for none
    schema: dict[str, Any] | None = None  # JSON schema of the answer; None where the answer is plain text
    must_see: bool = False  # whether an answer without the image would be useless


class Dialect:
    """The options of a request that the server has not refused so far."""

    def __init__(self) -> None:
        self.format = _FORMATS[0]
        self.pictures = True
        self._temperature = True
        self._limit = "max_completion_tokens"

    def body(self, model: str, question: Question, earlier: list[dict[str, Any]]) -> dict[str, Any]:
        """The request as JSON; `earlier`: messages of a first attempt (its answer and a complaint), [] for none."""
        system = question.system
        body: dict[str, Any] = {"model": model}
        if question.schema is not None:
            if self.format == "json_schema":
                strict = {"name": "reply", "strict": True, "schema": question.schema}
                body["response_format"] = {"type": "json_schema", "json_schema": strict}
            else:
                schema = json.dumps(question.schema, separators=(",", ":"))
                system += f"\n\nReply with one JSON object, and nothing else, by this JSON schema:\n{schema}"
                if self.format == "json_object":
                    body["response_format"] = {"type": "json_object"}
        content: Any = question.text
        if question.picture is not None and self.pictures:
            url = "data:image/jpeg;base64," + base64.b64encode(question.picture).decode()
            image = {"type": "image_url", "image_url": {"url": url}}
            content = [{"type": "text", "text": question.text}, image]
        if self._temperature:
            body["temperature"] = 0
        if self._limit:
            body[self._limit] = 8192  # a plan has one or two thousand; the rest is for models that think first
        messages = [{"role": "system", "content": system}, {"role": "user", "content": content}, *earlier]
        return {**body, "messages": messages}

    def give_up(self, complaint: str, question: Question) -> bool:
        """Leaves out or simplifies the option that a server complains about; False if no option is left to change."""
        formats = question.schema is not None and self.format != "text"
        pictures = question.picture is not None and self.pictures and not question.must_see
        of_picture = _PICTURE.search(complaint) and not _FORMAT.search(complaint)
        if _TEMPERATURE.search(complaint) and self._temperature:
            self._temperature = False
        elif _LIMIT.search(complaint) and self._limit:
            self._limit = "max_tokens" if self._limit == "max_completion_tokens" else ""
        elif pictures and (of_picture or not formats):
            self.pictures = False
        elif formats:
            self.format = _FORMATS[_FORMATS.index(self.format) + 1]
        else:
            return False
        return True


_MOST = 500  # most answers that are kept; the least recently used are deleted


class Cache:
    """A folder of answers by key, one small JSON file each. A file that cannot be read or written counts as missing."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or cache_folder("vlm")

    def read(self, key: str) -> Any:
        """The answer of a key; None if there is none."""
        path = self.folder / f"{key}.json"
        try:
            answer = json.loads(path.read_text(encoding="utf-8"))["answer"]
            os.utime(path)
            return answer
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            return None

    def write(self, key: str, answer: Any) -> None:
        """Stores an answer in a file that only this user can read, and deletes old answers; ignores failures."""
        with contextlib.suppress(OSError, RuntimeError):
            self.folder.mkdir(parents=True, exist_ok=True)
            with atomic.replacing(self.folder / f"{key}.json") as part:
                part.touch(mode=0o600)
                part.write_text(json.dumps({"answer": answer}), encoding="utf-8")
            for path in sorted(self.folder.glob("*.json"), key=lambda p: p.stat().st_mtime)[:-_MOST]:
                path.unlink(missing_ok=True)


_AGAIN = "That was not what was asked for. Reply exactly in the form that was asked for, and with nothing else."


@dataclass
class Usage:
    """Requests, tokens and cost so far."""

    calls: int = 0  # requests; one that the openai package repeats counts once
    cached: int = 0  # questions answered from the disk
    read: int = 0  # tokens of all questions, as the server counts them
    written: int = 0  # tokens of all answers
    seconds: float = 0.0  # time spent waiting
    cost: float | None = None  # US dollars; None if neither the server nor VIBE_VLM_PRICE gives a price

    def add(self, answer: Completion, prices: tuple[float, float] | None) -> None:
        """Counts an answer; `prices` as in `Endpoint`."""
        self.read, self.written = self.read + answer.read, self.written + answer.written
        cost = answer.cost
        if cost is None and prices:
            cost = (answer.read * prices[0] + answer.written * prices[1]) / 1e6
        if cost is not None:
            self.cost = (self.cost or 0.0) + cost

    def account(self) -> dict[str, Any]:
        """The numbers as fields for report.json."""
        return {
            "calls": self.calls,
            "cached": self.cached,
            "tokens": {"read": self.read, "written": self.written},
            "seconds": round(self.seconds, 2),
            "cost_usd": None if self.cost is None else round(self.cost, 6),
        }


class Client:
    """Asks the model of an endpoint; gives up when `stop` returns True."""

    def __init__(
        self, endpoint: Endpoint, stop: Callable[[], bool] = lambda: False, cache: Cache | None = None
    ) -> None:
        self.endpoint, self._cache = endpoint, cache or Cache()
        self._transport = Transport(endpoint, stop)
        self.usage = Usage()
        self.dialect = Dialect()

    def ask(self, question: Question, check: Callable[[Any], object] = bool, fresh: bool = False) -> Any:
        """The answer, an object if the question has a schema, else text; from the cache, unless `fresh`.

        If `check` raises ModelError, the model is asked once more. Raises ModelError without a usable answer.
        """
        point = self.endpoint
        # The number is the version of questions and answers: another one invalidates the cache.
        asked = [1, point.url, point.model, question.system, question.text, question.schema]
        key = hashlib.sha256(json.dumps(asked, sort_keys=True).encode() + (question.picture or b"")).hexdigest()
        if not fresh and (cached_answer := self._cache.read(key)) is not None:
            self.usage.cached += 1
            return cached_answer
        if question.must_see and not self.dialect.pictures:
            raise ModelError(f"The model {point.model} does not see pictures.", "Use a vision-language model.")
        start = time.monotonic()
        try:
            answer = self._converse(question, check, start + point.seconds)
        finally:
            self._transport.close()
            self.usage.seconds += time.monotonic() - start
        self._cache.write(key, answer)
        return answer

    def _converse(self, question: Question, check: Callable[[Any], object], end: float) -> Any:
        """Asks, and once more if the answer cannot be read or `check` refuses it; `end` is a monotonic time."""
        earlier: list[dict[str, Any]] = []  # unreadable answer and complaint about it
        while True:
            answer = self._speak(question, earlier, end)
            text = scrub(answer.text, self.endpoint.key)
            try:
                if answer.cut:
                    remedy = "Use a model with more context, or one that thinks less."
                    raise ModelError("The model's answer was cut off.", remedy)
                schema = question.schema
                reading = scrub(find_object(text, schema["properties"]), self.endpoint.key) if schema else text
                check(reading)
                return reading
            except ModelError:
                if earlier:
                    raise
                earlier = [{"role": "assistant", "content": text[:4000]}, {"role": "user", "content": _AGAIN}]

    def _speak(self, question: Question, earlier: list[dict[str, Any]], end: float) -> Completion:
        """One answer; leaves out options until the server accepts the request. `end` is a monotonic time."""
        for _ in range(8):  # refusals, until the server counts as useless
            body = self.dialect.body(self.endpoint.model, question, earlier)
            try:
                self.usage.calls += 1
                answer = self._transport.post(body, max(end - time.monotonic(), 0.1))
                self.usage.add(answer, self.endpoint.prices)
                return answer
            except ModelError as error:
                words = error.complaint
                # A server that fails with words about a part of the request refuses that part.
                broken = error.broken and not any(p.search(words) for p in (_TEMPERATURE, _LIMIT, _FORMAT, _PICTURE))
                if error.lasting or not words or broken or not self.dialect.give_up(words, question):
                    raise
        remedy = "Use another model."
        raise ModelError(f"{self.endpoint.place} refuses everything that it is asked.", remedy, lasting=True)
