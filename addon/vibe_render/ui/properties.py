# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""What the panel holds, kept in the scene at `scene.vibe`. The groups come from the schema."""

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

from ..core.schema_import import labels, messages, schema
from ..scene import stored_subject
from ..scene.subject import Choice
from ..session import preferences

MAX_PROMPT = 2000  # characters that the field takes

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
    from ..session import result  # it reads these properties

    result.mix(settings.id_data)


def _dim(settings: "VibeSettings", context: bpy.types.Context) -> None:
    """Moving the slider shows what it does, also while the original is shown."""
    if settings.show_original:
        settings.show_original = False  # which mixes
    else:
        _mix(settings, context)


def _choose_anew(settings: "VibeSettings", context: bpy.types.Context) -> None:
    stored_subject.forget(settings.id_data)


class VibeSettings(_Toggles, bpy.types.PropertyGroup):  # type: ignore[misc]
    """The panel's fields, and what the last vibe changed."""

    prompt: StringProperty(
        name="Prompt",
        description="The mood in your own words, for example: misty tree silhouette, cool blue fog, vignette",
        maxlen=MAX_PROMPT,
        options={"TEXTEDIT_UPDATE"},
    )
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
        name="Effort",
        description="How long to look for the look",
        items=(
            *(
                (name.upper(), name.capitalize(), f"{b.rounds} rounds of {b.steps} steps: {b.summary}")
                for name, b in schema.BUDGETS.items()
            ),
            ("CUSTOM", "Custom", "Your own numbers"),
        ),
        default="STANDARD",
    )
    rounds: IntProperty(
        name="Rounds", description="How often the plan is made anew", default=6, min=1, max=100
    )
    steps: IntProperty(name="Steps", description="Refinements in each round", default=40, min=1, max=1000)
    size: IntProperty(
        name="Preview Size",
        description="Longer side of the preview, in pixels",
        default=512,
        min=64,
        max=2048,
    )
    top_k: IntProperty(
        name="Values at Once", description="How many values a round may refine", default=8, min=1, max=64
    )
    variants: IntProperty(
        name="Variants",
        description="Different looks for the same words, as pictures to choose from",
        default=1,
        min=1,
        max=8,
    )
    seed: IntProperty(name="Seed", description="Another seed finds another look", min=0)
    anchor: BoolProperty(
        name="Anchor to Cycles",
        description="Between rounds, render a small picture with Cycles that corrects the prediction: closer to the "
        "final render, but Blender pauses for about a second each time",
        default=True,
    )
    lock: StringProperty(
        name="Lock by Name",
        description="Values that must stay, separated by commas: light/Key, material/*/metallic, film/exposure",
    )
    locks: CollectionProperty(type=VibeLock, description="Single values that must stay")
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
    vibed_preset: StringProperty(description="The preset that the look comes from, if any")
    variant: IntProperty(description="Number of the variant that is in the scene", min=0)
    pivot: FloatVectorProperty(size=3, description="What lights and camera orbit: the subject's center")

    def choice(self) -> Choice:
        """What the picture is about."""
        if self.subject == "COLLECTION" and self.collection:
            return Choice(objects=(self.collection.name,))
        return Choice(selected=self.subject == "SELECTED")

    def groups(self) -> tuple[str, ...]:
        """The groups that a vibe may change."""
        return tuple(g for g in schema.GROUPS if getattr(self, f"change_{g}"))

    def engine_options(self, context: bpy.types.Context) -> messages.Options:
        """What the engine is asked to do."""
        saved = preferences.get(context)
        own = schema.Budget(self.rounds, self.steps, self.size, 1, "")
        budget = schema.BUDGETS.get(self.budget.lower(), own)
        return messages.Options(
            **{name: getattr(budget, name) for name in schema.budgets.NUMBERS},
            top_k=self.top_k,
            seed=self.seed,
            anchor=self.anchor,
            groups=self.groups(),
            variants=self.variants,
            lock=(*filter(None, (pattern.strip() for pattern in self.lock.split(","))), *self.locks.keys()),
            encoder=saved.encoder if saved else "",
            device=(saved.device.strip().lower() if saved else "") or "auto",
            vlm_model=saved.vlm_model if saved else "",
            vlm_url=saved.vlm_url if saved else "",
            online=preferences.online(),
        )


CLASSES = (VibeChange, VibeLock, VibeSettings)
