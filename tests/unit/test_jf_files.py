"""Scene files of JF are read, in any spelling, or named with what is wrong."""

import json
import math

import pytest
from jf_nodes import notes

from nested_dielectric.importers import jf_parameters, jf_reader, jf_translation


def parameters(body: str) -> dict:
    """The parameters of one node that is written in Arnold's way."""
    (node,) = jf_reader.parse_ass(f"jf_nested_dielectric {{ name X {body}\n}}")
    return node.parameters


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
    nodes = jf_reader.parse_ass(text)
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
    assert jf_reader.parse_json(text, "Water") == [
        jf_reader.JfNode("Water", {"mediumIOR": 1.4, "mediumTransmittance": (1, 0.5, 0)})
    ]


def test_what_stands_there_twice_is_told():
    for node in (
        *jf_reader.parse_ass("jf_nested_dielectric { name X mediumIOR 1.4 mediumIOR 1.6 }"),
        *jf_reader.parse_json('{"X": {"mediumIOR": 1.4, "mediumIOR": 1.6}}', ""),
    ):
        translation = jf_translation.translate(node)
        assert translation.keywords["ior"] == 1.6
        assert "1.6" in notes(translation, "mediumIOR")


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
    with pytest.raises(jf_parameters.JfError) as error:
        jf_translation.translate(jf_reader.parse_ass(f"jf_nested_dielectric {{ name Tumbler {body} }}")[0])
    assert all(word in str(error.value) for word in ("Tumbler", *words)), str(error.value)


@pytest.mark.parametrize("value", [None, {"r": 1}, [1, [2], 3], True, math.nan, math.inf])
@pytest.mark.parametrize("name", ["mediumIOR", "mediumTransmittance"])
def test_json_that_is_no_number_is_named(name, value):
    (node,) = jf_reader.parse_json(json.dumps([{"name": "X", name: value}]), "")
    with pytest.raises(jf_parameters.JfError, match=f"X: {name}="):
        jf_translation.translate(node)


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
    with pytest.raises(jf_parameters.JfError, match=word):
        jf_reader.parse_ass(text)


@pytest.mark.parametrize(
    "text", ["", "{", "3", '"x"', "[1]", '[{"a": 1}, 2]', '{"Water": {"mediumIOR": 1}, "mediumIOR": 1}']
)
def test_json_of_another_form_is_named(text):
    with pytest.raises(jf_parameters.JfError):
        jf_reader.parse_json(text, "X")
