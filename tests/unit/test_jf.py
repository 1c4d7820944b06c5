"""Every parameter of JF's shader is carried over or told."""

import math

import pytest
from jf_nodes import notes

from nested_dielectric.importers import jf_lobes, jf_parameters, jf_reader, jf_translation
from nested_dielectric.model.parameters import BY_KEYWORD, PARAMETERS, check_keywords

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


def translate(**values) -> jf_translation.Translation:
    return jf_translation.translate(jf_reader.JfNode("Glass", values))


def other_value(name: str):
    """A value that is not the default."""
    kind, default = jf_parameters.JF_PARAMETERS[name]
    if isinstance(kind, tuple):
        return kind[default == kind[0]]
    if kind == "BOOL":
        return not default
    if kind == "TEXT":
        return default + "Other"
    if kind in ("RGB", "VECTOR"):
        return (0.25, 0.5, 0.75)
    return -4 if default < 0 else default + 1 if kind == "INT" else default * 0.5 + 0.3


def test_the_interface_is_complete():
    assert list(jf_parameters.JF_PARAMETERS) == NAMES


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
    (node,) = jf_reader.parse_ass(ASS_DEFAULTS)
    assert list(node.parameters) == NAMES
    written = jf_translation.translate(node)
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
    if isinstance(jf_parameters.JF_PARAMETERS[name][0], tuple):
        with pytest.raises(jf_parameters.JfError, match=f"Glass: {name}=noise1"):
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
    assert list(jf_translation.report([translation])) == [f"Glass: {name}: {notes(translation, name)}"]


def test_a_single_component_is_told():
    assert "component" in notes(
        jf_translation.translate(jf_reader.JfNode("X", {"mediumTransmittance.r": "noise.r"})), "mediumTransmittance.r"
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


def test_lights_are_scaled_in_proportion_to_rays():
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


def alphas(roughness: float, anisotropy: float) -> tuple[float, float]:
    """As anisotropic_alpha() of osl/fresnel.h."""
    alpha, stretch = roughness**2, 1.0 - min(abs(anisotropy), 0.99)
    along, across = alpha * stretch, min(alpha / stretch, 1.0)
    return (along, across) if anisotropy >= 0.0 else (across, along)


@pytest.mark.parametrize(
    "widths", [(0.3, 0.3), (0.1, 0.4), (0.4, 0.1), (1e-4, 1.0), (1.0, 1e-4), (1.0, 0.2), (0.0, 0.0), (3e-9, 1e-6)]
)
def test_the_shader_recovers_the_widths_of_a_lobe(widths):
    roughness, anisotropy = jf_lobes.roughness_and_anisotropy(*widths)
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
