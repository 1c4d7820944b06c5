"""Media are left to volumes where all can be given back."""

from __future__ import annotations

import pytest

from nested_dielectric.analysis.charging import Filling, left_to_volumes


def filling(material: str, priority: int, *, chord=1.0, absorbs=(0.1, 0.5, 1.0), **keywords) -> Filling:
    return Filling(material, priority, chord, absorbs, **keywords)


CLEAR = (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "fillings, pairs, volumes, giving_back",
    [
        pytest.param([filling("Tea", 2)], [], {"Tea"}, set(), id="alone"),
        pytest.param([filling("Water", 2, absorbs=CLEAR)], [], set(), set(), id="clear"),
        pytest.param(
            [filling("Tea", 2), filling("Ice", 1, absorbs=CLEAR)], [(0, 1)], set(), set(), id="nothing wants it"
        ),
        pytest.param(
            [filling("Tea", 2, wanted=True), filling("Ice", 1, absorbs=CLEAR)],
            [(0, 1)],
            {"Tea"},
            {"Ice"},
            id="a lamp in iced tea",
        ),
        pytest.param(
            [filling("Tea", 3, wanted=True), filling("Ice", 2, absorbs=CLEAR), filling("Gem", 1, absorbs=CLEAR)],
            [(0, 1), (1, 2)],
            {"Tea"},
            {"Ice", "Gem"},
            id="ways through ice end at the gem in it",
        ),
        pytest.param(
            [filling("Tea", 2, wanted=True), filling("Ice", 1, absorbs=CLEAR, certain=False)],
            [(0, 1)],
            set(),
            set(),
            id="ice that moves",
        ),
        pytest.param(
            [filling("Tea", 2, wanted=True), filling("Tea", 2)], [(0, 1)], set(), set(), id="two of one priority"
        ),
        pytest.param(
            [filling("Ink", 2, wanted=True, absorbs=(9.0, 9.0, 9.0)), filling("Ice", 1, absorbs=CLEAR)],
            [(0, 1)],
            set(),
            set(),
            id="too dark to be given back",
        ),
        pytest.param(
            [filling("Ink", 2, wanted=True, absorbs=(9.0, 9.0, 9.0)), filling("Glass", 1, chord=0.1, absorbs=CLEAR)],
            [(0, 1)],
            {"Ink"},
            {"Glass"},
            id="a thin wall",
        ),
        pytest.param([filling("Tea", 2), filling("Tea", 2, simple=False)], [], set(), set(), id="one of several unfit"),
    ],
)
def test_media_are_left_to_volumes_where_all_can_be_given_back(fillings, pairs, volumes, giving_back):
    assert left_to_volumes(fillings, pairs) == (volumes, giving_back)
