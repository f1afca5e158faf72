# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's fields, kept in the scene at `scene.vibe`. Groups and options come from the schema."""

from typing import Any

import bpy
from bpy import props

from ..core import compat, preferences
from ..core.schema_import import labels, messages, options, schema, targets
from ..render import reference
from ..run import result
from ..scene.subject import SubjectChoice, forget_subject
from . import light_mix, live
from .picture import PictureSettings

SHARED = (  # choices for materials of the subject that other objects use too
    ("ALL", "Affect All Users", "The other objects change with the subject"),
    ("SINGLE", "Make Single-User", "The subject gets copies of its own; Revert removes them"),
)
_EFFORT = options.named("effort").panel
_AUTO = "What was chosen before; otherwise the prominent objects in view, without what they stand on or in front of"


def declare(preferences: bool) -> dict[str, Any]:
    """Option name -> Blender property, for the options among the add-on's preferences, or else for the scene's."""
    rows = [row for row in options.TABLE if row.panel and row.panel.preferences == preferences]
    # The panel declares options with choices, with its own titles.
    return {row.name: _property(row) for row in rows if not row.choices}


def _property(row: options.Option) -> Any:
    panel = row.panel
    assert panel is not None
    facts: dict[str, Any] = {"name": panel.title, "description": panel.description}
    if isinstance(row.default, bool):
        return props.BoolProperty(**facts, default=row.default)
    if isinstance(row.default, int):
        bounds = panel.bounds or row.bounds
        facts |= {"min": bounds[0], "max": bounds[1]} if bounds else {}
        return props.IntProperty(**facts, default=row.default)
    if panel.suggestions:
        facts |= {"search": lambda _owner, _context, _text: panel.suggestions, "search_options": {"SUGGESTION"}}
    facts |= {"options": {"TEXTEDIT_UPDATE"}, "update": live.typed} if panel.live else {}
    facts |= {"subtype": "FILE_PATH", "options": compat.RELATIVE_PATHS} if panel.path else {}
    return props.StringProperty(**facts, default=panel.default, maxlen=panel.length)


class VibeChange(bpy.types.PropertyGroup):
    """One value that the last vibe changed. Its `name` is the parameter's key. Scalars use the first component."""

    before: props.FloatVectorProperty(size=3, subtype="COLOR", description="What it was")
    after: props.FloatVectorProperty(size=3, subtype="COLOR", description="What it is with the new look")
    reason: props.StringProperty()

    def values(self) -> tuple[schema.Values, schema.Values]:
        """The old and the new value, with as many components as the parameter has."""
        count = labels.parameter(self.name).components
        return tuple(self.before)[:count], tuple(self.after)[:count]


class VibeTarget(bpy.types.PropertyGroup):
    """The artist's target for a word of the prompt. Its `name` is the word."""

    target: props.StringProperty(description="A name in the scene, or one of lights, world, image, not used and so on")


def _group_toggle(group: str) -> Any:
    words = [labels.words(p.name) for p in schema.PARAMETERS if p.group == group]
    names = ", ".join(word if word.isupper() else word.lower() for word in words)  # IOR
    framed = group == "camera"  # the artist framed the shot
    text = f"A vibe may change: {names}"
    return props.BoolProperty(name=labels.GROUP_TITLES[group], description=text, default=not framed)


def _dim(settings: "VibeSettings", context: bpy.types.Context) -> None:
    """Update function of Strength: shows the vibe at that strength, and switches Before off."""
    if settings.show_original:
        settings.show_original = False  # its update writes the values
    else:
        result.mix(settings.id_data)


class VibeSettings(PictureSettings, bpy.types.PropertyGroup):
    """The panel's fields, and what the last vibe changed."""

    subject: props.EnumProperty(
        name="Subject",
        description="What the image is about; everything else is its surroundings",
        items=(
            ("AUTO", "Automatic", _AUTO),
            ("SELECTED", "Selected Objects", "What is selected when the vibe starts"),
            ("COLLECTION", "Collection", "Everything in one collection"),
        ),
        update=lambda settings, _context: forget_subject(settings.id_data),
    )
    collection: props.PointerProperty(
        type=bpy.types.Collection, name="Collection", description="What the image is about"
    )
    effort: props.EnumProperty(
        name=_EFFORT.title,
        description=_EFFORT.description,
        items=[
            (name.upper(), name.capitalize(), f"{b.rounds} rounds of {b.steps} steps: {b.summary}")
            for name, b in schema.BUDGETS.items()
        ]
        + [("CUSTOM", "Custom", "Your own numbers")],
        default=_EFFORT.default,
    )
    # The names are keys of parameters.
    locks: props.CollectionProperty(type=bpy.types.PropertyGroup, description="Single values that must stay")
    targets: props.CollectionProperty(
        type=VibeTarget, description="What words describe, where you have chosen something else"
    )
    shared: props.EnumProperty(
        name="Shared",
        description="Materials of the subject that other objects use too",
        items=(("ASK", "Ask", "Ask when it matters"), *SHARED),
    )
    strength: props.FloatProperty(
        name="Strength", description="From the original (0) to the vibe (1)",
        default=1.0, min=0.0, max=1.0, subtype="FACTOR", update=_dim,
    )  # fmt: skip
    show_original: props.BoolProperty(
        name="Show Original",
        description="Switch between the scene as it was and the new look, to compare",
        update=lambda settings, _context: result.mix(settings.id_data),
    )
    changes: props.CollectionProperty(type=VibeChange)
    mix: props.CollectionProperty(type=light_mix.VibeMixChannel)
    further: props.StringProperty(
        name="And Now",
        description="A further sentence, which goes on from the result: a bit warmer; less fog; but leave the sky; back to the first",
        maxlen=schema.limits.LONGEST_PROMPT,
    )
    edited: props.IntProperty(
        description="Number of the step that the further sentence replaces; 0 for another step", min=0
    )
    check_every: props.IntProperty(
        name="Every", description="Frames from one that is checked to the next", default=10, min=1
    )
    vibed_prompt: props.StringProperty()
    vibed_goals: props.StringProperty()  # of the last search, as JSON, for presets; "" for none
    vibed_like: props.StringProperty(description="The picture that the look comes from, if any")
    vibed_preset: props.StringProperty(description="The preset that the look comes from, if any")
    variant: props.IntProperty(description="Number of the variant that is in the scene", min=0)
    pivot: props.FloatVectorProperty(size=3, description="What lights and camera orbit: the subject's center")

    def choice(self) -> SubjectChoice:
        if self.subject == "COLLECTION" and self.collection:
            return SubjectChoice(objects=(self.collection.name,))
        return SubjectChoice(selected=self.subject == "SELECTED")

    def target_pairs(self) -> list[str]:
        """The artist's targets for the words that the prompt has, as "word=target": "copper=Cup"."""
        present = (each for each in self.targets if targets.is_said(each.name, self.prompt))
        return [f"{each.name}={each.target}" for each in present]

    def set_target(self, word: str, target: str) -> None:
        """Stores the artist's target for a word; "" removes it."""
        place = self.targets.find(word)
        if place >= 0:
            self.targets.remove(place)
        if target:
            added = self.targets.add()
            added.name, added.target = word, target

    def groups(self) -> tuple[str, ...]:
        return tuple(g for g in schema.GROUPS if getattr(self, f"change_{g}"))

    def engine_options(self, context: bpy.types.Context) -> messages.Options:
        """The options of a vibe, from these fields and the add-on's preferences."""
        saved = preferences.get(context)
        own = schema.Budget(self.rounds, self.steps, self.size, 1, "")
        budget = schema.BUDGETS.get(self.effort.lower(), own)
        chosen: dict[str, Any] = {}
        for row in options.rows(messages.Options):
            owner = saved if row.panel and row.panel.preferences else self
            if row.panel and owner:
                chosen[row.name] = getattr(owner, row.name)
        chosen |= {name: getattr(budget, name) for name in schema.limits.NUMBERS}
        chosen["device"] = chosen.get("device", "").strip().lower() or "auto"
        patterns = filter(None, (pattern.strip() for pattern in self.lock.split(",")))
        chosen |= {"groups": self.groups(), "target": self.target_pairs(), "lock": [*patterns, *self.locks.keys()]}
        picture = reference.picture_name(self)  # the session saves the image, and then sets its path
        chosen |= {"like": picture, "like_only": self.traits() if picture else ()}
        return messages.Options.from_dict(chosen | {"online": preferences.online()})


VibeSettings.__annotations__ |= declare(preferences=False)
VibeSettings.__annotations__ |= {f"change_{group}": _group_toggle(group) for group in schema.GROUPS}
