# SPDX-License-Identifier: Apache-2.0
"""Stands for `batch.py serve` where many quick jobs are needed: what the prompt says, happens.

As there, files appear whole, and the end of the input ends everything: if a worker dies, its job may be under way in the
same folder again before anybody has ended this process.
"""

import json
import os
import queue
import sys
import threading
import time
from pathlib import Path

from PIL import Image

REPORT = {
    "verdicts": [
        {"word": "misty", "state": "visible"},
        {"word": "noir", "state": "missed"},
        {"word": "", "state": "missed"},
    ],
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


def write(path, save):
    """Saves a file beside its place, then moves it there."""
    part = path.with_name(f"part-{os.getpid()}-{path.name}")
    save(part)
    part.replace(path)


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
            write(out / numbered(name, number), Image.new("RGB", (24, 16), (level, level, 120)).save)
    preset = json.dumps({"prompt": prompt, "seed": options["seed"]})
    write(out / "preset.json", lambda path: path.write_text(preset))
    write(out / "vibed.blend", lambda path: path.write_bytes(b"BLENDER"))
    shots = [
        {"name": c, "scene": "shot", "blend": "vibed.blend", "camera": c, "frame": None}
        | {kind: numbered(kind, i) for kind in ("before", "after")}
        for i, c in enumerate(cameras)
    ]
    report = json.dumps(REPORT | ({"shots": shots} if len(shots) > 1 else {}))
    write(out / "report.json", lambda path: path.write_text(report))
    say(type="result", lines=[])


def render_frames(blend, options, out):
    """Frames that tell through which camera they are seen."""
    assert blend.read_bytes() == b"BLENDER"
    out.mkdir(parents=True, exist_ok=True)
    for number in options["frames"].split("-"):
        (out / f"000{number}.png").write_text(options.get("cameras", "the scene's own"))
    say(type="result", lines=[])


def listen(lines):
    """Reads while a job is under way."""
    for line in sys.stdin:
        lines.put(line)
    os._exit(1)


if __name__ == "__main__":
    orders = queue.SimpleQueue()
    threading.Thread(target=listen, args=(orders,), daemon=True).start()
    while True:
        carry_out(json.loads(orders.get()))
