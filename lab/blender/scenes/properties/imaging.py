# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of camera, film and compositor that change the whole image: each builder adds one to the plain scene."""

from __future__ import annotations

import bpy
from bpy.types import Node, Object, Scene
from vibe_render.core import compat, rendered

from .plain import AddProperty, obstacle


def film_exposure(scene: Scene, subject: Object) -> None:
    """More light on the film."""
    scene.cycles.film_exposure = 2.5


def pixel_aspect(scene: Scene, subject: Object) -> None:
    """Pixels that are not square."""
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = 2.0, 1.0


def transparent(scene: Scene, subject: Object) -> None:
    """A film without background."""
    scene.render.film_transparent = True


def camera_shift(scene: Scene, subject: Object) -> None:
    """A shifted lens, fitted on the height."""
    scene.camera.data.shift_x, scene.camera.data.sensor_fit = 0.2, "VERTICAL"


def border(scene: Scene, subject: Object) -> None:
    """A part of the image."""
    scene.render.use_border, scene.render.border_max_x = True, 0.5


def strips(scene: Scene, subject: Object) -> None:
    """A sequencer with a strip."""
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    strips.new_scene("Card", scene, 1, 1)


def stereo(scene: Scene, subject: Object) -> None:
    """Two views."""
    scene.render.use_multiview = True


def motion_blur(scene: Scene, subject: Object) -> None:
    """Motion blur."""
    scene.render.use_motion_blur = True


def freestyle(scene: Scene, subject: Object) -> None:
    """Freestyle lines."""
    scene.render.use_freestyle = True


def view_curves(scene: Scene, subject: Object) -> None:
    """Curves of the view transform."""
    scene.view_settings.use_curve_mapping = True


def white_balance(scene: Scene, subject: Object) -> None:
    """The white balance of the view."""
    compat.assign(scene.view_settings, use_white_balance=True, white_balance_temperature=4000.0)


def view_settings(scene: Scene, subject: Object) -> None:
    """Exposure, gamma and look of the view."""
    view = scene.view_settings
    view.exposure, view.gamma, view.look = 0.7, 1.2, "AgX - Punchy"


def standard_view(scene: Scene, subject: Object) -> None:
    """Another view transform."""
    scene.view_settings.view_transform = "Standard"


def orthographic(scene: Scene, subject: Object) -> None:
    """A camera without perspective."""
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 4.0


def depth_of_field(scene: Scene, subject: Object) -> None:
    """A lens that blurs."""
    dof = scene.camera.data.dof
    dof.use_dof, dof.aperture_fstop, dof.focus_object = True, 0.2, subject


def camera_clip(scene: Scene, subject: Object) -> None:
    """An obstacle before the camera's near plane."""
    obstacle(scene)
    scene.camera.data.clip_start = 2.8


def scaled_camera(scene: Scene, subject: Object) -> None:
    """A camera whose object is scaled."""
    scene.camera.scale = (2.0, 2.0, 3.0)


def marked_camera(scene: Scene, subject: Object) -> None:
    """A camera that a marker of the timeline puts in place of the scene's."""
    other = bpy.data.objects.new("Other Camera", scene.camera.data.copy())
    other.matrix_world = scene.camera.matrix_world
    other.data.lens = 80.0
    scene.collection.objects.link(other)
    scene.timeline_markers.new("Cut", frame=0).camera = other


def wide_filter(scene: Scene, subject: Object) -> None:
    """A soft film."""
    scene.cycles.filter_width = 4.0


def box_filter(scene: Scene, subject: Object) -> None:
    """A film whose pixels are boxes."""
    scene.cycles.pixel_filter_type = "BOX"


def percentage(scene: Scene, subject: Object) -> None:
    """A smaller image."""
    scene.render.resolution_percentage = 50


def no_bounces(scene: Scene, subject: Object) -> None:
    """Light that is not bounced."""
    scene.cycles.diffuse_bounces = 0


def unused_compositor(scene: Scene, subject: Object) -> None:
    """A compositor that is switched off."""
    _compositing(scene, 2.0)
    scene.render.use_compositing = False


def muted_compositor(scene: Scene, subject: Object) -> None:
    """A compositor whose nodes are muted."""
    _compositing(scene, 2.0)
    tree = compat.compositor(scene)
    assert tree
    next(n for n in tree.nodes if n.bl_idname == "CompositorNodeExposure").mute = True


def other_scene(scene: Scene, subject: Object) -> None:
    """A compositor that shows another scene."""
    other = bpy.data.scenes.new("Second")
    other.camera = scene.camera
    other.collection.objects.link(scene.camera)
    other.collection.objects.link(subject)
    other.render.engine = "CYCLES"
    _compositing(scene, 0.0).scene = other


def group_mix(scene: Scene, subject: Object) -> None:
    """A compositor that shows a light group."""
    rendered.layer(scene).lightgroups.add(name="key")
    scene.objects["Sun"].lightgroup = "key"
    scene.render.engine = "CYCLES"
    layers = _compositing(scene, 0.0)
    exposure = next(n for n in layers.id_data.nodes if n.bl_idname == "CompositorNodeExposure")
    layers.id_data.links.new(layers.outputs["Combined_key"], exposure.inputs["Image"])


def grouped_compositor(scene: Scene, subject: Object) -> None:
    """An exposure inside a group."""
    layers = _compositing(scene, 0.0)
    tree = layers.id_data
    old = next(n for n in tree.nodes if n.bl_idname == "CompositorNodeExposure")
    group = bpy.data.node_groups.new("Grade", "CompositorNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Image", in_out=way, socket_type="NodeSocketColor")
    exposure = group.nodes.new("CompositorNodeExposure")
    exposure.inputs["Exposure"].default_value = -1.0
    group.links.new(group.nodes.new("NodeGroupInput").outputs[0], exposure.inputs["Image"])
    group.links.new(exposure.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    user = tree.nodes.new("CompositorNodeGroup")
    user.node_tree = group
    tree.links.new(layers.outputs["Image"], user.inputs[0])
    tree.links.new(user.outputs[0], old.outputs[0].links[0].to_socket)
    tree.nodes.remove(old)


def compositor(scene: Scene, subject: Object) -> None:
    """An exposure after the render."""
    _compositing(scene, 1.0)


def glare(scene: Scene, subject: Object) -> None:
    """A compositor that blurs."""
    tree = _compositing(scene, 0.5).id_data
    blur = tree.nodes.new("CompositorNodeBlur")
    if "size_x" in blur.bl_rna.properties:
        blur.size_x = blur.size_y = 8
    else:
        blur.inputs["Size"].default_value = (8.0, 8.0)
    exposure = next(n for n in tree.nodes if n.bl_idname == "CompositorNodeExposure")
    target = exposure.outputs[0].links[0].to_socket
    tree.links.new(exposure.outputs[0], blur.inputs["Image"])
    tree.links.new(blur.outputs[0], target)


def two_layers(scene: Scene, subject: Object) -> None:
    """A compositor that shows the second view layer."""
    scene.view_layers.new("Second")
    _compositing(scene, 0.0).layer = "Second"


def _compositing(scene: Scene, stops: float) -> Node:
    """Render Layers, Exposure, output; returns the first."""
    if compat.COMPOSITOR_IS_GROUP:
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Grading", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    layers, exposure = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeExposure")
    layers.scene = scene
    exposure.inputs["Exposure"].default_value = stops
    tree.links.new(layers.outputs["Image"], exposure.inputs["Image"])
    tree.links.new(exposure.outputs["Image"], output.inputs["Image"])
    return layers


HONORED: tuple[AddProperty, ...] = (
    film_exposure, pixel_aspect, transparent, camera_shift, view_settings, standard_view, orthographic,
    depth_of_field, camera_clip, scaled_camera, marked_camera, wide_filter, box_filter, percentage, no_bounces,
    unused_compositor, muted_compositor, white_balance, compositor, grouped_compositor,
)  # fmt: skip
"""The prediction shows what a render shows."""
REPORTED: dict[AddProperty, str] = {
    border: "The render border is left out",
    strips: "strips are left out",
    stereo: "Stereo is left out",
    motion_blur: "Motion blur is left out",
    freestyle: "Freestyle lines",
    view_curves: "curves are left out",
    two_layers: 'The compositor "',
    other_scene: 'The compositor "',
    group_mix: 'The compositor "',
    glare: 'The compositor "',
}
"""A note says what the prediction leaves out."""
