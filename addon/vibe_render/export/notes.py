# SPDX-License-Identifier: GPL-3.0-or-later
"""What a prediction leaves out or approximates, in few lines for the artist."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

_NAMED = 3
_MOST = 5


def notes_by_reason(notes: Mapping[str, Sequence[str]]) -> list[str]:
    """One line for each reason, with the things that it is true of.

    As in "Glossy BSDF is approximated in A, B and 7 more."

    Args:
        notes: Reasons, sentences without their full stops, by the name of a thing; what matters most comes first.
    """
    things: dict[str, list[str]] = {}
    for name, reasons in notes.items():
        for reason in dict.fromkeys(reasons):
            things.setdefault(reason, []).append(name)
    return [f"{reason} in {_listed(names)}." for reason, names in things.items()]


def _listed(names: Sequence[str]) -> str:
    """ "A", "A and B", "A, B and C", "A, B, C and 4 more"."""
    if len(names) > _NAMED:
        return f"{', '.join(names[:_NAMED])} and {len(names) - _NAMED} more"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def shortened_notes(lines: Sequence[str]) -> list[str]:
    """At most five lines, each once, and how many more there are."""
    lines = list(dict.fromkeys(lines))
    rest = len(lines) - _MOST
    return lines if rest <= 0 else [*lines[:_MOST], f"And {rest} more."]
