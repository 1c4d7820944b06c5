"""Values that no slider gives are bounded in Python as in the shader, or named."""

import re

import numpy as np
import pytest
from odd_values import BOUNDED, INF, NAN, PRIORITIES
from scenes import add_box, add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.model import parameters, shader_source
from nested_dielectric.model.parameters import BY_KEYWORD, BY_NAME


def test_the_shader_uses_no_number_of_the_table_before_it_is_bounded():
    """The shader itself only hands numbers on, and what takes them bounds them."""
    source = shader_source.without_comments(shader_source.inlined_source("nested_dielectric.osl"))
    body = source[source.index("shader nested_dielectric(") :].partition(")\n{")[2]
    for parameter in BOUNDED:
        limits = f"{parameter.keyword.upper()}_LIMITS"
        assert re.search(rf"\bbounded\([\w.]+, {limits}\)", source), parameter.name
        body = body.replace(f"bounded({parameter.osl_name}, {limits})", "")
        uses = re.findall(rf"(\S\s*)\b{parameter.osl_name}\b(\s*\S)", body)
        assert all(before.strip() in "({," and after.strip() in ")},;" for before, after in uses), parameter.name


@pytest.mark.parametrize(
    "name, value, expected",
    [
        ("IOR", 1.5, 1.5),
        ("IOR", 1e30, 100.0),
        ("IOR", -1.0, 0.01),
        ("IOR", NAN, 1.33),
        ("IOR", -INF, 1.33),
        ("Priority", 5000, 1000),
        ("Priority", -5, 0),
        ("Dispersion Model", 7, 2),
        ("Transmittance", (2.0, -1.0, 0.5, 1.0), (1.0, 0.0, 0.5, 1.0)),
        ("Transmittance", (0.2, NAN, 0.5, 1.0), (1.0, 1.0, 1.0, 1.0)),
        ("Sellmeier C", (INF, 0.0, 0.0), BY_KEYWORD["sellmeier_c"].default),
    ],
)
def test_python_takes_a_value_for_what_the_shader_does(name, value, expected):
    assert BY_NAME[name].bounded(value) == expected


def two_media():
    """A ball of priority 4 half in a sea of priority 2."""
    scene = new_scene(12)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=26)
    add_box("Sea", (-1, -1, -1), (1, 1, 0.1), nd.new_material("Sea", ior=1.2, priority=2))
    return scene, add_sphere("Ball", 0.8, nd.new_material("Glass", ior=1.6, priority=4), segments=32)


def test_an_odd_priority_is_named_with_what_it_counts_as():
    scene, obj = two_media()
    for value, number in PRIORITIES:
        obj["nd_priority"] = value
        assert nd.get_priority(obj) == (4 if number is None else number)
        (problem,) = nd.prepare(scene).problems
        words = "does not count: 4" if number is None else f"counts as {number}"
        assert problem.name == "Ball" and words in problem.text and "set its priority again" in problem.remedy
        nd.set_priority(obj, nd.get_priority(obj))
        assert find_problems(scene) == [] and type(obj["nd_priority"]) is int


def test_keyframes_of_a_priority_beyond_the_limits_are_named():
    scene, obj = two_media()
    nd.set_priority(obj, 3)
    for frame, priority in ((1, 3), (5, 7)):
        obj["nd_priority"] = priority
        obj.keyframe_insert('["nd_priority"]', frame=frame)
    assert not any("keyframes" in problem.text for problem in find_problems(scene))
    obj["nd_priority"] = -2
    obj.keyframe_insert('["nd_priority"]', frame=9)
    scene.frame_set(1)
    assert any("keyframes of its priority beyond" in problem.text for problem in find_problems(scene))


def test_a_priority_that_a_driver_takes_off_the_whole_numbers_is_named():
    scene, obj = two_media()
    obj["nd_priority"] = 1.0
    driver = obj.driver_add('["nd_priority"]').driver
    driver.type, driver.expression = "SCRIPTED", "2.5"
    scene.view_layers[0].update()
    assert nd.get_priority(obj) == 4
    assert any("does not count" in problem.text for problem in nd.prepare(scene).problems)


@pytest.mark.parametrize("value", (10**400, np.array([1, 2]), b"one", None), ids=str)
def test_values_of_no_use_are_refused_by_name(value):
    for keyword in ("ior", "priority", "polarize", "shadow_mode", "transmittance", "spectral_distribution"):
        with pytest.raises(nd.ParameterError, match=keyword):
            nd.new_material("M", **{keyword: value})
    assert parameters.BY_KEYWORD["ior"].check(1.5) == 1.5
