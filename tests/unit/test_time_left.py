"""How long a run of renders will still take is guessed from what has been rendered."""

import property_tests  # noqa: F401
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.model.time_left import in_words, time_left

SECONDS = st.floats(0.001, 1e6)
SHARES = st.floats(0.001, 1.0)


def test_frames_that_are_finished_tell_how_long_the_others_take():
    assert time_left([2.0, 4.0], 10) == 30.0
    assert time_left([2.0, 4.0], 10, begun=1.0, sampled=1.0, share=0.5) == 31.5
    assert time_left([2.0], 0) == 0.0


def test_the_first_frame_tells_by_its_samples_and_what_comes_before_them():
    assert time_left([], 0, begun=5.0, sampled=2.0, share=0.25) == 6.0
    assert time_left([], 3, begun=5.0, sampled=2.0, share=0.25) == 6.0 + 3 * (5.0 + 8.0)


@pytest.mark.parametrize("sampled, share", [(0.0, 0.0), (3.0, 0.0), (0.0, 0.5)])
def test_before_the_first_sample_nothing_is_known(sampled, share):
    assert time_left([], 1, 2.0, sampled, share) is None


@given(st.lists(SECONDS, max_size=5), st.integers(0, 1000), SECONDS, SECONDS, SHARES, SHARES)
def test_the_more_is_done_the_less_is_left(finished, to_come, begun, sampled, first, second):
    less, more = sorted((first, second))
    rate = sampled / 1.0
    early = time_left(finished, to_come, begun, rate * less, less)
    late = time_left(finished, to_come, begun, rate * more, more)
    assert 0.0 <= late <= early * (1 + 1e-9) + 1e-9


@pytest.mark.parametrize(
    "seconds, words",
    [
        (0.0, "0.0 s"), (4.24, "4.2 s"), (9.94, "9.9 s"), (9.96, "10 s"), (45.4, "45 s"), (59.7, "1 min"), (61, "1 min"),
        (364, "6 min"), (3599, "1 h"), (7800, "2 h 10 min"), (86399, "1 d"), (273600, "3 d 4 h"), (1e8, "1157 d 9 h"),
    ],
)  # fmt: skip
def test_times_are_said_as_people_do(seconds, words):
    assert in_words(seconds) == words


@given(st.floats(0.0, 1e9))
def test_any_time_has_words(seconds):
    assert in_words(seconds).split()[1] in ("s", "min", "h", "d")
