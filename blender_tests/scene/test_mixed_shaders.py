# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as people build them: the value that an artist would drag is the one that changes, and comes back."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from dump import difference, dump
from marks import few_of
from vibe_render.scene import bindings, snapshot
from vibe_render.scene.nodes import layers, owned
from vibe_render.scene.nodes.inputs import TINT

PIVOT = (0.0, 0.0, 0.0)
BLUE = (0.02, 0.05, 0.4)
RED, GRAY, GREEN = (0.8, 0.1, 0.05, 1.0), (0.8, 0.8, 0.8, 1.0), (0.1, 0.5, 0.1, 1.0)


@pytest.fixture
def subject(scene):
    return scenes.studio(scene)


@pytest.fixture
def tree(subject):
    """The tree of the subject's material, with nothing but its output."""
    nodes = bpy.data.materials["Body"].node_tree
    nodes.nodes.remove(scenes.shader(bpy.data.materials["Body"]))
    return nodes


def node(tree, kind, **inputs):
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        put(tree, value, made.inputs[name])
    return made


def put(tree, value, socket):
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, socket)
    elif isinstance(value, bpy.types.Node):
        tree.links.new(value.outputs[0], socket)
    else:
        socket.default_value = value


def joined(tree, kind, *parts, fac=None):
    """A Mix or Add Shader."""
    made = node(tree, f"{kind}Shader")
    for entry, part in zip(made.inputs[1 if kind == "Mix" else 0 :], parts, strict=False):
        put(tree, part, entry)
    if fac is not None:
        put(tree, fac, made.inputs[0])
    return made


def shown(tree, shader):
    put(tree, shader, tree.nodes["Material Output"].inputs["Surface"])
    return shader


def write(scene, subject, **values):
    keyed = {f"material/Body/{name}": np.atleast_1d(value) for name, value in values.items()}
    assert bindings.write(scene, keyed, subject, PIVOT) == {}


def color_of(socket):
    return tuple(socket.default_value[:3])


def layered(tree, kind):
    """Mixes that people build, each with the shader whose color is the material's."""
    n = tree
    if kind == "plastic by Fresnel":
        body = node(n, "BsdfDiffuse", Color=RED)
        return body, joined(n, "Mix", body, node(n, "BsdfGlossy", Color=GRAY), fac=node(n, "Fresnel"))
    if kind == "plastic, glossy first":
        body = node(n, "BsdfDiffuse", Color=RED)
        return body, joined(n, "Mix", node(n, "BsdfGlossy", Color=GRAY), body, fac=0.6)
    if kind == "car paint":
        body = node(n, "BsdfGlossy", Color=RED, Roughness=0.5)
        coat = node(n, "BsdfGlossy", Color=GRAY, Roughness=0.1)
        return body, joined(n, "Mix", body, coat, fac=node(n, "LayerWeight").outputs["Fresnel"])
    if kind == "glow added":
        body = node(n, "BsdfPrincipled")
        body.inputs["Base Color"].default_value = RED
        return body, joined(n, "Add", node(n, "Emission", Strength=2.0), body)
    if kind == "glass with a clear shadow":
        body = node(n, "BsdfGlass", Color=GREEN)
        fac = node(n, "LightPath").outputs["Is Shadow Ray"]
        return body, joined(n, "Mix", body, node(n, "BsdfTransparent"), fac=fac)
    if kind == "leaf":
        body = node(n, "BsdfDiffuse", Color=GREEN)
        inner = joined(n, "Mix", node(n, "BsdfTranslucent", Color=GRAY), body, fac=0.8)
        return body, joined(n, "Mix", node(n, "BsdfTransparent"), inner, fac=node(n, "TexNoise").outputs[0])
    body = node(n, "BsdfDiffuse", Color=RED)  # three deep
    inner = joined(n, "Mix", body, node(n, "BsdfSheen", Color=GRAY), fac=0.2)
    outer = joined(n, "Mix", inner, node(n, "BsdfGlossy", Color=GRAY), fac=0.3)
    return body, joined(n, "Mix", outer, node(n, "BsdfTranslucent", Color=GRAY), fac=0.1)


KINDS = (
    "plastic by Fresnel", "plastic, glossy first", "car paint", "glow added",
    "glass with a clear shadow", "leaf", "three deep",
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_the_color_is_that_of_the_shader_that_shows(scene, subject, tree, kind):
    body, end = layered(tree, kind)
    shown(tree, end)
    before = dump()
    write(scene, subject, base_color=BLUE)
    assert color_of(body.inputs[0]) == pytest.approx(BLUE)
    others = [n for n in tree.nodes if n != body and n.bl_idname.startswith("ShaderNodeBsdf")]
    assert all(color_of(n.inputs[0]) != pytest.approx(BLUE) for n in others)
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_matte_car_paint_of_nodes_loses_its_lacquer(scene, subject, tree):
    body, end = layered(tree, "car paint")
    lacquer = next(n for n in tree.nodes if n.bl_label == "Glossy BSDF" and n != body)
    lacquer.inputs["Color"].default_value = (0.8, 0.4, 0.4, 1.0)
    shown(tree, end)
    before = dump()
    assert bindings.read(scene, subject, PIVOT)["material/Body/coat"] == pytest.approx((0.8,))
    assert bindings.read(scene, subject, PIVOT)["material/Body/coat_roughness"] == pytest.approx((0.1,))
    write(scene, subject, coat=0.2, coat_roughness=0.6)
    assert color_of(lacquer.inputs["Color"]) == pytest.approx((0.2, 0.1, 0.1))
    assert lacquer.inputs["Roughness"].default_value == pytest.approx(0.6)
    assert color_of(body.inputs["Color"]) == pytest.approx(RED[:3])
    assert body.inputs["Roughness"].default_value == pytest.approx(0.5)
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_the_roughness_of_plastic_is_its_coats_and_the_glow_the_emissions(scene, subject, tree):
    gloss = node(tree, "BsdfGlossy", Color=GRAY)
    plastic = joined(tree, "Mix", node(tree, "BsdfDiffuse", Color=RED), gloss, fac=0.1)
    glow = node(tree, "Emission", Strength=0.5)
    shown(tree, joined(tree, "Add", plastic, glow))
    write(scene, subject, roughness=0.3, emission=4.0, emission_color=BLUE)
    assert gloss.inputs["Roughness"].default_value == pytest.approx(0.3)
    assert glow.inputs["Strength"].default_value == 4.0
    assert color_of(glow.inputs["Color"]) == pytest.approx(BLUE)


def test_a_principled_shader_behind_a_value_is_not_the_surface(scene, subject, tree):
    shown(tree, node(tree, "Emission", Color=RED))
    assert layers.by_prominence(bpy.data.materials["Body"])[0].shader.node.bl_idname == "ShaderNodeEmission"
    assert "material/Body/base_color" not in bindings.read(scene, subject, PIVOT)


def test_a_muted_mix_is_its_first_shader(scene, subject, tree):
    parts = [node(tree, "BsdfDiffuse", Color=color) for color in (RED, GREEN)]
    shown(tree, joined(tree, "Mix", *parts, fac=0.9)).mute = True
    write(scene, subject, base_color=BLUE)
    assert color_of(parts[0].inputs["Color"]) == pytest.approx(BLUE)
    assert color_of(parts[1].inputs["Color"]) == pytest.approx(GREEN[:3])


def test_an_rgb_node_of_mixed_shaders_is_dragged(scene, subject, tree):
    paint = node(tree, "RGB")
    parts = [node(tree, kind, Color=paint) for kind in ("BsdfDiffuse", "SubsurfaceScattering")]
    shown(tree, joined(tree, "Mix", *parts, fac=0.3))
    write(scene, subject, base_color=BLUE)
    assert color_of(paint.outputs[0]) == pytest.approx(BLUE)
    assert not [n for n in tree.nodes if n.name.startswith("Vibe")]


def test_an_rgb_node_that_means_something_else_too_is_left_alone(scene, subject, tree):
    paint, bump = node(tree, "RGB"), node(tree, "Bump")
    paint.outputs[0].default_value = RED
    tree.links.new(paint.outputs[0], bump.inputs["Height"])
    parts = [node(tree, k, Color=paint, Normal=bump) for k in ("BsdfDiffuse", "BsdfTranslucent")]
    shown(tree, joined(tree, "Mix", *parts, fac=0.3))
    before = dump()
    write(scene, subject, base_color=BLUE)
    assert color_of(paint.outputs[0]) == pytest.approx(RED[:3])
    sources = {part.inputs["Color"].links[0].from_node for part in parts}
    assert len(sources) == 1
    assert color_of(sources.pop().outputs[0]) == pytest.approx(BLUE)
    assert bump.inputs["Height"].links[0].from_node == paint
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_a_texture_of_mixed_shaders_is_tinted_once_and_its_bump_is_not(scene, subject, tree):
    noise, bump = node(tree, "TexNoise"), node(tree, "Bump")
    tree.links.new(noise.outputs["Color"], bump.inputs["Height"])
    color = noise.outputs["Color"]
    parts = [node(tree, k, Color=color, Normal=bump) for k in ("BsdfDiffuse", "BsdfTranslucent")]
    shown(tree, joined(tree, "Mix", *parts, fac=0.5))
    before = dump()
    write(scene, subject, tint=BLUE, recolor=1.0)
    (ours,) = owned.group_nodes(tree, TINT.name)
    assert {part.inputs["Color"].links[0].from_node for part in parts} == {ours}
    assert bump.inputs["Height"].links[0].from_node == noise
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_colors_that_are_mixed_are_tinted_each(scene, subject, tree):
    """Two paints by a mask: tinting one of them would leave the other's color."""
    parts = [node(tree, "BsdfDiffuse", Color=color) for color in (RED, GREEN)]
    shown(tree, joined(tree, "Mix", *parts, fac=node(tree, "TexNoise").outputs[0]))
    before = dump()
    assert "material/Body/base_color" not in bindings.read(scene, subject, PIVOT)
    write(scene, subject, tint=BLUE, recolor=1.0)
    ours = owned.group_nodes(tree, TINT.name)
    assert [color_of(n.inputs["Color"]) for n in ours] == [pytest.approx(c[:3]) for c in (RED, GREEN)]
    assert all(color_of(n.inputs["Tint"]) == pytest.approx(BLUE) for n in ours)
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def nested(tree, name="Outer"):
    """A Diffuse BSDF two groups deep, with a color of its own; used by the material Ground too."""
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    outer = bpy.data.node_groups.new(name, "ShaderNodeTree")
    body = node(inner, "BsdfDiffuse", Color=RED)
    for group, last in ((inner, body), (outer, None)):
        group.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
        end = group.nodes.new("NodeGroupOutput")
        if last is None:
            last = group.nodes.new("ShaderNodeGroup")
            last.node_tree = inner
        group.links.new(last.outputs[0], end.inputs[0])
    for each in (tree, bpy.data.materials["Ground"].node_tree):
        holder = each.nodes.new("ShaderNodeGroup")
        holder.node_tree = outer
        shown(each, holder)
    return body


def test_a_shared_group_is_copied_and_other_materials_stay(scene, subject, tree):
    body = nested(tree)
    before = dump()
    write(scene, subject, base_color=BLUE)
    values = bindings.read(scene, subject, PIVOT)
    assert values["material/Body/base_color"] == pytest.approx(BLUE)
    assert values["material/Ground/base_color"] == pytest.approx(RED[:3])
    assert color_of(body.inputs["Color"]) == pytest.approx(RED[:3])
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_both_materials_of_a_shared_group_get_their_own_values(scene, subject, tree):
    nested(tree)
    values = {"material/Body/base_color": BLUE, "material/Ground/base_color": GREEN[:3]}
    before = dump()
    with bindings.trial(scene, values, subject, PIVOT) as rest:
        read = bindings.read(scene, subject, PIVOT)
        assert rest == {}
        assert [read[key] for key in values] == [pytest.approx(value) for value in values.values()]
    assert difference(before, dump()) == {}


def test_a_group_of_a_library_is_copied_too(scene, subject, tree, tmp_path):
    nested(tree, "Painted")
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {bpy.data.node_groups["Painted"]}, fake_user=True)
    with bpy.data.libraries.load(path, link=True) as (_, here):
        here.node_groups = ["Painted"]
    holder = next(n for n in tree.nodes if n.type == "GROUP")
    holder.node_tree = here.node_groups[0]
    before = dump()
    write(scene, subject, base_color=BLUE)
    assert holder.node_tree.library is None
    assert bindings.read(scene, subject, PIVOT)["material/Body/base_color"] == pytest.approx(BLUE)
    assert snapshot.revert(scene) == []
    assert holder.node_tree.library
    changed = {path for path in difference(before, dump()) if not path.endswith("is_library_indirect")}
    assert not changed  # Blender finds out anew at saving what is linked by what


def test_a_computed_glow_is_tinted(scene, subject, tree):
    ramp = node(tree, "ValToRGB", Fac=node(tree, "TexNoise"))
    glow = shown(tree, node(tree, "Emission", Color=ramp))
    before = dump()
    write(scene, subject, emission_color=BLUE, emission=3.0)
    (ours,) = owned.group_nodes(tree, TINT.name)
    assert color_of(ours.inputs["Tint"]) == pytest.approx(BLUE)
    assert glow.inputs["Color"].links[0].from_node == ours
    assert snapshot.revert(scene) == []
    assert difference(before, dump()) == {}


def test_a_copied_group_is_given_back_after_saving_and_reopening(scene, subject, tree, tmp_path):
    nested(tree)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "before.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "before.blend"))  # drops what nothing uses
    before = {path: value for path, value in dump().items() if "node_groups" in path or "materials" in path}
    here = bpy.context.scene
    write(here, [bpy.data.objects["Subject"]], base_color=BLUE)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "after.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "after.blend"))
    assert snapshot.revert(bpy.context.scene) == []
    after = {path: value for path, value in dump().items() if "node_groups" in path or "materials" in path}
    assert difference(before, after) == {}


SOURCES = ("ValToRGB", "HueSaturation", "Mix", "Attribute", "VertexColor", "TexGradient", "TexVoronoi")
SHADERS = ("BsdfDiffuse", "BsdfGlossy", "BsdfGlass", "BsdfTranslucent", "BsdfToon", "SubsurfaceScattering")


@pytest.mark.parametrize("grouped", few_of([False, True], [True]))
@pytest.mark.parametrize("kind", SOURCES)
def test_every_computed_color_of_every_shader_is_tinted(scene, subject, tree, kind, grouped):
    """Of shaders in a group that another material uses, too."""
    where = tree
    if grouped:
        nested(tree)
        (holder,) = (n for n in tree.nodes if n.type == "GROUP")
        where = next(n for n in holder.node_tree.nodes if n.type == "GROUP").node_tree
    source = node(where, kind)
    if kind == "Mix":
        source.data_type = "RGBA"
    color = next(s for s in source.outputs if s.type == "RGBA" and s.enabled)
    for shader in SHADERS:
        body = node(where, shader, Color=color)
        if grouped:
            end = next(n for n in where.nodes if n.type == "GROUP_OUTPUT")
            where.links.new(body.outputs[0], end.inputs[0])
        else:
            shown(tree, body)
        before = dump()
        write(scene, subject, tint=BLUE, recolor=1.0)
        assert bindings.read(scene, subject, PIVOT)["material/Body/tint"] == pytest.approx(BLUE)
        if grouped:
            assert bindings.read(scene, subject, PIVOT)["material/Ground/tint"] == (1.0, 1.0, 1.0)
        assert snapshot.revert(scene) == []
        assert difference(before, dump()) == {}
        where.nodes.remove(body)
