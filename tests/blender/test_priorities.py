"""Priorities: who wins over whom, and that a move changes the number of nothing else."""

import itertools
import random

import bpy
import pytest
from scenes import add, add_box, mostly_again, new_scene

import nested_dielectric as nd
from nested_dielectric.nodes.mending import repair_nodes
from nested_dielectric.scene import priorities
from nested_dielectric.scene.materials import dielectric_node

CUBE = (0, 0, 0), (1, 1, 1)


@pytest.fixture(autouse=True)
def scene():
    return new_scene()


def material(name, priority):
    return nd.new_material(name, priority=priority)


def socket(material):
    return material.node_tree.nodes["Nested Dielectric"].inputs["Priority"]


def numbers():
    """The numbers of all materials, and of all objects that have one of their own."""
    found = {material.name: socket(material).default_value for material in bpy.data.materials}
    return found | {obj.name: obj["nd_priority"] for obj in bpy.data.objects if "nd_priority" in obj}


def places():
    """Names of what has each number, the lowest number first."""
    levels = {}
    for row in priorities.priority_rows(bpy.context.scene.objects):
        levels.setdefault(row.priority, set()).add(row.owner.name)
    return [levels[number] for number in sorted(levels)]


def add_table(**rows):
    """A cube of a material for each number; where it stands in a list, a cube with a number of its own."""
    for name, number in rows.items():
        if isinstance(number, list):
            add_box(name, *CUBE, bpy.data.materials[-1], number[0])
        else:
            add_box(f"Cube of {name}", *CUBE, material(name, number))


def owner(name):
    return bpy.data.materials.get(name) or bpy.data.objects[name]


def test_rows_are_materials_with_all_objects_that_rely_on_them_and_objects_with_numbers_of_their_own():
    water, ice = material("Water", 30), material("Ice", 20)
    for index in range(3):
        add_box(f"Drop {index}", *CUBE, water)
    add_box("Cube", *CUBE, ice)
    add_box("Odd", *CUBE, water, 15)
    rows = priorities.priority_rows(bpy.context.scene.objects)
    assert [(row.owner.name, row.priority, len(row.objects), row.is_own) for row in rows] == [
        ("Odd", 15, 1, True),
        ("Ice", 20, 1, False),
        ("Water", 30, 3, False),
    ]


def test_words_say_over_whom_a_medium_wins_the_nearest_first():
    add_table(Air=0, Glass=10, Ice=20, Snow=20, Water=30, Oil=40, A=50, B=51, C=52)
    rows = priorities.priority_rows(bpy.context.scene.objects)

    def words(name):
        return priorities.in_words(rows, next(row for row in rows if row.owner.name == name))

    assert words("Ice") == "wins over Water, Oil, A, B and 1 more; gives way to Glass, Air; is one with Snow"
    assert words("Air") == "wins over Glass, Ice, Snow, Water and 4 more"
    assert words("C") == "gives way to B, A, Oil, Water and 4 more"
    assert priorities.in_words(rows[:1], rows[0]) == "is alone"


def test_words_count_what_has_the_same_number():
    add_table(**dict.fromkeys("ABCDEFG", 5))
    rows = priorities.priority_rows(bpy.context.scene.objects)
    assert priorities.in_words(rows, rows[1]) == "is one with A, C, D, E and 2 more"
    assert priorities.in_words(rows, rows[6]) == "is one with A, B, C, D and 2 more"


@pytest.mark.parametrize(
    "name, step, number",
    [
        ("Water", -1, 15),  # between glass and ice
        ("Ice", 1, 40),  # a step beyond the last
        ("Glass", -1, 25),  # before the first, between a step farther and it
        ("Ice", -1, 4),
    ],
)
def test_a_material_passes_the_next_place_and_no_other_number_changes(name, step, number):
    table = {"Water": 30, "Ice": 20, "Glass": 10, "Air": 0}
    if name == "Glass":
        table = {"Glass": 40, "Air": 35}
    elif step == -1 and number == 4:
        table = {"Ice": 20, "Glass": 10}
    elif name == "Ice":
        table = {"Water": 30, "Ice": 20}
    add_table(**table)
    assert priorities.move(bpy.context.scene, owner(name), step)
    assert numbers() == table | {name: number}


def test_what_shares_a_number_is_parted_from_it_first():
    add_table(Air=0, Ice=20, Snow=20, Water=30)
    before = numbers()
    assert priorities.move(bpy.context.scene, owner("Snow"), -1)
    assert places() == [{"Air"}, {"Snow"}, {"Ice"}, {"Water"}]
    assert numbers() == before | {"Snow": 10}
    assert priorities.move(bpy.context.scene, owner("Snow"), 1)
    assert places() == [{"Air"}, {"Ice"}, {"Snow"}, {"Water"}]


def test_an_object_that_relies_on_its_material_is_parted_from_it_alone():
    water = material("Water", 30)
    drops = [add_box(f"Drop {index}", *CUBE, water) for index in range(3)]
    add_box("Cube", *CUBE, material("Ice", 20))
    assert priorities.move(bpy.context.scene, drops[1], -1)
    assert numbers() == {"Water": 30, "Ice": 20, "Drop 1": 25}
    assert priorities.move(bpy.context.scene, drops[1], -1)
    assert places() == [{"Drop 1"}, {"Ice"}, {"Water"}]


def test_objects_with_numbers_of_their_own_stay_when_their_material_moves():
    water = material("Water", 30)
    add_box("Sea", *CUBE, water)
    add_box("Drop", *CUBE, water, 15)
    add_box("Cube", *CUBE, material("Ice", 20))
    assert priorities.move(bpy.context.scene, water, -1)
    assert places() == [{"Drop"}, {"Water"}, {"Ice"}]
    assert nd.get_priority(bpy.data.objects["Drop"]) == 15


def test_the_first_and_the_last_stay():
    add_table(Air=0, Water=30)
    before = numbers()
    assert not priorities.move(bpy.context.scene, owner("Air"), -1)
    assert not priorities.move(bpy.context.scene, owner("Water"), 1)
    assert numbers() == before


@pytest.mark.parametrize(
    "table, name, step, where",
    [
        ({"A": 10, "B": 11, "C": 12}, "C", -1, "between 10 and 11"),
        ({"A": 0, "B": 10}, "B", -1, "below 0"),
        ({"A": 999, "B": 1000}, "A", 1, "above 1000"),
        ({"A": 10, "B": 10, "C": 11}, "A", 1, "between 10 and 11"),
    ],
)
def test_where_no_number_is_free_nothing_changes_until_room_is_made(table, name, step, where):
    add_table(**table)
    with pytest.raises(nd.ParameterError, match=f"'{name}' finds no free number {where}; press Space Out Priorities"):
        priorities.move(bpy.context.scene, owner(name), step)
    assert numbers() == table
    order = places()
    changes, kept = priorities.space_out()
    assert places() == order and changes and not kept
    assert priorities.move(bpy.context.scene, owner(name), step)
    assert places() != order
    assert priorities.space_out()[0] and priorities.space_out() == ([], [])


def in_group(material):
    """The material's node stands in a group of the artist's, with its number set in there."""
    tree = material.node_tree
    group = bpy.data.node_groups.new("Artist's", "ShaderNodeTree")
    group.interface.new_socket("Surface", in_out="OUTPUT", socket_type="NodeSocketShader")
    inner, sink = group.nodes.new("ShaderNodeGroup"), group.nodes.new("NodeGroupOutput")
    inner.node_tree = dielectric_node(material).node_tree
    inner.inputs["Priority"].default_value = 20
    group.links.new(inner.outputs[0], sink.inputs[0])
    tree.nodes.remove(dielectric_node(material))
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    tree.links.new(node.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    repair_nodes(material)
    return inner


def test_a_number_that_is_set_in_a_group_is_changed_where_it_is_set():
    add_table(Glass=10, Ice=20, Air=0)
    inner = in_group(owner("Ice"))
    assert nd.get_priority(bpy.data.objects["Cube of Ice"]) == 20
    assert priorities.move(bpy.context.scene, owner("Ice"), -1)
    assert inner.inputs["Priority"].default_value == nd.get_priority(bpy.data.objects["Cube of Ice"]) == 5
    assert repair_nodes(owner("Ice")) == []


def share_group():
    in_group(owner("Ice"))
    other = material("Other", 5)
    node = other.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = bpy.data.node_groups["Artist's"]


def plug_number():
    tree = owner("Ice").node_tree
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], socket(owner("Ice")))


def link_object():
    bpy.data.libraries.write(path := bpy.app.tempdir + "library.blend", {bpy.data.objects["Own"]})
    bpy.data.objects.remove(bpy.data.objects["Own"])
    with bpy.data.libraries.load(path, link=True) as (_, here):
        here.objects = ["Own"]
    bpy.context.scene.collection.objects.link(here.objects[0])


def link_material():
    bpy.data.libraries.write(path := bpy.app.tempdir + "library.blend", {owner("Ice")})
    bpy.data.materials.remove(owner("Ice"))
    with bpy.data.libraries.load(path, link=True) as (_, here):
        here.materials = ["Ice"]
    bpy.data.objects["Cube of Ice"].data.materials[0] = here.materials[0]


HINDRANCES = {
    "keyframes of a material": (
        "Ice",
        lambda: socket(owner("Ice")).keyframe_insert("default_value"),
        "has keyframes or",
    ),
    "a driver of a material": (
        "Ice",
        lambda: socket(owner("Ice")).driver_add("default_value"),
        "has keyframes or a driver",
    ),
    "keyframes of an object": (
        "Own",
        lambda: owner("Own").keyframe_insert('["nd_priority"]'),
        "has keyframes or a driver",
    ),
    "other nodes": ("Ice", plug_number, "has its priority from other nodes"),
    "a group of several users": (
        "Ice",
        share_group,
        'has its priority in the node group "Artist\'s", which others use',
    ),
    "a linked material": ("Ice", link_material, "belongs to a library; make it local"),
    "a linked object": ("Own", link_object, "belongs to a library; make it local"),
}


@pytest.mark.parametrize("case", mostly_again(HINDRANCES))
def test_what_cannot_be_changed_is_named_and_stays_while_all_else_is_spaced_out_around_it(case):
    name, hinder, reason = HINDRANCES[case]
    add_table(Air=19, Glass=10, Ice=20, Water=21, Zinc=60, Own=[22])
    hinder()
    order, before = places(), numbers()
    with pytest.raises(nd.ParameterError, match=f"'{name}' {reason}"):
        priorities.move(bpy.context.scene, owner(name), -1)
    assert numbers() == before
    changes, kept = priorities.space_out()
    assert any(line.startswith(f"{name!r} keeps {before[name]}, because it") for line in kept)
    assert all(reason in line for line in kept)
    assert places() == order and changes
    assert numbers()[name] == before[name]
    # Everything but it got room.
    taken = sorted(number for each, number in numbers().items() if each != "Other")
    assert min(b - a for a, b in itertools.pairwise(taken)) >= 2


def test_making_room_keeps_the_order_of_every_scene():
    add_table(Glass=10, Ice=11)
    here = bpy.context.scene
    other = bpy.data.scenes.new("Other")
    for name in ("Water", "Oil"):
        obj = add_box(name, *CUBE, material(name, {"Water": 12, "Oil": 10}[name]))
        other.collection.objects.link(obj)
        here.collection.objects.unlink(obj)
    other.collection.objects.link(bpy.data.objects["Cube of Ice"])
    priorities.space_out()
    assert numbers() == {"Glass": 10, "Oil": 10, "Ice": 20, "Water": 30}


def test_spaced_numbers_keep_order_and_what_is_fixed_and_stand_apart_where_there_is_room():
    for seed in range(40):
        rng = random.Random(seed)
        crowd = sorted(rng.sample(range(rng.choice((12, 60, 1001))), rng.randint(1, 12)))
        if seed % 8 == 7:
            crowd = list(range(1001))
        fixed = set(rng.sample(crowd, rng.randint(0, min(3, len(crowd)))))
        result = priorities.spaced(crowd, fixed)
        after = [result[number] for number in crowd]
        assert after == sorted(set(after)) and after[0] >= 0 and after[-1] <= 1000, seed
        assert all(result[number] == number for number in fixed), seed
        if not fixed and len(crowd) < 100:
            assert after == [10 * (index + 1) for index in range(len(crowd))], seed
        assert len(crowd) == 1001 or priorities.spaced(after, fixed) == dict(zip(after, after)), seed


def test_no_random_move_changes_another_number_or_passes_more_than_one_place():
    rng = random.Random(5)
    add_table(A=0, B=10, C=10, D=20, E=30, F=[15], G=[30])
    moved = refused = 0
    for _ in range(60):
        name, step = rng.choice("ABCDEFG"), rng.choice((-1, 1))
        before, order = numbers(), places()
        place = next(index for index, level in enumerate(order) if name in level)
        try:
            changed = priorities.move(bpy.context.scene, owner(name), step)
        except nd.ParameterError:
            assert numbers() == before
            assert priorities.space_out()[0] and places() == order
            refused += 1
            continue
        others = numbers()
        assert others.pop(name) != before.pop(name) or not changed
        assert others == before
        alone = order[place] == {name}
        assert changed or (alone and place == (0 if step < 0 else len(order) - 1))
        if changed:
            moved += 1
            expected = [level - {name} for level in order]
            target = place if not alone else place + step
            # Parted: beside those it was with. Alone: on the other side of the level that it passes.
            rest = [level for level in expected if level]
            cut = sum(bool(level) for level in expected[:target]) + (step > 0)
            assert places() == [*rest[:cut], {name}, *rest[cut:]]
    assert moved > 25 and refused > 0


def test_thousands_of_objects_are_grouped_and_move_as_one():
    water = material("Water", 30)
    mesh = add_box("Mould", *CUBE, water).data
    for index in range(2000):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(f"Drop {index}", mesh))
    add_box("Cube", *CUBE, material("Ice", 20))
    add("Empty", None)
    assert priorities.move(bpy.context.scene, water, -1)
    assert numbers() == {"Water": 10, "Ice": 20}


def test_a_free_number_is_missing_where_all_are_taken():
    add_table(Glass=0)
    data = bpy.data.objects["Cube of Glass"].data
    for number in range(1001):
        obj = bpy.data.objects.new("Medium", data)
        bpy.context.scene.collection.objects.link(obj)
        obj["nd_priority"] = number
    twin = bpy.data.objects.new("Twin", data)
    bpy.context.scene.collection.objects.link(twin)
    twin["nd_priority"] = 500
    with pytest.raises(nd.ParameterError, match="'Twin' finds no free number between 499 and 500"):
        priorities.move(bpy.context.scene, twin, -1)
    assert priorities.space_out() == ([], [])
