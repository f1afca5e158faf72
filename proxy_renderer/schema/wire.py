# SPDX-License-Identifier: Apache-2.0
"""Messages on a pipe: JSON objects, each ended by a NUL byte, and the same parameter table at both ends."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from typing import BinaryIO, get_args

from .errors import VibeError
from .messages import Message
from .parameters import schema_hash

_TYPES: dict[str, type] = {message.type: message for message in get_args(Message)}


def encode(message: Message) -> bytes:
    """The wire form: UTF-8 JSON and a NUL byte.

    Raises:
        ValueError: A number in the message is NaN or infinite.
    """
    body = {"type": message.type, **asdict(message)}
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode() + b"\0"


def decode(raw: bytes | str) -> Message:
    """Inverse of `encode`, with or without the NUL byte.

    Raises:
        VibeError: It is anything else than a message of this version.
    """
    text = raw.decode(errors="replace") if isinstance(raw, bytes) else raw
    try:
        body = json.loads(text.rstrip("\0"))
        return _TYPES[body.pop("type")](**body)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise VibeError(
            f"The engine and Blender do not understand each other: {text[:80]!r}.",
            "Install the same version of vibe-render for both.",
        ) from error


def read(stream: BinaryIO) -> Iterator[Message]:
    """Messages of a stream as they arrive, until it ends. A message that was cut off is dropped.

    Raises:
        VibeError: As `decode` does.
    """
    pending = b""
    while chunk := stream.read1(65536):  # type: ignore[attr-defined]
        *whole, pending = (pending + chunk).split(b"\0")
        yield from map(decode, whole)


def check_schema(theirs: str, who: str) -> None:
    """Makes sure that the other process has this process's parameter table.

    Args:
        who: "engine" or "add-on", the one that sent it.

    Raises:
        VibeError: It has another one.
    """
    if theirs != schema_hash():
        raise VibeError(
            f"The {who} has another parameter table ({theirs or 'none'} instead of {schema_hash()}).",
            "Install the same version of vibe-render for Blender and for the engine.",
        )
