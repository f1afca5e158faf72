# SPDX-License-Identifier: Apache-2.0
"""Parses further sentences, which go on from a result: requests about earlier steps; others become prompts."""

import re
import tomllib
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple

from .errors import VibeError

SAY_WHAT = 'Say what is to change, and how: "less fog", "the lamp dimmer".'
"""The remedy for a further sentence that changes nothing."""
_TABLES = tomllib.loads(Path(__file__).with_name("sentences.toml").read_text(encoding="utf-8"))


def _pattern(text: str) -> re.Pattern[str]:
    for name, part in reversed(_TABLES["parts"].items()):  # a part may contain parts from above it
        text = text.replace(f"{{{name}}}", part)
    return re.compile(text, re.I)


_NUMBERS = {name: n for n, name in enumerate(("original", "first", "second", "third", "fourth", "fifth"))}
_NUMBERS |= {"start": 0, "beginning": 0, "scene": 0}
_LAST = ("last", "previous", "before", "earlier")  # names of the step before the one that is shown
_FACTORS = {
    "half": 0.5, "halve": 0.5, "a half": 0.5, "a third": 1 / 3, "a quarter": 0.25, "twice": 2.0, "double": 2.0,
    "two times": 2.0, "three times": 3.0, "triple": 3.0,
}  # fmt: skip
_PATTERNS = {name: _pattern(text) for name, text in _TABLES["patterns"].items()}
_FORMS = [(kind, _pattern(f"(?:{form})[.!]*")) for kind, form in _TABLES["forms"]]
_COMPARING = [(_pattern(text), word) for text, word in _TABLES["comparing"]]
_OBJECT = (
    r"(?P<thing>(?:the|that|this|her|his|its|my|those|these) [\w -]+?|it|them|everything)(?: up| down| off)?"
    r"(?P<after> a bit| much)?"
)
_VERBS = [
    (re.compile(rf"\b(?P<before>a bit |much )?(?:{verb})(?: up| down| off)? {_OBJECT}(?=$|[,;.]| by )", re.I), word)
    for verb, word in _TABLES["verbs"]
]
_PLAINER = [(_pattern(text), word) for text, word in _TABLES["plainer"]]
_PRONOUNS = ("it", "this", "that", "i", "we", "they", "these", "those", "there", "still")
_WORDS = "|".join(sorted(_FACTORS, key=len, reverse=True))
_POWERFUL = rf"\b(?P<factor>{_WORDS}) as (?:strong|bright|intense|powerful)\b"
# without "a third" and the like: "a third darker" is not a third of the brightness
_TIMES = "|".join(word for word in _FACTORS if not word.startswith("a "))
_COMPARED = rf"\b(?P<factor>{_TIMES})(?: as(?: much)?)?(?: of)?(?: the)? (?!but |and )(?=\w)"
_MULTIPLE = r"\b(?P<number>\d{1,2}(?:\.\d+)?) ?(?:x|×|times)(?: as)? (?P<what>brighter|stronger|darker|dimmer|weaker|more|less)\b"
_MULTIPLE_AFTER = r",? (?:(?:like|about|maybe|by) )?(?P<number>\d{1,2}(?:\.\d+)?) ?(?:x|×|times)$"
_COUNTS = {"two": 2.0, "three": 3.0, "half a": 0.5, "1/2": 0.5, "2/3": 2 / 3}
_COUNTS |= dict.fromkeys(("a third of a", "third of a", "1/3"), 1 / 3)
_DOWN = ("darker", "dimmer", "weaker", "down", "under", "less")


class AboutSteps(NamedTuple):
    """The request of a sentence about earlier steps."""

    kind: Literal["show", "between", "strength", "without", "instead", "except"]
    number: int = -1  # of the step to show: 0 is the scene before the first step, -1 the step before the shown one
    factor: float = 1.0  # on the strength of the last step
    what: str = ""  # the word or target that is taken back, or that stays; for "show" and "between" a word of the step
    new: str = ""  # the target that gets the look instead of `what`
    rest: str = ""  # the further sentence that applies after the return to the step


class PlainSentence(NamedTuple):
    """A further sentence in the form of a prompt."""

    text: str
    factor: float = 0.0  # of its comparison: 2 for "twice as much fog"; 0 if it has none
    compared: str = ""  # the end of `text`, from the word that the factor belongs to


def about_steps(sentence: str) -> AboutSteps | None:
    """The request in a sentence about earlier steps; None for a sentence that only names looks.

    >>> about_steps("No, the wall, not the table")
    AboutSteps(kind='instead', number=-1, factor=1.0, what='table', new='wall', rest='')
    """
    text = _PATTERNS["tail"].sub("", " ".join(sentence.split()))
    if _PATTERNS["links"].search(text):
        return None
    if said := _about_steps(text):
        return said
    first, *rest = _PATTERNS["next"].split(_PATTERNS["lead"].sub("", text), maxsplit=1)
    if rest and _PATTERNS["too"].fullmatch(first):
        return about_steps(*rest)
    said = _about_steps(first) if rest else None
    returns = said and said.kind in ("show", "between") and not about_steps(*rest)
    return said._replace(rest=rest[0]) if said and returns else None


def _about_steps(text: str) -> AboutSteps | None:
    """The request about earlier steps in one clause; None if the clause has none."""
    for kind, form in _FORMS:
        if not (found := form.fullmatch(text) or form.fullmatch(_PATTERNS["lead"].sub("", text))):
            continue
        named = {name: value.strip(" .!") for name, value in found.groupdict().items() if value}
        step = named.get("step", "").lower()
        number = int(step) if step.isdigit() else _NUMBERS.get(step, -1)
        if step and number < 0 and step not in _LAST:
            continue
        return AboutSteps(kind, number, _factor(named), named.get("what", ""), named.get("new", ""))
    return None


def _factor(named: dict[str, str]) -> float:
    """The factor in the named groups of a match: 0.5 for "half", 1.2 for "20 % more"; 1 without one."""
    if "factor" in named:
        return _FACTORS[named["factor"].lower()]
    if "share" not in named:
        return 1.0
    text = named["share"].lower()
    share = _FACTORS[text] if text in _FACTORS else float(text.rstrip("%percnt ")) / 100.0
    return 1.0 + share if named.get("sign", "").lower() in ("more", "stronger") else 1.0 - share


def adds_light(sentence: str) -> bool:
    """True if a sentence asks for a rim or a fill in addition to the existing ones.

    >>> adds_light("a cool rim light"), adds_light("the rim light cooler")
    (True, False)
    """
    return bool(_PATTERNS["another"].search(sentence))


def plain(sentence: str) -> PlainSentence:
    """A sentence in the form of a prompt, with the factor of its comparison.

    Raises VibeError for a sentence that only describes the present image.

    >>> plain("And now twice as much fog")
    PlainSentence(text='more fog', factor=2.0, compared='more fog')
    >>> plain("brighten the lamp a bit").text
    'the lamp a bit brighter'
    """
    said = _PATTERNS["start"].sub("", _PATTERNS["tail"].sub("", " ".join(sentence.split())))
    text = _wish(said)
    if said and not text:
        raise VibeError(f"'{sentence}' says how the image is, not what is to change.", SAY_WHAT)
    text = _rewritten(text, _COMPARING)
    for verb, comparative in _VERBS:
        text = verb.sub(partial(_compared, comparative), text)
    text, factor, place = _with_factor(text)
    compared = text[place:] if factor else ""
    return PlainSentence(_rewritten(text, _PLAINER), factor, _rewritten(compared, _PLAINER))


def _with_factor(text: str) -> tuple[str, float, int]:
    """(text with a comparative in place of its factor, the factor, the factor's index); (text, 0, 0) without one."""
    factor, word = 0.0, ""
    if found := _PATTERNS["stops"].search(text):
        clause = re.split(r"[,;.]", text[: found.start()])[-1]
        ways = (found["way"] or clause).lower().split()
        stops = _COUNTS.get(found["count"].lower(), 1.0) + (0.5 if found["half"] else 0.0)
        factor = 2.0 ** (-stops if set(ways) & set(_DOWN) else stops)
        word = "darker" if factor < 1.0 else "brighter"
    elif found := _PATTERNS["share_before"].search(text):
        word = found["what"]
        factor = _factor({"share": found["share"], "sign": "less" if word in _DOWN else "more"})
    elif found := re.search(_POWERFUL, text, re.I):
        factor = _FACTORS[found["factor"].lower()]
        word = "brighter" if factor > 1.0 else "dimmer"
    elif found := _PATTERNS["percent"].search(text):
        factor, word = _factor(found.groupdict()), f"{found['sign']} {found['what']}"
    elif found := _PATTERNS["share_after"].search(text):
        factor = _factor({"share": found["share"], "sign": "less" if _PATTERNS["less"].search(text) else "more"})
        rest = re.sub(", but leave .*", "", text.replace(found[0], ""))
        if "," in rest:  # a factor would apply to the whole sentence, but is meant for its last part
            factor = 0.0
    elif found := re.search(_MULTIPLE, text, re.I):  # "1.5x brighter", and "2 times darker" is half
        word = found["what"]
        factor = (1.0 / max(float(found["number"]), 0.1)) if word in _DOWN else float(found["number"])
    elif found := re.search(_MULTIPLE_AFTER, text, re.I):  # "stronger glow, like 3x"
        factor = float(found["number"])
    elif found := _PATTERNS["amount_after"].search(text):
        factor = _FACTORS[found["factor"].lower()]
    elif found := re.search(_COMPARED, text, re.I):
        factor = _FACTORS[found["factor"].lower()]
        word = "more " if factor > 1.0 else "less "
    if not found:
        return text, 0.0, 0
    return text.replace(found[0], word), factor, found.start()


def _compared(comparative: str, found: re.Match[str]) -> str:
    """A verb and its object as a comparison: "slightly darken the wall" as "the wall a bit darker"."""
    degree = (found["before"] or found["after"] or "").strip()
    return " ".join(filter(None, (found["thing"], degree, comparative)))


def _rewritten(text: str, table: Iterable[tuple[re.Pattern[str], str]]) -> str:
    for pattern, words in table:
        text = " ".join(pattern.sub(words, text).split())
    return text


def _wish(text: str) -> str:
    """The request of a sentence, without clauses about the present look and without reasons; "" if it has none."""
    text = _PATTERNS["reason"].sub("", _PATTERNS["resembles"].sub("", text))
    text = _PATTERNS["needs"].sub(", ", text).strip(" ,")
    if found := _PATTERNS["question"].match(text):
        return _with_noun(text[found.end() :], found["thing"])
    found = _PATTERNS["complaint"].fullmatch(text)
    if found and found["thing"].lower() not in _PRONOUNS:
        return _with_noun(found["act"], found["thing"])
    clauses = re.split(r"\s*[,;.!?]+\s+|\s+-+\s+", text)
    stated = [None if _PATTERNS["modal"].search(each) else _PATTERNS["statement"].match(each) for each in clauses]
    if len(clauses) == 1 or not any(stated):
        return text
    things = [each["thing"] for each in stated if each and each["thing"].lower() not in _PRONOUNS]
    wished = ", ".join(clause for clause, each in zip(clauses, stated, strict=True) if not each)
    return _with_noun(wished, things[-1]) if things else wished


def _with_noun(text: str, noun: str) -> str:
    """A text with a noun in the place of its first pronoun."""
    noun = noun if noun.startswith("the ") else f"the {noun}"
    return re.sub(r"\b(?:it|them|that(?! \w*(?:er|s)\b))\b", noun, text, count=1, flags=re.I)
