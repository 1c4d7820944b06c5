"""The panels of a medium: its parameters, its dispersion and its spectrum."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from ui import add_cube, add_dispersive, texts

import nested_dielectric as nd
from nested_dielectric.model import parameters, spectral_tables
from nested_dielectric.model.colour_science import SpectrumError
from nested_dielectric.model.effects import has_effect
from nested_dielectric.model.parameters import BY_KEYWORD
from nested_dielectric.nodes.spectral_images import digest
from nested_dielectric.scene import material_spectra, materials
from nested_dielectric.ui import pictures
from nested_dielectric.ui.panels import dispersion_panels, medium_panels

PANELS = {cls.bl_idname.removeprefix("NESTED_DIELECTRIC_PT_"): cls for cls in medium_panels.CLASSES}
DISPERSION, SPECTRUM = PANELS["sidebar_dispersion"], PANELS["sidebar_spectrum"]

pytestmark = pytest.mark.usefixtures("registered")


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
    with pytest.raises(RuntimeError, match=r"no real index at 587\.6 nm; correct Sellmeier B and C"):
        bpy.ops.nested_dielectric.sellmeier_ior()
    node.inputs["Sellmeier B"].default_value = (0.0, 0.0, 1e4)
    node.inputs["Sellmeier C"].default_value = (0.0, 0.0, 0.0)
    with pytest.raises(RuntimeError, match=r"ior=100\.0.* is outside 0\.01 to 100"):
        bpy.ops.nested_dielectric.sellmeier_ior()
    assert node.inputs["IOR"].default_value == pytest.approx(1.5168, abs=1e-5)
    bpy.ops.nested_dielectric.dispersion_model(model="ABBE")
    with pytest.raises(RuntimeError, match="Choose Sellmeier"):
        bpy.ops.nested_dielectric.sellmeier_ior()


def test_a_spectrum_is_a_word_an_illuminant_or_a_file_and_what_is_not_given_stays(tmp_path):
    material, _ = add_dispersive(spectral_saturation=0.7, clamp_negative=False)
    before = material_spectra.spectrum_settings(material)
    file = tmp_path / "light.csv"
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
        assert material_spectra.spectrum_settings(material) == before | {"spectral_distribution": distribution}
        expected = spectral_tables.spectral_table(distribution, "REC709", 0.7, False)
        np.testing.assert_array_equal(material_spectra.material_table(material), expected)


def test_the_dialog_of_a_spectrum_starts_at_the_material_in_any_case_of_its_word(tmp_path):
    settings = {"spectral_gamut": "ACESCG", "spectral_saturation": 0.25, "clamp_negative": False}
    material, _ = add_dispersive(spectral_distribution="fl11", **settings)
    # Without a window Blender presses OK at once.
    bpy.ops.nested_dielectric.spectrum("INVOKE_DEFAULT", gamut="REC2020")
    changed = {"spectral_distribution": "FL11", "spectral_gamut": "REC2020"}
    assert material_spectra.spectrum_settings(material) == settings | changed


def test_a_wrong_spectrum_leaves_everything_as_it_was(tmp_path):
    material, node = add_dispersive(spectral_distribution="LED")
    file = tmp_path / "light.csv"
    file.write_text("400, 1\n700, bright\n")
    sockets = [socket.default_value for socket in node.inputs if socket.type in ("INT", "VALUE")]
    settings, table = material_spectra.spectrum_settings(material), material_spectra.material_table(material)
    for keywords, message in (
        ({"filepath": str(file)}, "light.csv, line 2: '700, bright': two finite numbers"),
        ({"filepath": str(tmp_path / "none.csv"), "gamut": "ACESCG"}, "no such word, CIE illuminant or file"),
        ({"distribution": "FILE"}, "a word or the path of a file is needed"),
    ):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.nested_dielectric.spectrum(**keywords)
        assert material_spectra.spectrum_settings(material) == settings
        np.testing.assert_array_equal(material_spectra.material_table(material), table)
    assert sockets == [socket.default_value for socket in node.inputs if socket.type in ("INT", "VALUE")]
    assert len(bpy.data.images) == 1


MATERIAL_OPERATORS = ("dispersion_model", "sellmeier_ior", "spectrum")


def test_operators_on_a_material_are_greyed_out_where_there_is_none_to_change(tmp_path):
    def refuse(message):
        for name in MATERIAL_OPERATORS:
            with pytest.raises(RuntimeError, match=message):
                getattr(bpy.ops.nested_dielectric, name)()
        assert [panel.poll(bpy.context) for panel in (DISPERSION, SPECTRUM)] == seen

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


@pytest.mark.parametrize(
    "model, sockets",
    [
        ("ABBE", {"Abbe"}),
        ("SELLMEIER", {"Sellmeier B", "Sellmeier C"}),
        ("JF", {"Spread"}),
    ],
)
def test_the_panel_shows_what_the_dispersion_model_reads_and_the_index_it_gives(draw, model, sockets):
    add_dispersive(dispersion_model=model, ior=1.5168, abbe=64.17, dispersion=0.0)
    labels, properties, buttons = texts(draw(DISPERSION))
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
    labels, _, buttons = texts(draw(DISPERSION))
    assert error in labels
    assert "n_C" not in labels and not any(text.startswith("Set IOR") for text in buttons)


def test_the_panel_offers_the_index_of_the_sellmeier_coefficients_where_ior_is_another(draw):
    _, _node = add_dispersive(ior=1.6)
    labels, _, buttons = texts(draw(PANELS["material_dispersion"]))
    assert "IOR is not the coefficients' own 1.51680" in labels and "n_d 1.60000" in labels
    assert "Set IOR to 1.51680" in buttons
    bpy.ops.nested_dielectric.sellmeier_ior()
    labels, _, buttons = texts(draw(PANELS["material_dispersion"]))
    assert "coefficients" not in labels and "Set IOR to 1.51680" not in buttons


def test_the_panel_says_why_a_medium_that_disperses_shows_no_colours(draw, monkeypatch):
    _, node = add_dispersive()
    monkeypatch.setattr(dispersion_panels, "achromatic_reason", lambda scene: f"scene {scene.name!r} has no colours")
    viewport = "The viewport shows"
    for disperse in (True, False):
        node.inputs["Disperse"].default_value = disperse
        labels, _, _ = texts(draw(DISPERSION))
        assert ("Scene 'Scene' has no colours" in labels, viewport in labels) == (disperse, disperse)
    node.inputs["Disperse"].default_value = True
    monkeypatch.setattr(dispersion_panels, "achromatic_reason", lambda scene: None)
    labels, _, _ = texts(draw(DISPERSION))
    assert "no colours" not in labels and viewport in labels


def test_the_panel_shows_a_spectrum_and_its_picture_even_without_colour_science_or_the_file(
    draw, monkeypatch, tmp_path
):
    def fail():
        raise SpectrumError("spectra need colour-science")

    file = tmp_path / "light.csv"
    file.write_text("400, 1\n700, 2\n")
    _material, node = add_dispersive(
        spectral_distribution=str(file), spectral_gamut="PROPHOTO", spectral_saturation=0.5
    )
    file.unlink()
    monkeypatch.setattr("nested_dielectric.model.distributions.colour_science", fail)
    drawn = draw(SPECTRUM)
    text = "Distribution light.csv Gamut ProPhoto RGB Saturation 0.5 Negative clamped"
    assert texts(drawn)[0] == text
    assert [keywords["scale"] for name, _, keywords in drawn if name == "template_icon"] == [6.0]
    bpy.data.images.remove(node.node_tree.nodes["Spectral Tables"].image)
    drawn = draw(SPECTRUM)
    assert texts(drawn)[0] == text
    assert "template_icon" not in {name for name, _, _ in drawn}


def test_a_picture_is_drawn_once_for_every_table_in_encoded_colours(monkeypatch):
    tables = [spectral_tables.spectral_table("LED", saturation=saturation) for saturation in (0.0, 0.5, 1.0)]
    drawn = []
    monkeypatch.setattr(
        dispersion_panels, "preview", lambda *arguments: drawn.append(1) or spectral_tables.preview(*arguments)
    )
    monkeypatch.setattr(dispersion_panels, "MAX_PICTURES", 2)
    for table in tables[:2] * 2:
        dispersion_panels.picture(table)
    assert len(drawn) == 2
    dispersion_panels.picture(tables[2])
    dispersion_panels.picture(tables[2].copy())
    assert len(drawn) == 3
    assert len(pictures._pictures) == 2
    pixels = np.array(pictures._pictures[f"spectrum {digest(tables[2])}"].image_pixels_float).reshape(256, 256, 4)
    # The ground, 0.01, and the top of the curve, 1, in 8 bit.
    np.testing.assert_allclose(pixels[-1, 0], (0.0998, 0.0998, 0.0998, 1.0), atol=0.5 / 255)
    assert pixels[0, :, :3].max() == 1.0


def test_panel_and_node_show_first_what_artists_change_first(draw):
    _, node = add_dispersive()
    first = [
        BY_KEYWORD[keyword] for keyword in ("transmittance", "transmittance_depth", "ior", "roughness", "priority")
    ]
    assert [socket.name for socket in node.inputs][:5] == [parameter.name for parameter in first]
    below_slots = SimpleNamespace(bl_label="", draw=medium_panels.draw_in_material_properties)
    for panel in (PANELS["sidebar_medium"], below_slots):
        _, properties, _ = texts(draw(panel))
        assert list(properties) == ["Colour", "Depth", "IOR", "Roughness", "Priority"]


def test_every_parameter_stands_in_one_panel(draw):
    _material, _node = add_dispersive()
    shown = []
    for name, panel in PANELS.items():
        if name.startswith("sidebar"):
            shown += drawn_parameters(draw, panel)
    dispersion = {"dispersion_model", "abbe", "dispersion"}  # by buttons, or where the model reads them
    assert sorted(shown) == sorted(p.keyword for p in parameters.SOCKETS if p.keyword not in dispersion)


def drawn_parameters(draw, panel):
    """Keywords of the parameters that a panel draws."""
    found = []

    def write_down(layout, material, keyword, has_effect=True):
        found.append(keyword)

    with pytest.MonkeyPatch.context() as patch:
        for module in (medium_panels, dispersion_panels):
            patch.setattr(module, "draw_parameter", write_down)
        draw(panel)
    return found


def test_the_nodes_own_sockets_are_the_artists():
    _, node = add_dispersive()
    names = {parameter.name for parameter in parameters.SOCKETS}
    assert {socket.name for socket in node.inputs if not socket.hide} == names
    assert not any(socket.hide for socket in node.outputs)


FIELD, LINE = 160, 205
"""Pixels of a name in a number's field and on a line of its own, where the sidebar is as wide as Blender opens it."""


def test_no_name_is_cut_at_the_width_that_the_sidebar_opens_with():
    import blf  # which bpy brings

    blf.size(0, 11)
    for parameter in parameters.SOCKETS:
        width = blf.dimensions(0, parameter.label or parameter.name)[0]
        in_field = parameter.kind in ("FLOAT", "INT") and parameter.panel != "Dispersion"
        assert width < (FIELD if in_field else LINE - 20), parameter.name
        for choice in parameter.choices:
            assert blf.dimensions(0, choice.name)[0] < LINE, choice.name


@pytest.mark.parametrize(
    "keywords, idle",
    [
        ({}, {"transmittance_depth", "distribution", "anisotropy", "tangent", "reflection_roughness", "thin_film_ior"}),
        ({"transmittance": (1.0, 0.9, 1.0), "thin_film_thickness": 300.0}, {"distribution", "reflection_roughness"}),
        ({"roughness": 0.1, "anisotropy": 0.5}, {"transmittance_depth", "reflection_anisotropy", "polarization_angle"}),
        ({"separate_reflection": True}, {"reflection_distribution", "reflection_anisotropy", "tangent"}),
        ({"internal_reflections": False}, {"reflection_probability", "caustic_internal_reflections"}),
    ],
)
def test_what_does_not_show_is_greyed_out(keywords, idle):
    material = nd.new_material("Glass", **keywords)
    values = medium_panels.known_values(bpy.context.scene, material)
    for keyword in idle:
        assert not has_effect(BY_KEYWORD[keyword], values), keyword
    for keyword in ("ior", "priority", "roughness", "shadow_mode", *keywords):
        assert has_effect(BY_KEYWORD[keyword], values), keyword


def test_a_panel_greys_out_what_does_not_show(draw):
    _, node = add_dispersive()
    for colour, active in ((1.0, False), (0.5, True)):
        node.inputs["Transmittance"].default_value = (1.0, 1.0, colour, 1.0)
        drawn = draw(PANELS["sidebar_medium"])
        assert [
            keywords["active"] for name, _, keywords in drawn if name == "prop" and keywords["text"] == "Depth"
        ] == [active]


def test_what_is_linked_keyframed_or_carried_by_lobes_may_show(draw):
    material, node = add_dispersive()
    scene = bpy.context.scene

    def shows(keyword):
        return has_effect(BY_KEYWORD[keyword], medium_panels.known_values(scene, material))

    assert not shows("thin_film_ior") and not shows("distribution") and not shows("direct_refraction")
    node.inputs["Thin Film Thickness"].keyframe_insert("default_value")
    assert shows("thin_film_ior")
    value = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(value.outputs[0], node.inputs["Roughness"])
    assert shows("distribution")
    labels, properties, _ = texts(draw(PANELS["sidebar_medium"]))
    assert "Roughness" not in properties and "Roughness Value" in labels
    bpy.ops.object.light_add(type="POINT")
    bpy.context.object.visible_transmission = False
    assert shows("direct_refraction") and not shows("direct_roughness")


def test_a_medium_says_after_which_length_half_of_its_light_is_left(draw):
    scene = bpy.context.scene
    _material, node = add_dispersive(transmittance=(0.25, 0.25, 0.25), transmittance_depth=0.5)
    assert materials.half_distance(node) == pytest.approx(0.25, rel=1e-6)
    assert "Half of the light is left after 25 cm" in texts(draw(PANELS["sidebar_medium"]))[0]
    scene.unit_settings.scale_length = 0.01
    assert "Half of the light is left after 2.5 mm" in texts(draw(PANELS["sidebar_medium"]))[0]
    node.inputs["Transmittance"].default_value = (1.0, 1.0, 0.0, 1.0)
    assert materials.half_distance(node) is None
    assert "Half" not in texts(draw(PANELS["sidebar_medium"]))[0]
