# SPDX-License-Identifier: Apache-2.0
"""Asks a model: from the cache if it can, else with patience, within a time limit, and counts what it costs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .cache import Cache
from .dialect import Dialect, Question
from .endpoint import Endpoint
from .errors import ModelError
from .extract import find_object, scrub
from .transport import Completion, Transport

_VERSION = 1  # of the questions and what is made of answers; a new one forgets the cache
_TRIES = 4
_PAUSE = 0.5  # seconds before the second try; doubled every time
_REFUSALS = 8  # things that a server may refuse before it counts as useless
_AGAIN = (
    "That was not what was asked for. Reply exactly in the form that was asked for, and with nothing else."
)


@dataclass
class Usage:
    """Requests, tokens and cost so far.

    Attributes:
        calls: Requests sent, repetitions included.
        cached: Questions answered from the disk.
        read: Tokens of all questions, as the server counts them.
        written: Tokens of all answers.
        seconds: Time spent waiting.
        cost: US dollars, where the server or VIBE_VLM_PRICE says what tokens cost.
    """

    calls: int = 0
    cached: int = 0
    read: int = 0
    written: int = 0
    seconds: float = 0.0
    cost: float | None = None

    def account(self) -> dict[str, Any]:
        """For report.json."""
        return {
            "calls": self.calls,
            "cached": self.cached,
            "tokens": {"read": self.read, "written": self.written},
            "seconds": round(self.seconds, 2),
            "cost_usd": None if self.cost is None else round(self.cost, 6),
        }


def _anything(answer: Any) -> None:
    """Every answer will do."""


def never() -> bool:
    """Nobody stops it."""
    return False


class Client:
    """A model to ask.

    Args:
        stop: True when the wait should end now.

    Attributes:
        usage: What it has cost.
        dialect: What the server has turned out to understand.
    """

    def __init__(
        self, endpoint: Endpoint, stop: Callable[[], bool] = never, cache: Cache | None = None
    ) -> None:
        self.endpoint, self._stop, self._cache = endpoint, stop, cache or Cache()
        self._transport = Transport(endpoint, stop)
        self.usage = Usage()
        self.dialect = Dialect()

    def ask(
        self, question: Question, check: Callable[[Any], object] | None = None, fresh: bool = False
    ) -> Any:
        """The answer: an object if the question has a schema, else text.

        Args:
            check: Raises ModelError for an answer that is of no use; the model is asked once more then.
            fresh: Do not look on the disk.

        Raises:
            ModelError: There is none.
        """
        point = self.endpoint
        key = Cache.key(
            _VERSION,
            point.url,
            point.model,
            question.system,
            question.text,
            question.schema,
            question.picture or b"",
        )
        if not fresh and (cached_answer := self._cache.read(key)) is not None:
            self.usage.cached += 1
            return cached_answer
        if question.must_see and not self.dialect.pictures:
            raise ModelError(
                f"The model {point.model} does not see pictures.", "Use a vision-language model."
            )
        start = time.monotonic()
        try:
            answer = self._converse(question, check or _anything, start + point.seconds)
        finally:
            self._transport.close()
            self.usage.seconds += time.monotonic() - start
        self._cache.write(key, answer)
        return answer

    def _converse(self, question: Question, check: Callable[[Any], object], end: float) -> Any:
        """Asks, and once more if the answer cannot be read."""
        earlier: list[dict[str, Any]] = []
        while True:
            answer = self._speak(question, earlier, end)
            text = scrub(answer.text, self.endpoint.key)
            try:
                if answer.cut:
                    raise ModelError(
                        "The model's answer was cut off.",
                        "Use a model with more context, or one that thinks less.",
                    )
                reading: Any = text
                if question.schema is not None:
                    reading = scrub(find_object(text, question.schema["properties"]), self.endpoint.key)
                check(reading)
                return reading
            except ModelError:
                if earlier:
                    raise
                earlier = [{"role": "assistant", "content": text[:4000]}, {"role": "user", "content": _AGAIN}]

    def _speak(self, question: Question, earlier: list[dict[str, Any]], end: float) -> Completion:
        """One answer, in whatever dialect the server understands."""
        for _ in range(_REFUSALS):
            body = self.dialect.body(self.endpoint.model, question, earlier)
            try:
                return self._send(body, end)
            except ModelError as error:
                broken = error.wait is not None and not self.dialect.about(error.complaint)
                if (
                    error.lasting
                    or not error.complaint
                    or broken
                    or not self.dialect.give_up(error.complaint, question)
                ):
                    raise
        raise ModelError(
            f"{self.endpoint.place} refuses everything that it is asked.", "Use another model.", lasting=True
        )

    def _send(self, body: dict[str, Any], end: float) -> Completion:
        """One request, repeated with growing pauses while that may help and there is time."""
        pause = _PAUSE
        for attempt in range(1, _TRIES + 1):
            self.usage.calls += 1
            try:
                answer = self._transport.post(body, max(end - time.monotonic(), 0.1))
                self._count(answer)
                return answer
            except ModelError as error:
                if error.wait is None or attempt == _TRIES or self.dialect.about(error.complaint):
                    raise
                wait = max(pause, error.wait)
                if time.monotonic() + wait > end:
                    raise
            self._sleep(wait)
            pause *= 2
        raise AssertionError("the last try returns or raises")

    def _sleep(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if self._stop():
                raise ModelError("You stopped it.", "", lasting=True)
            time.sleep(min(left, 0.05))

    def _count(self, answer: Completion) -> None:
        use, prices = self.usage, self.endpoint.prices
        use.read, use.written = use.read + answer.read, use.written + answer.written
        cost = answer.cost
        if cost is None and prices:
            cost = (answer.read * prices[0] + answer.written * prices[1]) / 1e6
        if cost is not None:
            use.cost = (use.cost or 0.0) + cost
