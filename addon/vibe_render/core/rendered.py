# SPDX-License-Identifier: GPL-3.0-or-later
"""Content of a scene's render: the only module that asks Blender which objects, lights and settings count.

A scene is rendered through its first view layer in use. `docs/develop/what-is-rendered.md` has a row for each property.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import bpy
from bpy.types import Collection, Material, NodeTree, Object, Scene, ViewLayer, World
from mathutils import Matrix, Vector

from . import compat

MARK = "vibe_owned"  # the custom property by which Vibe Render knows what it has added
GEOMETRY = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD"}
FILM = "film"  # stands for the film among kinds of rays: a holdout is hidden from it
_RAYS = ("camera", "diffuse", "glossy", "transmission", "shadow")
_LIT = ("diffuse", "glossy", "transmission")

# --- objects ----------------------------------------------------------------------------------------


def layer(scene: Scene) -> ViewLayer:
    """The first view layer that is used for rendering; the first of all if none is."""
    return next((each for each in scene.view_layers if each.use), scene.view_layers[0])


def scenes(scene: Scene) -> list[Scene]:
    """The scene and its background sets, which a render shows too."""
    found = [scene]
    while (behind := found[-1].background_set) and behind not in found:
        found.append(behind)
    return found


def shown(scene: Scene) -> set[Object]:
    """The objects that a render shows, those of background sets too."""
    # One of an object's collections must be shown: neither it nor one around it is disabled, and the layer has it.
    found: set[Object] = set()
    for each in scenes(scene):
        here = set(filter(None, layer(each).objects))  # an object removed just now is there as None
        enabled = (o for c in _enabled(each.collection) for o in c.objects)
        found |= {o for o in enabled if o in here and not o.hide_render}
    return found


def _enabled(collection: Collection) -> Iterator[Collection]:
    if not collection.hide_render:
        yield collection
        for child in collection.children:
            yield from _enabled(child)


def depsgraph(scene: Scene) -> bpy.types.Depsgraph:
    """The updated dependency graph of the scene's rendered view layer."""
    chosen = layer(scene)
    chosen.update()
    return chosen.depsgraph


def instances(scene: Scene) -> Iterator[tuple[Object, Object | None, Matrix]]:
    """Yields (object, instancer or None, world matrix) for all that a render shows.

    Objects that the viewport shows are evaluated, others are not.
    """
    objects = shown(scene)
    seen = set()
    for item in depsgraph(scene).object_instances:
        original, instancer = item.object.original, item.parent.original if item.parent else None
        seen.add(instancer or original)
        by_nodes = instancer is not None and instancer.instance_type == "NONE"  # geometry nodes or particles
        hidden = original.hide_render and not by_nodes
        shows = original.show_instancer_for_render if original.is_instancer else item.show_self
        if shows and (instancer or original) in objects and not hidden:
            yield item.object, instancer, item.matrix_world.copy()
    for obj in sorted(objects - seen, key=lambda each: each.name_full):  # the viewport hides them
        yield obj, None, obj.matrix_world.copy()


def is_finite(matrix: Matrix) -> bool:
    """True if all numbers of an object's matrix are finite; with broken drivers or constraints they may not be."""
    return all(math.isfinite(v) for row in matrix for v in row)


def hidden_from(thing: Object, of: ViewLayer) -> frozenset[str]:
    """The kinds of rays that pass through an object and its instances; has `FILM` for a holdout."""
    rays = {ray for ray in _RAYS if not getattr(thing, f"visible_{ray}")}
    if thing.original.indirect_only_get(view_layer=of):
        rays.add("camera")
    # A holdout stops all rays, but leaves a hole in the image.
    if thing.original.holdout_get(view_layer=of) or all(map(is_holdout, worn(thing, of))):
        rays.add(FILM)
    return frozenset(rays)


def frustum(scene: Scene) -> Matrix | None:
    """The matrix from world space to the clip space of the scene's camera; None without a camera."""
    camera, render = scene.camera, scene.render
    if camera is None or camera.type != "CAMERA":
        return None
    size = {"x": render.resolution_x, "y": render.resolution_y}
    aspect = {"scale_x": render.pixel_aspect_x, "scale_y": render.pixel_aspect_y}
    projection = camera.calc_matrix_camera(layer(scene).depsgraph, **size, **aspect)
    return projection @ camera.matrix_world.normalized().inverted()


def in_frame(to_clip: Matrix, thing: Object, matrix: Matrix) -> bool:
    """True unless the bounding box of an object at world `matrix` is outside the view; `to_clip`: from `frustum`."""
    corners = [to_clip @ matrix @ Vector((*corner, 1.0)) for corner in thing.bound_box]
    sides = [(axis, sign) for axis in range(3) for sign in (1.0, -1.0)]
    return not any(all(sign * c[axis] > c.w for c in corners) for axis, sign in sides)


# --- surfaces ---------------------------------------------------------------------------------------


def worn(thing: Object, of: ViewLayer) -> list[Material | None]:
    """The material of each slot of an object in renders of a view layer; at least one entry, which may be None."""
    if override := of.material_override:
        return [override.original]
    slots = [slot.material for slot in thing.material_slots] or list(getattr(thing.data, "materials", None) or ())
    return [m.original if m else None for m in slots] or [None]


def override_lock(scene: Scene) -> str:
    """Lock reason of all materials of a scene if its view layer overrides them; "" without such an override."""
    override = layer(scene).material_override
    if override is None:
        return ""
    return f'the view layer "{layer(scene).name}" shows "{override.name}" in place of all materials'


def has_surface(material: Material | None) -> bool:
    """True if a material shows a surface; a box of fog has none."""
    output = compat.output_node(material)
    return output is None or output.inputs["Surface"].is_linked or not output.inputs["Volume"].is_linked


def is_holdout(material: Material | None) -> bool:
    """True if a material's surface is nothing but a Holdout."""
    output = compat.output_node(material)
    links = output.inputs["Surface"].links if output else ()
    return any(link.from_node.bl_idname == "ShaderNodeHoldout" for link in links)


def surface_note(thing: Object, of: ViewLayer) -> str:
    """A note on an object that a render does not show as a plain surface; "" for others."""
    if FILM in hidden_from(thing, of):
        return f"{thing.name} is a holdout: words about it cannot be visible."
    if thing.is_shadow_catcher:
        return f"{thing.name} is a shadow catcher: the prediction shows it as a plain surface."
    return ""


# --- lights -----------------------------------------------------------------------------------------


def is_portal(obj: Object) -> bool:
    """True if a light is a portal, which guides the world's light and gives none."""
    return obj.data.type == "AREA" and obj.data.cycles.is_portal


def _shines(obj: Object) -> bool:
    return obj.type == "LIGHT" and not is_portal(obj)


def lights(scene: Scene) -> list[Object]:
    """The scene's own lights that a render shows, sorted by name; without portals and lights whose matrix is not finite."""
    found = [o for o in shown(scene) & {*scene.objects} if _shines(o) and is_finite(o.matrix_world)]
    return sorted(found, key=lambda o: o.name_full)


def instanced_lights(scene: Scene) -> list[tuple[Object, Matrix]]:
    """(light, world matrix) for instanced lights (of collections, geometry nodes) and lights of background sets."""
    here = set(scene.objects)
    return [
        (thing.original, matrix)
        for thing, instancer, matrix in instances(scene)
        if _shines(thing) and (instancer or thing.original not in here) and is_finite(matrix)
    ]


def unlit_rays(light: Object) -> list[str]:
    """The kinds of rays to which a light is invisible, of "diffuse", "glossy" and "transmission"."""
    return [ray for ray in _LIT if not getattr(light, f"visible_{ray}")]


def world(scene: Scene) -> World | None:
    """The world that a render shows: the view layer's override, or the scene's; None if the layer leaves it out."""
    of = layer(scene)
    return (of.world_override or scene.world) if of.use_sky else None


def unlit_by(world: World | None) -> list[str]:
    """The kinds of rays to which a world is invisible, of "camera" and those of `unlit_rays`; [] for no world."""
    return [ray for ray in ("camera", *_LIT) if world and not getattr(world.cycles_visibility, ray)]


def set_world(scene: Scene, new: World | None, put: Callable[[Any, str, Any], None] = setattr) -> None:
    """Makes renders show the world `new` (None: none); `put` sets a property, as `setattr` or `Journal.set` does."""
    of = layer(scene)
    if new is not None and not of.use_sky:
        put(of, "use_sky", True)
    if of.world_override:
        put(of, "world_override", new)
        if new is not None:
            return
    put(scene, "world", new)


def world_users(block: World) -> int:
    """The number of scenes and view layers that render with a world."""
    users = [s.world for s in bpy.data.scenes]
    users += [each.world_override for s in bpy.data.scenes for each in s.view_layers]
    return users.count(block)


# --- the image --------------------------------------------------------------------------------------


def image_notes(scene: Scene) -> list[str]:
    """Notes for the artist on settings of the whole image that the prediction leaves out."""
    view, render, cycles = scene.view_settings, scene.render, scene.cycles
    culls = render.use_simplify and (cycles.use_camera_cull or cycles.use_distance_cull)
    strips = render.use_sequencer and getattr(scene.sequence_editor, "strips", ())
    in_place = override_lock(scene).replace("the", "The", 1)
    settings = {
        "The view transform's curves are left out of the prediction.": view.use_curve_mapping,
        "Motion blur is left out of the prediction.": render.use_motion_blur,
        "Freestyle lines are in the pictures, not in the prediction.": render.use_freestyle,
        "The render border is left out: the whole picture is predicted and rendered.": render.use_border,
        "Stereo is left out: the picture is what the camera itself sees.": render.use_multiview,
        "The sequencer's strips are left out: the picture is the scene's own render.": strips,
        "Culling by Simplify is left out: the prediction shows culled objects too.": culls,
        f"{in_place}: words about materials cannot be visible. "
        "Remove the material override, or ask for light only.": in_place,
    }
    return [note for note, used in settings.items() if used]


def changing_compositor(scene: Scene) -> NodeTree | None:
    """The compositor tree, if it changes the rendered view layer by more than Vibe Render's grade; otherwise None."""
    tree = compat.compositor(scene)
    socket = compat.compositor_output(tree) if tree else None
    while socket is not None and (links := [link for link in socket.links if not link.is_muted]):
        node = links[0].from_node
        if node.bl_idname == "CompositorNodeRLayers":
            first = node.layer == layer(scene).name and links[0].from_socket.name == "Image"
            return None if first and node.scene in (None, scene) else tree
        ours = node.type == "GROUP" and node.node_tree and MARK in node.node_tree
        if not (ours or node.type == "REROUTE" or node.mute):
            return tree
        socket = node.inputs[0]
    return None  # nothing reaches the output: the render is black, which is reported elsewhere
