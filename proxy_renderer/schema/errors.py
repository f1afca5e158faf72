# SPDX-License-Identifier: Apache-2.0
"""The one error that a user is shown: what went wrong, and what to do about it."""


class VibeError(Exception):
    """A mistake that its reader can mend.

    Attributes:
        message: What went wrong, in one sentence.
        remedy: What to do about it, in one sentence.
    """

    def __init__(self, message: str, remedy: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.message} {self.remedy}".strip()


def quoted(text: str, most: int = 40) -> str:
    """A text of a file, on one line and short enough for a message."""
    return repr(text if len(text) <= most else text[:most] + "…")
