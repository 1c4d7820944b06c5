"""Lists of frames and ranges of samples are read as they are meant, and each frame has a file of its own."""

from itertools import pairwise
from pathlib import Path

import property_tests  # noqa: F401
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.model.frames import (
    FIRST_FRAME,
    LAST_FRAME,
    has_number,
    list_frames,
    parse_frames,
    parse_samples,
    path_of_frame,
)

FRAMES = st.integers(FIRST_FRAME, LAST_FRAME)
FEW_FRAMES = st.lists(st.one_of(st.integers(-20, 20), FRAMES), min_size=1, unique=True)


@pytest.mark.parametrize(
    "text, frames",
    [
        ("7", [7]),
        ("-7", [-7]),
        ("1-4", [1, 2, 3, 4]),
        ("-2--1", [-2, -1]),
        ("-1-1", [-1, 0, 1]),
        ("0-10:5", [0, 5, 10]),
        ("0-9:5", [0, 5]),
        ("3, 1-4 ,3", [3, 1, 2, 4]),
        ("007-8", [7, 8]),
    ],
)
def test_a_list_of_frames_holds_each_once_in_its_order(text, frames):
    assert parse_frames(text) == tuple(frames)


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "'' is no frame"),
        ("1-3,x", "'x' is no frame"),
        ("1,,2", "'' is no frame"),
        ("1..3", "'1..3' is no frame"),
        ("1.5", "'1.5' is no frame"),
        ("1-3:", "'1-3:' is no frame"),
        ("4:2", "'4:2' is no frame"),
        ("١", "is no frame"),
        ("1-3:0", "'1-3:0': the step must be 1 or more"),
        ("1-3:-1", "'1-3:-1' is no frame"),
        ("5,9-3", "'9-3' ends before it begins; write 3-9"),
        ("1-1048575", "'1-1048575': frames must be -1048574 to 1048574"),
        ("9" * 5000, "is no frame"),
    ],
)
def test_what_is_no_list_of_frames_is_named(text, words):
    with pytest.raises(ValueError) as caught:
        parse_frames(text)
    assert words in str(caught.value)


@given(FEW_FRAMES)
def test_a_list_that_is_written_is_read_as_it_was(frames):
    assert parse_frames(list_frames(tuple(frames))) == tuple(frames)


@given(FRAMES, st.integers(0, 200), st.integers(1, 300))
def test_a_range_holds_every_step_up_to_its_end(first, length, step):
    last = min(first + length, LAST_FRAME)
    frames = parse_frames(f"{first}-{last}:{step}")
    assert frames[0] == first and last - step < frames[-1] <= last
    assert all(later - earlier == step for earlier, later in pairwise(frames))


@given(st.text())
def test_any_text_is_a_list_of_frames_or_an_error_in_words(text):
    try:
        frames = parse_frames(text)
    except ValueError as error:
        assert str(error)
    else:
        assert frames and all(FIRST_FRAME <= frame <= LAST_FRAME for frame in frames)


@pytest.mark.parametrize(
    "name, frame, file",
    [
        ("a_####.exr", 12, "a_0012.exr"),
        ("a_####.exr", -1, "a_-0001.exr"),
        ("#.png", 1234, "1234.png"),
        ("v#_##.png", 3, "v#_03.png"),
        ("b_##/a_##.png", 3, "b_##/a_03.png"),
        ("##/a.png", 3, "##/a.png"),
        ("{a}\\1_#.png", 3, "{a}\\1_3.png"),
    ],
)
def test_the_last_run_of_hashes_in_a_name_is_the_frame(name, frame, file):
    assert path_of_frame(Path(name), frame) == Path(file)


@given(FEW_FRAMES, st.integers(1, 9))
def test_each_frame_has_a_file_of_its_own(frames, digits):
    pattern = Path(f"out/frame_{'#' * digits}.exr")
    assert has_number(pattern)
    files = {path_of_frame(pattern, frame) for frame in frames}
    assert len(files) == len(frames) and not any(map(has_number, files))


def test_samples_are_a_number_or_a_range():
    assert parse_samples("64") == 64
    assert parse_samples("0:64") == range(64) and parse_samples("64:128") == range(64, 128)


@pytest.mark.parametrize(
    "text, words",
    [
        ("0", "0 is not a positive number"),
        ("", "'' is no number"),
        ("-4", "'-4' is no number"),
        ("1.5", "'1.5' is no number"),
        ("4:4", "'4:4' holds no samples"),
        ("8:4", "'8:4' holds no samples"),
        ("-1:4", "'-1:4' is no number"),
        (":4", "':4' is no number"),
    ],
)
def test_what_is_no_number_of_samples_is_named(text, words):
    with pytest.raises(ValueError) as caught:
        parse_samples(text)
    assert words in str(caught.value)
