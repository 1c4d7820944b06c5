"""What media are told of their surroundings, and scenes to tell it in."""

from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Matrix
from scenes import add, add_camera, add_sphere, new_scene, render, set_striped_world

import nested_dielectric as nd
from nested_dielectric.model.contract import Exterior
from nested_dielectric.nodes.names import OBJECT_PROPERTIES

TOLD = (
    "Outside",
    "Outside Priority",
    "Overlaps Itself",
    "Foreign Objects",
    "Surroundings",
    "Surroundings Transmittance",
    "Absorbs by Volume",
    "Gives Back",
)
"""Sockets of a material that an analysis writes."""

SAMPLES = 16

UNTOLD = (None,) * len(OBJECT_PROPERTIES)
TINT = {"transmittance": (0.9, 0.6, 0.4), "transmittance_depth": 0.5}
GREY = {"transmittance": (0.7, 0.7, 0.7), "transmittance_depth": 0.5}

# The same rays meet the same answers. Only the last bits of sums may differ, and where those decide, whole samples.
OUTLIERS = 0.005
MEAN_TOLERANCE = 1e-3

# The world is grey and no tint here takes more from green than from blue, so nothing but the alarm lacks green.
MAGENTA = 1e-3


def fresh(resolution: int = 32) -> bpy.types.Scene:
    """An empty scene in which the node group stands already."""
    return new_scene(resolution, with_group=True)


def stage(resolution: int = 32) -> bpy.types.Scene:
    scene = fresh(resolution)
    set_striped_world()
    add_camera((0.3, -5, 0.8), (0, 0, 0), angle=30)
    return scene


def ball(name: str, radius: float, material=None, priority=None, location=(0.0, 0.0, 0.0)) -> bpy.types.Object:
    return add_sphere(name, radius, material, priority, location, segments=32)


def medium(name: str, ior: float, **keywords) -> bpy.types.Material:
    return nd.new_material(name, ior=ior, **keywords)


def inputs(material: bpy.types.Material) -> bpy.types.NodeInputs:
    return material.node_tree.nodes["Nested Dielectric"].inputs


def plain(value):
    """Numbers of a socket or a custom property, rounded to what single precision keeps."""
    return tuple(round(float(v), 5) for v in value) if hasattr(value, "__len__") else round(float(value), 5)


def told_by_material(material: bpy.types.Material) -> tuple:
    return tuple(plain(inputs(material)[name].default_value) for name in TOLD)


def told_by_object(obj: bpy.types.Object) -> tuple:
    return tuple(plain(obj[name]) if name in obj else None for name in OBJECT_PROPERTIES)


def told_code(obj: bpy.types.Object) -> int:
    """What the shader takes for the object's code; of several materials the one that is told most."""
    own = int(obj[OBJECT_PROPERTIES[0]][0]) % 8 if OBJECT_PROPERTIES[0] in obj else Exterior.UNKNOWN
    by_material = [inputs(material)["Outside"].default_value for material in media_of(obj)]
    return max(own if code == Exterior.BY_OBJECT else code for code in by_material)


def media_of(obj: bpy.types.Object) -> list[bpy.types.Material]:
    return [slot.material for slot in obj.material_slots if "Nested Dielectric" in slot.material.node_tree.nodes]


def told_foreign(obj: bpy.types.Object) -> bool:
    """Whether the shader looks out for foreign objects."""
    sockets = inputs(obj.active_material)
    if sockets["Outside"].default_value == Exterior.BY_OBJECT:
        return OBJECT_PROPERTIES[0] not in obj or int(obj[OBJECT_PROPERTIES[0]][0]) // 16 % 2 == 0
    return sockets["Foreign Objects"].default_value


def snapshot() -> dict:
    """All that is told in this file."""
    told = {
        material.name: told_by_material(material)
        for material in bpy.data.materials
        if "Nested Dielectric" in material.node_tree.nodes
    }
    for obj in bpy.data.objects:
        told["object " + obj.name] = told_by_object(obj)
    return told


def codes() -> dict[str, int]:
    return {obj.name: told_code(obj) for obj in bpy.data.objects if obj.type == "MESH" and media_of(obj)}


def magenta(picture: np.ndarray) -> np.ndarray:
    """Which pixels the alarm of a wrong analysis is in."""
    return np.minimum(picture[..., 0], picture[..., 2]) - picture[..., 1] > MAGENTA


def differing(told: np.ndarray, asked: np.ndarray) -> float:
    """Share of the pixels that differ by more than rounding."""
    return float((np.abs(told - asked).max(axis=2) > 1e-4).mean())


def assert_same_answers(told: np.ndarray, asked: np.ndarray, outliers: float = OUTLIERS) -> None:
    assert differing(told, asked) < outliers
    assert abs(told.mean() / asked.mean() - 1.0) < MEAN_TOLERANCE


def asked_and_told(scene: bpy.types.Scene, samples: int = SAMPLES) -> tuple[np.ndarray, np.ndarray]:
    """Pictures without and with an analysis."""
    nd.clear_analysis(scene)
    asked = render(samples)
    nd.analyse(scene)
    return asked, render(samples)


def balls(*places: tuple[float, tuple[float, float, float]]) -> Callable[[bmesh.types.BMesh], None]:
    """Icospheres in one mesh, by radius and centre."""

    def build(bm: bmesh.types.BMesh) -> None:
        for radius, centre in places:
            bmesh.ops.create_icosphere(bm, subdivisions=3, radius=radius, matrix=Matrix.Translation(centre))

    return build


def instance(collection: bpy.types.Collection, location=(0.0, 0.0, 0.0)) -> bpy.types.Object:
    empty = add("Instance", None, location)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    return empty


def into_collection(*objects: bpy.types.Object) -> bpy.types.Collection:
    """A new collection that takes objects out of the scene's own."""
    collection = bpy.data.collections.new("Collection")
    for obj in objects:
        bpy.context.scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
    return collection


def displacing(material: bpy.types.Material) -> bpy.types.Material:
    """The material, made to push surfaces out by 1.5."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeDisplacement")
    for name, value in (("Height", 1.0), ("Midlevel", 0.0), ("Scale", 1.5)):
        node.inputs[name].default_value = value
    output = tree.get_output_node("CYCLES")
    tree.links.new(node.outputs[0], output.inputs["Displacement"])
    material.displacement_method = "DISPLACEMENT"
    return material


def instanced_by_geometry_nodes(obj) -> tuple[str, ...]:
    tree = bpy.data.node_groups.new("Instance", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = obj
    info.inputs["As Instance"].default_value = True
    time = tree.nodes.new("GeometryNodeInputSceneTime")
    place = tree.nodes.new("GeometryNodeTransform")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(info.outputs["Geometry"], place.inputs["Geometry"])
    tree.links.new(time.outputs["Seconds"], place.inputs["Translation"])
    tree.links.new(place.outputs["Geometry"], output.inputs[0])
    bpy.context.scene.collection.objects.unlink(obj)
    host = add("Host", bpy.data.meshes.new("Host"))
    host.modifiers.new("Nodes", "NODES").node_group = tree
    return obj.name, host.name


ORDINARY = {"Water": Exterior.UNKNOWN, "Bead": Exterior.MEDIUM, "Crossing": Exterior.UNKNOWN, "Bystander": Exterior.AIR}


def ordinary_scene() -> tuple[bpy.types.Scene, bpy.types.Object]:
    """Media that are told of air and of a medium, and two that cross; the bead is in the water."""
    scene = fresh()
    ball("Water", 1.0, medium("Water", 1.33), 5)
    bead = ball("Bead", 0.4, medium("Bead", 1.5), 1)
    ball("Crossing", 0.5, medium("Crossing", 1.4), 2, (1.0, 0.1, 0.2))
    ball("Bystander", 0.5, medium("Bystander", 1.6), 3, (5.0, 0.0, 0.0))
    return scene, bead
