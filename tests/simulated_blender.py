# SPDX-License-Identifier: Apache-2.0
"""Stands for `batch.py serve` where many quick jobs are needed: what the prompt says, happens."""

import json
import os
import sys
import time
from pathlib import Path

from PIL import Image

REPORT = {
    "similarity": {"before": 0.1, "after": 0.25},
    "delta_e": 0.5,
    "parameters": {
        "world/strength": {"before": 0.3, "after": 0.1, "reason": "noir: a dark world"},
        "film/gamma": {"before": 1.0, "after": 1.0, "reason": ""},
    },
    "timings": {"render before": 0.1, "render after": 0.2, "engine: loop": 0.3},
}


def say(**event):
    print(f"VIBE {json.dumps(event)}", flush=True)


def numbered(name, number):
    return f"{name}-{number + 1}.png" if number else f"{name}.png"


def carry_out(arguments):
    options = dict(a[2:].split("=", 1) for a in arguments if a.startswith("--") and "=" in a)
    out = Path(options["out"])
    if arguments[0] == "frames":
        return render_frames(Path(arguments[1]), options, out)
    prompt = options["prompt"]
    say(type="stage", name=f"working as process {os.getpid()}")
    if "slow" in prompt:
        time.sleep(0.3)
    if "fails" in prompt:
        return say(type="error", message="The camera is panoramic.", remedy="Use another.")
    if "once" in prompt and not (out / "tried").exists():
        (out / "tried").touch()
        return say(type="error", message="Bad luck.", remedy="")
    if "crash" in prompt:
        print("Segmentation fault", flush=True)
        os.kill(os.getpid(), 9)
    if "sleeps" in prompt:
        time.sleep(600)
    if "eats" in prompt:
        eaten = b"x" * 400_000_000
        time.sleep(600)
        return eaten
    cameras = options.get("cameras", "").split(",")
    for number, _ in enumerate(cameras):
        for name, level in (("before", 90), ("after", 30 + int(options["seed"]) % 200), ("compare", 60)):
            Image.new("RGB", (24, 16), (level, level, 120)).save(out / numbered(name, number))
    (out / "preset.json").write_text(json.dumps({"prompt": prompt, "seed": options["seed"]}))
    (out / "vibed.blend").write_bytes(b"BLENDER")
    shots = [
        {"name": c, "scene": "shot", "blend": "vibed.blend", "camera": c, "frame": None}
        | {kind: numbered(kind, i) for kind in ("before", "after")}
        for i, c in enumerate(cameras)
    ]
    (out / "report.json").write_text(json.dumps(REPORT | ({"shots": shots} if len(shots) > 1 else {})))
    say(type="result", lines=[])


def render_frames(blend, options, out):
    """Frames that tell through which camera they are seen."""
    assert blend.read_bytes() == b"BLENDER"
    out.mkdir(parents=True, exist_ok=True)
    for number in options["frames"].split("-"):
        (out / f"000{number}.png").write_text(options.get("cameras", "the scene's own"))
    say(type="result", lines=[])


if __name__ == "__main__":
    while line := sys.stdin.readline():
        carry_out(json.loads(line))
