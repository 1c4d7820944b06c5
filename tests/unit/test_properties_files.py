"""Presets and files with any names and texts."""

import re
import tempfile
from pathlib import Path

import property_tests
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nested_dielectric.model.files import MARK, WriteError, replacing
from nested_dielectric.model.parameter import ParameterError
from nested_dielectric.model.parameters import PARAMETERS
from nested_dielectric.model.presets import LONGEST_KEY, Preset, key_of, load_preset, renamed, save_preset

LONGEST_FILE_NAME = 255
"""Bytes."""


def values_of(parameter) -> st.SearchStrategy:
    """Values that a parameter takes."""
    if parameter.choices:
        return st.sampled_from([choice.keyword for choice in parameter.choices])
    if parameter.kind == "BOOL":
        return st.booleans()
    if parameter.kind == "TEXT":
        return st.text(min_size=1)
    low, high = parameter.minimum, parameter.maximum
    if parameter.kind == "INT":
        return st.integers(low, high)
    numbers = st.floats(low, high, allow_nan=False, allow_infinity=False)
    return numbers if parameter.kind == "FLOAT" else st.tuples(numbers, numbers, numbers).map(list)


SAVED = {each.keyword: values_of(each) for each in PARAMETERS if each.kind != "SHADER"}

presets = st.builds(
    Preset,
    key=st.just("saved"),
    name=st.text(min_size=1),
    group=st.text(),
    tags=st.lists(st.text()).map(tuple),
    description=st.text(),
    source=st.text(),
    parameters=st.fixed_dictionaries({}, optional=SAVED),
)


@settings(max_examples=property_tests.FEW)
@given(presets)
def test_a_preset_that_is_saved_is_read_as_it_was(preset):
    with tempfile.TemporaryDirectory() as folder:
        save_preset(preset, Path(folder))
        assert load_preset("saved", Path(folder)) == preset


@given(st.text())
def test_a_file_with_any_text_is_a_preset_or_named(text):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "any.toml")
        file.write_text(text, encoding="utf-8", newline="")
        with pytest.raises(ParameterError, match=re.escape("any.toml")):
            load_preset("any", Path(folder))


@given(st.text())
def test_the_key_of_any_name_is_a_file_in_the_folder(name):
    try:
        key = key_of(name)
    except ParameterError:
        assert not re.search(r"[^\W_]", name.casefold()[: LONGEST_KEY + 1])
        return
    assert re.fullmatch(r"\w+", key) and Path(key).name == key
    assert len(f"{key}.toml".encode()) <= LONGEST_FILE_NAME
    assert key_of(key) == key


@settings(max_examples=property_tests.FEW)
@given(presets, st.text())
def test_another_name_changes_the_name_alone(preset, name):
    try:
        other = renamed(preset, name)
    except ParameterError:
        return
    assert other.name == name.strip() and other.parameters == preset.parameters and other.key == key_of(name)


@settings(max_examples=property_tests.FEW)
@given(st.text(), st.binary(), st.binary())
def test_a_file_of_any_name_is_replaced_whole_or_stays(name, before, after):
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        path = place / name.replace("/", "_")
        try:
            for content in (before, after):
                with replacing(path) as draft:
                    draft.write_bytes(content)
            assert path.read_bytes() == after
            with pytest.raises(KeyError), replacing(path) as draft:
                draft.write_bytes(before)
                raise KeyError
            assert path.read_bytes() == after
        except (WriteError, ValueError):
            assert path == place or "\0" in name or name in (".", "..") or len(name.encode()) > 200
        assert not [file for file in place.iterdir() if file.name.startswith(MARK)]
