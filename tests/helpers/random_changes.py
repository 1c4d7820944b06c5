"""Random changes to a scene of many media: `python tests/helpers/random_changes.py CHANGES [SEED]` makes thousands.

No handler may raise anything, and every render among them is that of a scene which was never prepared.
"""

from __future__ import annotations

import random
import sys
import traceback
from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Matrix
from scenes import add_camera, add_sphere, diffuse, new_scene, render, set_striped_world

import nested_dielectric as nd
from nested_dielectric.analysis import analysis
from nested_dielectric.preparation import live

MEDIA = 30
IORS = (1.0, 1.1, 1.33, 1.5, 1.7)
SAMPLES = 4
SAME = 2e-3
"""Root mean square beyond which two pictures differ by more than the noise of tint at 64 times the samples (up to 1.5e-3); all
others are equal but for last bits.
"""


CHANGES: list[Callable[[random.Random], None]] = []


def change(function: Callable[[random.Random], None]) -> Callable[[random.Random], None]:
    """Put a function among the changes."""
    CHANGES.append(function)
    return function


def build_scene(chance: random.Random) -> bpy.types.Scene:
    """Balls, some in others, of few materials and priorities."""
    scene = new_scene(20)
    set_striped_world()
    materials = [nd.new_material(f"Medium {ior}", ior=ior) for ior in IORS]
    materials.append(nd.new_material("Tinted", ior=1.4, transmittance=(0.8, 0.8, 0.8), transmittance_depth=1.0))
    for index in range(MEDIA):
        ball = add_sphere(f"Ball {index}", 0.5, chance.choice(materials), chance.randrange(9), segments=10)
        scatter(ball, chance)
    add_camera((0.13, -12.0, 0.41), (0.02, 0.0, 0.01), angle=35)
    nd.analyse(scene)
    return scene


def scatter(obj: bpy.types.Object, chance: random.Random) -> None:
    obj.location = [chance.uniform(-2.5, 2.5) for _ in range(3)]
    obj.rotation_euler = [chance.uniform(0.0, 3.0) for _ in range(3)]
    obj.scale = [chance.uniform(0.3, 2.0)] * 3


def scene_now() -> bpy.types.Scene:
    return bpy.context.scene


def some(chance: random.Random, types: tuple[str, ...] = ("MESH",)) -> bpy.types.Object:
    """Any object of the scene of some types; a new ball where there is none."""
    objects = [obj for obj in scene_now().objects if obj.type in types and obj.library is None]
    if objects:
        return chance.choice(objects)
    add_ball(chance)
    return some(chance)


def some_material(chance: random.Random) -> bpy.types.Material:
    found = [material for material in bpy.data.materials if material.library is None]
    return chance.choice(found) if found else nd.new_material("Medium", ior=chance.choice(IORS))


def node_of(material: bpy.types.Material) -> bpy.types.ShaderNodeGroup | None:
    return material.node_tree.nodes.get("Nested Dielectric")


@change
def move(chance: random.Random) -> None:
    scatter(some(chance), chance)


@change
def mirror(chance: random.Random) -> None:
    some(chance).scale.x *= -1.0


@change
def add_ball(chance: random.Random) -> None:
    scatter(add_sphere("Ball", 0.5, some_material(chance), chance.randrange(9), segments=10), chance)


@change
def remove(chance: random.Random) -> None:
    if len(scene_now().objects) > MEDIA:
        bpy.data.objects.remove(some(chance))


@change
def copy(chance: random.Random) -> None:
    source = some(chance)
    twin = source.copy()
    if chance.random() < 0.5 and twin.data is not None:
        twin.data = source.data.copy()
    scene_now().collection.objects.link(twin)
    scatter(twin, chance)


@change
def rename(chance: random.Random) -> None:
    some(chance).name = chance.choice(("Ball", "Nested Dielectric", "nd_outside", "名前", "a\"b'c"))


@change
def hide(chance: random.Random) -> None:
    obj = some(chance)
    attribute = chance.choice(
        ("hide_viewport", "hide_render", "visible_camera", "visible_shadow", "visible_transmission")
    )
    setattr(obj, attribute, not getattr(obj, attribute))


@change
def hide_both(chance: random.Random) -> None:
    obj = some(chance)
    obj.hide_viewport = obj.hide_render = not obj.hide_render


@change
def give_material(chance: random.Random) -> None:
    obj = some(chance)
    obj.active_material = diffuse() if chance.random() < 0.2 else some_material(chance)


@change
def change_slots(chance: random.Random) -> None:
    materials = some(chance).data.materials
    if len(materials) > 1 and chance.random() < 0.7:
        materials.pop(index=len(materials) - 1)
    elif len(materials):
        materials.append(materials[0] if chance.random() < 0.7 else None)
    else:
        materials.append(some_material(chance))


@change
def remove_material(chance: random.Random) -> None:
    if len(bpy.data.materials) > 6:
        bpy.data.materials.remove(some_material(chance))


@change
def set_value(chance: random.Random) -> None:
    node = node_of(some_material(chance))
    if node is not None:
        node.inputs["IOR"].default_value = chance.choice(IORS)
        node.inputs["Priority"].default_value = chance.randrange(9)


@change
def tint(chance: random.Random) -> None:
    node = node_of(some_material(chance))
    if node is not None:
        grey = chance.choice((1.0, 0.7))
        node.inputs["Transmittance"].default_value = (grey, grey, grey, 1.0)


@change
def link_value(chance: random.Random) -> None:
    tree = some_material(chance).node_tree
    node = tree.nodes.get("Nested Dielectric")
    if node is None:
        return
    socket = node.inputs[chance.choice(("Roughness", "Specular Scale"))]
    if socket.is_linked:
        tree.links.remove(socket.links[0])
    else:
        tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], socket)


@change
def set_priority(chance: random.Random) -> None:
    obj = some(chance)
    if any(node_of(slot.material) for slot in obj.material_slots if slot.material is not None):
        nd.set_priority(obj, chance.choice((None, *range(9))))


@change
def add_modifier(chance: random.Random) -> None:
    obj = some(chance)
    kind = chance.choice(("SUBSURF", "ARRAY", "DISPLACE", "BOOLEAN", "MIRROR", "WELD"))
    modifier = obj.modifiers.new(kind, kind)
    if kind == "ARRAY":
        modifier.relative_offset_displace = (1.5, 0.0, 0.0)
    elif kind == "DISPLACE":
        modifier.strength = 0.05
    elif kind == "BOOLEAN":
        other = some(chance)
        modifier.object = None if other == obj else other
    elif kind == "MIRROR":
        modifier.use_axis = (False, False, False)


@change
def change_modifier(chance: random.Random) -> None:
    obj = some(chance)
    if not obj.modifiers:
        return
    modifier = chance.choice(list(obj.modifiers))
    if chance.random() < 0.6:
        obj.modifiers.remove(modifier)
    elif modifier.type == "SUBSURF":
        modifier.render_levels = chance.randrange(3)
    else:
        modifier.show_render = not modifier.show_render


@change
def parent(chance: random.Random) -> None:
    child, other = some(chance), some(chance, ("MESH", "CAMERA"))
    if child.parent is not None:
        child.parent = None
    elif child != other and other.parent is None and not any(obj.parent == child for obj in bpy.data.objects):
        child.parent = other


@change
def keyframe(chance: random.Random) -> None:
    obj = some(chance)
    if obj.animation_data is not None:
        obj.animation_data_clear()
    else:
        obj.keyframe_insert("location", frame=1)
        obj.location.x += 0.5
        obj.keyframe_insert("location", frame=10)


@change
def clear_animation(chance: random.Random) -> None:
    for data in (*bpy.data.objects, *bpy.data.materials):
        data.animation_data_clear()


@change
def constrain(chance: random.Random) -> None:
    obj = some(chance)
    if obj.constraints:
        obj.constraints.remove(obj.constraints[0])
    else:
        obj.constraints.new("LIMIT_LOCATION")


@change
def key_shape(chance: random.Random) -> None:
    obj = some(chance)
    if obj.data.shape_keys:
        obj.shape_key_clear()
    else:
        obj.shape_key_add(name="Basis")


@change
def edit_mesh(chance: random.Random) -> None:
    obj = some(chance)
    if obj.data.shape_keys is None:
        obj.data.transform(Matrix.Scale(chance.uniform(0.8, 1.2), 4))
        obj.data.update()


@change
def refill_mesh(chance: random.Random) -> None:
    obj = some(chance)
    if obj.data.shape_keys is None:
        refill(obj.data)


def refill(mesh: bpy.types.Mesh) -> None:
    bm = bmesh.new()
    bmesh.ops.create_icosphere(bm, subdivisions=2, radius=0.5)
    bm.to_mesh(mesh)
    bm.free()


@change
def open_mesh(chance: random.Random) -> None:
    if chance.random() < 0.2:
        obj = some(chance)
        bm = bmesh.new()
        bm.from_mesh(obj.data)
        bmesh.ops.delete(bm, geom=list(bm.faces)[:3], context="FACES_ONLY")
        bm.to_mesh(obj.data)
        bm.free()


@change
def swap_mesh(chance: random.Random) -> None:
    some(chance).data = some(chance).data


@change
def flow(chance: random.Random) -> None:
    attributes = some(chance).data.attributes
    if "velocity" in attributes:
        attributes.remove(attributes["velocity"])
    elif chance.random() < 0.3:
        attributes.new("velocity", "FLOAT_VECTOR", "POINT")


@change
def into_collection(chance: random.Random) -> None:
    collection = bpy.data.collections.new("Collection")
    scene_now().collection.children.link(collection)
    obj = some(chance)
    for each in obj.users_collection:
        each.objects.unlink(obj)
    collection.objects.link(obj)


@change
def hide_collection(chance: random.Random) -> None:
    children = scene_now().collection.children
    if children:
        collection = chance.choice(list(children))
        attribute = chance.choice(("hide_viewport", "hide_render"))
        setattr(collection, attribute, not getattr(collection, attribute))


@change
def exclude_collection(chance: random.Random) -> None:
    children = bpy.context.view_layer.layer_collection.children
    if children:
        child = chance.choice(list(children))
        child.exclude = not child.exclude


@change
def remove_collection(chance: random.Random) -> None:
    for collection in list(scene_now().collection.children)[:1]:
        for obj in list(collection.objects):
            if obj.name not in scene_now().collection.objects:
                scene_now().collection.objects.link(obj)
        bpy.data.collections.remove(collection)


@change
def instance(chance: random.Random) -> None:
    children = list(scene_now().collection.children)
    if not children or chance.random() < 0.5:
        for obj in [obj for obj in scene_now().objects if obj.type == "EMPTY"]:
            bpy.data.objects.remove(obj)
        return
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", chance.choice(children)
    scene_now().collection.objects.link(empty)
    empty.location = [chance.uniform(-2.0, 2.0) for _ in range(3)]


@change
def add_other_type(chance: random.Random) -> None:
    data = chance.choice(
        (
            lambda: bpy.data.curves.new("Text", "FONT"),
            lambda: bpy.data.curves.new("Curve", "CURVE"),
            lambda: bpy.data.metaballs.new("Meta"),
            lambda: bpy.data.pointclouds.new("Points"),
            lambda: bpy.data.volumes.new("Volume"),
            lambda: bpy.data.lights.new("Light", "POINT"),
        )
    )()
    obj = bpy.data.objects.new("Other", data)
    scene_now().collection.objects.link(obj)
    if getattr(data, "materials", None) is not None:
        data.materials.append(some_material(chance))


@change
def remove_other_type(chance: random.Random) -> None:
    for obj in [obj for obj in bpy.data.objects if obj.name.startswith("Other")]:
        bpy.data.objects.remove(obj)


@change
def enter_mode(chance: random.Random) -> None:
    obj = some(chance)
    if obj.name in bpy.context.view_layer.objects and obj.visible_get() and obj.mode == "OBJECT":
        bpy.context.view_layer.objects.active = obj
        bpy.ops.object.mode_set(mode=chance.choice(("EDIT", "SCULPT")))
        bpy.context.view_layer.update()
        if chance.random() < 0.9:
            bpy.ops.object.mode_set(mode="OBJECT")


@change
def leave_mode(chance: random.Random) -> None:
    active = bpy.context.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


@change
def damage(chance: random.Random) -> None:
    """As scripts do that know no better."""
    obj = some(chance)
    obj[chance.choice(("nd_outside", "nd_outside_transmittance", "nd_offset"))] = chance.choice(
        (1, "x", [1.0, 2.0], True)
    )


@change
def set_frame(chance: random.Random) -> None:
    scene_now().frame_set(chance.randrange(1, 12))


@change
def set_render(chance: random.Random) -> None:
    """Persistent Data are left out: OSL crashes now and then over scripts that Cycles keeps while scenes come and go."""
    render_settings = scene_now().render
    attribute = chance.choice(("use_simplify", "use_motion_blur"))
    setattr(render_settings, attribute, not getattr(render_settings, attribute))


@change
def undo(chance: random.Random) -> None:
    bpy.ops.ed.undo_push(message="change")
    move(chance)
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="change")
    bpy.ops.ed.undo()
    if chance.random() < 0.5:
        bpy.ops.ed.redo()


@change
def copy_scene(chance: random.Random) -> None:
    if len(bpy.data.scenes) == 1:
        bpy.context.window.scene = scene_now().copy()
    elif chance.random() < 0.5:
        bpy.context.window.scene = chance.choice(list(bpy.data.scenes))
    else:
        bpy.data.scenes.remove(next(scene for scene in bpy.data.scenes if scene != scene_now()))


@change
def purge(chance: random.Random) -> None:
    bpy.data.orphans_purge()


@change
def analyse(chance: random.Random) -> None:
    nd.analyse(scene_now())


@change
def clear(chance: random.Random) -> None:
    nd.clear_analysis(scene_now())
    nd.analyse(scene_now())


@change
def heal(chance: random.Random) -> None:
    """Take away whatever leaves all media asking, or few of the pictures would show what an analysis knows."""
    leave_mode(chance)
    clear_animation(chance)
    remove_other_type(chance)
    scene_now().render.use_simplify = scene_now().render.use_motion_blur = False
    for collection in bpy.data.collections:
        collection.hide_viewport = collection.hide_render
    for obj in bpy.data.objects:
        obj.hide_viewport = obj.hide_render
        obj.modifiers.clear()
        obj.constraints.clear()
        if obj.type != "MESH":
            continue
        obj.shape_key_clear()
        for attribute in [each for each in obj.data.attributes if each.name == "velocity"]:
            obj.data.attributes.remove(attribute)
        closed = bmesh.new()
        closed.from_mesh(obj.data)
        is_open = any(not edge.is_manifold for edge in closed.edges)
        closed.free()
        if is_open:
            refill(obj.data)


CHANGES += [heal] * 8


def compare(samples: int) -> tuple[float, int]:
    """Render the scene as it is known and without an analysis; return how much the pictures differ, as a root mean square, and
    how many media knew what surrounds them.
    """
    known = render(samples)
    found = analysis.last_found(scene_now())
    nd.clear_analysis(scene_now())
    live.remove()
    difference = float(np.sqrt(((render(samples) - known) ** 2).mean()))
    nd.analyse(scene_now())
    return difference, len(found.known)


def make_changes(seed: int, count: int, every: int, look: Callable[[str, float, int], None]) -> list[str]:
    """Make random changes to a scene, and render after every few of them with what is known and without.

    :param look: called with the names of the latest changes, how much the two pictures differ, as a root mean square, and how
        many media knew what surrounds them.
    :returns: what handlers raised, with the names of the changes before it.
    """
    chance = random.Random(seed)
    build_scene(chance)
    raised: list[str] = []
    latest: list[str] = []
    hook = sys.excepthook
    sys.excepthook = lambda *error: raised.append(f"{latest[-3:]}: {''.join(traceback.format_exception(*error))}")
    try:
        for index in range(1, count + 1):
            make = chance.choice(CHANGES)
            latest.append(make.__name__)
            make(chance)
            bpy.context.view_layer.update()
            if index % every == 0:
                leave_mode(chance)
                difference, knowing = compare(SAMPLES)
                if difference > SAME:
                    # What charges for tint decides which lobes Cycles draws; that is noise.
                    difference, knowing = compare(64 * SAMPLES)
                look(f"change {index} of seed {seed}, after {latest[-every:]}", difference, knowing)
    finally:
        sys.excepthook = hook
    return raised


def main(arguments: list[str]) -> int:
    """Make changes by the thousand, each scene from another seed."""
    count = int(arguments[0])
    seed = int(arguments[1]) if len(arguments) > 1 else 0
    looked: list[tuple[float, str, int]] = []
    raised: list[str] = []
    while count > 0:
        some_changes = min(count, 500)
        raised += make_changes(
            seed, some_changes, 10, lambda what, *numbers: looked.append((numbers[0], what, numbers[1]))
        )
        count -= some_changes
        seed += 1
    looked.sort(reverse=True)
    for difference, what, _ in looked[:10]:
        print(f"{difference:.5f}  {what}")
    differ, knew = (sum(flags) for flags in zip(*((one > SAME, bool(known)) for one, _, known in looked)))
    print(f"{len(looked)} renders, in {knew} media knew something, {differ} differ, {len(raised)} errors", *raised[:5])
    return bool(raised or differ)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
