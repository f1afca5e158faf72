# SPDX-License-Identifier: Apache-2.0
"""The results folder: a folder for each job, a contact sheet for people and tables for programs, all rewritten as jobs end.

All paths in it are relative, so that it may be moved.

DIR/jobs/NAME/done.json       the job is done: written last, atomically, by whoever has done it
DIR/jobs/NAME/failed.json     its last attempt has failed; the next run of the batch tries it again
DIR/jobs/NAME/final.json      how the rendering of its final frames went; they are in frames/
DIR/index.html, results.csv, results.jsonl
"""

import csv
import html
import json
import os
import platform
import re
import shutil
import time
import uuid
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Self

from filelock import FileLock, Timeout

from ..schema import VibeError, atomic
from ..schema.options import checks
from .manifest import BatchPlan, Job, Take

JobRow = dict[str, Any]  # a job in the tables of results, see `FIELDS`
DONE, FAILED, LOG = "done.json", "failed.json", "log.txt"
FINAL, FRAMES = "final.json", "frames"
WORDS = ("visible", "already", "unmeasured", "missed")  # a row's lists of words by state, as in `verdicts`
TOKEN = "batch.json"  # its token identifies the results folder, so that a machine can check that it sees the same one
FIELDS = (
    "name", "scene", "prompt", "seed", "status", *WORDS, "delta_e",
    "seconds", "seconds_loop", "seconds_cycles", "memory_gb", "attempts", "frames", "shots", "variants", "final_error", "error", "remedy", "folder",
)  # fmt: skip
FILES = {
    "before": "before.png", "after": "after.png", "compare": "compare.png",
    "blend": "vibed.blend", "preset": "preset.json", "report": "report.json",
}  # fmt: skip
_PAGE = Path(__file__).with_name("page")
_SCRIPTS = ("rows.js", "card.js", "large.js", "keys.js")
_SHARE = 0.05  # greatest share of the time that is spent on rewriting the sheet while jobs run
_SOONEST = 5.0  # seconds


class Store:
    """A results folder, locked so that only one batch uses it at a time. Use it as a context manager."""

    def __init__(self, folder: Path) -> None:
        self.folder = checks.folder(folder)
        self.jobs = self.folder / "jobs"
        self._lock = FileLock(self.folder / ".lock", timeout=0)
        self.token = ""

    def __enter__(self) -> Self:
        try:
            self._lock.acquire()
        except Timeout as error:
            owner = read_json(self.folder / TOKEN) or {}
            problem = f"Another batch works in {self.folder} ({owner.get('holder', 'unknown')})."
            raise VibeError(problem, "Wait for it, end it, or choose another --out.") from error
        self.jobs.mkdir(exist_ok=True)
        self.token = (read_json(self.folder / TOKEN) or {}).get("token") or uuid.uuid4().hex
        write_json(self.folder / TOKEN, {"token": self.token, "holder": f"process {os.getpid()} on {platform.node()}"})
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def done(self, job: Job) -> bool:
        """True if a vibe has its result, or if a job of final frames has rendered them."""
        if job.frames is not None:
            final = read_json(self.jobs / job.name / FINAL) or {}
            return final.get("status") == "done" and final.get("wanted") == job.frames
        # a string: a hundred thousand `Path`s take seconds. A power failure leaves an empty file: not done.
        try:
            return os.stat(f"{self.jobs}/{job.name}/{DONE}").st_size > 0
        except OSError:
            return False

    def finished(self, plan: Iterable[Job]) -> bytearray:
        """For each job 1 if it is done, else 0."""
        return bytearray(self.done(job) for job in plan)

    def row(self, job: Job) -> JobRow:
        """A job's row: its result, its last failure, or one with the status "waiting"."""
        for name in (DONE, FAILED):
            if row := read_json(self.jobs / job.name / name):
                final = read_json(self.jobs / job.name / FINAL) or {}
                return row | {key: final[key] for key in ("frames", "final_error") if key in final}
        return head(job) | {"status": "waiting"}

    def fail(self, job: Job, row: JobRow) -> None:
        """Records a failed attempt in the job's folder."""
        folder = self.jobs / job.name
        folder.mkdir(exist_ok=True)
        if job.frames is not None:
            write_json(folder / FINAL, row | {"final_error": row["error"]})
        else:
            write_json(folder / FAILED, row)

    def receive(self, job: Job, files: dict[str, bytes]) -> None:
        """Writes the files, by path, of a job that another machine has carried out; `done.json` is written last."""
        folder = self.jobs / job.name
        folder.mkdir(exist_ok=True)
        for name in sorted(files, key=lambda name: name in (DONE, FINAL)):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            write_bytes(folder / name, files[name])

    def check_space(self, free_gb: float) -> None:
        """Raises VibeError if less than `free_gb` gigabytes of disk space are free."""
        free = shutil.disk_usage(self.folder).free / 1e9
        if free < free_gb:
            remedy = "Make room, or lower [limits] free_gb; then run the same command again: it continues."
            raise VibeError(f"Only {free:.1f} GB are free in {self.folder}, less than {free_gb:g}.", remedy)


def head(job: Job) -> JobRow:
    """The fields of a row that identify its job."""
    folder = f"jobs/{job.name}"
    return {"name": job.name, "scene": job.scene, "prompt": job.prompt, "seed": job.seed, "folder": folder}


def read_json(path: Path) -> JobRow | None:
    """The content of a JSON file; None if there is no such file, or if it was cut off."""
    try:
        return json.loads(path.read_bytes())
    except (OSError, ValueError):
        return None


def write_json(path: Path, content: Any) -> None:
    """Writes a JSON file, all at once or not at all. Raises VibeError if it cannot be written."""
    write_bytes(path, json.dumps(content, ensure_ascii=False).encode())


def write_bytes(path: Path, content: bytes) -> None:
    """Writes a file, all at once or not at all. Raises VibeError if it cannot be written."""
    with _replacing(path) as part:
        part.write_bytes(content)


@contextmanager
def _replacing(path: Path) -> Iterator[Path]:
    """As `atomic.replacing`, but raises VibeError if the file cannot be written."""
    try:
        with atomic.replacing(path) as part:
            yield part
    except OSError as error:
        reason = "no space is left" if atomic.is_full(error) else error.strerror or type(error).__name__
        remedy = "Make room there; then run the same command again: it continues."
        raise VibeError(f"{path} cannot be written: {reason}.", remedy) from error


def tidy(folder: Path) -> None:
    """Prepares a job's folder for another attempt: removes unfinished files and the failure of the last one."""
    folder.mkdir(parents=True, exist_ok=True)
    for left in (*folder.glob(".*part-*"), *folder.glob(f"{FRAMES}/**/.*")):
        left.unlink(missing_ok=True)
    (folder / FAILED).unlink(missing_ok=True)


class Finals:
    """An iterable of jobs, one for the final frames of each finished result; a repeated job keeps rendered frames."""

    def __init__(self, plan: Iterable[Job], store: Store, frames: str) -> None:
        # frames: "1-24"; or "" for those that the look was made for, else the scene's own
        self._plan, self._store, self._frames = plan, store, frames

    def __iter__(self) -> Iterator[Job]:
        for job in filter(self._store.done, self._plan):
            folder = self._store.jobs / job.name
            shots = (read_json(folder / "report.json") or {}).get("shots", [])
            blends = list(dict.fromkeys(shot["blend"] for shot in shots)) or ["vibed.blend"]
            first, *more = (folder / name for name in blends)
            takes_of_job = takes(shots, blends, self._frames)
            yield replace(job, source=first, more=tuple(more), frames=self._frames, takes=takes_of_job)


def takes(shots: list[dict[str, Any]], blends: list[str], frames: str) -> tuple[Take, ...]:
    """The renders of final frames for a vibe's shots: each .blend through each of its cameras, once.

    `shots` are those of report.json, `blends` the names of their .blends, `frames` as in `Take`; "" for the shots' own.
    """
    if not shots:
        return (Take(0, frames=frames),)
    grouped: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for shot in shots:
        grouped.setdefault((shot["blend"], shot["camera"]), []).append(shot)
    keys = ("scene", "camera") if len({shot["scene"] for shot in shots}) > 1 else ("camera",)
    labels = [_label(*(some[0][key] for key in keys)) for some in grouped.values()]
    grouped_takes = []
    for ((blend, camera), some), label in zip(grouped.items(), labels, strict=True):
        own = [str(shot["frame"]) for shot in some if shot["frame"] is not None]
        if labels.count(label) > 1:  # each frame has a grade, and so a .blend, of its own
            label = _label(label, *own[:1])
        folder = label if len(grouped) > 1 else ""
        grouped_takes.append(Take(blends.index(blend), camera, frames or ",".join(own), folder))
    return tuple(grouped_takes)


def _label(*parts: str) -> str:
    return "-".join(re.sub(r"[^\w.-]+", "_", part) for part in parts if part)


class Sheet:
    """Keeps the contact sheet and the tables of results up to date."""

    def __init__(self, title: str, plan: BatchPlan, store: Store) -> None:
        self._title, self._plan, self._store = title, plan, store
        self._next = 0.0

    def update(self) -> None:
        """Rewrites the sheet and the tables, at most every 5 seconds and for at most 5 % of the time."""
        if time.monotonic() >= self._next:
            self.write()

    def write(self) -> None:
        """Rewrites the sheet and the tables, a row at a time. Raises VibeError if they cannot be written."""
        start = time.monotonic()
        # Style and scripts are inside the page: browsers load hardly any other file for one that is opened from disk.
        texts = {part.name: part.read_text("utf-8") for part in _PAGE.iterdir() if part.is_file()}
        script = "\n".join(texts[name] for name in _SCRIPTS)
        text = texts["sheet.html"].replace("{{style}}", texts["sheet.css"]).replace("{{script}}", script)
        before, after = text.replace("{{title}}", html.escape(self._title)).split("{{rows}}")
        with ExitStack() as stack:
            paths = [self._store.folder / name for name in ("index.html", "results.jsonl", "results.csv")]
            parts = [stack.enter_context(_replacing(path)) for path in paths]
            page, lines, cells = (stack.enter_context(p.open("w", encoding="utf-8", newline="")) for p in parts)
            table = csv.DictWriter(cells, [*FIELDS, *FILES], restval="", extrasaction="ignore")
            table.writeheader()
            page.write(before)
            for row in map(self._store.row, self._plan):
                full = complete(row)
                table.writerow(full | {key: " | ".join(full[key] or []) for key in (*WORDS, "shots")})
                lines.write(json.dumps(full, ensure_ascii=False) + "\n")
                short = {k: row[k] for k in FIELDS if row.get(k) not in (None, "")}
                text = json.dumps(short, ensure_ascii=False)
                # escaped, so that no text in a row ends the page's script element
                page.write(text.replace("<", "\\u003c").replace("\u2028", "\\u2028") + ",\n")
            page.write(after)
        now = time.monotonic()
        self._next = now + max(_SOONEST, (now - start) / _SHARE)


def complete(row: JobRow) -> JobRow:
    """A row with all fields, in their order, and with the paths of its files relative to the results folder."""
    done = row["status"] == "done"
    files = {kind: f"{row['folder']}/{name}" if done else None for kind, name in FILES.items()}
    return {key: row.get(key) for key in FIELDS} | files
