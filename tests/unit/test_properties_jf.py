"""Arnold's files, generated and broken."""

import json

import property_tests
from hypothesis import given, settings
from hypothesis import strategies as st

from nested_dielectric.importers.jf_parameters import JF_PARAMETERS, NODE_TYPE, JfError
from nested_dielectric.importers.jf_reader import parse_ass, parse_json
from nested_dielectric.importers.jf_translation import translate
from nested_dielectric.model.parameters import check_keywords

words = st.from_regex(r"[A-Za-z_][A-Za-z_0-9]*", fullmatch=True)
numbers = st.floats(-1e6, 1e6, allow_nan=False)
FOREIGN = "# a comment { with braces\npolymesh { name box visibility 255 }\n"


def value_of(kind) -> st.SearchStrategy:
    if isinstance(kind, tuple):
        return st.sampled_from(kind)
    if kind == "INT":
        return st.integers(-(2**31), 2**31 - 1)
    if kind == "BOOL":
        return st.booleans()
    return st.tuples(numbers, numbers, numbers) if kind in ("RGB", "VECTOR") else numbers


KINDS = {name: value_of(kind) for name, (kind, _) in JF_PARAMETERS.items()}

nodes = st.tuples(words, st.fixed_dictionaries({}, optional=KINDS))


def written(value) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, tuple):
        return " ".join(map(repr, value))
    return f'"{value}"' if isinstance(value, str) else repr(value)


def ass(name: str, parameters: dict) -> str:
    lines = [f" {parameter} {written(value)}" for parameter, value in parameters.items()]
    return "\n".join([NODE_TYPE, "{", f" name {name}", *lines, "}\n"])


@settings(max_examples=property_tests.FEW)
@given(st.lists(nodes, max_size=3))
def test_nodes_are_read_as_they_were_written(wanted):
    text = FOREIGN.join(ass(*node) for node in wanted)
    read = parse_ass(text)
    assert [(node.name, dict(node.parameters)) for node in read] == wanted


@settings(max_examples=property_tests.FEW)
@given(nodes)
def test_every_node_becomes_values_that_media_take(node):
    (read,) = parse_ass(ass(*node))
    check_keywords(translate(read).keywords)


SIGNS = ("{", "}", '"', "\\", "#", "\n", "name", "declare", "1", "2", "-1", "1e999", "nan", "3 3 RGB", "b85")
pieces = st.sampled_from((NODE_TYPE, *SIGNS, *[*JF_PARAMETERS][:6]))


@given(st.one_of(st.text(), st.lists(st.one_of(pieces, st.text(max_size=5)), max_size=25).map(" ".join)))
def test_any_text_is_read_or_refused(text):
    for broken in (text, f"{NODE_TYPE} {{ {text} }}"):
        try:
            for node in parse_ass(broken):
                translate(node)
        except JfError as error:
            assert str(error)


json_values = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text()),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(), inner, max_size=4)),
    max_leaves=10,
)


@given(st.one_of(st.text(), json_values.map(json.dumps)))
def test_any_json_is_read_or_refused(text):
    try:
        for node in parse_json(text, "file"):
            translate(node)
    except JfError as error:
        assert str(error)
