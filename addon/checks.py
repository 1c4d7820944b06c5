"""What is wrong with a scene's media, object by object, and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from . import meshes
from .analysis import SHAPED, triangles_of
from .foreign import is_clear, lamp_box, sends_light_on
from .lights import carried_lamps, lamps, light_carriers, listed_lamps
from .materials import absorption_coefficients, dielectric_node, dielectrics, has_own_volume, medium_material
from .media import dispersing_materials, get_priority, media
from .node_group import BY_VOLUME_SOCKET, MASK_OUTPUT, MATERIAL_SLOTS, group_version
from .parameters import GROUP_NAME, NEIGHBOUR_PARAMETERS, PRIORITY_PROPERTY


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
    shapes = [shape for obj in objects if (shape := _shape(obj, depsgraph)) is not None]
    problems = [problem for obj in scene.objects for problem in _node_problems(obj)]
    problems += [problem for obj in objects for problem in _object_problems(obj)]
    for shape in shapes:
        problems += _mesh_problems(shape)
    problems += _overlap_problems(shapes)
    if dispersing_materials(scene):
        problems += _dispersion_problems(scene)
    if objects:
        problems += _lamp_problems(scene)
    problems += _tint_problems(scene, depsgraph, shapes)
    problems += _volume_problems(shapes)
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


def _shape(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> _Shape | None:
    evaluated = obj.evaluated_get(depsgraph)
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
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    world = vertices.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]
    return _Shape(obj, world, triangles)


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


def _is_tinted(obj: bpy.types.Object) -> bool:
    return max(absorption_coefficients(dielectric_node(medium_material(obj)))) > 0.0


def _is_left_to_volume(obj: bpy.types.Object) -> bool:
    """Whether Cycles' volume absorbs in a medium for all rays, as an analysis has told its material."""
    socket = dielectric_node(medium_material(obj)).inputs.get(BY_VOLUME_SOCKET)
    return socket is not None and socket.default_value


def _tint_problems(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, shapes: list[_Shape]) -> list[Problem]:
    """What surfaces do not charge rightly for in a tinted medium that is not left to its volume."""
    charged = [shape for shape in shapes if len(shape.triangles) and _is_tinted(shape.obj)]
    problems = [
        Problem(
            shape.obj.name,
            f"is tinted and has the label {slot.material.name!r}, which lets light into it unseen",
            "make the label an object of its own, a little off the surface",
        )
        for shape in charged
        for slot in shape.obj.material_slots
        if dielectric_node(slot.material) is None and is_clear(slot.material)
    ]
    charged = [shape for shape in charged if not _is_left_to_volume(shape.obj)]
    problems += [
        Problem(
            shape.obj.name,
            "is tinted and has a volume of its own in its material, whose scattered light is tinted in part",
            _TO_VOLUME.format(shape.obj.name),
        )
        for shape in charged
        if has_own_volume(medium_material(shape.obj))
    ]
    if charged:
        inside = _Inside()
        for name, points in _beyond_surfaces(scene, depsgraph, {shape.obj for shape in shapes}):
            problems += [
                Problem(
                    name,
                    f"shines, scatters or lets light through inside the tinted {shape.obj.name!r}, which tints that in part",
                    _TO_VOLUME.format(shape.obj.name),
                )
                for shape in charged
                if inside.any(shape, points)
            ]
    return problems


_TO_VOLUME = (
    "prepare the scene; should that not help, let nothing that touches {!r} move, link nothing into its colour, give it a "
    "priority of its own, and less tint where others win over it"
)

_SAMPLES = 256
"""Points of an object of which one must lie in a medium for the object to stand in it."""


def _beyond_surfaces(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, known: set[bpy.types.Object]):
    """Yield lamps and what lets light on, by name, with (n, 3) points of them."""
    for lamp in lamps(scene):
        if lamp.data.type != "SUN" and not lamp.hide_render:
            yield lamp.name, lamp_box(lamp).mean(axis=0)[None]
    for obj in scene.objects:
        if obj in known or obj.type not in SHAPED or obj.hide_render or not sends_light_on(obj):
            continue
        if medium_material(obj) is not None:
            continue
        shape = _shape(obj, depsgraph) if obj.type == "MESH" else None
        if shape is not None and len(shape.vertices):
            yield obj.name, _points(shape)
        else:
            yield obj.name, np.array([tuple(obj.matrix_world @ Vector(corner)) for corner in obj.bound_box]).mean(axis=0)[None]


def _points(shape: _Shape) -> np.ndarray:
    """(n, 3) some points of a surface: corners and centres of triangles."""
    points = np.concatenate([shape.vertices, shape.vertices[shape.triangles].mean(axis=1)])
    return points[:: len(points) // _SAMPLES + 1]


class _Inside:
    """Which points lie in a closed shape, by the parity of crossings along a ray; trees are made once."""

    def __init__(self) -> None:
        self._trees: dict[int, BVHTree] = {}

    def any(self, shape: _Shape, points: np.ndarray) -> bool:
        """Whether a shape holds any of (n, 3) points."""
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        near = points[((points >= low) & (points <= high)).all(axis=1)]
        return any(self._holds(shape, Vector(point)) for point in near)

    def _holds(self, shape: _Shape, point: Vector) -> bool:
        key = id(shape)
        if key not in self._trees:
            self._trees[key] = _tree(shape)
        way = Vector((0.3713, 0.4871, 0.7904)).normalized()
        crossings = 0
        while (hit := self._trees[key].ray_cast(point, way))[0] is not None:
            crossings += 1
            point = hit[0] + way * 1e-5
        return crossings % 2 == 1


def _tree(shape: _Shape) -> BVHTree:
    return BVHTree.FromPolygons(shape.vertices.tolist(), shape.triangles.tolist(), all_triangles=True)


def _volume_problems(shapes: list[_Shape]) -> list[Problem]:
    """Volumes that an artist has added to a medium and that go on where another wins, or cannot tell where that is."""
    problems = []
    inside = _Inside()
    for shape in shapes:
        material = medium_material(shape.obj)
        if not len(shape.triangles) or not has_own_volume(material):
            continue
        mask = dielectric_node(material).outputs.get(MASK_OUTPUT)
        priority = get_priority(shape.obj)
        for winner in (other for other in shapes if len(other.triangles) and get_priority(other.obj) < priority):
            if mask is not None and mask.is_linked:
                if winner.obj.matrix_world.determinant() < 0.0:
                    problems.append(
                        Problem(
                            winner.obj.name,
                            f"is mirrored, so the {MASK_OUTPUT!r} of {shape.obj.name!r} takes its inside for its outside",
                            "apply its scale (Object > Apply > Scale) and recalculate its normals",
                        )
                    )
            elif inside.any(shape, _points(winner)) or inside.any(winner, _points(shape)):
                problems.append(
                    Problem(
                        shape.obj.name,
                        f"has a volume of its own in its material that goes on inside {winner.obj.name!r}, which wins over it",
                        f"multiply its density by the node's output {MASK_OUTPUT!r}",
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
            trees[index] = _tree(shapes[index])
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
