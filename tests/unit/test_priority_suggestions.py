"""Suggested priorities: what lies inside wins, then bubbles, solids, ice and liquids; as little as can be changes."""

from dataclasses import replace
from itertools import combinations

import property_tests  # noqa: F401  its profile
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.model.media_kinds import Kind, density_of, kind_of, kind_of_index
from nested_dielectric.model.number_orders import fewest_changes, is_possible, numbered
from nested_dielectric.model.parameter import MAX_PRIORITY
from nested_dielectric.model.presets import all_presets
from nested_dielectric.model.priority_suggestion import suggested
from nested_dielectric.model.winning_rules import Overlap, Placed

GAS, SOLID, ICE, LIQUID = Kind


def body(name, priority, kind=None, owner=None, **values):
    """An object whose medium is its owner's, which is itself if none is named."""
    return Placed(name, owner or name, priority, owner or name, kind, **values)


def accepted(bodies, changes):
    """The objects once all changes are accepted: one that gets a number of its own owns it from then on."""
    bodies = list(bodies)
    for change in changes:
        if change.owner is None:
            old = bodies[change.body]
            assert old.priority == change.before
            bodies[change.body] = replace(old, owner=f"own {old.name}", priority=change.after)
        else:
            owned = {index for index, each in enumerate(bodies) if each.owner == change.owner}
            for index in owned:
                assert bodies[index].priority == change.before
                bodies[index] = replace(bodies[index], priority=change.after)
    return bodies


def told(bodies, overlaps):
    """What is suggested: names, numbers and reasons."""
    return [
        (bodies[c.body].name if c.owner is None else c.owner, c.before, c.after, c.reason)
        for c in suggested(bodies, overlaps)
    ]


# What wins over what


def test_what_lies_inside_another_medium_wins_over_it_whatever_the_two_are():
    bodies = [body("Block", 10, SOLID), body("Drop", 30, LIQUID)]
    assert told(bodies, [Overlap(1, 0, True)]) == [("Drop", 30, 5, "it lies inside 'Block'")]


def test_where_media_cross_bubbles_win_over_solids_solids_over_ice_and_ice_over_liquids():
    names = {"Bubble": GAS, "Glass": SOLID, "Cube": ICE, "Drink": LIQUID}
    bodies = [body(name, 40 - kind, kind) for name, kind in names.items()]
    every = [Overlap(one, other) for one, other in combinations(range(4), 2)]
    after = accepted(bodies, suggested(bodies, every))
    assert [each.name for each in sorted(after, key=lambda each: each.priority)] == list(names)


def test_of_two_liquids_the_one_that_floats_wins():
    bodies = [body("Oil", 30, LIQUID, density=911.0), body("Water", 30, LIQUID, density=998.2)]
    assert told(bodies, [Overlap(0, 1)]) == [("Oil", 30, 25, "it floats on 'Water' (911 against 998 kg/m³)")]


def test_numbers_stay_where_nothing_speaks_against_them():
    bodies = [body("Glass", 7, SOLID), body("Water", 8, LIQUID), body("Lens", 9, SOLID), body("Odd", 3)]
    assert not told(bodies, [Overlap(0, 1), Overlap(2, 0), Overlap(3, 0), Overlap(3, 1)])


def test_media_of_one_number_are_parted_and_the_smaller_one_is_whole():
    bodies = [body("Gem", 10, SOLID, volume=1.0), body("Resin", 10, SOLID, volume=9.0)]
    (change,) = suggested(bodies, [Overlap(0, 1)])
    after = accepted(bodies, [change])
    assert after[0].priority < after[1].priority
    assert change.reason.startswith("with one number it and")


def test_a_material_changes_where_all_of_its_objects_want_the_same():
    cubes = [body(f"Cube {index}", 30, ICE, "Ice") for index in range(3)]
    bodies = [body("Water", 30, LIQUID), *cubes]
    assert told(bodies, [Overlap(0, 1), Overlap(0, 2)]) == [("Ice", 30, 20, "it is ice and 'Water' is a liquid")]


def test_an_object_gets_a_number_of_its_own_where_its_fellows_want_another():
    bodies = [
        body("Marble", 10, SOLID, "Glass"),
        body("Ball", 10, SOLID, "Glass"),
        body("Sea", 30, LIQUID, "Water"),
        body("Drop", 30, LIQUID, "Water"),
    ]
    assert told(bodies, [Overlap(0, 2, True), Overlap(3, 1, True)]) == [("Drop", 30, 5, "it lies inside 'Ball'")]


def test_objects_of_one_medium_that_touch_keep_one_number():
    bodies = [
        body("Glass", 10, SOLID),
        replace(body("Drink", 5, LIQUID), medium="water"),
        replace(body("Drop", 5, LIQUID), medium="water"),
        replace(body("Apart", 5, LIQUID), medium="water"),
    ]
    changes = suggested(bodies, [Overlap(0, 1), Overlap(1, 2)])
    after = accepted(bodies, changes)
    assert after[0].priority < after[1].priority == after[2].priority
    assert after[3] == bodies[3]


def test_what_cannot_be_changed_stays_and_the_others_go_by_it():
    bodies = [body("Glass", 30, SOLID, is_fixed=True), body("Water", 10, LIQUID)]
    assert told(bodies, [Overlap(0, 1)]) == [("Water", 10, 35, "it is a liquid and 'Glass' is a solid")]
    assert not told(
        [body("Glass", 30, SOLID, is_fixed=True), body("Water", 10, LIQUID, is_fixed=True)], [Overlap(0, 1)]
    )


def test_what_cannot_be_one_number_between_two_that_are_fixed_is_two():
    bodies = [
        body("Glass", 10, SOLID, is_fixed=True),
        body("Water", 11, LIQUID, is_fixed=True),
        body("Cube at the glass", 20, ICE, "Ice"),
        body("Cube in the water", 20, ICE, "Ice"),
    ]
    after = accepted(bodies, suggested(bodies, [Overlap(2, 0), Overlap(3, 1)]))
    assert [each.priority for each in after] == [10, 11, 20, 10]


def test_numbers_without_room_for_what_is_between_them_do_not_both_stay():
    assert fewest_changes([3, 2, 4], [3, 1, 3], [(0, 1), (1, 2)]) == {0}
    assert fewest_changes([3, 2, 5], [3, 1, 3], [(0, 1), (1, 2)]) == {1}
    assert fewest_changes([0, 0, MAX_PRIORITY], [1, 1, 1], [(0, 1), (2, 1)]) == {1, 2}


# For any scene

kinds = st.one_of(st.none(), st.sampled_from(Kind))


@st.composite
def scenes(draw, nested=False):
    """Objects of a few owners, and overlaps: any, or such that each lies inside one before it at most."""
    owners = draw(
        st.lists(
            st.tuples(st.integers(0, 45), kinds, st.one_of(st.none(), st.floats(500, 2000)), st.integers(0, 3)),
            min_size=1,
            max_size=6,
        )
    )
    bodies = []
    for index in range(draw(st.integers(1, 8))):
        owner = draw(st.integers(0, len(owners) - 1))
        priority, kind, density, medium = owners[owner]
        fixed = not nested and draw(st.integers(0, 4)) == 0
        bodies.append(
            Placed(
                f"Object {index}",
                f"fixed {index}" if fixed else owner,
                priority,
                medium,
                kind,
                density,
                draw(st.sampled_from((1.0, 2.0, 3.0))),
                fixed,
            )
        )
    pairs = list(combinations(range(len(bodies)), 2))
    if nested:
        overlaps = [Overlap(second, first, True) for first, second in pairs if draw(st.integers(0, 2)) == 0]
    else:
        overlaps = []
        for first, second in pairs:
            kind = draw(st.integers(0, 6))
            if kind < 4:
                one, other = (first, second)[:: 1 if kind % 2 else -1]
                overlaps.append(Overlap(one, other, kind < 2))
    return bodies, overlaps


@given(scenes())
def test_whoever_accepts_all_is_suggested_nothing_more(scene):
    bodies, overlaps = scene
    after = accepted(bodies, suggested(bodies, overlaps))
    assert not told(after, overlaps)
    assert all(old.priority == new.priority for old, new in zip(bodies, after) if old.is_fixed)
    assert all(0 <= each.priority <= MAX_PRIORITY for each in after)


@given(scenes(nested=True))
def test_all_that_lies_inside_another_medium_wins_over_it(scene):
    bodies, overlaps = scene
    after = accepted(bodies, suggested(bodies, overlaps))
    for overlap in overlaps:
        inner, outer = after[overlap.one], after[overlap.other]
        assert inner.medium == outer.medium or inner.priority < outer.priority


@given(scenes(), st.randoms(use_true_random=False))
def test_the_order_in_which_objects_are_listed_does_not_matter(scene, random):
    bodies, overlaps = scene
    order = list(range(len(bodies)))
    random.shuffle(order)
    place = {old: new for new, old in enumerate(order)}
    mixed = [Overlap(place[each.one], place[each.other], each.is_inside) for each in overlaps]
    random.shuffle(mixed)
    first = accepted(bodies, suggested(bodies, overlaps))
    second = accepted([bodies[old] for old in order], suggested([bodies[old] for old in order], mixed))
    assert {each.name: each.priority for each in first} == {each.name: each.priority for each in second}


@st.composite
def orders(draw):
    """Numbers, weights, and pairs without circles."""
    count = draw(st.integers(1, 7))
    numbers = draw(st.lists(st.integers(0, 8), min_size=count, max_size=count))
    weights = draw(st.lists(st.integers(1, 3), min_size=count, max_size=count))
    rank = draw(st.permutations(range(count)))
    every = [(rank[first], rank[second]) for first, second in combinations(range(count), 2)]
    return numbers, weights, draw(st.lists(st.sampled_from(every), unique=True)) if every else []


@given(orders())
def test_no_smaller_change_would_do(order):
    numbers, weights, pairs = order
    changed = fewest_changes(numbers, weights, pairs)
    new = numbered(numbers, pairs, changed, numbers)
    assert all(new[first] < new[second] for first, second in pairs)
    assert all(new[node] == numbers[node] for node in range(len(numbers)) if node not in changed)
    cost = min(
        sum(weights[node] for node in some)
        for size in range(len(numbers) + 1)
        for some in combinations(range(len(numbers)), size)
        if is_possible(len(numbers), pairs, {node: n for node, n in enumerate(numbers) if node not in some})
    )
    assert sum(weights[node] for node in changed) == cost


# Kinds


@pytest.mark.parametrize("preset", all_presets(), ids=lambda preset: preset.key)
def test_presets_have_the_number_of_their_kind_and_oils_one_that_floats(preset):
    index = preset.parameters["ior"]
    number, density = preset.parameters["priority"], density_of(preset, index)
    kind = kind_of(preset, index)
    assert number == kind or (kind == LIQUID and number == 25 and density < density_of_water())


def density_of_water():
    (water,) = (preset for preset in all_presets() if preset.key == "water")
    return density_of(water, water.parameters["ior"])


def test_an_index_tells_the_kind_of_what_is_of_no_preset_and_between_oil_and_glass_the_shape_does():
    indices = {0.5: None, 1.0: GAS, 1.2: LIQUID, 1.31: ICE, 1.333: LIQUID, 1.47: SOLID, 1.52: SOLID, 2.4: SOLID}
    assert {index: kind_of_index(index) for index in indices} == indices
    assert (kind_of_index(1.47, True), kind_of_index(1.52, True)) == (LIQUID, SOLID)


def test_a_preset_whose_index_was_changed_is_another_medium():
    (water,) = (preset for preset in all_presets() if preset.key == "water")
    assert (kind_of(water, 1.34), density_of(water, 1.34)) == (LIQUID, 998.2)
    assert (kind_of(water, 1.52), density_of(water, 1.52)) == (SOLID, None)
    assert kind_of(water, None) is None
