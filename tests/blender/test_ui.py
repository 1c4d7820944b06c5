"""Operators, panels and registration, as Blender's buttons call them."""

import bpy
import pytest
from ui import add_cube, add_dispersive, add_media, labels_and_operators, texts

import nested_dielectric as nd
from nested_dielectric import registration
from nested_dielectric.nodes.material_version import MATERIAL_VERSION, find_group, group_version
from nested_dielectric.nodes.names import VERSION_PROPERTY
from nested_dielectric.scene import lights, materials, media
from nested_dielectric.scene.passes import compositors
from nested_dielectric.ui import polls
from nested_dielectric.ui.operators import update_operators
from nested_dielectric.ui.panels import light_panel, medium_panels, object_menu, scene_panels

pytestmark = pytest.mark.usefixtures("registered")


def priorities():
    return {obj.name: nd.get_priority(obj) for obj in bpy.context.scene.objects}


def in_blender():
    """What the extension has put into Blender."""
    classes = {cls for cls in registration.CLASSES if cls.is_registered}
    menus = bpy.types.VIEW3D_MT_object._dyn_ui_initialize().count(object_menu.draw_entry)
    handlers = bpy.app.handlers.render_init[:].count(registration.warn_before_render)
    pictures = len(bpy.utils.previews._uuid_open)
    properties = [
        hasattr(bpy.types.Scene, "nested_dielectric_active"),
        hasattr(bpy.types.WindowManager, "nested_dielectric_presets"),
    ]
    return len(classes), menus, handlers, properties, pictures


def test_registering_twice_changes_nothing():
    once = in_blender()
    nd.register()
    assert in_blender() == once == (len(registration.CLASSES), 1, 1, [True, True], 1)


def test_unregistering_leaves_no_classes_behind():
    nd.unregister()
    assert in_blender() == (0, 0, 0, [False, False], 0)
    assert not [name for name in dir(bpy.types) if name.upper().startswith("NESTED_DIELECTRIC")]
    nd.unregister()
    nd.register()
    assert in_blender() == (len(registration.CLASSES), 1, 1, [True, True], 1)


def test_a_registration_that_fails_raises_and_leaves_nothing_behind(monkeypatch):
    def fail(*_):
        raise ValueError("no more commands")

    nd.unregister()
    monkeypatch.setattr(registration.bpy.utils, "register_cli_command", fail)
    with pytest.raises(ValueError, match="no more commands"):
        nd.register()
    assert in_blender() == (0, 0, 0, [False, False], 0)


def test_an_unsupported_blender_still_gets_the_panels_and_says_why(monkeypatch, capsys):
    nd.unregister()
    monkeypatch.setattr(registration, "blender_problem", lambda: "this Blender cannot")
    nd.register()
    assert in_blender()[0] == len(registration.CLASSES)
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
    monkeypatch.setattr(polls, "blender_problem", lambda: "this Blender cannot")
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


def test_an_object_that_is_no_medium_is_named_in_the_error():
    add_media(A=1)
    add_cube("Wall")
    with pytest.raises(RuntimeError, match="'Wall' is no medium of scene 'Scene'"):
        bpy.ops.nested_dielectric.priority_own()


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


@pytest.mark.parametrize("width", [1, 150, 2000])
def test_panels_draw_in_any_width(draw, width):
    add_dispersive()
    for panel in registration.CLASSES:
        if issubclass(panel, bpy.types.Panel):
            assert draw(panel, width) or issubclass(panel, medium_panels._AdvancedPanel)


def test_the_panels_offer_to_update_materials_of_another_version(draw):
    add_media(A=1)
    update = update_operators.UpdateMaterials.bl_idname
    for panel in (scene_panels.SidebarPanel, scene_panels.ObjectPanel):
        assert update not in labels_and_operators(draw(panel))[1]
    node = materials.dielectric_node(bpy.data.objects["A"].active_material)
    node.node_tree = node.node_tree.copy()
    node.node_tree[VERSION_PROPERTY] = 1
    for panel in (scene_panels.SidebarPanel, scene_panels.ObjectPanel):
        labels, buttons = labels_and_operators(draw(panel))
        assert "From another version, or a copy: Water" in labels and update in buttons
    bpy.ops.nested_dielectric.update_materials()
    assert group_version(node.node_tree) == MATERIAL_VERSION
    assert update not in labels_and_operators(draw(scene_panels.SidebarPanel))[1]


def test_the_panels_name_a_material_of_a_newer_version(draw):
    add_media(A=1)
    find_group()[VERSION_PROPERTY] = MATERIAL_VERSION + 1
    labels, buttons = labels_and_operators(draw(scene_panels.SidebarPanel))
    assert "'Water' was made by a newer version" in labels and update_operators.UpdateMaterials.bl_idname not in buttons


def add_light(name, **visibility):
    bpy.ops.object.light_add(type="POINT")
    light = bpy.context.object
    light.name = name
    for attribute, value in visibility.items():
        setattr(light, attribute, value)
    return light


def carriers():
    return {carrier.light: carrier.refraction for carrier in nd.light_carriers(bpy.context.scene)}


def test_a_button_gives_the_selected_lights_to_the_lobe_and_back_and_all_where_none_is_selected(capfd):
    for name in "AB":
        add_light(name).select_set(name == "B")
    bpy.context.scene.objects["A"].select_set(False)
    assert bpy.ops.nested_dielectric.lamp_carrier(carrier="LOBE") == {"FINISHED"}
    assert carriers() == {"A": "RAYS", "B": "LOBE"}
    assert [light.name for light in lights.listed_lights(bpy.context.scene)] == ["B"]
    bpy.context.scene.objects["B"].select_set(False)
    bpy.ops.nested_dielectric.lamp_carrier(carrier="LOBE")
    assert carriers() == {"A": "LOBE", "B": "LOBE"}
    bpy.ops.nested_dielectric.lamp_carrier(carrier="RAYS")
    assert carriers() == {"A": "RAYS", "B": "RAYS"}
    assert lights.listed_lights(bpy.context.scene) == []
    bpy.ops.nested_dielectric.lamp_carrier(carrier="RAYS")
    output = "".join(capfd.readouterr())
    for report in ("Lobes refract B", "Lobes refract A", "Rays refract A, B", "Nothing to change"):
        assert f"Info: {report}\n" in output


def test_a_light_that_no_lobe_can_carry_stays_with_rays(capfd):
    add_light("A").data.normalize = False
    bpy.ops.nested_dielectric.lamp_carrier(carrier="LOBE")
    assert carriers() == {"A": "RAYS"}
    assert "Warning: 'A' stays with rays, because its strength is not normalized" in "".join(capfd.readouterr())


def test_undo_takes_a_light_caustics_and_passes_back():
    bpy.context.scene.render.engine = "CYCLES"
    add_media(A=1)
    add_light("Lamp")
    bpy.ops.ed.undo_push(message="light")
    bpy.ops.nested_dielectric.lamp_carrier("EXEC_DEFAULT", True, carrier="LOBE")
    bpy.ops.nested_dielectric.shadow_caustics("EXEC_DEFAULT", True, enable=True)
    bpy.ops.nested_dielectric.add_passes("EXEC_DEFAULT", True)

    def state():
        scene = bpy.context.scene
        passes = bool(compositors(scene)) and scene.view_layers[0].use_pass_emit
        return carriers()["Lamp"], scene.objects["A"].cycles.is_caustics_caster, passes

    assert state() == ("LOBE", True, True)
    bpy.ops.ed.undo()
    assert state() == ("LOBE", True, False)
    bpy.ops.ed.undo()
    assert state() == ("LOBE", False, False)
    bpy.ops.ed.undo()
    assert state() == ("RAYS", False, False)
    assert lights.listed_lights(bpy.context.scene) == []


def test_operators_on_the_scene_report_what_they_changed(capfd):
    bpy.context.scene.render.engine = "CYCLES"
    add_media(A=1)
    add_light("Lamp")
    for _ in range(2):
        assert bpy.ops.nested_dielectric.shadow_caustics(enable=True) == {"FINISHED"}
        assert bpy.ops.nested_dielectric.shadow_caustics(enable=False) == {"FINISHED"}
        bpy.ops.nested_dielectric.add_passes()
    output = "".join(capfd.readouterr())
    assert output.count("Info: Cast Shadow Caustics of A: on") == 2
    assert output.count("Info: Shadow Caustics of Point: off") == 2
    assert output.count("Info: Light Group of A: Media") == output.count("Info: Nothing to change") == 1


def test_buttons_for_lights_and_passes_are_greyed_out_where_there_is_nothing_for_them(monkeypatch):
    for name, message in (
        ("lamp_carrier", "The scene has no light; add one first"),
        ("shadow_caustics", "The scene has no medium; assign a preset first"),
        ("add_passes", "The scene has no medium; assign a preset first"),
    ):
        with pytest.raises(RuntimeError, match=message):
            getattr(bpy.ops.nested_dielectric, name)()
    add_media(A=1)
    add_light("Lamp")
    with pytest.raises(RuntimeError, match="Passes need Cycles; prepare the scene first"):
        bpy.ops.nested_dielectric.add_passes()
    monkeypatch.setattr(polls, "blender_problem", lambda: "this Blender cannot")
    for name in ("lamp_carrier", "shadow_caustics", "add_passes"):
        with pytest.raises(RuntimeError, match="this Blender cannot"):
            getattr(bpy.ops.nested_dielectric, name)()


def test_the_panel_lists_what_carries_every_light_and_why_nothing_does(draw):
    add_light("Beam", visible_transmission=False)
    add_light("Key")
    for name in ("Wild", "Wilder"):
        add_light(name, visible_glossy=False).data.normalize = False
    labels, _, buttons = texts(draw(light_panel.LightsPanel, 2000))
    assert labels.startswith(
        "Light Refraction Reflection Wild Rays None Wilder Rays None Beam Lobe Rays Key Rays Rays "
    )
    assert "No lobe can carry 'Wild', 'Wilder': its strength is not normalized" in labels
    assert set(buttons) == {"Refract by Lobe", "Refract by Rays", "On", "Off", "Add Passes"}


def test_the_panel_stays_short_with_many_lights(draw, monkeypatch):
    monkeypatch.setattr(light_panel, "MAX_LIGHTS", 2)
    for name in "ABCDE":
        add_light(name)
    labels, _, _ = texts(draw(light_panel.LightsPanel))
    assert "A Rays Rays B Rays Rays And 3 more" in labels and "C" not in labels.split()
