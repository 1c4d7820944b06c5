"""What is wrong with a scene's media, object by object, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..analysis.analysis import SHAPED, is_relative, listed
from ..geometry import contacts, meshes
from ..model.parameters import MAX_PRIORITY, NEIGHBOUR_PARAMETERS, PRIORITY_PROPERTY, SOCKETS
from ..nodes.animation import curves
from ..nodes.identity import known_number
from ..nodes.lookups import looked_up_once, unchanged_nodes
from ..nodes.node_group import BY_VOLUME_SOCKET, MASK_OUTPUT, MATERIAL_SLOTS
from ..nodes.trees import node_problems, shows_others_blindly, socket_value
from ..scene.foreign import is_clear, lamp_box, sends_light_on
from ..scene.lights import carried_lamps, lamps, light_carriers, listed_lamps
from ..scene.materials import (
    absorption_coefficients,
    dielectric_node,
    dielectrics,
    has_own_volume,
    may_disperse,
    medium_material,
)
from ..scene.media import (
    NO_SOLIDS,
    SOLID_TYPES,
    all_objects,
    dispersing_materials,
    get_priority,
    is_cut_surface,
    media,
    own_priority,
)
from ..scene.shapes import triangles_of

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
    """An evaluated mesh in world space.

    :param mesh: the same in its own space, one for all objects that show it.

    :param materials: nested dielectrics that its faces have.
    """

    obj: bpy.types.Object
    mesh: _Mesh
    vertices: np.ndarray
    triangles: np.ndarray
    materials: tuple[bpy.types.Material, ...]


@dataclass(frozen=True, eq=False)
class _Mesh:
    """An evaluated mesh in its own space, and what is wrong with it.

    :param slots: material slots of its faces.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    slots: np.ndarray

    @cached_property
    def open_edges(self) -> int:
        """Number of edges that are not between two faces turned alike; a seam is none."""
        edges = meshes.open_edge_count(self.triangles)
        return edges and meshes.open_edge_count(meshes.same_places(self.vertices)[self.triangles])

    @cached_property
    def is_inverted(self) -> bool:
        """Whether its normals point inwards."""
        return meshes.signed_volume(self.vertices.astype(np.float64), self.triangles) < 0.0


@unchanged_nodes()
def find_problems(scene: bpy.types.Scene) -> list[Problem]:
    """Look at every medium of a scene as it is evaluated now; change nothing."""
    depsgraph = _depsgraph(scene)
    objects = media(scene)
    evaluated = [obj.evaluated_get(depsgraph) for obj in objects]
    known: dict[int, _Mesh] = {}
    shapes = [shape for obj in evaluated if (shape := _shape(obj, np.array(obj.matrix_world), known)) is not None]
    problems = material_problems(scene)
    problems += _kind_problems(depsgraph)
    problems += [problem for obj in objects for problem in _object_problems(obj)]
    problems += _value_problems(objects)
    for shape in shapes:
        problems += _mesh_problems(shape, shapes) + _mixture_problems(shape)
    problems += _overlap_problems(shapes)
    problems += _mask_problems(shapes)
    problems += _resting_problems(shapes, objects, depsgraph)
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


@unchanged_nodes()
def material_problems(scene: bpy.types.Scene) -> list[Problem]:
    """Return what is wrong with the nodes of a scene's materials, each named by the first object that has it."""
    users: dict[bpy.types.Material, bpy.types.Object] = {}
    for obj in sorted(all_objects(scene), key=lambda obj: obj.name_full):
        for slot in obj.material_slots:
            if slot.material is not None:
                users.setdefault(slot.material, obj)
    return [
        Problem(obj.name, f"has {text}", remedy)
        for material, obj in users.items()
        for text, remedy in node_problems(material)
    ]


def _shape(evaluated: bpy.types.Object, matrix: np.ndarray, known: dict[int, _Mesh] | None = None) -> _Shape | None:
    """known: meshes by the session's numbers of those that objects show as they are; brought up to date."""
    obj = evaluated.original
    shared = known is not None and obj.type == "MESH" and not obj.modifiers and obj.data.shape_keys is None
    mesh = known.get(obj.data.session_uid) if shared else None
    if mesh is None:
        mesh = _mesh(evaluated)
        if mesh is None:
            return None
        if shared:
            known[obj.data.session_uid] = mesh
    world = mesh.vertices.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    triangles = mesh.triangles[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else mesh.triangles
    materials = [slot.material.original if slot.material else None for slot in evaluated.material_slots]
    used = (materials[min(slot, len(materials) - 1)] for slot in mesh.slots) if materials else ()
    return _Shape(obj, mesh, world, triangles, tuple(each for each in dict.fromkeys(used) if dielectric_node(each)))


def _mesh(evaluated: bpy.types.Object) -> _Mesh | None:
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        return None
    if mesh is None:
        return None
    try:
        slots = np.zeros(len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("material_index", slots)
        return _Mesh(*triangles_of(mesh), np.unique(slots))
    finally:
        evaluated.to_mesh_clear()


def _kind_problems(depsgraph: bpy.types.Depsgraph) -> list[Problem]:
    """What has a nested dielectric and no inside: objects, and what modifiers make of them."""
    found = {}
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type in NO_SOLIDS and any(dielectric_node(m.original) for m in obj.data.materials if m is not None):
            owner = instance.parent if instance.is_instance else obj
            found[owner.original] = obj.type
    for obj in depsgraph.scene.objects:
        if any(_is_hair(obj.original, system) for system in obj.particle_systems):
            found[obj.original] = "CURVES"
    problems = []
    for obj, kind in found.items():
        what, remedy = NO_SOLIDS[kind]
        text = f"is {what}" if obj.type == kind else f"makes {what} of a nested dielectric"
        remedy = f"{remedy}, or give it another material"
        problems.append(Problem(obj.name, f"{text}, which Cycles knows no inside of", remedy))
    return problems


def _is_hair(obj: bpy.types.Object, system: bpy.types.ParticleSystem) -> bool:
    """Whether particles are rendered as strands of a nested dielectric."""
    slots, settings = obj.material_slots, system.settings
    if settings.render_type != "PATH" or not slots:
        return False
    return dielectric_node(slots[min(settings.material, len(slots)) - 1].material) is not None


def _object_problems(obj: bpy.types.Object) -> list[Problem]:
    problems = _priority_problems(obj)
    for slot, _ in dielectrics(obj):
        if slot >= MATERIAL_SLOTS:
            problems.append(
                Problem(
                    obj.name,
                    f"has a nested dielectric in slot {slot + 1}, where its neighbours do not look",
                    f"move it to one of the first {MATERIAL_SLOTS} slots",
                )
            )
    return problems


def _priority_problems(obj: bpy.types.Object) -> list[Problem]:
    """A custom property that is no whole number, or is animated beyond what counts."""
    value = obj.get(PRIORITY_PROPERTY)
    if value is None:
        return []
    problems = []
    own = own_priority(obj)
    if own is None or type(value) is not int:
        counts = f"counts as {own}" if own is not None else f"does not count: {get_priority(obj)}, its material's, does"
        problems.append(
            Problem(
                obj.name,
                f"has the custom property {PRIORITY_PROPERTY!r} with no whole number from 0 to {MAX_PRIORITY} in it, "
                f"which {counts}",
                "delete it, or set its priority again",
            )
        )
    path = f'["{PRIORITY_PROPERTY}"]'
    keys = [key for curve in curves(obj.animation_data) if curve.data_path == path for key in curve.keyframe_points]
    if any(not 0.0 <= key.co[1] <= MAX_PRIORITY for key in keys):
        problems.append(
            Problem(
                obj.name,
                f"has keyframes of its priority beyond 0 to {MAX_PRIORITY}, where its material's counts",
                "move them, or delete them",
            )
        )
    return problems


def _value_problems(objects: list[bpy.types.Object]) -> list[Problem]:
    """Values of sockets that only a script can set: the shader takes the nearest within limits, or the default."""
    problems = []
    users = {material: obj for obj in reversed(objects) for _, material in dielectrics(obj)}
    for material, obj in users.items():
        node = dielectric_node(material)
        for parameter in SOCKETS:
            socket = node.inputs[parameter.name]
            if parameter.limits is None or socket.is_linked:
                continue
            value = socket.default_value
            counts = parameter.bounded(value)
            if not np.array_equal(np.float32(value), np.float32(counts)):
                problems.append(
                    Problem(
                        obj.name,
                        f"has {_shown(value)} for {parameter.name!r} in material {material.name!r}, "
                        f"which counts as {_shown(counts)}",
                        f"set it to something from {parameter.limits[0]:g} to {parameter.limits[1]:g}",
                    )
                )
    return problems


def _shown(value: float | Sequence[float]) -> str:
    if isinstance(value, (int, float)):
        return f"{value:.4g}"
    return f"({', '.join(f'{component:.4g}' for component in tuple(value)[:3])})"


_EMPTY = {
    "MESH": "give it a closed mesh, or another material",
    "CURVE": "give it a Bevel Depth and Fill Caps (Curve properties > Geometry), or another material",
    "FONT": "give it letters and an Extrude (Text properties > Geometry), or another material",
    "SURFACE": "close it (Edit Mode > Surface > Cyclic), or give it another material",
    "META": "let it reach its threshold (a larger Radius or Stiffness), or give it another material",
}
_CONVERT = "turn it into a mesh (Object > Convert > Mesh)"
_OPEN = {
    "MESH": "close it (Mesh > Clean Up > Fill Holes, Merge > By Distance, or a Solidify modifier) and recalculate its "
    "normals",
    "CURVE": "switch on Fill Caps (Curve properties > Geometry > Bevel) or make it Cyclic; turn around a bevel object that "
    "faces the other way (Edit Mode > Segments > Switch Direction)",
    "FONT": "give it an Extrude and the Fill Mode Both (Text properties)",
    "SURFACE": f"close it (Edit Mode > Surface > Cyclic), or {_CONVERT} and merge its vertices by distance",
    "META": f"{_CONVERT} and close that",
}
_INVERTED = {
    "MESH": "recalculate them in Edit Mode (Mesh > Normals > Recalculate Outside)",
    "SURFACE": f"turn it around (Edit Mode > Segments > Switch Direction), or {_CONVERT} and recalculate its normals",
    "META": "make its elements positive",
}
"""Remedies by the object's type."""


def _mesh_problems(shape: _Shape, shapes: list[_Shape]) -> list[Problem]:
    obj, name = shape.obj, shape.obj.name
    if len(shape.triangles) == 0:
        family = next((other.obj for other in shapes if is_relative(other.obj, obj) and len(other.triangles)), None)
        if family is not None:
            return _family_problems(obj, family)
        return [Problem(name, "has no faces", _EMPTY[obj.type])] if obj.type in SOLID_TYPES else []
    if not np.isfinite(shape.vertices).all():
        return [
            Problem(
                name, "has coordinates that are not numbers", "remove those vertices, or the modifier that makes them"
            )
        ]
    edges = shape.mesh.open_edges
    if edges:
        text = f"is not closed or its faces are turned against each other ({edges} edges)"
        return [Problem(name, text, _OPEN.get(obj.type, _CONVERT))]
    if shape.mesh.is_inverted:
        remedy = _INVERTED.get(obj.type, f"{_CONVERT} and recalculate its normals")
        return [Problem(name, "has its normals pointing inwards", remedy)]
    return []


def _family_problems(obj: bpy.types.Object, family: bpy.types.Object) -> list[Problem]:
    """Metaballs of one name are one object, which the first of them gives its material and its priority."""
    if get_priority(obj) == get_priority(family) and _signature(obj) == _signature(family):
        return []
    return [
        Problem(
            obj.name,
            f"merges into the metaball {family.name!r}, whose medium and priority are not its own",
            "give it the same, or a name of its own that differs in more than a number",
        )
    ]


def _mixture_problems(shape: _Shape) -> list[Problem]:
    """An object is one medium: which it is inside cannot be told by faces."""
    media_of = {_values(material): material.name for material in shape.materials}
    if len(media_of) < 2:
        return []
    return [
        Problem(
            shape.obj.name,
            f"has {len(media_of)} media in one object, {' and '.join(map(repr, media_of.values()))}",
            "separate them (Edit Mode > Mesh > Separate > By Material) and close each"
            if shape.obj.type == "MESH"
            else f"{_CONVERT} and separate them (Edit Mode > Mesh > Separate > By Material)",
        )
    ]


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
        if obj.type not in SOLID_TYPES or obj.original in among or obj.original.hide_render or is_cut_surface(obj):
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
    carried = carried_lamps(scene)
    linked = {
        material: obj
        for obj in reversed(media(scene))
        for _, material in dielectrics(obj)
        if material.library is not None and carried
    }
    problems += [
        Problem(
            obj.name,
            f"has the linked material {material.name!r}, whose lobes carry none of this scene's lamps, such as "
            f"{carried[0].name!r}",
            "make the material local, or switch Transmission and Glossy on in the Ray Visibility of the lamps",
        )
        for material, obj in linked.items()
    ]
    if listed_lamps(scene) != carried:
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


def _is_left_to_volume(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Whether Cycles' volume absorbs in a medium for all rays, as an analysis has told its material."""
    socket = dielectric_node(medium_material(obj)).inputs.get(BY_VOLUME_SOCKET)
    return socket is not None and 0 < socket.default_value == known_number(scene)


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
    charged = [shape for shape in charged if not _is_left_to_volume(scene, shape.obj)]
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
        evaluated = obj.evaluated_get(depsgraph)
        shape = _shape(evaluated, np.array(evaluated.matrix_world)) if obj.type == "MESH" else None
        if shape is not None and len(shape.vertices):
            yield obj.name, _points(shape)
        else:
            yield (
                obj.name,
                np.array([tuple(obj.matrix_world @ Vector(corner)) for corner in obj.bound_box]).mean(axis=0)[None],
            )


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

    def overlap(self, one: _Shape, other: _Shape) -> bool:
        """Whether two shapes cross, or one holds the other."""
        if self._tree(one).overlap(self._tree(other)):
            return True
        return self.any(one, other.vertices[other.triangles[:1, 0]]) or self.any(
            other, one.vertices[one.triangles[:1, 0]]
        )

    def _tree(self, shape: _Shape) -> BVHTree:
        key = id(shape)
        if key not in self._trees:
            self._trees[key] = BVHTree.FromPolygons(
                shape.vertices.tolist(), shape.triangles.tolist(), all_triangles=True
            )
        return self._trees[key]

    def _holds(self, shape: _Shape, point: Vector) -> bool:
        way = Vector((0.3713, 0.4871, 0.7904)).normalized()
        crossings = 0
        while (hit := self._tree(shape).ray_cast(point, way))[0] is not None:
            crossings += 1
            point = hit[0] + way * 1e-5
        return crossings % 2 == 1


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


def _mask_problems(shapes: list[_Shape]) -> list[Problem]:
    """Other shaders that show where the surface that they are mixed into does not exist."""
    used = {material for shape in shapes for material in shape.materials}
    blind = {material for material in used if shows_others_blindly(material)}
    if not blind:
        return []
    shapes = [shape for shape in shapes if len(shape.vertices)]
    low = np.array([shape.vertices.min(axis=0) for shape in shapes])
    high = np.array([shape.vertices.max(axis=0) for shape in shapes])
    priorities = np.array([get_priority(shape.obj) for shape in shapes])
    remedy = "multiply the factor of the Mix Shader by Surface Exists of the nested dielectric"
    problems = []
    for index, shape in enumerate(shapes):
        mixed = [material for material in shape.materials if material in blind]
        if not mixed:
            continue
        meets = np.all((low < high[index]) & (high > low[index]), axis=1) & (priorities <= priorities[index])
        wrong = ["show inside media that win over it, too"] if np.count_nonzero(meets) > 1 else []  # more than itself
        wrong += ["count twice where light is split"] if any(map(may_disperse, mixed)) else []
        if wrong:
            text = f"mixes other shaders into material {mixed[0].name!r}, which {' and '.join(wrong)}"
            problems.append(Problem(shape.obj.name, text, remedy))
    return problems


@looked_up_once
def _values(material: bpy.types.Material) -> tuple:
    """What neighbours read of a material."""
    node = dielectric_node(material)
    return tuple(socket_value(node.inputs[name]) for name in NEIGHBOUR_PARAMETERS)


def _signature(obj: bpy.types.Object) -> tuple:
    return _values(medium_material(obj))[1:]


def _overlap_problems(shapes: list[_Shape]) -> list[Problem]:
    """Objects of equal priority that overlap are one medium; that they should be two different ones cannot be meant."""
    levels: dict[int, list[_Shape]] = {}
    for shape in shapes:
        if len(shape.triangles) and np.isfinite(shape.vertices).all():
            levels.setdefault(get_priority(shape.obj), []).append(shape)
    inside = _Inside()
    return [
        Problem(
            one.obj.name,
            f"overlaps {other.obj.name!r} with the same priority {priority} and another medium",
            "give the one that should win the lower priority",
        )
        for priority, level in levels.items()
        for one, other in _different_neighbours(level)
        if inside.overlap(one, other)
    ]


def _different_neighbours(shapes: list[_Shape]) -> Iterator[tuple[_Shape, _Shape]]:
    """Pairs of shapes of different media whose boxes meet."""
    numbers: dict[tuple, int] = {}
    kinds = np.array([numbers.setdefault(_signature(shape.obj), len(numbers)) for shape in shapes])
    if len(numbers) < 2:
        return
    low, high = (np.array([end(shape.vertices, axis=0) for shape in shapes]) for end in (np.min, np.max))
    for index, shape in enumerate(shapes):
        rest = slice(index + 1, None)
        meets = (low[rest] <= high[index]).all(axis=1) & (high[rest] >= low[index]).all(axis=1)
        for other in np.flatnonzero(meets & (kinds[rest] != kinds[index])):
            yield shape, shapes[index + 1 + other]
