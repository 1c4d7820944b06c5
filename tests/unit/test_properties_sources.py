"""Texts and words: sources of shaders, the contract's macros, choices, effects, presets' files."""

import math
import os
import re
import tempfile
from pathlib import Path

import property_tests
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nested_dielectric.model import contract, files
from nested_dielectric.model.choice import Choice, keyword_of
from nested_dielectric.model.effects import has_effect, limits_at_work
from nested_dielectric.model.osl_contract import macros, osl_contract
from nested_dielectric.model.parameter import LARGEST, is_number
from nested_dielectric.model.parameters import BY_KEYWORD, PARAMETERS, SOCKETS
from nested_dielectric.model.presets import Preset, all_presets, preset_names, preset_text
from nested_dielectric.model.shader_source import inlined_source, without_comments

# Shaders

NAMES = ("a", "b", "c", "d", "e")

trees = st.fixed_dictionaries({name: st.lists(st.sampled_from(NAMES), max_size=3) for name in NAMES})


@given(trees)
def test_every_header_is_inlined_once_where_it_is_met_first(includes):
    with tempfile.TemporaryDirectory() as folder:
        for name, others in includes.items():
            lines = ["#pragma once", *(f'#include "{other}.h"' for other in others), f"body of {name}"]
            Path(folder, f"{name}.h").write_text("\n".join(lines) + "\n", encoding="utf-8")
        Path(folder, "test.osl").write_text('#include "a.h"\nshader\n', encoding="utf-8")
        text = inlined_source("test.osl", Path(folder))
    seen = []

    def meet(name: str) -> list[str]:
        if name in seen:
            return []
        seen.append(name)
        return [*(line for other in includes[name] for line in meet(other)), f"body of {name}"]

    assert text.splitlines() == [*meet("a"), "shader"]


def test_a_header_that_is_missing_is_named():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "test.osl").write_text('#include "gone.h"\n', encoding="utf-8")
        with pytest.raises(FileNotFoundError, match=r"gone\.h"):
            inlined_source("test.osl", Path(folder))


pieces = st.lists(
    st.sampled_from(("/* a */", "/*b\nc*/", "// d\n", "x = 1;", "\n", "  ", "y / 2", "z * 3", "/", "*", "\t")),
    max_size=20,
).map("".join)


def stripped(source: str) -> str:
    """Read a text letter by letter and leave out comments."""
    out, place = [], 0
    while place < len(source):
        if source.startswith("/*", place) and (end := source.find("*/", place + 2)) >= 0:
            place = end + 2
        elif source.startswith("//", place):
            end = source.find("\n", place)
            place = len(source) if end < 0 else end
        else:
            out.append(source[place])
            place += 1
    return "".join(out)


@given(pieces)
def test_a_source_without_comments_is_what_a_reader_leaves_of_it(source):
    expected = "\n".join(line.rstrip() for line in stripped(source).splitlines() if line.strip())
    assert without_comments(source) == expected
    assume("/*" not in expected and "//" not in expected)
    assert without_comments(without_comments(source)) == expected


def test_macros_have_names_of_their_own_and_say_what_python_knows():
    names = [name for name, _ in macros()]
    assert len(names) == len(set(names))
    values = dict(macros())
    assert osl_contract() == "".join(f"#define {name} {value}\n" for name, value in macros())
    for parameter in SOCKETS:
        if parameter.limits is not None:
            limits = values[f"{parameter.keyword.upper()}_LIMITS"]
            assert tuple(map(float, limits.split(", ")[:2])) == pytest.approx(parameter.limits[:2], rel=0)
        if parameter.kind in ("COLOR", "VECTOR"):
            numbers = re.findall(r"[-\d.e+]+(?=[,)])", values[f"{parameter.keyword.upper()}_DEFAULT"])
            assert tuple(map(float, numbers)) == parameter.default
        if parameter.kind == "FLOAT":
            assert float(values[f"{parameter.keyword.upper()}_DEFAULT"]) == parameter.default


@given(st.integers(0, 99), st.sampled_from([parameter.name for parameter in SOCKETS]))
def test_paths_of_sockets_are_those_that_the_shader_spells(slot, name):
    spelled = dict(macros())["SOCKET(slot, name)"]
    inside = "".join(
        {"slot": str(slot), "name": name}.get(word, literal.replace('\\"', '"').replace("\\001", "\001"))
        for literal, word in re.findall(r'"((?:[^"\\]|\\.)*)"|(\bslot\b|\bname\b)', spelled)
    )
    assert inside == "\001object:" + contract.socket_path(slot, name)


# Words


@given(property_tests.VALUES, st.text(), st.text(), st.text())
def test_a_choice_has_a_keyword_and_all_else_is_its_own(value, keyword, name, description):
    assert keyword_of(Choice(keyword, name, description)) == keyword
    assert keyword_of(value) is value


@given(st.floats(width=32))
def test_numbers_are_what_single_precision_holds_short_of_its_end(value):
    assert is_number(value) == (math.isfinite(value) and abs(value) < LARGEST)


def values_of(parameter) -> st.SearchStrategy:
    """Values with and without effect."""
    if parameter.choices:
        return st.sampled_from([choice.keyword for choice in parameter.choices])
    if parameter.kind == "BOOL":
        return st.booleans()
    if parameter.kind == "COLOR":
        return st.sampled_from([(1.0, 1.0, 1.0), (0.5, 0.5, 0.5), (0.0, 0.0, 0.0)])
    return st.sampled_from([0.0, parameter.maximum, parameter.default])


MATERIALS = st.fixed_dictionaries(
    {},
    optional={
        each.keyword: values_of(each)
        for each in PARAMETERS
        if each.kind in ("BOOL", "COLOR", "FLOAT", "INT", "INDEX", "MENU")
    },
)


def shows(keyword: str, values: dict) -> bool:
    """Whether what has that keyword may be at work, by asking all it needs in turn."""
    parameter = BY_KEYWORD.get(keyword)
    value = values.get(keyword, True)
    if parameter is not None and parameter.kind == "COLOR" and keyword in values:
        value = tuple(value) != parameter.default
    needs = parameter.needs if parameter is not None else ()
    return bool(value) and (not needs or any(shows(need, values) for need in needs))


@given(MATERIALS)
def test_a_parameter_shows_where_something_that_it_needs_does(values):
    for parameter in PARAMETERS:
        expected = not parameter.needs or any(shows(need, values) for need in parameter.needs)
        assert has_effect(parameter, values) == expected


@given(MATERIALS, st.sampled_from([(5, 2, 0), (5, 3, 0), (6, 0, 0)]))
def test_limits_go_with_later_versions_and_where_nothing_is_changed(values, version):
    found = limits_at_work(values, version)
    assert set(limits_at_work(values, (9, 9, 9))) <= set(found) <= set(limits_at_work(values, (5, 1, 0)))
    assert set(found) <= set(limits_at_work({}, version))  # what is not known may be anything
    neutral = {
        each.keyword: each.default if each.limit is None or each.limit.neutral is None else each.limit.neutral
        for each in SOCKETS
        if each.kind != "SHADER"
    }
    assert not {limit for limit, parameter in limits_at_work(neutral, version).items() if parameter.keyword in neutral}
    for limit, parameter in found.items():
        assert limit.decides and parameter.limit == limit and has_effect(parameter, values)
        assert limit.before is None or version < limit.before


# Presets and files

sentences = st.text(max_size=20)


@settings(max_examples=property_tests.FEW)
@given(
    st.lists(sentences, min_size=4, max_size=4),
    st.lists(sentences, max_size=3),
    st.floats(0.0, 10.0),
    st.floats(0.0, 1.0),
)
def test_a_presets_colour_is_what_takes_light_on_its_way(words, tags, depth, red):
    parameters = {"transmittance": [red, 1.0, 1.0], "transmittance_depth": depth}
    preset = Preset("key", words[0], words[1], tuple(tags), words[2], words[3], parameters)
    assert preset.depth == depth and preset.has_colour == (red < 1.0 and depth > 0.0)
    lines = preset_text(preset).splitlines()
    assert lines[-2:] == [f"transmittance = [{red!r}, 1.0, 1.0]", f"transmittance_depth = {depth!r}"]
    bare = Preset("key", "", "", (), "", "", {})
    assert bare.depth == BY_KEYWORD["transmittance_depth"].default and not bare.has_colour


def test_presets_are_named_by_their_files_in_order():
    names = preset_names()
    assert list(names) == sorted(names) and {preset.key for preset in all_presets()} == set(names)


parts = st.sampled_from(("one", "two", "..", ".", "link"))


@given(st.lists(parts, min_size=1, max_size=6), st.booleans())
def test_a_path_leads_through_links_to_one_place_with_one_slash(names, twice):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve()
        (root / "one" / "two").mkdir(parents=True)
        (root / "link").symlink_to(root / "one")
        path = str(root.joinpath(*names))
        found = files.absolute(f"/{path}" if twice and os.sep == "/" else path)
        assert found == files.absolute(path) == Path(os.path.realpath(path)) and not str(found).startswith("//")
        assert files.absolute(found) == found


@settings(max_examples=property_tests.FEW)
@given(st.dictionaries(st.sampled_from(("a.txt", "deep/b.txt", "deep/er/c.txt")), st.binary(), min_size=1), st.binary())
def test_a_folder_of_files_is_put_in_place_and_what_stands_there_stays(contents, kept):
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "out")
        target.mkdir()
        (target / "kept.txt").write_bytes(kept)
        with files.replacing_in(target) as draft:
            for name, content in contents.items():
                (draft / name).parent.mkdir(parents=True, exist_ok=True)
                (draft / name).write_bytes(content)
        there = {str(path.relative_to(target)): path.read_bytes() for path in target.rglob("*") if path.is_file()}
        assert there == {**contents, "kept.txt": kept}
        with pytest.raises(ZeroDivisionError), files.replacing_in(target) as draft:
            (draft / "a.txt").write_bytes(b"half")
            raise ZeroDivisionError
        after = {str(path.relative_to(target)): path.read_bytes() for path in target.rglob("*") if path.is_file()}
        assert after == there and set(os.listdir(folder)) == {"out"}
