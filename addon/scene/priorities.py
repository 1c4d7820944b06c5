"""The order in which media win: whose numbers make it, moving one of them, and making room between them.

A material's number holds for all of its objects but those with a number of their own. To change one number changes no other:
where none is free, room is made by a step of its own.
"""

from __future__ import annotations

import itertools
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import bpy

from ..model.parameter import MAX_PRIORITY, PRIORITY_PROPERTY, ParameterError
from ..nodes.animation import curves, is_animated
from ..nodes.lookups import caching_nodes
from ..nodes.mending import repair_nodes
from .materials import dielectric_node, medium_material, parameter_socket
from .media import all_objects, get_priority, is_cut_surface, material_priority, own_priority, set_priority

Owner = bpy.types.Material | bpy.types.Object
"""Whose number it is."""

STEP = 10
"""Between numbers where there is room, as between those of the presets."""

MOST_NAMES = 4
"""Names in a sentence."""


@dataclass(frozen=True)
class Row:
    """One place in the order.

    :param owner: the material, or the object with a number of its own.
    :param objects: what renders with that number, by name.
    """

    owner: Owner
    priority: int
    objects: tuple[bpy.types.Object, ...]

    @property
    def is_own(self) -> bool:
        """Return whether an object has the number, not a material."""
        return isinstance(self.owner, bpy.types.Object)


@caching_nodes()
def priority_rows(objects: Iterable[bpy.types.Object]) -> tuple[Row, ...]:
    """Return the places that the media among some objects have, the one that wins over all others first."""
    found: dict[Owner, tuple[int, list[bpy.types.Object]]] = {}
    for obj in objects:
        material = medium_material(obj)
        if material is not None:
            own = own_priority(obj)
            owner, number = (material, material_priority(material)) if own is None else (obj, own)
            found.setdefault(owner, (number, []))[1].append(obj)
    rows = [
        Row(owner, number, tuple(sorted(members, key=lambda obj: obj.name)))
        for owner, (number, members) in found.items()
    ]
    return tuple(sorted(rows, key=lambda row: (row.priority, row.owner.name)))


def in_words(rows: Sequence[Row], row: Row) -> str:
    """Return over whom a place wins and to whom it gives way, the nearest first."""
    first = bisect_left(rows, row.priority, key=_number)
    last = bisect_right(rows, row.priority, key=_number)
    beside = [other for other in rows[first : min(last, first + MOST_NAMES + 1)] if other.owner != row.owner]
    parts = [
        f"{what} {_named(others, count)}"
        for what, others, count in (
            ("wins over", rows[last : last + MOST_NAMES], len(rows) - last),
            ("gives way to", rows[max(first - MOST_NAMES, 0) : first][::-1], first),
            ("is one with", beside, last - first - 1),
        )
        if count
    ]
    return "; ".join(parts) or "is alone"


def _number(row: Row) -> int:
    return row.priority


def _named(rows: Sequence[Row], count: int) -> str:
    """Return the names of the first few of many places, for a sentence."""
    names = [row.owner.name for row in rows[:MOST_NAMES]]
    more = count - len(names)
    return ", ".join(names) + (f" and {more} more" if more else "")


def hindrance(owner: Owner) -> str:
    """Return why the number of a material or an object cannot be changed, and the remedy; empty if it can."""
    if not owner.is_editable:
        return "belongs to a library; make it local first"
    if isinstance(owner, bpy.types.Object):
        path = f'["{PRIORITY_PROPERTY}"]'
        moved = any(curve.data_path == path for curve in curves(owner.animation_data))
        return "has keyframes or a driver of its priority; change those" if moved else ""
    socket = parameter_socket(owner, "Priority")
    if socket is None:
        return "has its priority from other nodes; change it there"
    tree = socket.id_data
    if not tree.is_embedded_data and (tree.users > 1 or not tree.is_editable):
        return f"has its priority in the node group {tree.name!r}, which others use; make it single-user first"
    return "has keyframes or a driver of its priority; change those" if is_animated(tree, socket) else ""


def set_number(owner: Owner, number: int) -> None:
    """Give a material, or an object, a number.

    :raises ParameterError: if it cannot be changed.
    """
    _require_changeable(owner)
    if isinstance(owner, bpy.types.Object):
        set_priority(owner, number)
    else:
        parameter_socket(owner, "Priority").default_value = number
        repair_nodes(owner)


def _require_changeable(owner: Owner) -> None:
    reason = hindrance(owner)
    if reason:
        raise ParameterError(f"{owner.name!r} {reason}")


def move(scene: bpy.types.Scene, owner: Owner, step: int) -> bool:
    """Move a material, or an object, one place up (-1) or down (+1) in the winning order of a scene.

    What shares its number with others is parted from them; what has one alone passes the next. An object that relies on its
    material gets a number of its own. No other number changes.

    :return: False if it is at the end already.
    :raises ParameterError: if it cannot be changed, or no number is free there.
    """
    taken = sorted(
        {row.priority for row in priority_rows(all_objects(scene)) if row.owner != owner and row.objects != (owner,)}
    )
    number = get_priority(owner) if isinstance(owner, bpy.types.Object) else material_priority(owner)
    place = bisect_left(taken, number)
    if number in taken:
        place += step > 0
    elif not 0 <= place + min(step, 0) < len(taken):
        return False
    else:
        place += step
    _require_changeable(owner)
    before = taken[place - 1] if place else -1
    behind = taken[place] if place < len(taken) else MAX_PRIORITY + 1
    if behind - before < 2:
        where = (
            f"between {before} and {behind}"
            if before >= 0 and behind <= MAX_PRIORITY
            else (f"below {behind}" if before < 0 else f"above {before}")
        )
        raise ParameterError(
            f"{owner.name!r} finds no free number {where}; press Space Out Priorities, which makes room"
        )
    # In the middle, but no farther than a step from the one that is passed.
    if step < 0:
        before = max(before, behind - 2 * STEP)
    else:
        behind = min(behind, before + 2 * STEP)
    set_number(owner, (before + behind) // 2)
    return True


def space_out() -> tuple[list[str], list[str]]:
    """Part all numbers of the open file from each other, in steps of ten where there is room.

    Who wins over whom, and who has the same number, stays as it is in every scene.

    :return: what was changed and what could not be, in sentences.
    """
    levels: dict[int, list[Owner]] = {}
    with caching_nodes():
        for material in bpy.data.materials:
            if dielectric_node(material) is not None:
                levels.setdefault(material_priority(material), []).append(material)
        for obj in itertools.filterfalse(is_cut_surface, bpy.data.objects):
            if own_priority(obj) is not None and medium_material(obj) is not None:
                levels.setdefault(own_priority(obj), []).append(obj)
    reasons = {owner: hindrance(owner) for owners in levels.values() for owner in owners}
    fixed = {number for number, owners in levels.items() if any(reasons[owner] for owner in owners)}
    numbers = spaced(sorted(levels), fixed)
    changes = []
    for number, owners in sorted(levels.items()):
        for owner in owners if numbers[number] != number else ():
            set_number(owner, numbers[number])
            changes.append(f"{owner.name}: {number} -> {numbers[number]}")
    kept = [
        f"{owner.name!r} keeps {number}, because it {reasons[owner]}"
        for number, owners in sorted(levels.items())
        for owner in owners
        if reasons[owner]
    ]
    return changes, kept


def spaced(numbers: Sequence[int], fixed: Collection[int]) -> dict[int, int]:
    """Return for each of some ascending numbers another, in the same order and with room between; the fixed ones stay."""
    result: dict[int, int] = {}
    run: list[int] = []
    before = -1
    for number in (*numbers, MAX_PRIORITY + 1):
        if number <= MAX_PRIORITY and number not in fixed:
            run.append(number)
            continue
        result.update(zip(run, _spread(len(run), before, number)))
        result[number] = before = number
        run = []
    del result[MAX_PRIORITY + 1]
    return result


def _spread(count: int, before: int, behind: int) -> list[int]:
    """Return as many numbers between two that are taken: in tens if they fit, else as far apart as can be."""
    start = max(before, 0)
    if start + STEP * (count + 1) <= behind:
        return [start + STEP * (index + 1) for index in range(count)]
    return [before + (index + 1) * (behind - before) // (count + 1) for index in range(count)]
