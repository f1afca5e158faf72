# SPDX-License-Identifier: Apache-2.0
"""Finds the model to ask: its name, the URL of its endpoint, and its key."""

import ipaddress
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from ..schema import VibeError
from ..schema.messages import Options

OPENAI = "https://api.openai.com/v1"
OFF = "off"
_SECONDS = 120.0
_HOW = "Ollama's is http://localhost:11434/v1, OpenAI's is " + OPENAI + "."


@dataclass(frozen=True)
class Endpoint:
    """A model behind an OpenAI-compatible endpoint."""

    model: str  # the model's name at the endpoint
    url: str  # the base URL, without a slash at its end
    key: str = field(default="", repr=False)  # never written anywhere, not even by `repr`
    seconds: float = _SECONDS  # time limit of a question, repetitions included
    prices: tuple[float, float] | None = None  # US dollars per million tokens, (read, written); None: unknown

    @property
    def local(self) -> bool:
        """True if the URL is on this computer (a loopback address)."""
        host = urlsplit(self.url).hostname or ""
        with suppress(ValueError):
            return ipaddress.ip_address(host).is_loopback
        return host == "localhost" or host.endswith(".localhost")

    @property
    def place(self) -> str:
        """Host and port, for messages; the rest of the URL may hold secrets."""
        return urlsplit(self.url).netloc.rpartition("@")[2]


def find_endpoint(options: Options, key: str = "", environment: Mapping[str, str] | None = None) -> Endpoint | None:
    """The model to ask; None if neither the options nor the environment name one.

    Options override the environment: VIBE_VLM_MODEL, VIBE_VLM_URL (else OPENAI_BASE_URL, else OpenAI's), VIBE_VLM_KEY,
    VIBE_VLM_TIMEOUT (seconds) and VIBE_VLM_PRICE ("2.5/10", US dollars per million tokens read/written).
    OPENAI_API_KEY is sent only to OPENAI_BASE_URL, or to OpenAI if that is not set. A `vlm_model` of "off" means none,
    whatever the environment says. `key` is the key in the add-on's preferences; "" for the environment's.

    Raises VibeError for an invalid URL, key, time limit or price, for a missing key, or for another computer's endpoint
    while Blender is offline.
    """
    env = os.environ if environment is None else environment
    model = (options.vlm_model or env.get("VIBE_VLM_MODEL", "")).strip()
    if not model or model == OFF:
        return None
    # Where, and with whose key: OpenAI's own key goes to OPENAI_BASE_URL alone.
    theirs = (env.get("OPENAI_BASE_URL", "").strip() or OPENAI).rstrip("/")
    url = (options.vlm_url or env.get("VIBE_VLM_URL", "")).strip().rstrip("/") or theirs
    _check(url)
    shared = env.get("OPENAI_API_KEY", "").strip() if url == theirs else ""
    key = (key or env.get("VIBE_VLM_KEY", "")).strip() or shared
    if url == OPENAI and not key:
        remedy = "Set OPENAI_API_KEY, or name another place by VIBE_VLM_URL. " + _HOW
        raise VibeError(f"The model {model} at OpenAI needs a key.", remedy)
    if not key.isascii() or not key.isprintable():
        remedy = "Copy it again, without quotes or line ends."
        raise VibeError("The model's key holds characters that no key has.", remedy)
    endpoint = Endpoint(model, url, key, _seconds(env.get("VIBE_VLM_TIMEOUT", "")), _prices(env))
    if not options.online and not endpoint.local:
        remedy = "Allow it in Preferences > System > Network, or use a model on this computer."
        raise VibeError(f"Blender's online access is off, and the model {model} is at {endpoint.place}.", remedy)
    return endpoint


def _check(url: str) -> None:
    try:
        parts = urlsplit(url)
        fine = parts.scheme in ("http", "https") and bool(parts.hostname) and (parts.port or 1) > 0
    except ValueError:
        fine = False
    if not fine:
        shown = url.rpartition("@")[2][:60]
        raise VibeError(f"{shown!r} is not an endpoint's URL.", "It starts with http:// or https://. " + _HOW)
    if parts.username or parts.password or parts.query:
        remedy = "Put the key into VIBE_VLM_KEY instead: URLs end up in reports."
        raise VibeError(f"The URL of the endpoint at {parts.hostname} holds more than an address.", remedy)


def _seconds(text: str) -> float:
    seconds = 0.0
    with suppress(ValueError):
        seconds = float(text or _SECONDS)
    if not 1.0 <= seconds <= 3600.0:
        raise VibeError(f"VIBE_VLM_TIMEOUT {text[:20]!r} is no time limit.", "Use 1 to 3600 seconds.")
    return seconds


def _prices(env: Mapping[str, str]) -> tuple[float, float] | None:
    text = env.get("VIBE_VLM_PRICE", "")
    if not text:
        return None
    try:
        read, written = (float(part) for part in text.split("/"))
    except ValueError as error:
        remedy = 'Use "2.5/10": US dollars per million tokens read and written.'
        raise VibeError(f"VIBE_VLM_PRICE {text[:20]!r} is no price.", remedy) from error
    return read, written
