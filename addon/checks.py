"""What is wrong with a scene's media, object by object, and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import bpy
import numpy as np
from mathutils.bvhtree import BVHTree

from . import contacts, meshes
from .analysis import listed, triangles_of
from .lights import carried_lamps, light_carriers, listed_lamps
from .materials import dielectric_node, dielectrics, medium_material
from .media import dispersing_materials, get_priority, media
from .node_group import MATERIAL_SLOTS, group_version
from .parameters import GROUP_NAME, NEIGHBOUR_PARAMETERS, PRIORITY_PROPERTY

SURFACES = frozenset(("MESH", "CURVE", "SURFACE", "FONT", "META"))
"""Types of objects that a render shows as a mesh."""

NEAR = 1e-4
"""By how much to move what rests on something else, in diagonals of its box."""


@dataclass(frozen=True)
class Problem:
    """What is wrong with one object, and the remedy."""

    name: str
    text: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.name!r} {self.text}: {self.remedy}"


@dataclass(frozen=True)
class _Shape:
    """An evaluated mesh in world space."""

    obj: bpy.types.Object
    vertices: np.ndarray
    triangles: np.ndarray


def find_problems(scene: bpy.types.Scene) -> list[Problem]:
    """Look at every medium of a scene as it is evaluated now; change nothing."""
    depsgraph = _depsgraph(scene)
    objects = media(scene)
    evaluated = [obj.evaluated_get(depsgraph) for obj in objects]
    shapes = [shape for obj in evaluated if (shape := _shape(obj, np.array(obj.matrix_world))) is not None]
    problems = [problem for obj in scene.objects for problem in _node_problems(obj)]
    problems += [problem for obj in objects for problem in _object_problems(obj)]
    for shape in shapes:
        problems += _mesh_problems(shape)
    problems += _overlap_problems(shapes)
    problems += _resting_problems(shapes, objects, depsgraph)
    if dispersing_materials(scene):
        problems += _dispersion_problems(scene)
    if objects:
        problems += _lamp_problems(scene)
    return problems


def _depsgraph(scene: bpy.types.Scene) -> bpy.types.Depsgraph:
    """The evaluated state of a scene, which need not be the one in the window."""
    layer = scene.view_layers[0]
    layer.update()
    return layer.depsgraph


def _node_problems(obj: bpy.types.Object) -> list[Problem]:
    """A group node by another name renders, but its neighbours take the object for a foreign one."""
    return [
        Problem(
            obj.name,
            f"has a nested dielectric in material {slot.material.name!r} whose node is named {node.name!r}",
            f"rename the node to {GROUP_NAME!r}",
        )
        for slot in obj.material_slots
        if slot.material is not None and dielectric_node(slot.material) is None
        for node in slot.material.node_tree.nodes
        if node.type == "GROUP" and group_version(node.node_tree) is not None
    ]


def _shape(evaluated: bpy.types.Object, matrix: np.ndarray) -> _Shape | None:
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        return None
    if mesh is None:
        return None
    try:
        vertices, triangles = triangles_of(mesh)
    finally:
        evaluated.to_mesh_clear()
    world = vertices.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]
    return _Shape(evaluated.original, world, triangles)


def _object_problems(obj: bpy.types.Object) -> list[Problem]:
    problems = []
    value = obj.get(PRIORITY_PROPERTY)
    if value is not None and not isinstance(value, int):
        problems.append(
            Problem(
                obj.name,
                f"has the custom property {PRIORITY_PROPERTY!r} with no whole number in it",
                "delete it, or set its priority again",
            )
        )
    for slot, material in dielectrics(obj):
        if slot >= MATERIAL_SLOTS:
            problems.append(
                Problem(
                    obj.name,
                    f"has a nested dielectric in slot {slot + 1}, where its neighbours do not look",
                    f"move it to one of the first {MATERIAL_SLOTS} slots",
                )
            )
        node = dielectric_node(material)
        for name in NEIGHBOUR_PARAMETERS:
            if node.inputs[name].is_linked:
                problems.append(
                    Problem(
                        obj.name,
                        f"has a link into {name!r} of material {material.name!r}, which its neighbours cannot follow",
                        "unlink it; set, keyframe or drive the value itself",
                    )
                )
    return problems


def _mesh_problems(shape: _Shape) -> list[Problem]:
    name = shape.obj.name
    if len(shape.triangles) == 0:
        return [Problem(name, "has no faces", "give it a closed mesh, or another material")]
    if not np.isfinite(shape.vertices).all():
        return [
            Problem(
                name, "has coordinates that are not numbers", "remove those vertices, or the modifier that makes them"
            )
        ]
    edges = meshes.open_edge_count(shape.triangles)
    if edges:
        return [
            Problem(
                name,
                f"is not closed or its faces are turned against each other ({edges} edges)",
                "close it (Mesh > Clean Up > Fill Holes, or a Solidify modifier) and recalculate its normals",
            )
        ]
    if meshes.signed_volume(shape.vertices, shape.triangles) < 0.0:
        return [
            Problem(
                name,
                "has its normals pointing inwards",
                "recalculate them in Edit Mode (Mesh > Normals > Recalculate Outside)",
            )
        ]
    return []


def _resting_problems(
    shapes: list[_Shape], objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[Problem]:
    """Media whose faces lie in the same place as those of what is no medium: a ray meets either."""
    shapes = [shape for shape in shapes if len(shape.triangles) and np.isfinite(shape.vertices).all()]
    if not shapes:
        return []
    low, high = (np.array([end(shape.vertices, axis=0) for shape in shapes]) for end in (np.min, np.max))
    size = np.linalg.norm(high - low, axis=1)
    margin = NEAR * size[:, None]
    among = set(objects)
    names: dict[int, dict[str, None]] = {}
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type not in SURFACES or obj.original in among or obj.original.hide_render:
            continue
        matrix = np.array(instance.matrix_world)
        box = np.array([tuple(corner) for corner in obj.bound_box]) @ matrix[:3, :3].T + matrix[:3, 3]
        meets = (low - margin <= box.max(axis=0)) & (high + margin >= box.min(axis=0))
        near = np.flatnonzero(meets.all(axis=1))
        foreign = _shape(obj, matrix) if len(near) else None
        if foreign is None or not np.isfinite(foreign.vertices).all():
            continue
        solids = [contacts.Solid(shapes[index].vertices, shapes[index].triangles) for index in near]
        for index in contacts.resting(solids, contacts.Solid(foreign.vertices, foreign.triangles)):
            names.setdefault(int(near[index]), {})[obj.name] = None
    return [
        Problem(
            shapes[index].obj.name,
            f"has faces in the same place as {listed(tuple(others))}, which is no medium",
            f"move them {NEAR * size[index]:.2g} apart, which leaves air between them, or let them overlap as much, "
            "which leaves none",
        )
        for index, others in sorted(names.items())
    ]


def _dispersion_problems(scene: bpy.types.Scene) -> list[Problem]:
    """What else uses the portals and the motion blur that carry wavelengths."""
    problems = [
        Problem(
            obj.name,
            f"has a Ray Portal in material {slot.material.name!r}; light through it is taken for a single colour by media",
            "remove it, or switch Disperse off in this scene",
        )
        for obj in scene.objects
        for slot in obj.material_slots
        if slot.material is not None and slot.material.node_tree is not None
        if any(node.bl_idname == "ShaderNodeBsdfRayPortal" for node in slot.material.node_tree.nodes)
    ]
    problems += [
        Problem(
            layer.name,
            "has a Vector pass, which Cycles leaves out with the motion blur that dispersion needs",
            "render the pass with Disperse and motion blur off",
        )
        for layer in scene.view_layers
        if layer.use_pass_vector
    ]
    return problems


def _lamp_problems(scene: bpy.types.Scene) -> list[Problem]:
    """Lamps whose light gets lost between rays and lobes."""
    problems = [
        Problem(
            carrier.lamp,
            f"is left out of refraction or reflection by its Ray Visibility, and no lobe carries it, because {carrier.reason}",
            "switch Transmission and Glossy on, or give it a plain colour and strength",
        )
        for carrier in light_carriers(scene)
        if carrier.reason
    ]
    if listed_lamps() != carried_lamps(scene):
        problems.append(
            Problem(
                scene.name,
                "has other lamps for direct refraction and reflection than its media know",
                "prepare it again",
            )
        )
    return problems


def _signature(obj: bpy.types.Object) -> tuple:
    node = dielectric_node(medium_material(obj))
    return tuple(
        tuple(value) if hasattr(value, "__len__") else value
        for value in (node.inputs[name].default_value for name in NEIGHBOUR_PARAMETERS[1:])
    )


def _overlap_problems(shapes: list[_Shape]) -> list[Problem]:
    """Objects of equal priority that overlap are one medium; that they should be two different ones cannot be meant."""
    problems = []
    boxes = [
        (shape.vertices.min(axis=0), shape.vertices.max(axis=0)) if len(shape.vertices) else None for shape in shapes
    ]
    media_of = [(get_priority(shape.obj), _signature(shape.obj)) for shape in shapes]
    trees: dict[int, BVHTree] = {}

    def tree(index: int) -> BVHTree:
        if index not in trees:
            shape = shapes[index]
            trees[index] = BVHTree.FromPolygons(shape.vertices.tolist(), shape.triangles.tolist(), all_triangles=True)
        return trees[index]

    for i, j in combinations(range(len(shapes)), 2):
        (priority, medium), (other_priority, other_medium) = media_of[i], media_of[j]
        if priority != other_priority or medium == other_medium or boxes[i] is None or boxes[j] is None:
            continue
        if meshes.boxes_overlap(*boxes[i], *boxes[j]) and tree(i).overlap(tree(j)):
            a, b = shapes[i].obj.name, shapes[j].obj.name
            problems.append(
                Problem(
                    a,
                    f"overlaps {b!r} with the same priority {priority} and another medium",
                    "give the one that should win the lower priority",
                )
            )
    return problems
