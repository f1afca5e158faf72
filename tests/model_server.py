# SPDX-License-Identifier: Apache-2.0
"""An OpenAI-compatible server on a local port: real sockets, the protocol's real shapes, any behavior."""

import contextlib
import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

KEY = "sk-secret-0123456789abcdef"
MODEL = "eyes:7b"


class Model:
    """What the server does with requests.

    Args:
        behave: (body, number of the request from 1) -> (status, JSON value or bytes, headers), or
            a callable that writes to the socket by itself.

    Attributes:
        asked: The bodies of all requests.
        headers: Their headers.
        url: The base URL.
    """

    def __init__(self, behave):
        self.behave, self.asked, self.headers, self.url = behave, [], [], ""


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_POST(self):
        model = self.server.model
        raw = self.rfile.read(int(self.headers["Content-Length"]))
        body = json.loads(raw)
        model.asked.append(body)
        model.headers.append({k.lower(): v for k, v in self.headers.items()})
        answer = model.behave(body, len(model.asked)) if self.path == "/v1/chat/completions" else (404, {}, {})
        with contextlib.suppress(OSError):
            if callable(answer):
                answer(self)
                return
            status, content, headers = answer
            data = content if isinstance(content, bytes) else json.dumps(content).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(data)))
            for name, value in headers.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(data)

    def log_message(self, *arguments):
        pass


@contextlib.contextmanager
def serving(behave):
    """A running server; yields its Model."""
    model = behave if isinstance(behave, Model) else Model(behave)
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Handler)
    server.daemon_threads = True
    server.model = model
    model.url = f"http://127.0.0.1:{server.server_port}/v1"
    threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
    try:
        yield model
    finally:
        server.shutdown()
        server.server_close()


def says(content, finish="stop", read=100, written=20):
    """A chat completion with this content; anything but text becomes JSON."""
    text = content if isinstance(content, str) else json.dumps(content)
    return (
        200,
        {
            "id": "x",
            "object": "chat.completion",
            "created": 0,
            "model": MODEL,
            "choices": [{"index": 0, "finish_reason": finish, "message": {"role": "assistant", "content": text}}],
            "usage": {"prompt_tokens": read, "completion_tokens": written, "total_tokens": read + written},
        },
        {},
    )


def refuses(status, message, headers=None, **more):
    """An error as OpenAI words them."""
    return status, {"error": {"message": message, "type": "error", **more}}, headers or {}


def document(body):
    """The JSON document of a planning request."""
    content = body["messages"][1]["content"]
    return json.loads(content if isinstance(content, str) else content[0]["text"])


def has_picture(body):
    """Whether a request shows a picture."""
    return isinstance(body["messages"][1]["content"], list)


def plan_for(body, **changes):
    """What a sensible model answers to "glossy teal ball, white studio background" on the tiny scene."""
    names = document(body)["parameters"]
    plan = [
        {"parameter": "material1/base_color", "lower": [0, 0.4, 0.4], "upper": [0.1, 0.6, 0.6], "priority": 1},
        {"parameter": "material1/roughness", "lower": [0.02], "upper": [0.15], "priority": 2},
        {"parameter": "world/strength", "lower": [0.8], "upper": [1.5], "priority": 3},
    ]
    answer = {
        "objects": [
            {
                "name": "ball",
                "region": "subject",
                "materials": ["material1"],
                "attributes": {
                    "color": "teal",
                    "material": "glossy",
                    "lighting": "",
                    "style": "",
                    "mood": "",
                    "shape": "round",
                },
            }
        ],
        "prompts": {
            "subject": "a glossy teal ball",
            "surroundings": "a white studio background",
            "whole": "a glossy teal ball on a white studio background",
            "subject_negatives": ["a white ball"],
            "surroundings_negatives": ["a teal background"],
            "whole_negatives": ["a dark picture"],
        },
        "targets": {"color": "teal", "finish": "glossy", "haze": ""},
        "colors": {"subject": "#108080", "surroundings": ""},
        "ignored": [],
        "plan": [{"reason": "asked for", **entry} for entry in plan if entry["parameter"] in names],
        "keep": [],
    }
    return {**answer, **changes}


VERDICT = says("WINNER = AFTER\nREASON = It is teal.")


def sensible(body, number):
    """Plans when asked to plan, judges when asked to judge."""
    return says(plan_for(body)) if "response_format" in body else VERDICT
