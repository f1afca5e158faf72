# SPDX-License-Identifier: GPL-3.0-or-later
"""A subject that was chosen once is meant by later looks too, until it is chosen anew."""

import bpy
import pytest
import vibe_render
from dump import contents, difference
from vibe_render.export import reading
from vibe_render.looks import transfer
from vibe_render.run.session import result
from vibe_render.scene.stage import DEMO_SUBJECT, build_demo
from vibe_render.scene.subject import SUBJECT_KEY, SubjectChoice, recall_subject, remember_subject

from proxy_renderer.schema import VibeError, preset

TEAL = preset.Preset("Teal", {"subject": [{"base_color": [0.0, 0.4, 0.4]}]}, {}, "teal")


@pytest.fixture
def still_life():
    """The demo's monkey among other things, with the add-on."""
    vibe_render.register()
    yield build_demo()
    vibe_render.unregister()


def painted(scene):
    """The materials that the last look has colored."""
    return {change.name.split("/")[1] for change in scene.vibe.changes}


def test_it_is_meant_by_the_next_preset_and_revert_forgets_it(still_life):
    before = contents()
    transfer.apply_preset(still_life, TEAL, SubjectChoice((DEMO_SUBJECT,)))
    assert painted(still_life) == {"Clay"}
    transfer.apply_preset(still_life, TEAL, SubjectChoice())
    assert painted(still_life) == {"Clay"}
    assert result.revert(still_life) == []
    assert difference(before, contents()) == {}
    assert recall_subject(still_life) == []


def test_it_stands_in_for_a_selection(still_life):
    bpy.ops.object.select_all(action="DESELECT")
    with pytest.raises(VibeError, match="Nothing is selected"):
        reading.read_scene(still_life, SubjectChoice(selected=True))
    remember_subject(still_life, [bpy.data.objects["Ring"]], SubjectChoice(("Ring",)))
    assert [o.name for o in reading.read_scene(still_life, SubjectChoice(selected=True)).analysis.objects] == ["Ring"]


def test_the_menu_makes_it_ours_again(still_life):
    remember_subject(still_life, [bpy.data.objects["Ring"]], SubjectChoice(("Ring",)))
    still_life.vibe.subject = "SELECTED"
    still_life.vibe.subject = "AUTO"
    assert recall_subject(still_life) == []


@pytest.mark.parametrize("stored", ["", "{", "3", '["Ring"', '[{"a": 1}]', 7, [1.0, 2.0]])
def test_nonsense_in_a_file_is_no_choice(still_life, stored):
    still_life[SUBJECT_KEY] = stored
    assert recall_subject(still_life) == []


def test_what_is_out_of_the_picture_is_not_asked_for(still_life):
    ring = bpy.data.objects["Ring"]
    remember_subject(still_life, [ring], SubjectChoice(("Ring",)))
    ring.hide_render = True
    assert DEMO_SUBJECT in [o.name for o in reading.read_scene(still_life, SubjectChoice()).analysis.objects]


def test_small_parts_of_a_subject_keep_their_looks(still_life):
    """A look for one thing goes onto what is as prominent, and what stays is listed."""
    rest = transfer.apply_preset(still_life, TEAL, SubjectChoice())
    assert "Brass" not in painted(still_life)
    assert any(line.startswith("Brass: shows too little") for line in rest)
