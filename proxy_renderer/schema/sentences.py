# SPDX-License-Identifier: Apache-2.0
"""The form of further sentences: those that speak of earlier steps, and what is left of others for a reader of prompts."""

import re
from typing import Literal, NamedTuple

_NUMBERS = {name: n for n, name in enumerate(("original", "first", "second", "third", "fourth", "fifth"))}
_NUMBERS |= {"start": 0, "beginning": 0, "scene": 0}
_STEP = r"(?:the )?(?:step )?(?P<step>\w+)(?: (?:one|look|step|version|result))?"
_FORMS = {
    "show": rf"(?:go )?back to {_STEP}|(?P<last>undo(?: that| it| the last(?: step)?)?|go back)",
    "between": rf"(?:something |half ?way )?between (?:this|it|now) and {_STEP}|half ?way back to {_STEP.replace('step>', 'other>')}",
    "strength": r"(?P<factor>half|twice|double)(?: as| the)? (?:strong|much|strength|that|of that)",
    "without": r"(?:without|remove|lose|drop|no more|take away) (?:the |any )?(?P<what>.+)",
    "instead": r"no,? (?:i meant? )?(?:the )?(?P<new>.+?),? (?:and )?not (?:the )?(?P<old>.+)",
    "except": r"(?:(?:but )?(?:leave|keep)|but not|except(?: for)?) (?:the )?(?P<stays>.+?)(?: alone| out| as it (?:is|was))?",
}
_MATCHES = {kind: re.compile(rf"(?:{form})[.!]*", re.I) for kind, form in _FORMS.items()}
_FACTOR = {"half": 0.5, "halve": 0.5, "twice": 2.0, "double": 2.0, "two times": 2.0, "three times": 3.0}

_LEAD = re.compile(r"^(?:(?:no|and|now|then|ok|okay|please)\b[ ,]*)+", re.I)
_START = re.compile(r"^(?:(?:and|but|now|then|also|please|make (?:it|that|this))\b[ ,]*)+", re.I)
_COMPARED = rf"\b(?P<factor>{'|'.join(_FACTOR)})(?: as much)?(?: of)?(?: the)? (?=\w)"
_PLAINER = (
    (r"\ba (?:touch|tad|little bit|hint|shade|trifle)\b(?! of)|\bsomewhat\b|\bslightly\b", "a bit"),
    (r"\ba lot\b|\b(?:way|far)(?= (?:\w+er|more|less)\b)", "much"),
    (r"\b(?:even|still|yet) (?=(?:a bit |much )?(?:\w+er|more|less)\b)", ""),
    (r"(?<=\bmore )glow\b|(?<=\bless )glow\b", "bloom"),
)


class AboutSteps(NamedTuple):
    """A sentence that speaks of earlier steps."""

    kind: Literal["show", "between", "strength", "without", "instead", "except"]
    number: int = -1  # of the step: 0 is the scene before the first one; -1 the one before the last
    factor: float = 1.0
    what: str = ""  # what is taken back, or what stays
    new: str = ""  # what gets it instead


def about_steps(sentence: str) -> AboutSteps | None:
    """What a sentence says of earlier steps; None for one that only names looks.

    >>> about_steps("No, the wall, not the table")
    AboutSteps(kind='instead', number=-1, factor=1.0, what='table', new='wall')
    """
    text = " ".join(sentence.split())
    for kind, form in _MATCHES.items():
        if found := form.fullmatch(text) or form.fullmatch(_LEAD.sub("", text)):
            named = {name: value.strip(" .!") for name, value in found.groupdict().items() if value}
            step = (named.get("step") or named.get("other", "")).lower()
            number = int(step) if step.isdigit() else _NUMBERS.get(step, -1)
            if step and number < 0 and step not in ("last", "previous"):
                continue
            factor = _FACTOR.get(named.get("factor", "").lower(), 1.0)
            what = named.get("what") or named.get("old") or named.get("stays", "")
            return AboutSteps(kind, number, factor, what, named.get("new", ""))  # type: ignore[arg-type]
    return None


def plain(sentence: str) -> tuple[str, float]:
    """A sentence as prompts say it, and the factor of what it compares; 0 if it has none.

    >>> plain("And now twice as much fog")
    ('more fog', 2.0)
    """
    text = _START.sub("", " ".join(sentence.split()))
    factor = 0.0
    if found := re.search(_COMPARED, text, re.I):
        factor = _FACTOR[found["factor"].lower()]
        text = text.replace(found[0], "more " if factor > 1.0 else "less ")
    for pattern, word in _PLAINER:
        text = re.sub(pattern, word, text, flags=re.I)
    return text.strip(), factor
