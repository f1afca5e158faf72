# SPDX-License-Identifier: Apache-2.0
"""`vibe doctor`: what is installed."""

from __future__ import annotations

import argparse

SUMMARY = "Check what is installed, and say what to fix."


def add_options(parser: argparse.ArgumentParser) -> None:
    """None."""


def act(a: argparse.Namespace) -> int:
    """Carries out the command."""
    from ..doctor import examine

    return examine()
