"""What a straight ray meets in nested bodies."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.geometry.nesting import Crossing, Met, count_crossings


def through(bodies: list[tuple[float, float, int]]) -> list[Crossing]:
    """Return the surfaces that a ray meets through bodies that begin and end somewhere on it and have priorities."""
    ends = [(start, index, priority, True) for index, (start, _, priority) in enumerate(bodies)]
    ends += [(stop, index, priority, False) for index, (_, stop, priority) in enumerate(bodies)]
    return [Crossing(index, priority, enters) for _, index, priority, enters in sorted(ends)]


def test_a_loser_ends_where_the_winner_begins():
    assert count_crossings(through([(0.0, 2.0, 1), (1.0, 3.0, 2)])) == Met(valid=3, hidden=1, priorities=2)


def test_what_lies_in_a_winner_is_hidden():
    assert count_crossings(through([(0.0, 9.0, 1), (1.0, 2.0, 5), (3.0, 4.0, 6)])) == Met(2, 4, 2)


@given(
    st.lists(
        st.tuples(st.integers(0, 40), st.integers(1, 40), st.integers(0, 3)).map(
            lambda b: (b[0], b[0] + b[1] + 0.5, b[2])
        ),
        min_size=1,
        max_size=8,
    )
)
def test_valid_interfaces_are_those_at_which_the_winner_changes(bodies):
    """Of bodies of different priorities; the winner is looked for anew in every interval."""
    bodies = [
        (start + 1e-3 * index, stop + 1e-3 * index, 10 * index + p) for index, (start, stop, p) in enumerate(bodies)
    ]
    places = sorted(end for start, stop, _ in bodies for end in (start, stop))
    middles = [(a + b) / 2 for a, b in pairwise(places)]
    inside = [[p for start, stop, p in bodies if start < x < stop] for x in middles]
    winners = [None, *(min(each, default=None) for each in inside), None]
    changes = sum(before != after for before, after in pairwise(winners))
    met = count_crossings(through(bodies))
    assert met.valid == changes and met.valid + met.hidden == 2 * len(bodies)
    assert met.priorities == max(map(len, inside), default=0)
