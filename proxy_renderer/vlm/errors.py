# SPDX-License-Identifier: Apache-2.0
"""Why a model did not help."""

from __future__ import annotations

from ..schema import VibeError


class ModelError(VibeError):
    """A question that was not answered.

    Attributes:
        lasting: Whether asking again in this run would fail in the same way (a wrong key, say).
        wait: Seconds after which asking again may help; None if it would not.
        complaint: What the server said, for finding out what it cannot do; "" if it said nothing.
    """

    def __init__(
        self, message: str, remedy: str, lasting: bool = False, wait: float | None = None, complaint: str = ""
    ) -> None:
        super().__init__(message, remedy)
        self.lasting, self.wait, self.complaint = lasting, wait, complaint
