"""Storms of random calls: the extension's operators, undoing and redoing, deleting, renaming, saving and opening again.

`python tests/helpers/storms.py CALLS [SEED]` makes one, and says what it did before anything went wrong.
"""

from __future__ import annotations

import random
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
from changes_of_media import scatter, scene_now, some
from changes_of_scenes import CHANGES
from odd_names import ODD_NAMES
from scenes import add_box, add_camera, add_point_light, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis.surroundings import is_invalid
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.nodes.sockets import ANALYSIS_SOCKETS
from nested_dielectric.preparation import guard
from nested_dielectric.scene.materials import dielectric_node

OPERATORS: dict[str, tuple[dict, ...]] = {
    "prepare": ({},),
    "put_back": ({},),
    "cut_surfaces": ({},),
    "keep_cut": ({},),
    "render_with": tuple({"backend": each} for each in ("AUTO", "OSL", "NATIVE")),
    "clear_analysis": ({},),
    "assign_preset": tuple({"preset": each} for each in ("water", "glass", "bk7", "wine_red", "air_bubble")),
    "fit_depth": ({},),
    "space_out": ({},),
    "priority_own": ({},),
    "select_objects": ({},),
    "update_materials": ({},),
    "add_passes": ({},),
    "lamp_carrier": tuple({"carrier": each} for each in ("RAYS", "LOBE")),
    "shadow_caustics": ({},),
    "sellmeier_ior": ({},),
    "show_problem": ({"name": "Ball"}, {"name": "gone"}),
}
"""Names and arguments; what an operator is not for at the moment, it refuses."""


def press(chance: random.Random) -> str:
    """Press one of the extension's buttons on an object or two."""
    objects = list(bpy.context.view_layer.objects)
    if objects:
        bpy.context.view_layer.objects.active = chance.choice(objects)
        for obj in objects:
            obj.select_set(chance.random() < 0.3)
    name = chance.choice(list(OPERATORS))
    arguments = chance.choice(OPERATORS[name])
    try:
        getattr(bpy.ops.nested_dielectric, name)(**arguments)
    except RuntimeError as error:  # refused, or reported as an error
        assert "Traceback" not in str(error), f"{name}: {error}"
    except TypeError as error:  # an operator of another version, or another word
        raise AssertionError(f"{name} {arguments}: {error}") from None
    bpy.ops.ed.undo_push(message=name)
    return name


def undo(chance: random.Random) -> str:
    return several_times(chance, "undo")


def redo(chance: random.Random) -> str:
    return several_times(chance, "redo")


def several_times(chance: random.Random, name: str) -> str:
    """Undo or redo one to three steps, as far as there are any."""
    operator, count = getattr(bpy.ops.ed, name), chance.randrange(1, 4)
    for _ in range(count):
        if operator.poll():
            operator()
    return f"{name} {count}"


def change(chance: random.Random) -> str:
    make = chance.choice(CHANGES)
    make(chance)
    bpy.ops.ed.undo_push(message=make.__name__)
    return make.__name__


def delete(chance: random.Random) -> str:
    """Delete anything, of the extension's as well."""
    kind = chance.choice(("objects", "materials", "node_groups", "images", "texts", "collections", "meshes", "lights"))
    found = list(getattr(bpy.data, kind))
    if not found or (kind == "objects" and len(found) < 6):
        return "nothing to delete"
    data = chance.choice(found)
    name = f"delete {kind} {data.name!r}"
    getattr(bpy.data, kind).remove(data)
    bpy.ops.ed.undo_push(message="delete")
    return name


def take_out(chance: random.Random) -> str:
    """Take a node or a link out of a group."""
    trees = [tree for tree in bpy.data.node_groups if len(tree.nodes) and len(tree.links)]
    if not trees:
        return "nothing to take out"
    tree = chance.choice(trees)
    part = chance.choice((tree.nodes, tree.links))
    part.remove(chance.choice(list(part)))
    bpy.ops.ed.undo_push(message="take out")
    return f"take a part out of {tree.name!r}"


def rename(chance: random.Random) -> str:
    kind = chance.choice(("objects", "materials", "node_groups", "collections", "scenes", "images", "worlds"))
    found = list(getattr(bpy.data, kind))
    if found:
        chance.choice(found).name = chance.choice(ODD_NAMES)
    bpy.ops.ed.undo_push(message="rename")
    return f"rename {kind}"


def save_and_open(chance: random.Random) -> str:
    """Save the file, go back to it as it was saved, or open it anew."""
    path = bpy.data.filepath
    what = chance.choice(("save", "revert", "open"))
    if what == "revert":
        bpy.ops.wm.revert_mainfile()
        return what
    bpy.ops.wm.save_as_mainfile(filepath=path)
    if what == "open":
        bpy.ops.wm.open_mainfile(filepath=path)
    return what


def step(chance: random.Random) -> str:
    scene_now().frame_set(chance.randrange(1, 9))
    return "frame"


CALLS: tuple[Callable[[random.Random], str], ...] = (
    *[press] * 8,
    *[undo] * 4,
    *[redo] * 3,
    *[change] * 6,
    delete,
    take_out,
    rename,
    save_and_open,
    step,
)


@contextmanager
def raised_by_handlers() -> Iterator[list[str]]:
    """Collect what handlers raise, whether the guard catches it or not."""
    raised: list[str] = []
    hook = sys.excepthook
    sys.excepthook = lambda *error: raised.append("".join(traceback.format_exception(*error)))
    try:
        yield raised
    finally:
        sys.excepthook = hook
        raised += [fault.details for fault in guard.faults()]
        guard.forget_faults()


def build_scene(chance: random.Random) -> None:
    """Some media that cross, one that disperses, and a light that a lobe carries."""
    new_scene(8, with_group=True)
    prism = nd.new_material("Prism", preset="bk7", disperse=True)
    water = nd.new_material("Sea", preset="water", transmittance=(0.5, 0.7, 0.9), transmittance_depth=2.0)
    for _ in range(4):
        scatter(add_sphere("Ball", 0.5, chance.choice((prism, water)), chance.randrange(9), segments=8), chance)
    add_box("Water", (-1, -1, -1), (1, 1, 0.1), water)
    add_box("Floor", (-1, -1, -1.5), (1, 1, -1), nd.new_material("Floor", preset="glass"))
    add_point_light((2.0, 2.0, 4.0), 100.0)
    bpy.data.objects["Lamp"].visible_transmission = False
    add_camera((0.13, -12.0, 0.41), (0.02, 0.0, 0.01), angle=35)
    nd.prepare(bpy.context.scene, cut=True)
    bpy.ops.ed.undo_push(message="built")


def stored_facts() -> dict:
    """All that media are told, by what carries it."""
    facts: dict = {}
    for material in bpy.data.materials:
        node = dielectric_node(material)
        if node is not None:
            values = (node.inputs[name].default_value for name in ANALYSIS_SOCKETS if name in node.inputs)
            facts[material.name] = [np.round(np.ravel(np.array(value, dtype=float)), 5).tolist() for value in values]
    for obj in bpy.data.objects:
        facts[obj.name, "object"] = [
            [round(number, 5) for number in obj[name]] if name in obj else None
            for name in ("nd_outside", "nd_outside_transmittance")
        ]
    return facts


def storm(seed: int, calls: int) -> None:
    """Make calls at random. Raise what a handler raised, or if media are told otherwise than they would be afresh."""
    chance = random.Random(seed)
    latest: list[str] = []
    with raised_by_handlers() as raised, tempfile.TemporaryDirectory() as folder:
        build_scene(chance)
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder, "storm.blend")))
        for _ in range(calls):
            try:
                latest.append(chance.choice(CALLS)(chance))
                bpy.context.view_layer.update()
            except ReferenceError:
                raise AssertionError(f"seed {seed}, after {latest[-5:]}") from None
            raised += [fault.details for fault in guard.faults()]
            assert not raised, f"seed {seed}, call {len(latest)}, after {latest[-5:]}: {raised[0]}"
        scene = scene_now()
        if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        nd.prepare(scene)
        some(chance).location.x += 0.1
        bpy.context.view_layer.update()
        if is_analysed(scene) and not is_invalid(scene):
            told = stored_facts()
            nd.analyse(scene)
            assert stored_facts() == told, f"seed {seed}, after {latest[-5:]}"
        assert nd.prepare(scene).changes == (), f"seed {seed}, after {latest[-5:]}"


if __name__ == "__main__":
    nd.register()
    storm(int(sys.argv[2]) if len(sys.argv) > 2 else 0, int(sys.argv[1]))
    print("all well")
