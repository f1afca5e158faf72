# SPDX-License-Identifier: Apache-2.0
"""A round's understanding of a prompt: captions for the encoder, the plan, and a readable account of both."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Protocol

from ..goals.resolve import Goals
from ..schema import Instance, VibeError, labels
from ..words.attributes import color_class
from ..words.lexicon.entries import VocabularyEntry
from ..words.lexicon.vocabulary import Vocabulary, default_vocabulary
from ..words.types import Attribute, Parsed, SceneDescription
from .planner import plan
from .types import LightPlan, Plan

_MOST = 5  # words per caption: short ones are understood better
_OF_MATTER = ("color", "finish", "material", "setting")
_KINDS = {"subject": ("silhouette", ("subject", "highlight", "glow")), "surroundings": ("fog", ("surroundings", "sky"))}
"""Region -> (kind or entry of words for all of the region, kinds of targets that the region's caption describes)."""


@dataclass(frozen=True)
class Prompts:
    """Captions for the encoder, region by region (equations 5 and 6); no caption contains a negation."""

    subject: str  # short caption of the subject alone
    surroundings: str  # short caption of the surroundings alone; "" when the words leave them open
    whole: str  # caption of the whole image
    subject_negatives: tuple[str, ...] = ()  # captions that the subject must not fit: swapped words, antonyms
    surroundings_negatives: tuple[str, ...] = ()  # captions that the surroundings must not fit
    whole_negatives: tuple[str, ...] = ()  # captions that the image must not fit: "thick fog" for "no fog"


def compose(parsed: Parsed, overruled: Collection[Attribute] = (), vocabulary: Vocabulary | None = None) -> Prompts:
    """Captions, and negatives that must not fit, of a parsed prompt, without the words in `overruled`."""
    captions = _Captions(vocabulary or default_vocabulary())
    meant = [a for a in parsed.attributes if a not in overruled]
    said = [a for a in meant if not a.negated and not a.cause]
    # Words for the surfaces of a region, its sky, or all of it
    mine, theirs = (
        [a for a in said if whole in (a.kind, a.entry) or (a.kind in kinds and a.slot in _OF_MATTER)]
        for whole, kinds in _KINDS.values()
    )
    names = {o.region: "" if o.name == o.region else o.name for o in reversed(parsed.objects)}
    noun, backdrop = names.get("subject") or "object", names.get("surroundings") or "background"
    things: dict[str, list[Attribute]] = {}  # noun -> its words: "a white cup, a black table" has two nouns
    for attribute in mine:
        things.setdefault((attribute.owners and attribute.thing) or noun, []).append(attribute)
    foreground = ", ".join(captions.caption(a, name) for name, a in (things or {noun: []}).items())
    background = captions.caption(theirs, backdrop) if theirs else ""
    whole = [a for a in said if a.region == "whole" or a.slot in ("lighting", "atmosphere", "grade", "mood")]
    looks = [captions.words(a) for a in whole if a not in mine and a not in theirs][:_MOST]
    caption = ", ".join(dict.fromkeys(filter(None, (foreground, background, *looks))))
    mistakes = captions.mistakes(mine, theirs, noun), captions.mistakes(theirs, mine, backdrop)
    return Prompts(foreground, background, caption, *mistakes, captions.unwanted(meant))


class _Captions:
    def __init__(self, vocabulary: Vocabulary) -> None:
        self.vocabulary, self.entries = vocabulary, vocabulary.entries

    def words(self, attribute: Attribute) -> str:
        """The encoder's text for a word: its expansion, with the intensity kept."""
        entry = self.entries.get(attribute.entry)
        if attribute.color or not entry:
            # A color has its name and its basic color, "crimson red": encoders know few names of colors.
            kind, name = color_class(attribute), attribute.entry
            if attribute.kind in ("light", "fill", "rim", "shadow", "highlight", "glow", "ambience"):
                return f"{name} {attribute.thing}"  # "blue shadows"
            return name if kind in name.replace("gray", "grey") else f"{name} {kind}"
        if attribute.shades:
            return attribute.english or attribute.word
        degree = "slightly " if attribute.strength < 0.8 else "very " if attribute.strength > 1.3 else ""
        return degree + entry.phrase

    def caption(self, attributes: Iterable[Attribute], noun: str) -> str:
        """A caption such as "a glossy teal dolphin": short phrases stand before the noun, longer ones after it."""
        before: list[str] = []
        after: list[str] = []
        # A setting that is part of the noun is left out: no "studio studio"
        said = (a for a in attributes if a.slot != "setting" or (a.english or a.word) not in noun)
        before_noun = {"finish": 1, "color": 2, "material": 3}  # slot -> place; others come first
        for attribute in sorted(said, key=lambda a: before_noun.get(a.slot, 0)):
            adjective, _, more = self.words(attribute).partition(", ")
            long = adjective.count(" ") > 1 and not attribute.color
            (after if long else before).append(adjective)
            after += filter(None, [more])
            if len(before) + len(after) == _MOST:
                break
        words = " ".join(dict.fromkeys([*before, noun])).split()
        front = " ".join(word for word, _ in groupby(words))
        article = "an" if front[:1] in {*"aeiou"} else "a"
        return ", ".join(dict.fromkeys([f"{article} {front}", *after]))

    def mistakes(self, own: list[Attribute], other: list[Attribute], noun: str) -> tuple[str, ...]:
        """Negatives of a region: its noun with the other region's colors and materials, and with opposites of its own words."""
        mine = {a.entry for a in own}
        swapped = (a for a in other if a.slot in ("color", "material") and a.entry not in mine)
        negatives = [self.caption([a], noun) for a in swapped]
        meant = {pair for name in mine & self.entries.keys() for pair in self.entries[name].classes.items()}
        opposites = (self._opposite(a) for a in own if a.slot in _OF_MATTER)
        negatives += [
            f"a {opposite.phrase.partition(',')[0]} {noun}"
            for opposite in opposites
            if opposite and meant.isdisjoint(opposite.classes.items())
        ]
        return tuple(dict.fromkeys(negatives))

    def unwanted(self, attributes: list[Attribute]) -> tuple[str, ...]:
        """Negatives of the whole image: what negated words describe, and the opposites of words about the whole image."""
        wanted = {self.words(a) for a in attributes if not a.negated}
        negatives: dict[str, None] = {}
        for attribute in attributes:
            if attribute.negated:
                negatives[self.words(replace(attribute, strength=1.0, shades=()))] = None
            elif attribute.region == "whole" and not attribute.cause and (opposite := self._opposite(attribute)):
                negatives[opposite.phrase] = None
        return tuple(n for n in negatives if n not in wanted)

    def _opposite(self, attribute: Attribute) -> VocabularyEntry | None:
        entry = self.entries.get(attribute.entry)
        return self.vocabulary.opposite(entry) if entry else None


NO_PROMPTS = Prompts("", "", "")  # nothing to ask an encoder


@dataclass(frozen=True)
class Advice:
    """A round's understanding of the prompt, and its plan."""

    goals: Goals  # what the words wish for; with the objects list O
    prompts: Prompts
    plan: Plan
    unmeasured: Prompts = NO_PROMPTS  # captions and negatives of only those words that no measure covers
    # the advisor: "offline planner" or a model, with the reason if it is not the one that was asked for
    source: str = "offline planner"


class Advisor(Protocol):
    """The interface of advisors, which make the `Advice` of a round: the planner, or a model."""

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """The advice for the current image, `display` (H, W, 3) in [0, 1]; `instances` have the locks."""


@dataclass(frozen=True)
class OfflineAdvisor:
    """The advisor without a model: the vocabulary and its planner."""

    goals: Goals | VibeError  # the prompt's goals, or the reason why nothing in it is understood
    light: LightPlan | None = None

    def advise(self, display: Any, instances: Mapping[str, Instance], scene: SceneDescription) -> Advice:
        """The planner's advice, whatever the current image is. Raises VibeError if no word of the prompt is known."""
        if isinstance(self.goals, VibeError):
            raise self.goals
        prompts = compose(self.goals.parsed, self.goals.overruled)
        decided = plan(self.goals, dict(instances), scene, light=self.light)
        served = self.light.served if self.light else ()
        return Advice(self.goals, prompts, decided, unmeasured(self.goals, served))


def unmeasured(goals: Goals, served: Collection[Attribute] = ()) -> Prompts:
    """Captions of only the words that no measured claim covers; words in `served`, which a rig serves, are covered."""
    measured = [wish.attribute for wish in goals.wishes if wish.is_measured]
    left = [
        a
        for a in goals.parsed.attributes
        if not (a.negated or a.cause or a in measured or a in served or a in goals.overruled)
    ]
    return compose(replace(goals.parsed, attributes=left)) if left else NO_PROMPTS


def explain(goals: Goals, prompts: Prompts, plan: Plan) -> str:
    """A readable account of a prompt: what it says, what the encoder is told, what may change and why."""
    parsed = goals.parsed
    lines = [f"Prompt: {parsed.prompt}", "", "Understood"]
    for thing in parsed.objects:
        said = "; ".join(f"{slot}: {words}" for slot, words in thing.attributes.items()) or "as it is"
        materials = f" [{', '.join(thing.materials)}]" if thing.materials else ""
        where = "" if thing.name == thing.region else f" ({thing.region})"
        lines.append(f"  {thing.name}{where}{materials}: {said}")
    moods: dict[str, dict[str, None]] = {}
    for attribute in (a for a in parsed.attributes if a.cause):
        moods.setdefault(attribute.cause, {})[attribute.word] = None
    lines += [f"  '{mood}' stands for: {', '.join(implied)}" for mood, implied in moods.items()]
    lines += [f"  guessed: '{unknown}' as '{entry}'" for unknown, entry in parsed.guesses.items()]
    if parsed.ignored:
        lines.append(f"  not used: {', '.join(parsed.ignored)}")
    lines += ["", "Words (--target WORD=NAME says what a word describes)"]
    for word in parsed.words:
        others = "".join(f"; {each.name} {each.probability:.0%}" for each in word.candidates[1:])
        sure = f" ({word.confidence:.0%}{others})" if word.candidates else ""
        lines.append(f"  {word.key}: {word.target}{sure}")
    lines += ["", "Told to an encoder that is named (--encoder)", f"  subject: {prompts.subject}"]
    lines.append(f"  surroundings: {prompts.surroundings or '(left open)'}")
    lines.append(f"  picture: {prompts.whole}")
    unwanted = (*prompts.subject_negatives, *prompts.surroundings_negatives, *prompts.whole_negatives)
    lines += [f"  not: {text}" for text in unwanted]
    lines += ["", "Plan (the smaller the priority, the more important)"]
    moving = sorted((e.priority, key) for key, e in plan.items() if e.priority is not None)
    for priority, key in moving:
        entry = plan[key]
        shown = labels.text(key, entry.upper)
        if entry.lower != entry.upper:
            shown = f"{labels.bare(key, entry.lower)} .. {shown}"
        lines.append(f"  {priority:3d}  {labels.title(key)}: {shown}  {entry.reason}")
    kept = len(plan) - len(moving)
    lines.append(f"  {kept} other parameters keep the artist's value.")
    lines += [f"  note: {note}" for note in plan.notes]
    return "\n".join(lines)


def as_dict(goals: Goals, prompts: Prompts, plan: Plan) -> dict:
    """The account of `explain` for `--json`: objects, prompts, plan, and the words that were ignored or guessed."""
    parsed = goals.parsed
    return {
        "prompt": parsed.prompt,
        "objects": [
            {"name": o.name, "region": o.region, "attributes": o.attributes, "materials": list(o.materials)}
            for o in parsed.objects
        ],
        "prompts": {name: getattr(prompts, name) for name in prompts.__dataclass_fields__},
        "classes": goals.classes,
        "plan": {
            key: {"lower": list(e.lower), "upper": list(e.upper), "priority": e.priority, "reason": e.reason}
            for key, e in plan.items()
        },
        "words": [word.row() for word in parsed.words],
        "ignored": parsed.ignored,
        "guesses": parsed.guesses,
        "notes": list(plan.notes),
    }
