"""Materials of JF Nested Dielectric, from Arnold's scene files and JSON."""

import json
import math
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from nested_dielectric import cli
from nested_dielectric.importers import jf
from nested_dielectric.model.parameters import BY_KEYWORD, PARAMETERS, check_keywords
from nested_dielectric.scene.materials import dielectric_node, get_parameter, spectrum_settings

pytestmark = pytest.mark.quick

# The interface of JF 1.0.5 as published: name and default. It stands here a second time, so that no row is lost.
INTERFACE = """
mediumPriority 0
mediumIOR 1.33
mediumTransmittance 1 1 1
mediumTransmittance_scale 1
polarize off
polarization_angle 0
refraction_scale 1
btdf "cook_torrance"
refraction_roughness_u 0
refraction_roughness_v 0
indirect_refraction 1
direct_refraction 1
dr_roughnessOffset 0.05
dr_roughnessDepthMultiplier 1
dr_roughnessDepthAdder 0
dr_use_refraction_btdf on
dr_btdf "cook_torrance"
dr_roughness_u 0
dr_roughness_v 0
dr_second_scale 0
dr_second_roughnessMultiplier 2
disperse off
dispersion 0.03
spectral_distribution "daylight"
spectral_gamut "sRGB"
spectral_clamp_negative_colors on
spectral_saturation 1
specular_scale 1
brdf "cook_torrance"
direct_specular 1
indirect_specular 1
specular_roughness_u 0
specular_roughness_v 0
specular_ray_type "Glossy"
blur_anisotropic_poles 0
enable_internal_reflections on
russian_roulette_probability 0.5
energy_cutoff_exponent -5
ward_tangent 0 1 0
refract_skydomes off
refract_skies on
reflect_skydomes on
reflect_skies on
emission_at_interfaces 0 0 0
emission_at_exits 0 0 0
emission_at_entrances 0 0 0
shadow_mode "transmit_and_outer_fresnels"
caustic_mode 0
caustic_refractions_direct on
caustic_dr_roughness_offset 0.1
caustic_refractions_indirect off
caustic_TIR off
caustic_internal_speculars off
caustic_dispersion off
caustic_specular_direct off
caustic_specular_indirect off
caustic_max_distance -1
aov_direct_refraction ""
aov_indirect_refraction "Refraction"
aov_direct_specular "Direct_Specular"
aov_indirect_specular "Indirect_Specular"
"""
NAMES = [line.split()[0] for line in INTERFACE.strip().splitlines()]
ASS_DEFAULTS = f"jf_nested_dielectric\n{{\n name Glass\n{INTERFACE}}}\n"


def parameters(body: str) -> dict:
    """The parameters of one node that is written in Arnold's way."""
    (node,) = jf.parse_ass(f"jf_nested_dielectric {{ name X {body}\n}}")
    return node.parameters


def translate(**values) -> jf.Translation:
    return jf.translate(jf.JfNode("Glass", values))


def notes(translation: jf.Translation, parameter: str) -> str:
    return "; ".join(text for name, text in translation.notes if name == parameter)


def other_value(name: str):
    """A value that is not the default."""
    kind, default = jf.JF_PARAMETERS[name]
    if isinstance(kind, tuple):
        return kind[default == kind[0]]
    if kind == "BOOL":
        return not default
    if kind == "TEXT":
        return default + "Other"
    if kind in ("RGB", "VECTOR"):
        return (0.25, 0.5, 0.75)
    return -4 if default < 0 else default + 1 if kind == "INT" else default * 0.5 + 0.3


# Reading


@pytest.mark.parametrize(
    "body, value",
    [
        ("a 2", 2),
        ("a -1.5e-3", -1.5e-3),
        ("a .5", 0.5),
        ("a +7.", 7.0),
        ("a on", True),
        ("a TRUE", True),
        ("a off", False),
        ("a false", False),
        ('a "two words"', "two words"),
        ('a ""', ""),
        ('a "a \\"quoted\\" word # } {"', 'a "quoted" word # } {'),
        ("a 0.1 0.2 0.3", (0.1, 0.2, 0.3)),
        ("a 0.1\n 0.2 # green\n 0.3", (0.1, 0.2, 0.3)),
        ("a noise1", "noise1"),
        ("a noise1.r", "noise1.r"),
        ('a "/shop/noise.r"', "/shop/noise.r"),
        ("a 1 1 FLOAT 0.5", 0.5),
        ("a 1 1 RGB 1 2 3", (1, 2, 3)),
        ("a 3 1 FLOAT 1 2 3", (3, 1, "FLOAT", 1, 2, 3)),
        ("a 1 2 POINT 1 2 3 4 5 6", (1, 2, "POINT", 1, 2, 3, 4, 5, 6)),
        ('a 2 1 STRING "x" "y"', (2, 1, "STRING", "x", "y")),
        ("a 8 1 b85POINT AB&z", (8, 1, "b85POINT", "AB&z")),
        ("a 0 1 NODE", (0, 1, "NODE")),
        ("a " + "1 0 0 0 " * 4, (1, 0, 0, 0) * 4),
    ],
)
@pytest.mark.parametrize(
    "end", ["", "\n b 5", " b 5 # last", " b 5 declare c constant FLOAT declare d uniform ARRAY RGB"]
)
def test_every_kind_of_value_is_read_on_lines_of_its_own_or_not(body, value, end):
    read = parameters(body + end)
    assert read["a"] == value and type(read["a"]) is type(value)
    assert read == ({"a": value, "b": 5} if end else {"a": value})


def test_nodes_are_found_among_others_in_any_spelling_of_their_type():
    text = """### exported from somewhere
    options { AA_samples 3 }
    include "other.ass"
    polymesh
    {
     name |ball
     vlist 2 1 b85VECTOR
    z$z0_&x
     shader "Water }" # }
     odd a#b }#c }
    jf_nested_dielectric { name Water mediumIOR 1.33 mediumPriority 2 }
    JFNestedDielectric
    {  # old
     name "Tall Glass"
     mediumIOR 1.5
    }
    jf_nested_dielectric
    {
    }
    JF_Nested_Dielectric { name 007 }"""
    nodes = jf.parse_ass(text)
    assert [node.name for node in nodes] == ["Water", "Tall Glass", "jf_nested_dielectric", "007"]
    assert nodes[0].parameters == {"mediumIOR": 1.33, "mediumPriority": 2}
    assert nodes[1].parameters == {"mediumIOR": 1.5} and nodes[2].parameters == {}


@pytest.mark.parametrize(
    "text",
    [
        '{"Water": {"mediumIOR": 1.4, "mediumTransmittance": [1, 0.5, 0]}}',
        '[{"name": "Water", "mediumIOR": 1.4, "mediumTransmittance": [1, 0.5, 0]}]',
        '{"name": "Water", "mediumIOR": 1.4, "mediumTransmittance": [1, 0.5, 0]}',
        '{"mediumIOR": 1.4, "mediumTransmittance": [1, 0.5, 0]}',
    ],
)
def test_the_forms_of_json_say_the_same(text):
    assert jf.parse_json(text, "Water") == [jf.JfNode("Water", {"mediumIOR": 1.4, "mediumTransmittance": (1, 0.5, 0)})]


def test_what_stands_there_twice_is_told():
    for node in (
        *jf.parse_ass("jf_nested_dielectric { name X mediumIOR 1.4 mediumIOR 1.6 }"),
        *jf.parse_json('{"X": {"mediumIOR": 1.4, "mediumIOR": 1.6}}', ""),
    ):
        translation = jf.translate(node)
        assert translation.keywords["ior"] == 1.6
        assert "1.6" in notes(translation, "mediumIOR")


# Saying it in our words


def test_the_interface_is_complete():
    assert list(jf.JF_PARAMETERS) == NAMES


def test_a_node_without_parameters_has_the_defaults_of_its_own_shader():
    translation = translate()
    assert translation.notes == () and translation.emission == {}
    expected = {
        "priority": 0, "ior": 1.33, "transmittance": (1, 1, 1), "transmittance_depth": 1.0,
        "roughness": 0.0, "distribution": "BECKMANN", "anisotropy": 0.0,
        "separate_reflection": False, "separate_direct_lobe": False,
        "reflection_probability": 0.5, "energy_cutoff_exponent": -5, "direct_roughness_offset": 0.05,
        "direct_second_roughness_multiplier": 2.0, "direct_world": False, "refract_sky": True, "reflect_sky": True,
        "disperse": False, "dispersion": 0.03, "dispersion_model": "JF", "spectral_gamut": "REC709",
        "spectral_distribution": "DAYLIGHT", "shadow_mode": "OUTSIDE_FRESNEL",
        "caustic_direct_refraction": True, "caustic_roughness_offset": 0.1, "caustic_refraction": False,
        "caustic_reflection": False, "caustic_direct_reflection": False, "caustic_total_reflection": False,
        "caustic_internal_reflections": False, "caustic_dispersion": False, "caustic_max_distance": -1.0,
    }  # fmt: skip
    assert {keyword: translation.keywords[keyword] for keyword in expected} == expected


def test_a_node_that_writes_every_default_down_is_the_same():
    (node,) = jf.parse_ass(ASS_DEFAULTS)
    assert list(node.parameters) == NAMES
    written = jf.translate(node)
    assert written.keywords == translate().keywords and written.emission == {}
    told = {name for name, _ in written.notes}
    assert told == {"ward_tangent", *(name for name in NAMES if name.startswith("aov"))}


def test_every_keyword_is_a_parameter_and_every_parameter_with_a_meaning_in_arnold_has_one():
    made = set(translate(btdf="ward_userTangent").keywords)
    assert made <= set(BY_KEYWORD)
    ours_alone = {"abbe", "sellmeier_b", "sellmeier_c", "normal", "thin_film_thickness", "thin_film_ior"}
    ours_alone |= {"max_interior_reflections"}
    assert {parameter.keyword for parameter in PARAMETERS if parameter.kind != "SHADER"} - made <= ours_alone


@pytest.mark.parametrize("name", NAMES)
def test_every_parameter_is_carried_over_or_told(name):
    before, after = translate(), translate(**{name: other_value(name)})
    carried = (before.keywords, before.emission) != (after.keywords, after.emission)
    assert carried or notes(after, name)
    check_keywords(after.keywords)


@pytest.mark.parametrize("name", [name for name in NAMES if name[:3] != "aov"])
def test_a_link_is_told_and_the_default_is_used(name):
    if isinstance(jf.JF_PARAMETERS[name][0], tuple):
        with pytest.raises(jf.JfError, match=f"Glass: {name}=noise1"):
            translate(**{name: "noise1"})
        return
    translation = translate(**{name: "noise1"})
    assert "noise1" in notes(translation, name) and translation.keywords == translate().keywords


@pytest.mark.parametrize(
    "name, value, told",
    [("mediumColour", 1.0, "1"), ("dcc_name", "pCube", "pCube"), ("user", tuple(range(20)), "0 1 2 3 4 5 6 7 ...")],
)
def test_an_unknown_parameter_is_told(name, value, told):
    translation = translate(**{name: value})
    assert told in notes(translation, name) and "unknown" in notes(translation, name)
    assert list(jf.report([translation])) == [f"Glass: {name}: {notes(translation, name)}"]


def test_a_single_component_is_told():
    assert "component" in notes(
        jf.translate(jf.JfNode("X", {"mediumTransmittance.r": "noise.r"})), "mediumTransmittance.r"
    )


@pytest.mark.parametrize(
    "name, value, keyword, expected",
    [
        ("mediumTransmittance", (1.5, -0.1, 0.5), "transmittance", (1.0, 0.0, 0.5)),
        ("mediumIOR", 200.0, "ior", 100.0),
        ("mediumPriority", -3, "priority", 0),
        ("refraction_scale", 2.0, "refraction_scale", 1.0),
        ("mediumTransmittance_scale", 0.0, "transmittance_depth", 1e-6),
        ("russian_roulette_probability", 1.5, "reflection_probability", 1.0),
        ("specular_roughness_u", 3.0, "reflection_roughness", 1.0),
        ("refraction_roughness_u", -0.5, "roughness", 0.0),
        ("caustic_max_distance", -7.0, "caustic_max_distance", -1.0),
        ("caustic_max_distance", 0.0, "caustic_max_distance", -1.0),
        ("direct_specular", 1.5, "direct_reflection", 1.0),
        ("energy_cutoff_exponent", -30, "energy_cutoff_exponent", -20),
    ],
)
def test_a_value_beyond_our_limits_is_moved_and_told(name, value, keyword, expected):
    translation = translate(**{name: value})
    assert translation.keywords[keyword] == expected
    assert "->" in notes(translation, name)
    check_keywords(translation.keywords)


@pytest.mark.parametrize(
    "name, word, keyword, expected",
    [
        ("shadow_mode", "black", "shadow_mode", "BLACK"),
        ("shadow_mode", 1, "shadow_mode", "TRANSMISSION"),
        ("shadow_mode", "transmit_and_all_fresnels", "shadow_mode", "ALL_FRESNEL"),
        ("spectral_distribution", "flourescent", "spectral_distribution", "FLUORESCENT"),
        ("spectral_distribution", "fluorescent", "spectral_distribution", "FLUORESCENT"),
        ("spectral_distribution", "Blue Sky", "spectral_distribution", "BLUE_SKY"),
        ("spectral_distribution", 0, "spectral_distribution", "FULL"),
        ("spectral_gamut", "ACES", "spectral_gamut", "ACES_AP0"),
        ("spectral_gamut", 3, "spectral_gamut", "PROPHOTO"),
        ("btdf", 2, "tangent_from", "REFRACTION"),
        ("btdf", "anisotropic_ray_tangent", "tangent_from", "REFRACTION"),
        ("brdf", "ward_userTangent", "tangent", (0.0, 1.0, 0.0)),
        ("polarization_angle", 0.5, "polarization_angle", math.pi / 2),
        ("reflect_skydomes", False, "reflect_sky", True),
        ("disperse", "on", "disperse", True),
    ],
)
def test_words_and_numbers_find_their_meaning(name, word, keyword, expected):
    assert translate(**{name: word}).keywords[keyword] == expected


def test_lamps_are_scaled_in_proportion_to_rays():
    keywords = translate(
        specular_scale=0.5, indirect_specular=0.8, direct_specular=0.4, refraction_scale=0.9, direct_refraction=0.0
    ).keywords
    assert keywords["specular_scale"] == pytest.approx(0.4) and keywords["direct_reflection"] == pytest.approx(0.5)
    assert keywords["refraction_scale"] == pytest.approx(0.9) and keywords["direct_refraction"] == 0.0
    lost = translate(indirect_refraction=0.0)
    assert lost.keywords["refraction_scale"] == 0.0 and "lost" in notes(lost, "direct_refraction")


@pytest.mark.parametrize("mode, on", [(0, True), (1, True), (2, False)])
def test_the_kind_of_caustics_decides_about_the_switches(mode, on):
    translation = translate(caustic_mode=mode, caustic_TIR=True)
    assert translation.keywords["caustic_total_reflection"] is on
    assert translation.keywords["caustic_direct_refraction"] is on
    assert bool(notes(translation, "caustic_mode")) is (mode != 0)


def test_emission_is_kept_but_cannot_be_negative():
    translation = translate(emission_at_exits=(0.0, 2.0, 0.5), emission_at_entrances=(-1.0, 0.0, 0.0))
    assert translation.emission == {"Emission at Exits": (0.0, 2.0, 0.5)}
    assert "->" in notes(translation, "emission_at_entrances")


# Lobes


def alphas(roughness: float, anisotropy: float) -> tuple[float, float]:
    """As anisotropic_alpha() of osl/optics.h."""
    alpha, stretch = roughness**2, 1.0 - min(abs(anisotropy), 0.99)
    along, across = alpha * stretch, min(alpha / stretch, 1.0)
    return (along, across) if anisotropy >= 0.0 else (across, along)


@pytest.mark.parametrize(
    "widths", [(0.3, 0.3), (0.1, 0.4), (0.4, 0.1), (1e-4, 1.0), (1.0, 1e-4), (1.0, 0.2), (0.0, 0.0), (3e-9, 1e-6)]
)
def test_the_shader_recovers_the_widths_of_a_lobe(widths):
    roughness, anisotropy = jf.roughness_and_anisotropy(*widths)
    check_keywords({"roughness": roughness, "anisotropy": anisotropy})
    assert alphas(roughness, anisotropy) == pytest.approx(widths, rel=1e-9)


@pytest.mark.parametrize(
    "lobe, roughness, word, prefix, along, across",
    [
        ("btdf", "refraction", "ward_rayTangent", "", 0.36, 0.04),
        ("btdf", "refraction", "ward_userTangent", "", 0.36, 0.04),
        ("brdf", "specular", "ward_rayTangent", "reflection_", 0.3, 0.1),
        ("brdf", "specular", "ward_userTangent", "reflection_", 0.1, 0.3),
        ("dr_btdf", "dr", "ward_userTangent", "direct_", 0.36, 0.04),
        ("btdf", "refraction", "stretched_phong", "", 0.04, 0.04),
        ("brdf", "specular", "cook_torrance", "reflection_", 0.1, 0.1),
    ],
)
def test_lobes_are_as_wide_as_in_arnold_along_and_across_the_tangent(lobe, roughness, word, prefix, along, across):
    keywords = translate(**{lobe: word, f"{roughness}_roughness_u": 0.2, f"{roughness}_roughness_v": 0.6}).keywords
    assert keywords[f"{prefix}distribution"] == "BECKMANN"
    made = alphas(keywords[f"{prefix}roughness"], keywords[f"{prefix}anisotropy"])
    assert made == pytest.approx((along, across), rel=1e-9)


def test_round_lobes_take_one_roughness_and_say_so():
    translation = translate(refraction_roughness_u=0.3, refraction_roughness_v=0.7)
    assert translation.keywords["roughness"] == pytest.approx(0.3) and translation.keywords["anisotropy"] == 0.0
    assert "without effect" in notes(translation, "refraction_roughness_v")


def test_a_lobe_that_is_too_thin_is_as_long_as_can_be():
    translation = translate(btdf="ward_rayTangent", refraction_roughness_u=0.0, refraction_roughness_v=0.5)
    keywords = translation.keywords
    assert alphas(keywords["roughness"], keywords["anisotropy"]) == pytest.approx((0.25, 0.25e-4))
    assert notes(translation, "refraction_roughness_u")


def test_reflection_is_separate_only_where_its_lobe_differs():
    same = translate(refraction_roughness_u=0.5, specular_roughness_u=0.5).keywords  # 0.5^2 = 0.5 / 2
    assert not same["separate_reflection"] and same["roughness"] == pytest.approx(0.5)
    other = translate(refraction_roughness_u=0.5, specular_roughness_u=0.18).keywords
    assert other["separate_reflection"] and other["reflection_roughness"] == pytest.approx(0.3)


def test_direct_refraction_takes_its_own_lobe_only_where_it_has_one():
    values = {"dr_btdf": "ward_rayTangent", "dr_roughness_u": 0.4, "dr_roughness_v": 0.2}
    assert not translate(**values).keywords["separate_direct_lobe"]
    keywords = translate(dr_use_refraction_btdf=False, **values).keywords
    assert keywords["separate_direct_lobe"] and keywords["tangent_from"] == "REFRACTION"


def test_lobes_that_refer_to_different_tangents_are_told():
    translation = translate(
        btdf="ward_rayTangent", refraction_roughness_u=0.4, brdf="ward_userTangent", specular_roughness_v=0.4
    )
    assert translation.keywords["tangent_from"] == "REFRACTION" and "tangent" not in translation.keywords
    assert "share a tangent" in notes(translation, "brdf")
    round_lobe = translate(btdf="ward_rayTangent", brdf="ward_userTangent", specular_roughness_v=0.4)
    assert round_lobe.keywords["tangent_from"] == "TANGENT"


# What cannot be read


@pytest.mark.parametrize(
    "body, words",
    [
        ("mediumIOR nan", ("mediumIOR=nan", "finite number")),
        ("mediumIOR -inf", ("mediumIOR=-inf", "finite number")),
        ("mediumIOR 1.#QNAN", ("mediumIOR", "finite number")),
        ("mediumIOR 1.3.3", ("mediumIOR=1.3.3", "finite number")),
        ("mediumIOR on", ("mediumIOR", "finite number")),
        ("mediumIOR 1 2", ("mediumIOR=1 2", "finite number")),
        ("mediumIOR " + "9" * 500, ("mediumIOR", "finite number")),
        ("mediumPriority 1.5", ("mediumPriority=1.5", "whole number")),
        ("mediumTransmittance 1 0.5", ("mediumTransmittance=1 0.5", "three numbers")),
        ("mediumTransmittance 1 0.5 nan", ("mediumTransmittance", "finite number")),
        ("mediumTransmittance 2 1 RGB 1 1 1 0 0 0", ("mediumTransmittance", "three numbers")),
        ("disperse 2", ("disperse=2", "on or off")),
        ('btdf "ggx"', ("btdf=ggx", "cook_torrance", "ward_userTangent")),
        ("btdf 4", ("btdf=4", "0 to 3")),
        ("shadow_mode on", ("shadow_mode", "black")),
        ("mediumIOR", ("mediumIOR", "missing")),
        ("mediumIOR 1.5 \n on 7", ("True", "mediumIOR", "remove")),
        ("user 5 1 FLOAT 1 2", ("user", "missing")),
    ],
)
def test_a_value_that_is_none_is_named_with_its_node_and_the_remedy(body, words):
    with pytest.raises(jf.JfError) as error:
        jf.translate(jf.parse_ass(f"jf_nested_dielectric {{ name Tumbler {body} }}")[0])
    assert all(word in str(error.value) for word in ("Tumbler", *words)), str(error.value)


@pytest.mark.parametrize("value", [None, {"r": 1}, [1, [2], 3], True, math.nan, math.inf])
@pytest.mark.parametrize("name", ["mediumIOR", "mediumTransmittance"])
def test_json_that_is_no_number_is_named(name, value):
    (node,) = jf.parse_json(json.dumps([{"name": "X", name: value}]), "")
    with pytest.raises(jf.JfError, match=f"X: {name}="):
        jf.translate(node)


@pytest.mark.parametrize(
    "text, word",
    [
        ("jf_nested_dielectric { name X mediumIOR 1.5", "no closing brace"),
        ("polymesh {", "no closing brace"),
        ("jf_nested_dielectric { { } }", "line 1"),
        ("\n\n}", "line 3"),
        ('\njf_nested_dielectric { name "X }', "line 2"),
    ],
)
def test_a_broken_scene_file_is_named(text, word):
    with pytest.raises(jf.JfError, match=word):
        jf.parse_ass(text)


@pytest.mark.parametrize(
    "text", ["", "{", "3", '"x"', "[1]", '[{"a": 1}, 2]', '{"Water": {"mediumIOR": 1}, "mediumIOR": 1}']
)
def test_json_of_another_form_is_named(text):
    with pytest.raises(jf.JfError):
        jf.parse_json(text, "X")


# The command


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "nested_dielectric", "import-jf", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_command_makes_a_file_of_materials_and_prints_every_note(tmp_path):
    source = tmp_path / "scene.ass"
    source.write_text(
        """
        jf_nested_dielectric { name Water mediumIOR 1.34 mediumPriority 2 mediumTransmittance 0.9 1.2 1 }
        jf_nested_dielectric
        {
         name "Tall Glass"
         mediumIOR noise1
         disperse on
         spectral_distribution "LED"
         spectral_gamut "ACES"
         btdf "ward_rayTangent"
         refraction_roughness_u 0.2
         refraction_roughness_v 0.4
         emission_at_exits 0 2 0.5
         shadow_mode 0
         sparkle 3
        }"""
    )
    done = run(source)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert any(line.startswith("Water: mediumTransmittance: 0.9 1.2 1 -> 0.9 1 1") for line in lines)
    assert any(line.startswith("Tall Glass: mediumIOR: the link to 'noise1'") for line in lines)
    assert any(line.startswith("Tall Glass: sparkle: unknown") for line in lines)
    output = tmp_path / "scene.blend"
    assert lines[-1].startswith("wrote 2 materials to") and lines[-1].endswith(str(output))

    bpy.ops.wm.open_mainfile(filepath=str(output))
    assert not bpy.data.objects
    translations = {node.name: jf.translate(node) for node in jf.read_nodes(source)}
    for name, translation in translations.items():
        material = bpy.data.materials[name]
        node = dielectric_node(material)
        settings = spectrum_settings(material)
        for keyword, value in translation.keywords.items():
            held = settings[keyword] if keyword in settings else get_parameter(node, BY_KEYWORD[keyword])
            same = held == value if isinstance(value, (str, bool)) else held == pytest.approx(value, rel=1e-6)
            assert same, (name, keyword, held, value)
    glass = dielectric_node(bpy.data.materials["Tall Glass"])
    (link,) = glass.inputs["Emission at Exits"].links
    assert tuple(link.from_node.inputs["Color"].default_value) == (0.0, 2.0, 0.5, 1.0)
    assert not glass.inputs["Emission at Entrances"].is_linked


def test_materials_are_added_to_the_file_that_is_open(tmp_path, capsys):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.data.objects.new("Prop", None).use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "open.blend"))
    (tmp_path / "jf.json").write_text('{"Water": {"mediumIOR": 1.4}, "Ice": {}, "Water": {}}')
    output = tmp_path / "new" / "both.blend"
    assert cli.main(["import-jf", str(tmp_path / "jf.json"), "--output", str(output)]) == 0
    assert "Water: name: the material is called 'Water.001'" in capsys.readouterr().out
    with bpy.data.libraries.load(str(output)) as (content, _):
        assert "Prop" in content.objects and set(content.materials) == {"Ice", "Water", "Water.001"}
    bpy.ops.wm.read_factory_settings(use_empty=True)


@pytest.mark.parametrize(
    "name, text, arguments, words",
    [
        (
            "a.ass",
            "jf_nested_dielectric { name Tumbler mediumIOR nan }",
            (),
            ("Tumbler", "mediumIOR", "finite"),
        ),
        ("a.ass", "polymesh { name ball }", (), ("a.ass", "no jf_nested_dielectric")),
        ("a.ass", "jf_nested_dielectric { name X", (), ("a.ass", "closing brace")),
        ("a.json", "{}", (), ("a.json", "no jf_nested_dielectric")),
        ("a.json", "{", (), ("a.json", "JSON")),
        ("a.ma", "", (), ("a.ma", ".ass or .json")),
        ("a.ass", "jf_nested_dielectric { }", ("-o", "b.png"), ("b.png", ".blend")),
    ],
)
def test_the_command_names_what_it_cannot_read_and_writes_nothing(
    name, text, arguments, words, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(text)
    assert cli.main(["import-jf", name, *arguments]) == 1
    error = capsys.readouterr().err.strip()
    assert error.startswith("nested-dielectric: error: ") and len(error.splitlines()) == 1
    assert all(word in error for word in words), error
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_the_command_does_not_overwrite_a_file_that_was_not_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text('{"mediumIOR": 1.4}')
    Path("a.blend").write_text("a scene")
    assert cli.main(["import-jf", "a.json"]) == 1
    assert "a.blend" in capsys.readouterr().err and Path("a.blend").read_text() == "a scene"
    Path("b.ass").write_bytes(b"\x1f\x8b\xff")
    assert cli.main(["import-jf", "b.ass"]) == 1 and "unpack" in capsys.readouterr().err
    assert cli.main(["import-jf", "c.ass"]) == 1 and "c.ass" in capsys.readouterr().err
