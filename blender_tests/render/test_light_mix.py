# SPDX-License-Identifier: GPL-3.0-or-later
"""Light mix: the layers of a render add up to it, and a mix is what Cycles renders with the lights mixed so."""

import bpy
import numpy as np
import pytest
import small_scenes as scenes
from dump import changes, difference, dump
from vibe_render.core import compat, rendered
from vibe_render.core.schema_import import schema
from vibe_render.render import bake, final_render, light_groups
from vibe_render.render.light_groups import LightMix
from vibe_render.run import light_mix, result
from vibe_render.scene import snapshot

SIZE = 48


@pytest.fixture
def mixed(addon):
    """A studio with a glowing cube, set up so that Cycles takes the same samples whatever the power of a light."""
    scene = bpy.context.scene
    for light in bpy.data.lights:
        light.energy *= 1.0 if light.type == "SUN" else 20.0
    glow(scene.objects["Subject"])
    linear(scene)
    return scene


def glow(obj):
    """The cube glows, and is sampled as a light however little; Cycles' own choice depends on its strength."""
    obj.data.materials[0].cycles.emission_sampling = "FRONT"
    inputs = scenes.shader(obj.data.materials[0]).inputs
    inputs["Emission Color"].default_value, inputs["Emission Strength"].default_value = ((1.0, 0.6, 0.2, 1.0), 0.4)


def linear(scene):
    scene.render.engine, cycles = "CYCLES", scene.cycles
    cycles.use_light_tree, cycles.light_sampling_threshold = False, 0.0
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = 0.0


def compositor_with_normals(scene):
    """An artist's compositing that uses another pass than the image."""
    tree = scenes.compositor(scene)
    rendered.layer(scene).use_pass_normal = True
    rendered.layer(scene).update_render_passes()
    layers = next(n for n in tree.nodes if n.bl_idname == "CompositorNodeRLayers")
    added = tree.nodes.new("ShaderNodeVectorMath")
    for number, name in enumerate(("Image", "Normal")):
        tree.links.new(layers.outputs[name], added.inputs[number])
    tree.links.new(added.outputs[0], compat.compositor_output(tree))


def render(scene, folder, samples=4, exact=True, number=0):
    """The picture's path, the layers, and the mix."""
    picture, lights = folder / f"after{number}.png", folder / f"lights{number}.exr"
    layers = final_render.render_picture(scene, picture, SIZE, samples, exact=exact, lights=lights)
    height, width, _ = bake.read_file(picture).shape
    return (
        picture,
        layers,
        LightMix(lights, rendered.layer(scene).name, [each.name for each in layers], (width, height)),
    )


@pytest.mark.parametrize("exact", [True, False])
def test_the_layers_add_up_to_the_same_picture_as_without_them(mixed, tmp_path, exact):
    compositor_with_normals(mixed)
    before = dump()
    final_render.render_picture(mixed, tmp_path / "plain.png", SIZE, 4, exact=exact)
    picture, layers, mix = render(mixed, tmp_path, exact=exact)
    assert {path for path in difference(before, dump()) if "Render Result" not in path} == set()
    plain, after = bake.read_file(tmp_path / "plain.png"), bake.read_file(picture)
    assert np.array_equal(plain, after)
    assert np.abs(mix.rest[..., :3]).max() < 1e-4  # all light is in a layer
    assert all(mix.layers[each.name].max() > 0.01 for each in layers)
    assert {each.title for each in layers} == {"Point", "Spot", "Area", "Sun", "World", "Emission"}
    mix.write(mixed, tmp_path / "mixed.png", {})
    apart = np.abs(bake.read_file(tmp_path / "mixed.png")[..., :3] - after[..., :3])
    assert apart.max() < 1.5 / 255  # a sum that ends between two levels is rounded up or down
    assert (apart > 0.0).mean() < 1e-3
    assert {path for path in difference(before, dump()) if "Render Result" not in path} == set()


def test_a_mix_is_a_new_render_with_the_lights_mixed_so(mixed, tmp_path):
    colors = {"Sun": (0.5, 0.5, 0.5), "Area": (3.0, 1.5, 0.6), "World": (0.2, 0.4, 1.0), "Emission": (2.0, 1.0, 2.0)}
    before = dump()
    _, layers, mix = render(mixed, tmp_path)
    channels = light_mix._channels(mixed, layers)
    assert light_mix.apply(mixed, channels, colors) == {}
    _, _, new = render(mixed, tmp_path, number=1)
    expected, got = mix.mixed(colors), new.mixed({})
    assert np.abs(expected - mix.mixed({})).mean() > 0.05
    assert np.abs(expected - got).max() < 1e-4 * max(1.0, got.max())
    assert bpy.data.lights["Area"].energy == pytest.approx(3.0 * 20.0 * 50.0, rel=1.0)  # the largest part is power
    assert result.revert(mixed) == []
    assert changes(before).keys() - {path for path in changes(before) if "Render Result" in path} == set()


def test_the_compositors_nodes_make_the_same_mix(mixed, tmp_path):
    colors = {"Sun": (0.0, 0.0, 0.0), "Area": (3.0, 1.5, 0.6)}
    mixed.cycles.use_denoising = False
    before = dump()
    _, layers, mix = render(mixed, tmp_path)
    channels = light_mix._channels(mixed, layers)
    mix.write(mixed, tmp_path / "expected.png", colors)
    light_mix.write_nodes(mixed, channels, colors)
    final_render.render_picture(mixed, tmp_path / "got.png", SIZE, 4, exact=True)
    expected, got = (bake.read_file(tmp_path / f"{name}.png")[..., :3] for name in ("expected", "got"))
    assert np.abs(expected - bake.read_file(tmp_path / "after0.png")[..., :3]).mean() > 0.02
    assert np.abs(expected - got).max() <= 1.5 / 255.0
    # Another mix replaces it, and Apply switches it off.
    other = {"Area": (0.5, 0.5, 0.5), "Spot": (4.0, 4.0, 4.0)}
    light_mix.write_nodes(mixed, channels, other)
    assert light_mix.mix.read_mix(mixed) == {"Sun": (1.0, 1.0, 1.0), **other}
    light_mix.apply(mixed, channels, other)
    assert light_mix.mix.read_mix(mixed) == {}
    assert snapshot.exists(mixed)
    assert result.revert(mixed) == []
    assert changes(before).keys() - {path for path in changes(before) if "Render Result" in path} == set()


def test_freestyle_lines_keep_nothing_that_revert_removes(mixed, tmp_path):
    mixed.render.use_freestyle = True
    rendered.layer(mixed).freestyle_settings.linesets.new("Lines")
    before = dump()
    channels = light_mix._channels(mixed, light_groups.light_layers(mixed))
    light_mix.write_nodes(mixed, channels, {"Sun": (0.5, 0.5, 0.5)})
    final_render.render_picture(mixed, tmp_path / "lines.png", SIZE, 1)
    assert result.revert(mixed) == []
    assert changes(before).keys() - {path for path in changes(before) if "Render Result" in path} == set()


def test_the_artists_light_groups_are_layers_of_their_own_and_stay(mixed, tmp_path):
    layer = rendered.layer(mixed)
    layer.lightgroups.add(name="Front")
    layer.lightgroups.add(name="Unused")
    for name in ("Area", "Spot"):
        mixed.objects[name].lightgroup = "Front"
    mixed.objects["Sun"].lightgroup = "Gone"  # a group that the view layer does not have
    before = dump()
    _, layers, mix = render(mixed, tmp_path)
    assert {path for path in difference(before, dump()) if "Render Result" not in path} == set()
    assert [mixed.objects[name].lightgroup for name in ("Area", "Spot", "Sun", "Point")] == [
        "Front",
        "Front",
        "Gone",
        "",
    ]
    assert [(each.name, each.own) for each in layers if each.own] == [("Front", True)]
    assert [each.title for each in layers] == ["Front", "Point", "Sun", "World", "Emission"]
    assert np.abs(mix.rest[..., :3]).max() < 1e-4
    light_mix.write_nodes(mixed, light_mix._channels(mixed, layers), {"Front": (2.0, 2.0, 2.0)})
    assert [group.name for group in layer.lightgroups] == ["Front", "Unused"]


@pytest.mark.parametrize(("lights", "world", "titles"), [(0, False, []), (0, True, ["World"]), (1, False, ["Bulb"])])
def test_few_lights(scene, tmp_path, lights, world, titles):
    scenes.cube(scene, "Cube")
    scenes.camera(scene)
    for _ in range(lights):
        scenes.light(scene, "POINT").name = "Bulb"
    if world:
        scenes.world(scene)
    assert [each.title for each in light_groups.light_layers(scene)] == titles
    _, layers, mix = render(scene, tmp_path, samples=1)
    assert list(mix.layers) == [each.name for each in layers]
    assert mix.mixed({}).shape[2] == 4


def test_many_lights_share_layers(scene, tmp_path):
    scenes.cube(scene, "Cube")
    scenes.camera(scene)
    for number in range(30):
        scenes.light(scene, "POINT", (number - 15.0, -4.0, 3.0)).name = (
            f"Bulb.{number:03}" if number < 15 else f"Own {'abcdefghijklmno'[number - 15]}"
        )
        bpy.data.lights[-1].energy = 10.0 * (number + 1)
    layers = light_groups.light_layers(scene)
    assert len(layers) == light_groups.MOST
    assert sum(len(each.members) for each in layers) == 30
    assert "Bulb (15)" in [each.title for each in layers]
    _, layers, mix = render(scene, tmp_path)
    assert np.abs(mix.rest[..., :3]).max() < 1e-4 * mix.mixed({}).max()


def test_a_material_in_two_layers_is_left_alone(mixed, tmp_path):
    other = scenes.cube(mixed, "Other", (3.0, 0.0, 0.5))
    other.data.materials.append(mixed.objects["Subject"].data.materials[0])
    rendered.layer(mixed).lightgroups.add(name="Signs")
    other.lightgroup = "Signs"
    layers = light_groups.light_layers(mixed)
    channels = {each.title: each for each in light_mix._channels(mixed, layers)}
    assert channels["Signs"].values == channels["Emission"].values == {}


def test_a_light_without_a_strength_gets_all_in_its_color():
    values = {"world/color": (0.5, 0.5, 0.5)}
    assert light_mix.mixed_values(values, (2.0, 1.0, 0.0)) == {"world/color": (1.0, 0.5, 0.0)}
    with_strength = {**values, "world/strength": (3.0,)}
    assert light_mix.mixed_values(with_strength, (2.0, 1.0, 0.0)) == {
        "world/color": (0.5, 0.25, 0.0),
        "world/strength": (6.0,),
    }
    off = light_mix.mixed_values(with_strength, (0.0, 0.0, 0.0))
    assert off == {"world/color": (0.5, 0.5, 0.5), "world/strength": (0.0,)}


def test_a_scene_without_light_says_so(addon, tmp_path):
    for obj in [o for o in addon.objects if o.type == "LIGHT"]:
        bpy.data.objects.remove(obj)
    addon.world = None
    with pytest.raises(schema.VibeError, match="no light to mix"):
        light_mix.RenderedMix(addon)
