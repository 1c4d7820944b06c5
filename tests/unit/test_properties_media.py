"""Orders of priorities, what is left to volumes, and what is told, for any numbers."""

import bpy  # noqa: F401  what is told knows of it
import property_tests  # noqa: F401  its profile
from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.analysis.charging import READABLE, THIN, Filling, left_to_volumes
from nested_dielectric.analysis.facts import ExteriorFacts, common_facts
from nested_dielectric.model.contract import Exterior, Facts, pack_facts, unpack_facts
from nested_dielectric.model.parameter import MAX_PRIORITY
from nested_dielectric.scene.priorities import spaced

# Priorities

levels = st.lists(st.integers(0, MAX_PRIORITY), unique=True, max_size=60).map(sorted)


@given(levels, st.data())
def test_numbers_that_are_spaced_out_keep_their_order_and_what_is_fixed(numbers, data):
    fixed = set(data.draw(st.lists(st.sampled_from(numbers), unique=True))) if numbers else set()
    new = spaced(numbers, fixed)
    assert list(new) == numbers
    assert all(0 <= number <= MAX_PRIORITY for number in new.values())
    assert list(new.values()) == sorted(set(new.values()))
    assert all(new[number] == number for number in fixed)


@given(levels)
def test_numbers_that_have_been_spaced_out_stay(numbers):
    once = spaced(numbers, ())
    assert (
        spaced(list(once.values()), ()) == {number: number for number in once.values()}
        or len(numbers) * 10 > MAX_PRIORITY
    )


# Volumes

fillings = st.lists(
    st.builds(
        Filling,
        material=st.integers(0, 4),
        priority=st.integers(0, 4),
        chord=st.floats(0.01, 10.0),
        coefficients=st.one_of(st.none(), st.tuples(*[st.floats(0.0, 20.0)] * 3), st.just((0.0, 0.0, 0.0))),
        certain=st.booleans(),
        simple=st.booleans(),
        wanted=st.booleans(),
    ),
    min_size=1,
    max_size=6,
)


@st.composite
def arrangements(draw):
    bodies = draw(fillings)
    indices = st.integers(0, len(bodies) - 1)
    pairs = (
        draw(st.lists(st.tuples(indices, indices).filter(lambda pair: pair[0] < pair[1]), max_size=8))
        if len(bodies) > 1
        else []
    )
    return bodies, pairs


@given(arrangements(), st.randoms(use_true_random=False))
def test_what_is_left_to_volumes_hangs_on_no_order(arrangement, random):
    bodies, pairs = arrangement
    order = list(range(len(bodies)))
    random.shuffle(order)
    turned = [(order.index(a), order.index(b)) for b, a in pairs]
    random.shuffle(turned)
    assert left_to_volumes([bodies[index] for index in order], turned) == left_to_volumes(bodies, pairs)


@given(arrangements())
def test_volumes_take_only_what_winners_can_give_back(arrangement):
    bodies, pairs = arrangement
    volumes, givers = left_to_volumes(bodies, pairs)
    for one, other in (each for pair in pairs for each in (pair, pair[::-1])):
        loser, winner = bodies[one], bodies[other]
        if loser.material in volumes and loser.absorbs and winner.priority <= loser.priority:
            assert loser.simple and winner.certain and winner.priority < loser.priority
            assert winner.chord * min(loser.coefficients) <= THIN
            assert winner.chord * max(loser.coefficients) <= READABLE
            assert winner.material in givers
    assert volumes <= {body.material for body in bodies if body.absorbs}


# Packed facts

FACTS = st.builds(
    Facts,
    code=st.sampled_from(Exterior),
    overlaps_itself=st.booleans(),
    may_hold_objects=st.booleans(),
    absorbs=st.booleans(),
    sole_priority=st.integers(-1, MAX_PRIORITY).map(float),
)


@given(FACTS)
def test_facts_are_unpacked_as_they_were_packed(facts):
    number = pack_facts(facts)
    assert unpack_facts(number) == facts
    assert number == float(int(number)) < 2**24


@given(FACTS, FACTS)
def test_no_two_facts_are_packed_alike(one, other):
    assert (pack_facts(one) == pack_facts(other)) == (one == other)


def test_nothing_told_is_0():
    assert pack_facts(Facts()) == 0.0


# What holds for several

EXTERIORS = st.builds(
    ExteriorFacts,
    code=st.sampled_from(Exterior),
    sole_priority=st.sampled_from((-1.0, 0.0, 3.0)),
    overlaps_itself=st.booleans(),
    may_hold_objects=st.booleans(),
    medium=st.sampled_from(((0.0, 1.0, 0.0), (2.0, 1.33, 1.0))),
    transmittance=st.sampled_from(((1.0, 1.0, 1.0, 1.0), (0.5, 0.2, 0.1, 1.0))),
)


def says_no_more(merged: ExteriorFacts, one: ExteriorFacts) -> bool:
    """Whether all that is told holds where one is true."""
    return (
        (merged.code, merged.medium, merged.transmittance) == (one.code, one.medium, one.transmittance)
        and merged.sole_priority in (-1.0, one.sole_priority)
        and merged.overlaps_itself >= one.overlaps_itself
        and merged.may_hold_objects >= one.may_hold_objects
    )


@given(EXTERIORS)
def test_what_holds_for_one_twice_is_that(one):
    assert one.merged(one) == one


@given(EXTERIORS, EXTERIORS)
def test_what_holds_for_two_hangs_on_no_order_and_says_no_more_than_either(one, other):
    both = one.merged(other)
    assert both == other.merged(one)
    if both is not None:
        assert says_no_more(both, one) and says_no_more(both, other)


@given(st.lists(EXTERIORS, min_size=1, max_size=5), st.randoms(use_true_random=False))
def test_what_holds_for_many_hangs_on_no_order(several, random):
    turned = list(several)
    random.shuffle(turned)
    common = common_facts(several)
    assert common == common_facts(turned)
    assert common is None or all(says_no_more(common, each) for each in several)
