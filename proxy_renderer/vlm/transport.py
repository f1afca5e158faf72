# SPDX-License-Identifier: Apache-2.0
"""Requests through the `openai` package, with limits of time and size, and their answers; every failure is a ModelError."""

import json
import queue
import re
import threading
import time
import unicodedata
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from typing import Any

from ..schema import VibeError
from .endpoint import OPENAI, Endpoint


def find_object(text: str, names: Collection[str]) -> dict[str, Any]:
    """The first JSON object in a model's text that has one of the keys `names`. Raises ModelError if there is none."""

    def refuse(constant: str) -> float:
        raise ValueError(f"{constant} is not JSON")

    text = text.rpartition("</think>")[2]
    decoder = json.JSONDecoder(parse_constant=refuse)
    for brace in islice(re.finditer("{", text), 200):
        with suppress(ValueError, RecursionError):
            candidate, _ = decoder.raw_decode(text, brace.start())
            if any(name in candidate for name in names):
                return candidate
    if not text.strip():
        raise ModelError("The model's answer is empty.", "Use another model.")
    remedy = "Use a larger model, or one that follows a JSON schema."
    raise ModelError("The model's answer is not the JSON object that was asked for.", remedy)


def clean(text: Any, longest: int) -> str:
    """A model's text on one line of at most `longest` characters, without control characters; "" if it is no text."""
    if not isinstance(text, str):
        return ""
    shown = "".join(" " if c.isspace() else c for c in text[: 20 * longest])
    shown = "".join(c for c in shown if unicodedata.category(c)[0] != "C")
    return " ".join(shown.split())[:longest].strip()


def scrub(value: Any, secret: str) -> Any:
    """A JSON value with *** for `secret` in its strings and keys, because a hostile server could send the key back.

    A secret of less than 12 characters stays.
    """
    if (
        len(secret) < 12
    ):  # a word, such as the "ollama" that local servers are given; real keys have 20 characters or more
        return value
    if isinstance(value, str):
        return value.replace(secret, "***")
    if isinstance(value, list):
        return [scrub(v, secret) for v in value]
    if isinstance(value, dict):
        return {scrub(k, secret): scrub(v, secret) for k, v in value.items()}
    return value


class ModelError(VibeError):
    """A question that was not answered."""

    def __init__(
        self, message: str, remedy: str, lasting: bool = False, broken: bool = False, complaint: str = ""
    ) -> None:
        super().__init__(message, remedy)
        self.lasting = lasting  # True if asking again in this run would fail too, as with a wrong key
        self.broken = broken  # True if the server itself failed, see `explain_status`
        self.complaint = complaint  # the server's words, which tell what it cannot do; "" for none


LARGEST = 2_000_000  # bytes of an answer; a plan has a few thousand
_RETRIES = 3  # after temporary failures; the openai package waits before each as long as the server says
_OVERFULL = re.compile(r"context[ _](length|size|window)|too many tokens|n_ctx", re.IGNORECASE)


@dataclass(frozen=True)
class Completion:
    """A server's answer."""

    text: str  # the model's words
    cut: bool  # whether it ran out of tokens
    read: int = 0  # tokens of the question; 0 if the server does not say
    written: int = 0  # tokens of the answer
    cost: float | None = None  # US dollars; None if the server does not say


class Transport:
    """A connection to an endpoint; a request ends when `stop` returns True."""

    def __init__(self, endpoint: Endpoint, stop: Callable[[], bool]) -> None:
        self.endpoint, self._stop = endpoint, stop
        self._client: Any = None

    def post(self, body: dict[str, Any], seconds: float) -> Completion:
        """Sends a request and waits at most `seconds` for the answer. Raises ModelError for any failure or a stop.

        The request runs in its own thread: both limits work even if the name look-up hangs, or a server sends a byte
        a minute.
        """
        client = self._connect()
        box: queue.Queue[Completion | ModelError] = queue.Queue()

        def act() -> None:
            try:
                response = client.chat.completions.with_raw_response.create(**body, timeout=seconds)
                box.put(read_completion(response.http_response.content))
            except ModelError as error:
                box.put(error)
            except Exception as error:
                box.put(self._explain(error))

        threading.Thread(target=act, daemon=True).start()
        # Look at the answer, at Stop and at the clock in turn.
        end = time.monotonic() + seconds
        outcome: Completion | ModelError | None = None
        while outcome is None:
            try:
                outcome = box.get(timeout=0.05)
            except queue.Empty:
                if self._stop():
                    outcome = ModelError("You stopped it.", "", lasting=True)
                elif time.monotonic() > end:
                    outcome = self._late(seconds)
        if isinstance(outcome, ModelError):
            raise outcome
        return outcome

    def close(self) -> None:
        """Ends the connection; the next request makes a new one."""
        client, self._client = self._client, None
        if client is not None:
            client.close()

    def _connect(self) -> Any:
        if self._client is None:
            try:
                import openai
            except ImportError as error:
                remedy = "pip install openai"
                raise ModelError("The openai package cannot be imported.", remedy, lasting=True) from error
            point = self.endpoint
            # A redirect could send the image to another server; a model on this computer needs no proxy.
            client = _bounded(openai.DefaultHttpxClient, point.place)
            http = client(follow_redirects=False, trust_env=not point.local)
            self._client = openai.OpenAI(
                base_url=point.url, api_key=point.key or "none", max_retries=_RETRIES, http_client=http
            )
            if point.url != OPENAI:  # only OpenAI gets the account that the environment names
                self._client.organization = self._client.project = None
        return self._client

    def _late(self, seconds: float) -> ModelError:
        remedy = "Use a faster one, or set VIBE_VLM_TIMEOUT to more seconds."
        return ModelError(f"The model {self.endpoint.model} did not answer within {seconds:.0f} s.", remedy)

    def _explain(self, error: Exception) -> ModelError:
        """The error, with its remedy, for an exception of the openai package."""
        import openai

        point = self.endpoint
        if isinstance(error, openai.APITimeoutError):
            return self._late(point.seconds)
        if isinstance(error, openai.APIStatusError):
            # The server's own words, on one line, without the key
            body: Any = error.body if isinstance(error.body, dict) else {}
            inner = body.get("error", body)
            text = inner.get("message") if isinstance(inner, dict) else inner
            complaint = clean(scrub(str(text or error.body or ""), point.key), 200).rstrip(". ")
            return explain_status(error.status_code, complaint, error.response.headers, point)
        if isinstance(error.__cause__, ModelError):  # of `_bounded`
            return error.__cause__
        if isinstance(error, openai.APIConnectionError):
            why = scrub(" ".join(str(error.__cause__ or "").split())[:120], point.key)
            problem = f"{point.place} cannot be reached{f' ({why})' if why else ''}."
            return ModelError(problem, "Start the server, or check VIBE_VLM_URL and the network.")
        problem = f"{point.place} does not speak the OpenAI protocol ({type(error).__name__})."
        return ModelError(problem, "Check the base URL: it usually ends in /v1.")


def read_completion(raw: bytes) -> Completion:
    """The model's answer in the body of a response. Raises ModelError if the body is no chat completion."""
    try:
        body = json.loads(raw)
        choice = body["choices"][0]
        message, usage = choice["message"], body.get("usage") or {}
        text = message.get("content") or ""
        if isinstance(text, list):  # parts
            text = "".join(part.get("text") or "" for part in text)
        if not isinstance(text, str):
            raise TypeError
        counts = (usage.get(name) for name in ("prompt_tokens", "completion_tokens"))
        read, written = (n if isinstance(n, int) and 0 <= n < 10**9 else 0 for n in counts)
        cost = usage.get("cost")
        cost = float(cost) if isinstance(cost, int | float) and 0 <= cost < 1e6 else None
        return Completion(text, choice.get("finish_reason") == "length", read, written, cost)
    except (ValueError, KeyError, IndexError, TypeError, AttributeError, RecursionError) as error:
        remedy = "Check the base URL: it usually ends in /v1."
        raise ModelError("The endpoint's answer is not a chat completion.", remedy) from error


def explain_status(code: int, complaint: str, headers: Any, point: Endpoint) -> ModelError:
    """The error for an HTTP status, with its remedy; `complaint`: the server's own words, "" for none."""
    # Errors that asking again cannot fix come first.
    lasting, broken, more = True, False, f": {complaint}" if complaint else ""
    if code in (401, 403):
        what, remedy = f"refuses the key{more}", "Check the key: `vibe doctor` tries it."
    elif code == 404:
        what = f"does not have the model {point.model}{more}"
        remedy = "Check the model's name and the base URL, which usually ends in /v1."
    elif code == 402 or (code == 429 and "quota" in complaint.lower()):
        what, remedy = f"wants to be paid{more}", "Check the account's balance."
    elif _OVERFULL.search(complaint):
        remedy = "Give the model more context: 16384 tokens are enough (Ollama: OLLAMA_CONTEXT_LENGTH=16384)."
        return ModelError(f"The scene does not fit into the context of {point.model}{more}.", remedy, lasting=True)
    elif 300 <= code < 400:
        what, remedy = f"sends us elsewhere (HTTP {code})", "Name the final base URL."
    elif code == 429:
        lasting, complaint, wait = False, "", headers.get("retry-after", "")
        what = "is asked too often" + (f" and asks to wait {wait} s" if wait.isdigit() else "")
        remedy = "Wait a little, or use another model."
    else:
        lasting, complaint = False, complaint or f"HTTP {code}"
        if code in (408, 409) or code >= 500:
            broken = True
            what, remedy = f"fails (HTTP {code}){more}", "Look at the server's log, or try again."
        else:
            what, remedy = f"refuses the request (HTTP {code}){more}", "Use another model."
    return ModelError(f"{point.place} {what}.", remedy, lasting, broken, complaint)


def _bounded(base: Any, place: str) -> Any:
    """A subclass of the HTTP client `base` that reads at most LARGEST bytes of any answer, errors included."""

    class Bounded(base):
        def send(self, request: Any, **how: Any) -> Any:
            how["stream"] = True
            response = super().send(request, **how)
            body = bytearray()
            try:
                for chunk in response.iter_bytes():
                    body += chunk
                    if len(body) > LARGEST:
                        problem = f"{place} sent more than {LARGEST // 10**6} MB."
                        raise ModelError(problem, "Check that it is the right endpoint.")
            finally:
                response.close()
            dropped = ("content-encoding", "content-length", "transfer-encoding")
            headers = [(k, v) for k, v in response.headers.multi_items() if k.lower() not in dropped]
            return type(response)(response.status_code, headers=headers, content=bytes(body), request=request)

    return Bounded
