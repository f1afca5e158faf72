# SPDX-License-Identifier: GPL-3.0-or-later
"""Light Mix in the panel: a slider and a color for each light of a Cycles render, which change its image at once."""

from __future__ import annotations

import bpy
from bpy.props import FloatProperty, FloatVectorProperty

from ..core.color import Color
from ..core.schema_import import labels, schema
from ..run import light_mix, preview
from ..run.state import addon_state
from ..scene.nodes import mix
from . import bases, drawing

_TICK = 0.02  # seconds between two images while a slider moves


def _shown(scene: bpy.types.Scene) -> light_mix.RenderedMix | None:
    """The rendered light layers of a scene; None if it has none, or if an undo has removed their sliders."""
    rendered = addon_state.mix
    if rendered is None or rendered.uid != scene.session_uid:
        return None
    return rendered if all(c.name in scene.vibe.mix for c in rendered.channels) else None


def draw_soon(_slider: object = None, _context: object = None) -> None:
    """Mixes the image anew in `_TICK` seconds, once for all sliders moved by then; also their update function."""
    if addon_state.mix:
        drawing.begin(_draw, _TICK)


def _draw() -> float | None:
    scene = bpy.context.scene
    rendered = _shown(scene)
    if rendered is None:
        return None
    if bpy.app.is_job_running("RENDER"):
        return 1.0
    try:
        rendered.draw(scene, colors(scene))
    except schema.VibeError as error:
        addon_state.failure = error
    drawing.redraw()
    return None


def render_soon() -> None:
    """Renders the light layers of the scene after a vibe, if "After Each Vibe" is switched on."""
    if bpy.context.scene.vibe.light_mix and bpy.context.window:
        drawing.begin(_render, _TICK)


def _render() -> None:
    if bpy.ops.vibe.mix_render.poll():
        bpy.ops.vibe.mix_render()


class VibeMixChannel(bpy.types.PropertyGroup):
    """The slider of a light layer. Its `name` is that of the light group."""

    factor: FloatProperty(
        name="Power", description="What the power of this light is multiplied by",
        default=1.0, min=0.0, max=1000.0, soft_max=4.0, precision=2, update=draw_soon,
    )  # fmt: skip
    color: FloatVectorProperty(
        name="Color", description="A color filter in front of this light. White leaves it as it is",
        size=3, subtype="COLOR", default=light_mix.WHITE, min=0.0, max=1.0, update=draw_soon,
    )  # fmt: skip
    applied: FloatVectorProperty(
        size=3, default=light_mix.WHITE, description="What Apply has multiplied it by since the render"
    )

    def product(self) -> Color:
        """The factors of red, green and blue: power times color."""
        red, green, blue = self.color
        return self.factor * red, self.factor * green, self.factor * blue

    def reset(self) -> None:
        self.factor, self.color = 1.0, light_mix.WHITE


def moved(scene: bpy.types.Scene) -> dict[str, Color]:
    """Channel name -> its factors of red, green and blue, for channels whose slider or color is not neutral."""
    return {c.name: c.product() for c in scene.vibe.mix if c.product() != light_mix.WHITE}


def colors(scene: bpy.types.Scene) -> dict[str, Color]:
    """Channel name -> its factors of red, green and blue since the render: those from Apply times `product`."""
    return {c.name: tuple(a * p for a, p in zip(c.applied, c.product(), strict=True)) for c in scene.vibe.mix}


class MixPanel(bases.IdlePanel):
    """The image of the mix, a slider and a color for each light, and buttons that write the mix into the scene."""

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        shown = _shown(context.scene)
        row = layout.row(align=True)
        row.operator("vibe.mix_render", text="Render Again" if shown else "Render Lights", icon="RENDER_STILL")
        row.prop(settings, "light_mix", text="After Each Vibe", toggle=True)
        if reason := VIBE_OT_mix_render.obstacle(context):
            drawing.paragraph(layout, context, reason, "INFO", faint=True)
        if shown is None:
            return
        drawing.before_after(layout, shown.rendered, shown.picture, 10.5, ("As rendered", "Mix"))
        column = layout.column(align=True)
        for channel in shown.channels:
            slider, split = settings.mix[channel.name], column.split(factor=0.4, align=True)
            split.label(text=channel.title, icon=channel.icon)
            values = split.row(align=True)
            values.prop(slider, "factor", text="", slider=True)
            swatch = values.row(align=True)
            swatch.ui_units_x = 2.0
            swatch.prop(slider, "color", text="")
        row = layout.row(align=True)
        row.scale_y = 1.3
        row.operator("vibe.mix_apply")
        row.operator("vibe.mix_nodes")
        row.operator("vibe.mix_reset", text="", icon="LOOP_BACK")


class VIBE_OT_mix_render(bases.IdleOperator, label="Render Lights", options={"UNDO"}):
    """Render a small image with Cycles, each light in a layer of its own. Your light groups stay as they are"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        if context.scene.render.engine != "CYCLES":
            return light_mix.NEEDS_CYCLES
        if preview.exists(context.scene):
            return "The scene shows a look of Live. Search for it, or switch Live off"
        if context.scene.camera is None:
            return "The scene has no camera"
        return bases.untouchable(context)

    def perform(self, context: bpy.types.Context) -> str:
        """Renders the light layers, and sets the sliders to the mix in the compositor, or to 1."""
        scene = context.scene
        addon_state.forget_mix()
        addon_state.mix = light_mix.RenderedMix(scene)
        scene.vibe.mix.clear()
        present = mix.read_mix(scene)
        for channel in addon_state.mix.channels:
            slider = scene.vibe.mix.add()
            slider.name = channel.name
            color = present.get(channel.name, light_mix.WHITE)
            if factor := max(color):
                slider.color = [c / factor for c in color]
            slider.factor = factor
        return f"{len(scene.vibe.mix)} light layers"


class _Mixed(bases.IdleOperator, options={"UNDO"}):
    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        if _shown(context.scene) is None:
            return "Render the lights first"
        return bases.untouchable(context) or ("" if moved(context.scene) else "Move a slider first")


class VIBE_OT_mix_apply(_Mixed, label="Apply"):
    """Write the mix into power and color of lights, world and emitting materials, as a step that Revert takes back"""

    def perform(self, context: bpy.types.Context) -> str:
        """Writes the moved channels' factors since the render, stores them in `applied`, and resets the sliders."""
        scene, rendered = context.scene, addon_state.mix
        assert rendered
        if scene.vibe.show_original:
            scene.vibe.show_original = False
        wanted = {name: color for name, color in colors(scene).items() if name in moved(scene)}
        skipped = light_mix.apply(scene, rendered.channels, wanted)
        for channel in scene.vibe.mix:
            if channel.name in wanted:
                channel.applied = wanted[channel.name]
                channel.reset()
        left = (f"{labels.title(key)} was left alone: {reason}" for key, reason in skipped.items())
        return next(left, "The mix is in the scene")


class VIBE_OT_mix_nodes(_Mixed, label="Compositor"):
    """Write the mix as nodes of the compositor, which work on every later render. Revert removes them"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        return super().obstacle(context) or VIBE_OT_mix_render.obstacle(context)

    def perform(self, context: bpy.types.Context) -> str:
        scene, rendered = context.scene, addon_state.mix
        assert rendered
        light_mix.write_nodes(scene, rendered.channels, moved(scene))
        return "The mix is in the compositor"


class VIBE_OT_mix_reset(_Mixed, label="Reset", options={"UNDO", "INTERNAL"}):
    """Move all sliders back"""

    def perform(self, context: bpy.types.Context) -> str:
        for channel in context.scene.vibe.mix:
            channel.reset()
        return "The image is as it was rendered"
