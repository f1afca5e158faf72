# SPDX-License-Identifier: Apache-2.0
"""Statements about a picture, bound to it."""

from proxy_renderer.claims.claim import Claim
from proxy_renderer.reference.statements import Statement


def bound(said: Statement) -> Claim:
    """The claim of a statement, as goals make one of it."""
    text = said.claim
    return Claim(
        said.word,
        said.material or text.part,
        text.measure,
        "picture" if said.material else text.part,
        text.lower,
        text.upper,
        (said.material,) if said.material else (),
        text.change,
        box=text.box,
    )
