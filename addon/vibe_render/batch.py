# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs Vibe Render without a window: as a script inside Blender, or as a program for the `vibe` command.

    blender -b shot.blend --python-exit-code 1 --python batch.py -- --prompt "misty, cool" --out DIR
    python batch.py --events run shot.blend --prompt "misty, cool" --out DIR     (with the bpy package)

A mistake of the user prints one line and exits with code 2. An unexpected error prints one line that names a log, and
exits with code 1.
"""

import atexit
import faulthandler
import os
import shutil
import sys
import tempfile
from pathlib import Path

if not __package__:
    # Run as a file: make the package importable, and its modules not importable by their bare names.
    here = Path(__file__).resolve().parent
    sys.path[:] = [p for p in sys.path if not p or Path(p).resolve() != here]
    sys.path[:0] = [str(here.parent)]
    if (here.parents[1] / "proxy_renderer").is_dir():  # a clone
        sys.path.insert(1, str(here.parents[1]))

from vibe_render.core import files
from vibe_render.core.schema_import import atomic, errors
from vibe_render.headless.arguments import Reporter, parse


def main() -> int:
    """Runs the command line; returns the exit code: 0, 2 after a mistake of the user, 1 after an unexpected error."""
    # Blender runs this file with the arguments after "--".
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    reporter = Reporter(events="--events" in arguments)
    try:
        given = parse(arguments)
        from vibe_render.headless import commands  # after parsing: importing bpy takes half a second

        if given.command == "serve":
            commands.serve()
        else:
            commands.COMMANDS[given.command](given, reporter)
        return 0
    except Exception as error:
        if isinstance(error, OSError) and atomic.is_full(error):
            error = files.unwritable(Path(tempfile.gettempdir(), "vibe"), error, "")
        shown = errors.to_show(error, reporter.doing)
        reporter.error(shown)
        return 1 if isinstance(shown, errors.UnexpectedError) else 2


def _end(status: list[int]) -> None:
    """Where Blender is a Python module, ends the process with code `status[0]`, without Blender's exit handlers.

    The handlers of Blender 4.5 may wait forever for one of their own threads (seen with bpy 4.5.15 on Linux).
    """
    bpy = sys.modules.get("bpy")
    if bpy and not bpy.app.binary_path:
        shutil.rmtree(bpy.app.tempdir, ignore_errors=True)  # which Blender's exit handlers would do
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status[0])


if __name__ == "__main__":
    faulthandler.enable()  # if Blender crashes, print the line of Python that ran
    outcome = [1]
    atexit.register(_end, outcome)  # registered first, so it runs last, after engines are stopped
    outcome[0] = main()
    sys.exit(outcome[0])
