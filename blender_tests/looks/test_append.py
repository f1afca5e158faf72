# SPDX-License-Identifier: GPL-3.0-or-later
"""Things of a vibed file in another one: they come as they look, and are not ours to revert there.

A vibe of the other scene leads back to exactly what it was.
"""

import bpy
import pytest
import small_scenes as scenes
from dump import changes, dump
from results import vibe
from vibe_render.scene import snapshot


@pytest.fixture(params=scenes.ALL)
def library(request, scene, tmp_path):
    """A vibed file."""
    path = tmp_path / "vibed.blend"
    vibe(scene, scenes.ALL[request.param](scene), 0.6)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return path


def bring(path, link):
    """All objects of a file, among those of the open scene."""
    with bpy.data.libraries.load(str(path), link=link) as (there, here):
        here.objects = there.objects
    for thing in here.objects:
        bpy.context.scene.collection.objects.link(thing)
    return here.objects


@pytest.mark.parametrize("link", [False, True], ids=["append", "link"])
def test_objects_in_another_file(library, link):
    held, scene = library.read_bytes(), bpy.context.scene
    subject = scenes.studio(scene)
    brought = bring(library, link)
    assert len(brought) > 3
    assert not snapshot.exists(scene)
    before = dump()
    vibe(scene, subject, 0.3)
    assert len(changes(before)) > 50
    assert snapshot.revert(scene) == []
    assert changes(before) == {}
    assert library.read_bytes() == held


@pytest.mark.parametrize("link", [False, True], ids=["append", "link"])
def test_an_empty_scene_of_such_objects_alone(library, link):
    """Also the camera, the lights and the fog box are the ones that the first vibe made, or changed."""
    scene = bpy.context.scene
    brought = bring(library, link)
    scene.camera = next(thing for thing in brought if thing.type == "CAMERA")
    before = dump()
    vibe(scene, [thing for thing in brought if thing.type == "MESH"][:1], 0.3)
    assert changes(before)
    assert snapshot.revert(scene) == []
    assert changes(before) == {}
