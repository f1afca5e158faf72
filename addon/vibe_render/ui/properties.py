# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The panel's fields, kept in the scene at `scene.vibe`. Groups and options come from the schema."""

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..core import preferences
from ..core.schema_import import labels, messages, options, schema, targets
from ..render import reference
from ..run import result
from ..scene import stored_subject
from ..scene.subject import SubjectChoice
from . import live, option_properties
from .picture_properties import PictureSettings

_LEFT_ALONE = ("camera",)  # unless asked: the artist framed the shot


class VibeChange(bpy.types.PropertyGroup):
    """One value that the last vibe changed. Its `name` is the parameter's key; a scalar is the first component."""

    before: FloatVectorProperty(size=3, subtype="COLOR", description="What it was")
    after: FloatVectorProperty(size=3, subtype="COLOR", description="What it is with the new look")
    reason: StringProperty()

    def values(self) -> tuple[schema.Values, schema.Values]:
        """The old and the new value, with as many components as the parameter has."""
        count = labels.parameter(self.name).components
        return tuple(self.before)[:count], tuple(self.after)[:count]


class VibeLock(bpy.types.PropertyGroup):
    """A single value that must stay. Its `name` is the parameter's key."""


class VibeTarget(bpy.types.PropertyGroup):
    """What a word of the prompt describes, against what it is taken for. Its `name` is the word."""

    target: StringProperty(
        description="A name in the scene, or one of lights, world, image, not used and so on"
    )


def _toggles() -> dict[str, BoolProperty]:
    """A toggle for every group of the schema."""
    toggles = {}
    for group in schema.GROUPS:
        words = [labels.words(p.name) for p in schema.PARAMETERS if p.group == group]
        names = ", ".join(word if word.isupper() else word.lower() for word in words)  # IOR
        toggles[f"change_{group}"] = BoolProperty(
            name=labels.GROUP_TITLES[group],
            description=f"A vibe may change: {names}",
            default=group not in _LEFT_ALONE,
        )
    return toggles


_Toggles = type("VibeToggles", (), {"__annotations__": _toggles(), "__module__": __name__})


def _mix(settings: "VibeSettings", context: bpy.types.Context) -> None:
    result.mix(settings.id_data)


def _dim(settings: "VibeSettings", context: bpy.types.Context) -> None:
    """Moving Strength shows the vibe, also while Before is pressed."""
    if settings.show_original:
        settings.show_original = False  # which mixes
    else:
        _mix(settings, context)


def _choose_anew(settings: "VibeSettings", context: bpy.types.Context) -> None:
    stored_subject.forget(settings.id_data)


_Options = option_properties.declare("VibeOptions", preferences=False, updates={"prompt": live.typed})
_EFFORT = options.named("budget").panel


class VibeSettings(_Toggles, _Options, PictureSettings, bpy.types.PropertyGroup):  # type: ignore[misc]
    """The panel's fields, and what the last vibe changed."""

    subject: EnumProperty(
        name="Subject",
        description="What the picture is about; everything else is its surroundings",
        items=(
            (
                "AUTO",
                "Automatic",
                "What was chosen before; otherwise the prominent things in view, without what they stand on or in front of",
            ),
            ("SELECTED", "Selected Objects", "What is selected when the vibe starts"),
            ("COLLECTION", "Collection", "Everything in one collection"),
        ),
        update=_choose_anew,
    )
    collection: PointerProperty(
        type=bpy.types.Collection, name="Collection", description="What the picture is about"
    )
    budget: EnumProperty(
        name=_EFFORT.title,
        description=_EFFORT.description,
        items=(
            *(
                (name.upper(), name.capitalize(), f"{b.rounds} rounds of {b.steps} steps: {b.summary}")
                for name, b in schema.BUDGETS.items()
            ),
            ("CUSTOM", "Custom", "Your own numbers"),
        ),
        default=_EFFORT.default,
    )
    locks: CollectionProperty(type=VibeLock, description="Single values that must stay")
    targets: CollectionProperty(
        type=VibeTarget, description="What words describe, where they are taken for something else"
    )
    shared: EnumProperty(
        name="Shared",
        description="Materials of the subject that other things use too",
        items=(
            ("ASK", "Ask", "Ask when it matters"),
            ("ALL", "Affect All Users", "The other things change with the subject"),
            ("SINGLE", "Make Single-User", "The subject gets copies of its own; Revert takes them away"),
        ),
    )
    show_reasons: BoolProperty(
        name="Reasons", description="Show which words caused each change", default=True
    )
    strength: FloatProperty(
        name="Strength",
        description="From the original (0) to the vibe (1)",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_dim,
    )
    show_original: BoolProperty(
        name="Show Original",
        description="Switch between the scene as it was and the new look, to compare",
        update=_mix,
    )
    changes: CollectionProperty(type=VibeChange)
    vibed_prompt: StringProperty()
    vibed_goals: StringProperty()  # as JSON, for presets
    vibed_like: StringProperty(description="The picture that the look comes from, if any")
    vibed_preset: StringProperty(description="The preset that the look comes from, if any")
    variant: IntProperty(description="Number of the variant that is in the scene", min=0)
    pivot: FloatVectorProperty(size=3, description="What lights and camera orbit: the subject's center")

    def choice(self) -> SubjectChoice:
        """What the picture is about."""
        if self.subject == "COLLECTION" and self.collection:
            return SubjectChoice(objects=(self.collection.name,))
        return SubjectChoice(selected=self.subject == "SELECTED")

    def told(self) -> list[str]:
        """What the artist says that words of the prompt describe: "copper=Cup"."""
        said = (each for each in self.targets if targets.is_said(each.name, self.prompt))
        return [f"{each.name}={each.target}" for each in said]

    def tell(self, word: str, target: str) -> None:
        """Keeps what the artist says that a word describes.

        Args:
            word: As `--target` calls it.
            target: A name, see `schema.targets`; "" to have the word described as it is read.
        """
        place = self.targets.find(word)
        if place >= 0:
            self.targets.remove(place)
        if target:
            told = self.targets.add()
            told.name, told.target = word, target

    def groups(self) -> tuple[str, ...]:
        """The groups that a vibe may change."""
        return tuple(g for g in schema.GROUPS if getattr(self, f"change_{g}"))

    def engine_options(self, context: bpy.types.Context) -> messages.Options:
        """What the engine is asked to do."""
        saved = preferences.get(context)
        own = schema.Budget(self.rounds, self.steps, self.size, 1, "")
        budget = schema.BUDGETS.get(self.budget.lower(), own)
        chosen: dict[str, Any] = {}
        for row in options.rows(messages.Options):
            owner = saved if row.panel and row.panel.preferences else self
            if row.panel and owner:
                chosen[row.name] = getattr(owner, row.name)
        chosen |= {name: getattr(budget, name) for name in schema.budgets.NUMBERS}
        chosen["device"] = chosen.get("device", "").strip().lower() or "auto"
        patterns = filter(None, (pattern.strip() for pattern in self.lock.split(",")))
        chosen |= {"groups": self.groups(), "lock": [*patterns, *self.locks.keys()]}
        chosen |= {"target": self.told()}
        chosen |= {"like": "", "like_only": ()}  # whoever reads the scene saves the picture, and knows where
        if picture := reference.name(self):
            chosen |= {"like": picture, "like_only": self.traits()}
        return messages.Options.from_dict(chosen | {"online": preferences.online()})


CLASSES = (VibeChange, VibeLock, VibeTarget, VibeSettings)
