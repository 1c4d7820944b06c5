"""Operators, panels and registration, as Blender's buttons call them."""

from types import SimpleNamespace

import bpy
import pytest

import nested_dielectric as nd
from nested_dielectric import media, operators, panels, registration


@pytest.fixture(autouse=True)
def registered():
    """The extension is registered in an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    nd.register()
    yield
    nd.unregister()


def add_cube(name, x=0.0):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(x, 0.0, 0.0))
    bpy.context.object.name = name
    return bpy.context.object


def add_media(**priorities):
    """Cubes of water with priorities of their own, or, where that is None, with that of water."""
    cubes = [add_cube(name) for name in priorities]
    for cube, priority in zip(cubes, priorities.values()):
        nd.assign(cube, "water", priority)
    return cubes


def priorities():
    return {obj.name: nd.get_priority(obj) for obj in bpy.context.scene.objects}


def in_blender():
    """What the extension has put into Blender."""
    classes = {cls for cls in (*operators.CLASSES, *panels.CLASSES) if cls.is_registered}
    menus = bpy.types.VIEW3D_MT_object._dyn_ui_initialize().count(operators.draw_preset_menu)
    handlers = bpy.app.handlers.render_init[:].count(registration.warn_before_render)
    return len(classes), menus, handlers, hasattr(bpy.types.Scene, "nested_dielectric_active")


def test_registering_twice_changes_nothing():
    once = in_blender()
    nd.register()
    assert in_blender() == once == (len(operators.CLASSES) + len(panels.CLASSES), 1, 1, True)


def test_unregistering_leaves_no_classes_behind():
    nd.unregister()
    assert in_blender() == (0, 0, 0, False)
    assert not [name for name in dir(bpy.types) if name.upper().startswith("NESTED_DIELECTRIC")]
    nd.unregister()
    nd.register()
    assert in_blender() == (len(operators.CLASSES) + len(panels.CLASSES), 1, 1, True)


def test_a_registration_that_fails_raises_and_leaves_nothing_behind(monkeypatch):
    def fail(*_):
        raise ValueError("no more commands")

    nd.unregister()
    monkeypatch.setattr(registration.bpy.utils, "register_cli_command", fail)
    with pytest.raises(ValueError, match="no more commands"):
        nd.register()
    assert in_blender() == (0, 0, 0, False)


def test_an_unsupported_blender_still_gets_the_panels_and_says_why(monkeypatch, capsys):
    nd.unregister()
    monkeypatch.setattr(registration, "blender_problem", lambda: "this Blender cannot")
    nd.register()
    assert in_blender()[0] == len(operators.CLASSES) + len(panels.CLASSES)
    assert capsys.readouterr().err == "Nested Dielectric: this Blender cannot\n"


def test_a_preset_goes_to_every_selected_solid_and_to_nothing_else():
    first, second, third = (add_cube(name) for name in "ABC")
    bpy.ops.object.camera_add()
    for obj in (first, third):
        obj.select_set(True)
    assert bpy.ops.nested_dielectric.assign_preset(preset="ice") == {"FINISHED"}
    assert [len(obj.material_slots) for obj in (first, second, third)] == [1, 0, 1]
    assert first.active_material == third.active_material == bpy.data.materials["Ice"]


def test_a_preset_goes_to_the_active_object_when_none_is_selected():
    cube = add_cube("A")
    cube.select_set(False)
    bpy.ops.nested_dielectric.assign_preset(preset="glass")
    assert cube.active_material.name == "Glass"


def test_presets_are_greyed_out_where_nothing_can_be_a_medium():
    bpy.ops.object.camera_add()
    assert not bpy.ops.nested_dielectric.assign_preset.poll()


def test_operators_are_greyed_out_in_a_blender_that_cannot_render_media(monkeypatch):
    add_cube("A")
    monkeypatch.setattr(operators, "blender_problem", lambda: "this Blender cannot")
    assert not bpy.ops.nested_dielectric.assign_preset.poll()
    assert not bpy.ops.nested_dielectric.prepare.poll()


def test_undo_takes_a_preset_and_a_priority_back():
    add_cube("A")
    bpy.ops.ed.undo_push(message="cube")
    bpy.ops.nested_dielectric.assign_preset("EXEC_DEFAULT", True, preset="water")
    bpy.ops.nested_dielectric.priority_own("EXEC_DEFAULT", True)
    assert media.own_priority(bpy.data.objects["A"]) == 30
    bpy.ops.ed.undo()
    assert media.own_priority(bpy.data.objects["A"]) is None
    bpy.ops.ed.undo()
    assert not bpy.data.objects["A"].material_slots
    bpy.ops.ed.redo()
    assert priorities() == {"A": 30}


def test_a_medium_moves_up_and_down_the_winning_order():
    add_media(A=1, B=2, C=3)
    bpy.ops.nested_dielectric.priority_move(name="C", direction="UP")
    assert priorities() == {"A": 1, "C": 2, "B": 3}
    bpy.ops.nested_dielectric.priority_move(name="A", direction="DOWN")
    assert priorities() == {"C": 1, "A": 2, "B": 3}


def test_the_first_medium_cannot_move_further_up():
    add_media(A=1, B=2)
    assert bpy.ops.nested_dielectric.priority_move(name="A", direction="UP") == {"CANCELLED"}


def test_without_a_name_the_active_object_moves():
    add_media(A=1, B=2)
    bpy.ops.nested_dielectric.priority_move(direction="UP")
    assert priorities() == {"B": 1, "A": 2}


def test_an_own_priority_starts_at_the_one_in_force_and_returns_to_that_of_the_material():
    (water,) = add_media(A=None)
    bpy.ops.nested_dielectric.priority_own(name="A")
    assert media.own_priority(water) == 30
    nd.set_priority(water, 7)
    bpy.ops.nested_dielectric.priority_own(name="A")
    assert media.own_priority(water) is None
    assert nd.get_priority(water) == 30


def test_an_object_that_is_no_medium_is_named_in_the_error():
    add_cube("Wall")
    with pytest.raises(RuntimeError, match="'Wall' is no medium of scene 'Scene'"):
        bpy.ops.nested_dielectric.priority_own()


def test_prepare_scene_reports_changes_and_problems(capfd):
    bpy.ops.mesh.primitive_plane_add()
    nd.assign(bpy.context.object, "water")
    bpy.ops.nested_dielectric.prepare()
    assert panels.settings_problem(bpy.context.scene) is None
    output = "".join(capfd.readouterr())
    assert "Info: Render Engine: BLENDER_EEVEE -> CYCLES" in output
    assert "Warning: 'Plane' is not closed" in output


def test_the_list_shows_the_media_of_a_scene_in_winning_order():
    add_media(A=3, B=1, C=None, D=2)
    add_cube("Wall")
    scene = bpy.context.scene

    def rows(text=""):
        instance = SimpleNamespace(filter_name=text, bitflag_filter_item=1 << 30)
        flags, places = panels.MediaList.filter_items(instance, bpy.context, scene, "objects")
        shown = [(place, obj.name) for obj, flag, place in zip(scene.objects, flags, places) if flag]
        return [name for _, name in sorted(shown)]

    assert rows() == ["B", "D", "A", "C"]
    assert rows("D") == ["D"]


def test_choosing_a_row_selects_its_object_and_the_list_follows_the_selection():
    first, second = add_media(A=1, B=2)
    scene = bpy.context.scene
    assert scene.objects[scene.nested_dielectric_active] == second
    scene.nested_dielectric_active = scene.objects.find("A")
    assert bpy.context.view_layer.objects.active == first
    assert bpy.context.selected_objects == [first]
    assert scene.objects[scene.nested_dielectric_active] == first


def test_choosing_a_row_outside_the_view_layer_changes_nothing():
    first, second = add_media(A=1, B=2)
    scene = bpy.context.scene
    hidden = bpy.data.collections.new("Excluded")
    scene.collection.children.link(hidden)
    scene.collection.objects.unlink(first)
    hidden.objects.link(first)
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    scene.nested_dielectric_active = scene.objects.find("A")
    assert bpy.context.view_layer.objects.active == second


def test_a_render_that_would_not_show_media_says_why(capsys):
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"
    registration.warn_before_render(scene)
    assert capsys.readouterr().err == ""
    add_media(A=1)
    registration.warn_before_render(scene)
    (line,) = capsys.readouterr().err.splitlines()
    assert line == "Nested Dielectric: scene 'Scene' renders with BLENDER_WORKBENCH; nested dielectrics need Cycles"
    nd.prepare(scene)
    registration.warn_before_render(scene)
    assert capsys.readouterr().err == ""
