"""Where an analysis is wrong it shows."""

import functools
from collections.abc import Callable

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from mathutils import Matrix
from scenes import add, add_camera, diffuse, render, set_striped_world
from told import GREY, OUTLIERS, SAMPLES, ball, differing, fresh, inputs, instance, into_collection, magenta, medium

import nested_dielectric as nd
from nested_dielectric.model.contract import Exterior
from nested_dielectric.nodes.names import OBJECT_PROPERTIES
from nested_dielectric.preparation import live

ALARM_SAMPLES = 16 * SAMPLES
"""So many that some of a few hundred pixels are checked."""

CELL = 12
"""Pixels along the edge of a cell of the pictures below; each has one thing in it that an analysis has not seen."""

SPACING = 3.0


class Cells:
    """Small arrangements side by side, each with a change to come."""

    def __init__(self, names: list[str]) -> None:
        self.names = names
        self.columns = 4
        rows = -(-len(names) // self.columns)
        self.scene = fresh()
        # Blender keeps the scene between renders, and must learn of all that an analysis changes.
        self.scene.render.use_persistent_data = True
        self.scene.render.resolution_x = CELL * self.columns
        self.scene.render.resolution_y = CELL * rows
        set_striped_world()
        centre = ((self.columns - 1) / 2 * SPACING, 0.0, -(rows - 1) / 2 * SPACING)
        add_camera((centre[0], -50.0, centre[2]), centre, width=SPACING * max(self.columns, rows))

    def place(self, name: str, *offset: float) -> tuple[float, float, float]:
        row, column = divmod(self.names.index(name), self.columns)
        return column * SPACING + offset[0], offset[1], -row * SPACING + offset[2]

    def inside(self, name: str) -> tuple[float, float, float]:
        """Where a small ball stands in the large one."""
        return self.place(name, 0.2, -0.7, 0.1)

    def cut(self, picture: np.ndarray) -> dict[str, np.ndarray]:
        cells = {}
        for index, name in enumerate(self.names):
            row, column = divmod(index, self.columns)
            cells[name] = picture[row * CELL : (row + 1) * CELL, column * CELL : (column + 1) * CELL]
        return cells


Change = Callable[[], object]


def a_medium_moves_in(cells: Cells, name: str, outer, inner) -> Change:
    return lambda: setattr(inner, "location", cells.inside(name))


def a_medium_grows(cells: Cells, name: str, outer, inner) -> Change:
    inner.location, inner.scale = cells.place(name, 1.0, 0.0, 0.0), (0.1, 0.1, 0.1)
    return lambda: setattr(inner, "scale", (1.2, 1.2, 1.2))


def a_medium_is_copied_in(cells: Cells, name: str, outer, inner) -> Change:
    def copy_in() -> None:
        twin = inner.copy()
        cells.scene.collection.objects.link(twin)
        twin.location = cells.inside(name)

    return copy_in


def a_mesh_changes(cells: Cells, name: str, outer, inner) -> Change:
    inner.location = cells.place(name, 0.2, -0.7, 0.1)
    inner.data.transform(Matrix.Translation((0.0, 60.0, 100.0)))

    def bend() -> None:
        inner.data.transform(Matrix.Translation((0.0, -60.0, -100.0)))
        inner.data.update()

    return bend


def a_parent_moves(cells: Cells, name: str, outer, inner) -> Change:
    parent = inner.parent = add("Parent", None)
    return lambda: setattr(parent, "location", Matrix.Translation(cells.inside(name)) @ -inner.location)


def an_instance_moves(cells: Cells, name: str, outer, inner) -> Change:
    inner.location = (0.0, 0.0, 0.0)
    instancer = instance(into_collection(inner), (40.0, 0.0, 100.0))
    return lambda: setattr(instancer, "location", cells.inside(name))


def the_medium_around_goes(cells: Cells, name: str, outer, inner) -> Change:
    return lambda: bpy.data.objects.remove(outer)


def its_own_priority_changes(cells: Cells, name: str, outer, inner) -> Change:
    return lambda: nd.set_priority(inner, 9)


def the_priority_around_changes(cells: Cells, name: str, outer, inner) -> Change:
    return lambda: nd.set_priority(outer, 0)


def a_third_medium_comes_to_two_that_cross(cells: Cells, name: str, outer, inner) -> Change:
    inner.location = cells.place(name, 0.8, 0.0, 0.0)
    third = ball("Third", 0.5, bpy.data.materials["Ice"], 0)
    third.location = (60.0, 0.0, 100.0)
    return lambda: setattr(third, "location", cells.place(name, 0.4, -0.8, 0.3))


def what_it_is_told_by_itself_is_wrong(cells: Cells, name: str, outer, inner) -> Change:
    def tell_wrongly() -> None:
        values = list(inner[OBJECT_PROPERTIES[0]])
        assert values[0] % 8 == Exterior.MEDIUM
        inner[OBJECT_PROPERTIES[0]] = [values[0] - Exterior.MEDIUM + Exterior.AIR, *values[1:]]
        inner.update_tag()

    return tell_wrongly


ALONE = [
    a_medium_moves_in,
    a_medium_grows,
    a_medium_is_copied_in,
    a_mesh_changes,
    a_parent_moves,
    an_instance_moves,
]
"""Of media that are all alone before it, told of air by their materials."""

TOGETHER = [
    the_medium_around_goes,
    its_own_priority_changes,
    the_priority_around_changes,
    a_third_medium_comes_to_two_that_cross,
    what_it_is_told_by_itself_is_wrong,
]
"""Of media one in another, which are told by objects."""

SHAPES = {change.__name__.replace("_", " "): change for change in ALONE + TOGETHER}


def build_shapes() -> tuple[Cells, list[Change]]:
    """A ball and a smaller one for each change, and the changes to come."""
    cells = Cells(list(SHAPES))
    for name, ior in (("Glass", 1.5), ("Water", 1.33), ("Ice", 1.3), ("Sea", 1.4)):
        medium(name, ior)
    pairs = []
    for number, (name, change) in enumerate(SHAPES.items()):
        alone = change in ALONE
        first, second, weak, strong = ("Glass", "Water", 2, 1) if alone else ("Sea", "Ice", 5, 1)
        outer = ball(f"{first} {number}", 0.9, bpy.data.materials[first], weak)
        outer.location = cells.place(name, 0.0, 0.0, 0.0)
        inner = ball(f"{second} {number}", 0.5, bpy.data.materials[second], strong)
        inner.location = (4.0 * number, 0.0, 100.0) if alone else cells.place(name, 0.1, -0.2, 0.1)
        pairs.append((outer, inner))
    return cells, [change(cells, name, *pair) for (name, change), pair in zip(SHAPES.items(), pairs)]


@functools.cache
def stale_shapes() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Pictures of cells that have changed since the analysis, of the same analysed again, and without an analysis."""
    cells, changes = build_shapes()
    assert not nd.analyse(cells.scene).doubts
    live.remove()
    for change in changes:
        change()
    stale = render(ALARM_SAMPLES)
    nd.analyse(cells.scene)
    told = render(ALARM_SAMPLES)
    nd.clear_analysis(cells.scene)
    pictures = [cells.cut(picture) for picture in (stale, told, render(ALARM_SAMPLES))]
    return {name: tuple(picture[name] for picture in pictures) for name in SHAPES}


@pytest.mark.parametrize("change", SHAPES)
def test_a_change_that_nobody_analysed_shows(change):
    stale, told, asked = stale_shapes()[change]
    assert magenta(stale).sum() >= 3
    assert not magenta(told).any()
    assert differing(told, asked) < OUTLIERS


VALUES = [
    "its index changes",
    "its colour changes",
    "its depth changes",
    "something foreign comes in",
    "it gets a second material",
]


@functools.cache
def stale_values() -> dict[str, np.ndarray]:
    """Pictures of balls in tinted media that change after the analysis."""
    cells = Cells(VALUES)
    ice = medium("Ice", 1.3)
    for name in VALUES:
        around = ball(name, 0.95, medium(name, 1.33, **GREY), 5)
        around.location = cells.place(name, 0.0, 0.0, 0.0)
        # A medium that nothing wins over is left to its volume, which need not know what stands in it.
        radius, height = (0.1, 0.8) if name == "something foreign comes in" else (0.7, 0.0)
        ball(f"{name} inside", radius, ice, 1).location = cells.place(name, 0.0, 0.0, height)
    foreign = ball("Foreign", 0.5, diffuse(0.8))
    foreign.location.z = 100.0
    assert not nd.analyse(cells.scene).doubts
    live.remove()
    for name, socket, value in zip(
        VALUES, ("IOR", "Transmittance", "Transmittance Depth"), (1.5, (0.4, 0.4, 0.4, 1.0), 0.1)
    ):
        inputs(bpy.data.materials[name])[socket].default_value = value
    foreign.location = cells.place("something foreign comes in", 0.0, 0.0, 0.0)
    bpy.data.objects["it gets a second material"].data.materials.append(foreign.active_material)
    return cells.cut(render(ALARM_SAMPLES))


@pytest.mark.parametrize("change", VALUES)
def test_a_value_that_changed_after_the_analysis_shows(change):
    assert magenta(stale_values()[change]).sum() >= 3
