"""Random changes to scenes: collections, instances, settings, what is undone and what is healed."""

from __future__ import annotations

import random

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
from changes_of_media import CHANGES, change, clear_animation, move, refill, scene_now, some, some_material

import nested_dielectric as nd


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
