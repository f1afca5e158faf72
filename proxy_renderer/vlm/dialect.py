# SPDX-License-Identifier: Apache-2.0
"""What a server understands: strict JSON by a schema, any JSON, or words only; with pictures or without.

OpenAI-compatible servers differ, and say so only by refusing. A dialect starts with everything and
gives up what a server refuses, one thing at a time, for as long as the run lasts.
"""

from __future__ import annotations

import base64
import json
import re
from dataclasses import dataclass
from typing import Any

_FORMATS = ("json_schema", "json_object", "text")
_MOST_TOKENS = 8192  # a plan has one or two thousand; the rest is for models that think first
_TEMPERATURE = re.compile(r"temperature", re.IGNORECASE)
_LIMIT = re.compile(r"max_(completion_)?tokens", re.IGNORECASE)
_FORMAT = re.compile(
    r"response_format|json_schema|json_object|schema|grammar|structured|json mode", re.IGNORECASE
)
_PICTURE = re.compile(
    r"image|vision|multi-?modal|mmproj|content.{0,20}(part|type|array|list|string)", re.IGNORECASE
)


@dataclass(frozen=True)
class Question:
    """What a model is asked.

    Attributes:
        system: Our instructions.
        text: The data, as one JSON document, or a text of ours.
        picture: A JPEG; None for none.
        schema: JSON schema of the answer; None where the answer is plain text.
        must_see: Whether an answer without the picture is of no use.
    """

    system: str
    text: str
    picture: bytes | None = None
    schema: dict[str, Any] | None = None
    must_see: bool = False


class Dialect:
    """The options of a request that the server has not refused so far.

    Attributes:
        format: "json_schema", "json_object" or "text".
        pictures: Whether pictures are sent.
    """

    def __init__(self) -> None:
        self.format = _FORMATS[0]
        self.pictures = True
        self._temperature = True
        self._limit = "max_completion_tokens"

    def body(self, model: str, question: Question, earlier: list[dict[str, Any]]) -> dict[str, Any]:
        """The request.

        Args:
            earlier: Messages after the question: an answer that could not be read, and our complaint.
        """
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
            content = [
                {"type": "text", "text": question.text},
                {"type": "image_url", "image_url": {"url": url}},
            ]
        if self._temperature:
            body["temperature"] = 0
        if self._limit:
            body[self._limit] = _MOST_TOKENS
        messages = [{"role": "system", "content": system}, {"role": "user", "content": content}, *earlier]
        return {**body, "messages": messages}

    def give_up(self, complaint: str, question: Question) -> bool:
        """Leaves out the option that the server refuses; False if there is nothing more to leave out."""
        if _TEMPERATURE.search(complaint) and self._temperature:
            self._temperature = False
            return True
        if _LIMIT.search(complaint) and self._limit:
            self._limit = "max_tokens" if self._limit == "max_completion_tokens" else ""
            return True
        formats = question.schema is not None and self.format != "text"
        pictures = question.picture is not None and self.pictures
        if (
            pictures
            and not question.must_see
            and ((_PICTURE.search(complaint) and not _FORMAT.search(complaint)) or not formats)
        ):
            self.pictures = False
            return True
        if formats:
            self.format = _FORMATS[_FORMATS.index(self.format) + 1]
            return True
        return False

    @staticmethod
    def about(complaint: str) -> bool:
        """Whether a server error's words are really a refusal of something that we sent."""
        return bool(complaint) and any(p.search(complaint) for p in (_TEMPERATURE, _LIMIT, _FORMAT, _PICTURE))
