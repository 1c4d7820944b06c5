"""Operators, panels and registration, as Blender's buttons call them."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

import nested_dielectric as nd
from nested_dielectric import (
    lights,
    materials,
    media,
    node_group,
    operators,
    panels,
    preset_menus,
    preset_operators,
    registration,
    spectra,
)
from nested_dielectric.parameters import BY_KEYWORD
from nested_dielectric.passes import compositors

pytestmark = pytest.mark.quick


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


def add_dispersive(preset="bk7", **keywords):
    """A cube of a preset that splits colours, its material and that one's group node."""
    cube = add_cube("Prism")
    material = nd.new_material("Prism", preset, disperse=True, **keywords)
    nd.assign(cube, material)
    return material, materials.dielectric_node(material)


class Layout:
    """A layout of Blender's that writes down what is drawn into it."""

    def __init__(self, layout, drawn):
        self.__dict__.update(layout=layout, drawn=drawn)

    def __setattr__(self, name, value):
        setattr(self.layout, name, value)

    def __getattr__(self, name):
        def call(*arguments, **keywords):
            self.drawn.append((name, arguments, keywords))
            result = getattr(self.layout, name)(*arguments, **keywords)
            return Layout(result, self.drawn) if isinstance(result, bpy.types.UILayout) else result

        return call


@pytest.fixture
def draw(capfd):
    """Draw a panel as Blender would, in a region of some width; what it draws, as in :class:`Layout`."""

    def draw(panel, width=220):
        context = SimpleNamespace(
            scene=bpy.context.scene,
            object=bpy.context.object,
            region=SimpleNamespace(width=width),
            preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
        )
        drawn = []
        capfd.readouterr()
        area = bpy.context.window.screen.areas[0]
        with bpy.context.temp_override(area=area, region=area.regions[0]):
            layout = bpy.context.window_manager.popover_begin__internal(ui_units_x=10).layout
            panel.draw(SimpleNamespace(layout=Layout(layout, drawn)), context)
        complaints = [line for line in "".join(capfd.readouterr()).splitlines() if "no icon for icon ID" not in line]
        assert not complaints
        return drawn

    return draw


def texts(drawn):
    """All labels of a panel as one text, its properties' names, and its buttons' names with what they look like."""
    by_kind = {
        kind: {keywords["text"]: keywords for name, _, keywords in drawn if name == kind}
        for kind in ("prop", "operator")
    }
    labels = " ".join(keywords["text"] for name, _, keywords in drawn if name == "label")
    return labels, by_kind["prop"].keys(), by_kind["operator"]


def labels_and_operators(drawn):
    """All labels of a panel as one text, and which operators it offers."""
    labels = " ".join(keywords["text"] for name, _, keywords in drawn if name == "label")
    return labels, [arguments[0] for name, arguments, _ in drawn if name == "operator"]


def in_blender():
    """What the extension has put into Blender."""
    classes = {cls for cls in registration.CLASSES if cls.is_registered}
    menus = bpy.types.VIEW3D_MT_object._dyn_ui_initialize().count(preset_menus.draw_object_menu)
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
    assert in_blender() == once == (len(registration.CLASSES), 1, 1, [True, True], 2)


def test_unregistering_leaves_no_classes_behind():
    nd.unregister()
    assert in_blender() == (0, 0, 0, [False, False], 0)
    assert not [name for name in dir(bpy.types) if name.upper().startswith("NESTED_DIELECTRIC")]
    nd.unregister()
    nd.register()
    assert in_blender() == (len(registration.CLASSES), 1, 1, [True, True], 2)


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
    for module in (operators, preset_operators):
        monkeypatch.setattr(module, "blender_problem", lambda: "this Blender cannot")
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
    assert priorities() == {"C": 2, "A": 3, "B": 4}


def test_the_first_medium_cannot_move_further_up():
    add_media(A=1, B=2)
    assert bpy.ops.nested_dielectric.priority_move(name="A", direction="UP") == {"CANCELLED"}


def test_without_a_name_the_active_object_moves():
    add_media(A=1, B=2)
    bpy.ops.nested_dielectric.priority_move(direction="UP")
    assert priorities() == {"B": 0, "A": 1}


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


def test_a_button_sets_the_dispersion_model_and_undo_takes_it_back():
    add_dispersive()
    bpy.ops.ed.undo_push(message="prism")

    def model():
        node = materials.dielectric_node(bpy.data.materials["Prism"])
        return materials.get_parameter(node, BY_KEYWORD["dispersion_model"])

    assert model() == "SELLMEIER"
    for word in ("JF", "ABBE"):
        assert bpy.ops.nested_dielectric.dispersion_model("EXEC_DEFAULT", True, model=word) == {"FINISHED"}
        assert model() == word
    bpy.ops.ed.undo()
    assert model() == "JF"


def test_ior_returns_to_that_of_the_sellmeier_coefficients():
    _, node = add_dispersive(ior=1.6)
    assert bpy.ops.nested_dielectric.sellmeier_ior() == {"FINISHED"}
    assert node.inputs["IOR"].default_value == pytest.approx(1.5168, abs=1e-5)
    node.inputs["Sellmeier B"].default_value = (-10.0, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="no real index at 587.6 nm; correct Sellmeier B and C"):
        bpy.ops.nested_dielectric.sellmeier_ior()
    node.inputs["Sellmeier B"].default_value = (0.0, 0.0, 1e4)
    node.inputs["Sellmeier C"].default_value = (0.0, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="ior=100.0.* is outside 0.01 to 100"):
        bpy.ops.nested_dielectric.sellmeier_ior()
    assert node.inputs["IOR"].default_value == pytest.approx(1.5168, abs=1e-5)
    bpy.ops.nested_dielectric.dispersion_model(model="ABBE")
    with pytest.raises(RuntimeError, match="Choose Sellmeier"):
        bpy.ops.nested_dielectric.sellmeier_ior()


def test_a_spectrum_is_a_word_an_illuminant_or_a_file_and_what_is_not_given_stays(tmp_path):
    material, _ = add_dispersive(spectral_saturation=0.7, clamp_negative=False)
    before = materials.spectrum_settings(material)
    file = tmp_path / "lamp.csv"
    file.write_text("400, 1\n700, 2\n")
    for keywords, distribution in (
        ({"distribution": "SUNSET"}, "SUNSET"),
        ({"distribution": "FL3.12"}, "FL3.12"),
        ({"distribution": "FILE", "filepath": str(file)}, str(file)),
        ({"distribution": "LED"}, "LED"),
        ({"filepath": str(file)}, str(file)),
        ({}, str(file)),
    ):
        assert bpy.ops.nested_dielectric.spectrum(**keywords) == {"FINISHED"}
        assert materials.spectrum_settings(material) == before | {"spectral_distribution": distribution}
        expected = spectra.spectral_table(distribution, "REC709", 0.7, False)
        np.testing.assert_array_equal(materials.material_table(material), expected)


def test_the_dialog_of_a_spectrum_starts_at_the_material_in_any_case_of_its_word(tmp_path):
    settings = {"spectral_gamut": "ACESCG", "spectral_saturation": 0.25, "clamp_negative": False}
    material, _ = add_dispersive(spectral_distribution="fl11", **settings)
    # Without a window Blender presses OK at once.
    bpy.ops.nested_dielectric.spectrum("INVOKE_DEFAULT", gamut="REC2020")
    changed = {"spectral_distribution": "FL11", "spectral_gamut": "REC2020"}
    assert materials.spectrum_settings(material) == settings | changed


def test_a_wrong_spectrum_leaves_everything_as_it_was(tmp_path):
    material, node = add_dispersive(spectral_distribution="LED")
    file = tmp_path / "lamp.csv"
    file.write_text("400, 1\n700, bright\n")
    sockets = [socket.default_value for socket in node.inputs if socket.type in ("INT", "VALUE")]
    settings, table = materials.spectrum_settings(material), materials.material_table(material)
    for keywords, message in (
        ({"filepath": str(file)}, "lamp.csv, line 2: '700, bright': two finite numbers"),
        ({"filepath": str(tmp_path / "none.csv"), "gamut": "ACESCG"}, "no such word, CIE illuminant or file"),
        ({"distribution": "FILE"}, "a word or the path of a file is needed"),
    ):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.nested_dielectric.spectrum(**keywords)
        assert materials.spectrum_settings(material) == settings
        np.testing.assert_array_equal(materials.material_table(material), table)
    assert sockets == [socket.default_value for socket in node.inputs if socket.type in ("INT", "VALUE")]
    assert len(bpy.data.images) == 1


MATERIAL_OPERATORS = ("dispersion_model", "sellmeier_ior", "spectrum")


def test_operators_on_a_material_are_greyed_out_where_there_is_none_to_change(tmp_path):
    def refuse(message):
        for name in MATERIAL_OPERATORS:
            with pytest.raises(RuntimeError, match=message):
                getattr(bpy.ops.nested_dielectric, name)()
        assert [
            panel.poll(bpy.context) for panel in (panels.SidebarDispersionPanel, panels.ObjectSpectrumPanel)
        ] == seen

    seen = [False, False]
    refuse("The active object is no medium")
    add_cube("Wall")
    refuse("The active object is no medium; assign a preset")

    material, _ = add_dispersive()
    library = str(tmp_path / "library.blend")
    bpy.data.libraries.write(library, {material})
    with bpy.data.libraries.load(library, link=True) as (there, here):
        here.materials = there.materials
    nd.assign(bpy.context.object, here.materials[0])
    seen = [True, True]
    refuse("Material 'Prism' belongs to a library; make it local first")
    nd.assign(bpy.context.object, here.materials[0].make_local())
    with pytest.raises(RuntimeError, match="Node group 'Nested Dielectric' belongs to a library; make it local first"):
        bpy.ops.nested_dielectric.spectrum()
    assert bpy.ops.nested_dielectric.dispersion_model(model="JF") == {"FINISHED"}


@pytest.mark.parametrize("panel", [cls for cls in panels.CLASSES if issubclass(cls, bpy.types.Panel)])
@pytest.mark.parametrize("width", [1, 150, 2000])
def test_panels_draw_in_any_width(draw, panel, width):
    add_dispersive()
    assert draw(panel, width)


@pytest.mark.parametrize(
    "model, sockets",
    [
        ("ABBE", {"IOR", "Abbe"}),
        ("SELLMEIER", {"IOR", "Sellmeier B", "Sellmeier C"}),
        ("JF", {"IOR", "Dispersion"}),
    ],
)
def test_the_panel_shows_what_the_dispersion_model_reads_and_the_index_it_gives(draw, model, sockets):
    add_dispersive(dispersion_model=model, ior=1.5168, abbe=64.17, dispersion=0.0)
    labels, properties, buttons = texts(draw(panels.SidebarDispersionPanel))
    assert properties == {"Disperse"} | sockets
    assert {text: keywords["depress"] for text, keywords in buttons.items()} == {
        "Abbe": model == "ABBE",
        "Sellmeier": model == "SELLMEIER",
        "JF": model == "JF",
    }
    if model == "JF":
        assert "n_C 1.51680 (656.3 nm) n_d 1.51680 (587.6 nm) n_F 1.51680 (486.1 nm) V_d no dispersion" in labels
    else:
        assert "n_C 1.5143" in labels
        assert "n_d 1.51680 (587.6 nm)" in labels
        assert "V_d 64.17" in labels
    assert "coefficients" not in labels


@pytest.mark.parametrize(
    "keywords, error",
    [
        (
            {"dispersion_model": "SELLMEIER", "sellmeier_b": (-10.0, 0.0, 0.0)},
            "No real index above 0 at 656.3, 587.6, 486.1 nm; correct Sellmeier B and C; C holds squares",
        ),
        (
            {"dispersion_model": "SELLMEIER", "sellmeier_b": (1.0, 0.1, 0.0), "sellmeier_c": (0.01, 0.2364, 0.0)},
            "No real index above 0 at 486.1 nm; correct Sellmeier B and C",
        ),
        ({"dispersion_model": "JF", "dispersion": 10.0}, "No real index above 0 at 656.3, 587.6 nm; bring Dispersion"),
        ({"dispersion_model": "ABBE", "abbe": 0.001}, "No real index above 0 at 656.3 nm; set a larger Abbe number"),
    ],
)
def test_the_panel_says_what_to_do_where_a_model_has_no_index(draw, keywords, error):
    add_dispersive(ior=1.5, **keywords)
    labels, _, buttons = texts(draw(panels.SidebarDispersionPanel))
    assert error in labels
    assert "n_C" not in labels and not any(text.startswith("Set IOR") for text in buttons)


def test_the_panel_offers_the_index_of_the_sellmeier_coefficients_where_ior_is_another(draw):
    _, node = add_dispersive(ior=1.6)
    labels, _, buttons = texts(draw(panels.ObjectDispersionPanel))
    assert "IOR is not the coefficients' own 1.51680" in labels and "n_d 1.60000" in labels
    assert "Set IOR to 1.51680" in buttons
    bpy.ops.nested_dielectric.sellmeier_ior()
    labels, _, buttons = texts(draw(panels.ObjectDispersionPanel))
    assert "coefficients" not in labels and "Set IOR to 1.51680" not in buttons


def test_the_panels_offer_to_update_materials_of_another_version(draw):
    add_media(A=1)
    update = operators.UpdateMaterials.bl_idname
    for panel in (panels.SidebarPanel, panels.ObjectPanel):
        assert update not in labels_and_operators(draw(panel))[1]
    node = materials.dielectric_node(bpy.data.objects["A"].active_material)
    node.node_tree = node.node_tree.copy()
    node.node_tree[node_group.VERSION_PROPERTY] = 1
    for panel in (panels.SidebarPanel, panels.ObjectPanel):
        labels, buttons = labels_and_operators(draw(panel))
        assert "From another version, or a copy: Water" in labels and update in buttons
    bpy.ops.nested_dielectric.update_materials()
    assert node_group.group_version(node.node_tree) == node_group.MATERIAL_VERSION
    assert update not in labels_and_operators(draw(panels.SidebarPanel))[1]


def test_the_panels_name_a_material_of_a_newer_version(draw):
    add_media(A=1)
    node_group.find_group()[node_group.VERSION_PROPERTY] = node_group.MATERIAL_VERSION + 1
    labels, buttons = labels_and_operators(draw(panels.SidebarPanel))
    assert "'Water' was made by a newer version" in labels and operators.UpdateMaterials.bl_idname not in buttons


def test_the_panel_says_why_a_medium_that_disperses_shows_no_colours(draw, monkeypatch):
    _, node = add_dispersive()
    monkeypatch.setattr(panels, "achromatic_reason", lambda scene: f"scene {scene.name!r} has no colours")
    viewport = "The viewport shows"
    for disperse in (True, False):
        node.inputs["Disperse"].default_value = disperse
        labels, _, _ = texts(draw(panels.SidebarDispersionPanel))
        assert ("Scene 'Scene' has no colours" in labels, viewport in labels) == (disperse, disperse)
    node.inputs["Disperse"].default_value = True
    monkeypatch.setattr(panels, "achromatic_reason", lambda scene: None)
    labels, _, _ = texts(draw(panels.SidebarDispersionPanel))
    assert "no colours" not in labels and viewport in labels


def test_the_panel_shows_a_spectrum_and_its_picture_even_without_colour_science_or_the_file(
    draw, monkeypatch, tmp_path
):
    def fail():
        raise spectra.SpectrumError("spectra need colour-science")

    file = tmp_path / "lamp.csv"
    file.write_text("400, 1\n700, 2\n")
    material, node = add_dispersive(spectral_distribution=str(file), spectral_gamut="PROPHOTO", spectral_saturation=0.5)
    file.unlink()
    monkeypatch.setattr(spectra, "_colour", fail)
    drawn = draw(panels.SidebarSpectrumPanel)
    text = "Distribution lamp.csv Gamut ProPhoto RGB Saturation 0.5 Negative clamped"
    assert texts(drawn)[0] == text
    assert [keywords["scale"] for name, _, keywords in drawn if name == "template_icon"] == [6.0]
    bpy.data.images.remove(node.node_tree.nodes["Spectral Tables"].image)
    drawn = draw(panels.SidebarSpectrumPanel)
    assert texts(drawn)[0] == text
    assert "template_icon" not in {name for name, _, _ in drawn}


def test_a_picture_is_drawn_once_for_every_table_in_encoded_colours(monkeypatch):
    tables = [spectra.spectral_table("LED", saturation=saturation) for saturation in (0.0, 0.5, 1.0)]
    drawn = []
    monkeypatch.setattr(panels, "preview", lambda *arguments: drawn.append(1) or spectra.preview(*arguments))
    monkeypatch.setattr(panels, "MAX_PICTURES", 2)
    for table in tables[:2] * 2:
        panels.picture(table)
    assert len(drawn) == 2
    panels.picture(tables[2])
    panels.picture(tables[2].copy())
    assert len(drawn) == 3
    assert len(panels._pictures) == 2
    pixels = np.array(panels._pictures[panels.digest(tables[2])].image_pixels_float).reshape(256, 256, 4)
    # The ground, 0.01, and the top of the curve, 1, in 8 bit.
    np.testing.assert_allclose(pixels[-1, 0], (0.0998, 0.0998, 0.0998, 1.0), atol=0.5 / 255)
    assert pixels[0, :, :3].max() == 1.0


def add_lamp(name, **visibility):
    bpy.ops.object.light_add(type="POINT")
    lamp = bpy.context.object
    lamp.name = name
    for attribute, value in visibility.items():
        setattr(lamp, attribute, value)
    return lamp


def carriers():
    return {carrier.lamp: carrier.refraction for carrier in nd.light_carriers(bpy.context.scene)}


def test_a_button_gives_the_selected_lamps_to_the_lobe_and_back_and_all_where_none_is_selected(capfd):
    for name in "AB":
        add_lamp(name).select_set(name == "B")
    bpy.context.scene.objects["A"].select_set(False)
    assert bpy.ops.nested_dielectric.lamp_carrier(carrier="LOBE") == {"FINISHED"}
    assert carriers() == {"A": "RAYS", "B": "LOBE"}
    assert [lamp.name for lamp in lights.listed_lamps(bpy.context.scene)] == ["B"]
    bpy.context.scene.objects["B"].select_set(False)
    bpy.ops.nested_dielectric.lamp_carrier(carrier="LOBE")
    assert carriers() == {"A": "LOBE", "B": "LOBE"}
    bpy.ops.nested_dielectric.lamp_carrier(carrier="RAYS")
    assert carriers() == {"A": "RAYS", "B": "RAYS"}
    assert lights.listed_lamps(bpy.context.scene) == []
    bpy.ops.nested_dielectric.lamp_carrier(carrier="RAYS")
    output = "".join(capfd.readouterr())
    for report in ("Lobes refract B", "Lobes refract A", "Rays refract A, B", "Nothing to change"):
        assert f"Info: {report}\n" in output


def test_a_lamp_that_no_lobe_can_carry_stays_with_rays(capfd):
    add_lamp("A").data.normalize = False
    bpy.ops.nested_dielectric.lamp_carrier(carrier="LOBE")
    assert carriers() == {"A": "RAYS"}
    assert "Warning: 'A' stays with rays, because its strength is not normalized" in "".join(capfd.readouterr())


def test_undo_takes_a_lamp_caustics_and_passes_back():
    bpy.context.scene.render.engine = "CYCLES"
    add_media(A=1)
    add_lamp("Lamp")
    bpy.ops.ed.undo_push(message="lamp")
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
    assert lights.listed_lamps(bpy.context.scene) == []


def test_operators_on_the_scene_report_what_they_changed(capfd):
    bpy.context.scene.render.engine = "CYCLES"
    add_media(A=1)
    add_lamp("Lamp")
    for _ in range(2):
        assert bpy.ops.nested_dielectric.shadow_caustics(enable=True) == {"FINISHED"}
        assert bpy.ops.nested_dielectric.shadow_caustics(enable=False) == {"FINISHED"}
        bpy.ops.nested_dielectric.add_passes()
    output = "".join(capfd.readouterr())
    assert output.count("Info: Cast Shadow Caustics of A: on") == 2
    assert output.count("Info: Shadow Caustics of Point: off") == 2
    assert output.count("Info: Light Group of A: Media") == output.count("Info: Nothing to change") == 1


def test_buttons_for_lamps_and_passes_are_greyed_out_where_there_is_nothing_for_them(monkeypatch):
    for name, message in (
        ("lamp_carrier", "The scene has no lamp; add one first"),
        ("shadow_caustics", "The scene has no medium; assign a preset first"),
        ("add_passes", "The scene has no medium; assign a preset first"),
    ):
        with pytest.raises(RuntimeError, match=message):
            getattr(bpy.ops.nested_dielectric, name)()
    add_media(A=1)
    add_lamp("Lamp")
    with pytest.raises(RuntimeError, match="Passes need Cycles; prepare the scene first"):
        bpy.ops.nested_dielectric.add_passes()
    monkeypatch.setattr(operators, "blender_problem", lambda: "this Blender cannot")
    for name in ("lamp_carrier", "shadow_caustics", "add_passes"):
        with pytest.raises(RuntimeError, match="this Blender cannot"):
            getattr(bpy.ops.nested_dielectric, name)()


def test_the_panel_lists_what_carries_every_lamp_and_why_nothing_does(draw):
    add_lamp("Beam", visible_transmission=False)
    add_lamp("Key")
    for name in ("Wild", "Wilder"):
        add_lamp(name, visible_glossy=False).data.normalize = False
    labels, _, buttons = texts(draw(panels.SidebarLampsPanel, 2000))
    assert labels.startswith("Lamp Refraction Reflection Wild Rays None Wilder Rays None Beam Lobe Rays Key Rays Rays ")
    assert "No lobe can carry 'Wild', 'Wilder': its strength is not normalized" in labels
    assert set(buttons) == {"Refract by Lobe", "Refract by Rays", "On", "Off", "Add Passes"}


def test_the_panel_stays_short_with_many_lamps(draw, monkeypatch):
    monkeypatch.setattr(panels, "MAX_LAMPS", 2)
    for name in "ABCDE":
        add_lamp(name)
    labels, _, _ = texts(draw(panels.SidebarLampsPanel))
    assert "A Rays Rays B Rays Rays And 3 more" in labels and "C" not in labels.split()
