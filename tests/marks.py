# SPDX-License-Identifier: Apache-2.0
"""Which cases of a test run by default, and which only where there is time for everything (the mark `slow`)."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def few_of(cases: Iterable[Any], quick: Collection[Any]) -> list[Any]:
    """Cases for `pytest.mark.parametrize`, all slow but a few.

    Args:
        cases: Single values, or tuples of one value for each argument.
        quick: Those that run by default.
    """
    cases = list(cases)
    assert all(case in cases for case in quick), quick
    return [case if case in quick else _slow(case) for case in cases]


def _slow(case: Any) -> Any:
    return pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.slow)
