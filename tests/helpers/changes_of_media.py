"""Random changes to media: their places, meshes, materials and animation."""

from __future__ import annotations

import random
from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
from mathutils import Matrix
from scenes import add_sphere, diffuse

import nested_dielectric as nd

MEDIA = 30
IORS = (1.0, 1.1, 1.33, 1.5, 1.7)

CHANGES: list[Callable[[random.Random], None]] = []


def change(function: Callable[[random.Random], None]) -> Callable[[random.Random], None]:
    """Put a function among the changes."""
    CHANGES.append(function)
    return function


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
