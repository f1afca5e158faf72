# SPDX-License-Identifier: Apache-2.0
"""One cheap question, for `vibe doctor`: is the endpoint there, does the key fit, does the model see?"""

from __future__ import annotations

from PIL import Image

from .client import Client, Question, jpeg_of
from .endpoint import Endpoint
from .transport import clean

_SCHEMA = {
    "type": "object",
    "properties": {"color": {"type": "string"}},
    "required": ["color"],
    "additionalProperties": False,
}
_FORMATS = {"json_schema": "strict JSON", "json_object": "plain JSON", "text": "JSON in plain text"}


def try_model(endpoint: Endpoint) -> str:
    """Shows the model a red square and returns what it says, what its server understands, and the time.

    Raises:
        ModelError: It does not answer.
    """
    client = Client(endpoint)
    square = jpeg_of(Image.new("RGB", (64, 64), (220, 20, 20)))
    system = (
        'Name the color of the square in one word, as {"color": "..."}. Say "unseen" if there is no picture.'
    )
    answer = client.ask(Question(system, "What color is it?", square, _SCHEMA), fresh=True)
    color = clean(answer.get("color"), 40)
    sees = "red" in color.lower() and client.dialect.pictures
    eyesight = "sees pictures" if sees else "does NOT see pictures: it plans from numbers, and cannot judge"
    return (
        f"{endpoint.model} at {endpoint.place} answers {color!r} to a red square in {client.usage.seconds:.1f} s: "
        f"{eyesight}; {_FORMATS[client.dialect.format]}"
    )
