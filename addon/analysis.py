"""Telling media what surrounds them, so that they need not ask the scene while it is rendered.

:func:`analyse` looks at a scene's media as they are evaluated now and writes what holds whenever the file is rendered: into
the sockets of a material where it holds for all of its objects, else into their custom properties, and into an attribute of
a mesh where its faces differ. The shader needs nothing else of the extension. Whatever may be different in a render (things
that move, modifiers that depend on more than their mesh, what is hidden in the viewport alone) leaves all media asking the
scene, as they do without an analysis; and the shader checks a share of what it is told (osl/outside.h).
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from time import perf_counter

import bpy
import numpy as np

from . import contacts
from .charging import Filling, left_to_volumes
from .contacts import AIR, FACES, LEVELS, MEDIUM, NEVER, PROBE, Body, Contact, Memory, Solid
from .foreign import is_clear, is_seen_by_all, lamp_box, sends_light_on
from .lights import lamps
from .materials import absorption_coefficients, dielectric_node, has_own_volume
from .media import media, own_priority
from .node_group import (
    AIR_AROUND,
    BY_OBJECT,
    BY_VOLUME_SOCKET,
    CLEAR,
    FACE_ATTRIBUTE,
    FOREIGN_SOCKET,
    GIVES_BACK_SOCKET,
    LEVEL_SOCKET,
    MATERIAL_SLOTS,
    NEIGHBOUR_VALUES,
    OBJECT_PROPERTIES,
    OFFSET_GROUP,
    OUTSIDE_SOCKET,
    OVERLAP_SOCKET,
    SLOTS_SOCKET,
    SURROUNDINGS_COLOR_SOCKET,
    SURROUNDINGS_SOCKET,
    VOLUME_OUTPUT,
    has_analysis,
)

ANALYSED = "nd_analysed"
"""Custom property of a scene whose media are kept analysed."""

SETTLED_MODIFIERS = frozenset(
    (
        "ARRAY",
        "BEVEL",
        "CAST",
        "DECIMATE",
        "DISPLACE",
        "EDGE_SPLIT",
        "MIRROR",
        "REMESH",
        "SCREW",
        "SIMPLE_DEFORM",
        "SMOOTH",
        "LAPLACIANSMOOTH",
        "CORRECTIVE_SMOOTH",
        "SOLIDIFY",
        "SUBSURF",
        "TRIANGULATE",
        "WEIGHTED_NORMAL",
        "WELD",
    )
)
"""Modifiers whose result depends on the mesh and on numbers alone, the same in the viewport and in a render."""

ABSORPTION_VALUES = ("Transmittance", "Transmittance Depth")
NOTHING_ABSORBED = (0.0, 0.0, 0.0)

EVERYWHERE = np.array([(-np.inf,) * 3, (np.inf,) * 3])
VAGUE = 0.5
"""Margin around what a render may show with another shape, in diagonals of its box: a subdivided surface stays within
the hull of any coarser one.
"""

NEAR = 1e-3
"""Margin around what has changed, which may touch what its box does not meet."""

PATIENCE = 0.03
"""Seconds that one look at a scene may take while the mouse moves something in it."""

HIGHEST_OBJECT_LEVEL = 2.0**17
"""Of an object's own; single precision keeps it and all that stands beside it."""


@dataclass(frozen=True)
class Outside:
    """What a medium is told of its outside; the defaults tell nothing."""

    code: int = PROBE
    level: float = -1.0
    overlaps_itself: bool = False
    foreign: bool = True
    medium: tuple[float, float, float] = AIR_AROUND
    transmittance: tuple[float, float, float, float] = CLEAR
    by_volume: bool = False
    gives_back: bool = False

    @property
    def absorbs(self) -> bool:
        """Whether the medium outside is said to absorb."""
        return self.transmittance != CLEAR

    def merged(self, other: Outside) -> Outside | None:
        """What holds for both, or None if that is less than each is told."""
        if self == other:
            return self
        if (self.code, self.medium, self.transmittance) != (other.code, other.medium, other.transmittance):
            return None
        return replace(
            self,
            level=self.level if self.level == other.level else -1.0,
            overlaps_itself=self.overlaps_itself or other.overlaps_itself,
            foreign=self.foreign or other.foreign,
        )


@dataclass(frozen=True)
class Found:
    """What an analysis found, by name of object, each in the order of the scene's media.

    :param known: media that ask the scene nowhere.
    :param partly: media that ask the scene only near crossings.
    :param asking: media that ask the scene everywhere.
    :param overlapping: media that overlap themselves.
    :param coincident: pairs of media with faces in the same place.
    :param stale: media that linked files tell of other surroundings than they have here.
    :param doubts: why nothing is told to any medium, by name; empty where it is.
    """

    known: tuple[str, ...] = ()
    partly: tuple[str, ...] = ()
    asking: tuple[str, ...] = ()
    overlapping: tuple[str, ...] = ()
    coincident: tuple[tuple[str, str], ...] = ()
    stale: tuple[str, ...] = ()
    doubts: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        lines = [f"{name!r} {reason}, so all media ask the scene what surrounds them" for name, reason in self.doubts]
        lines += [
            f"{what}: {_listed(names)}"
            for names, what in (
                (self.known, "know what surrounds them"),
                (self.partly, "know what surrounds them except near crossings"),
                (() if self.doubts else self.asking, "ask the scene what surrounds them"),
                (self.overlapping, "overlap themselves, which takes longer"),
                (self.stale, "show magenta, because their linked file tells them otherwise"),
            )
            if names
        ]
        return "\n".join(lines)


def _listed(names: tuple[str, ...], most: int = 4) -> str:
    shown = ", ".join(map(repr, names[:most]))
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def is_analysed(scene: bpy.types.Scene) -> bool:
    """Whether the media of a scene are kept analysed."""
    return bool(scene.get(ANALYSED))


def clear_analysis(scene: bpy.types.Scene) -> None:
    """Make all media of a scene ask it again while it is rendered, and those of other scenes until they are analysed."""
    scene.pop(ANALYSED, None)
    for obj in bpy.data.objects:
        _tell_object(obj, None)
        if obj.type == "MESH" and obj.mode == "OBJECT":
            _tell_faces(obj.data, None)
    for material in bpy.data.materials:
        if dielectric_node(material) is not None:
            _tell_material(material, Outside())


def analyse(scene: bpy.types.Scene) -> Found:
    """Look at the media of a scene, and tell each what surrounds it. The scene's media are kept analysed from then on.

    Linked materials and objects are left as they are.
    """
    scene[ANALYSED] = True
    layer = scene.view_layers[0]
    layer.update()
    forget_shapes()
    return _look(_survey(scene, layer.depsgraph))


def follow(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Analyse again after an update of a scene whose media are kept analysed, as far as the update reaches."""
    survey = _updated(scene, depsgraph)
    if survey is not None:
        _look(survey)


def hold(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Make all that an update of a scene may concern ask the scene, which takes little time, and return whether
    :func:`settle` is to be called once nothing moves any more.

    What comes, goes or changes its nature is analysed at once. So is all if the last look at something new was quick, since
    to ask is another shader, which a rendered view must compile.
    """
    survey = _updated(scene, depsgraph)
    if survey is None:
        return False
    latest = _surveys.get(scene.session_uid)
    settled = latest and (latest.settled or latest)
    if not settled or not survey.is_like(settled) or _seconds.get(scene.session_uid, 0.0) < PATIENCE:
        _look(survey)
        return False
    _conclude(replace(survey, contacts=settled.contacts, settled=settled))
    # What was told comes back as an update that changes no row.
    return not all(map(_Row.is_same, latest.rows, survey.rows))


def settle(scene: bpy.types.Scene) -> None:
    """Analyse what :func:`hold` left."""
    survey = _surveys.get(scene.session_uid)
    if survey is not None and survey.settled is not None:
        _look(replace(survey, settled=None))


def forget_shapes() -> None:
    """Look at all meshes anew the next time: after another file, or another state of this one, has been loaded."""
    _shapes.clear()
    _surveys.clear()


@dataclass(frozen=True)
class Coincidence:
    """Faces of a medium that lie in the same place as others' and are to be moved.

    :param others: names of those, for a sentence.
    :param rank: number of stronger levels of priority among all that coincide, at least 1.
    :param size: diagonal of the object's box, scene units.
    :param reach: its largest coordinate.
    :param matrix: (4, 4) from the mesh's space to the world's.
    :param corners: (m, 3) vertices of the triangles.
    :param normals: (m, 3) in the world, outwards.
    :param sides: (m,) 1 where they are to be moved along the normals, -1 where against them: a weaker medium's into the
        stronger one, a stronger one's outwards where only part of a larger face is met.
    """

    obj: bpy.types.Object
    others: str
    rank: int
    size: float
    reach: float
    matrix: np.ndarray
    corners: np.ndarray
    normals: np.ndarray
    sides: np.ndarray


def coincidences(scene: bpy.types.Scene) -> list[Coincidence]:
    """Return what coincides in a scene, as the last analysis in this session found it."""
    survey = _surveys.get(scene.session_uid)
    if survey is None:
        return []
    rows = survey.bodies
    among = [{other for other, *_ in contact.coincident} for contact in survey.contacts]
    moved = {}
    for index, (row, contact) in enumerate(zip(rows, survey.contacts)):
        found = []
        for other, triangles, signs in contact.coincident:
            if (row.body.priority, index) > (rows[other].body.priority, other):
                found.append((other, triangles, -signs))
            elif index not in among[other]:
                # Part of a larger face of the weaker one's, which cannot be moved alone.
                found.append((other, triangles, np.ones(len(signs))))
        if found and row.obj not in moved:
            moved[row.obj] = (row, found)
    levels = sorted({rows[other].body.priority for _, found in moved.values() for other, *_ in found})
    result = []
    for obj, (row, found) in moved.items():
        faces = np.concatenate([triangles for _, triangles, _ in found])
        corners = row.body.solid.triangles[faces]
        a, b, c = (row.body.solid.vertices[corners[:, i]] @ row.body.matrix[:3, :3].T for i in range(3))
        normals = np.cross(b - a, c - a) * np.sign(np.linalg.det(row.body.matrix[:3, :3]))
        result.append(
            Coincidence(
                obj,
                _listed(tuple(rows[other].obj.name for other, *_ in found)),
                max(sum(level < row.body.priority for level in levels), 1),
                float(np.linalg.norm(row.box[1] - row.box[0])),
                float(np.abs(row.box).max()),
                row.body.matrix,
                corners,
                normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30),
                np.concatenate([sides for *_, sides in found]).astype(float),
            )
        )
    return result


def last_found(scene: bpy.types.Scene) -> Found | None:
    """What the last analysis of a scene found in this session."""
    return _last.get(scene.session_uid) if is_analysed(scene) else None


_CONCERNED = (
    bpy.types.Object,
    bpy.types.Mesh,
    bpy.types.Material,
    bpy.types.ShaderNodeTree,
    bpy.types.GeometryNodeTree,
    bpy.types.Collection,
)
_SHADING = (bpy.types.Material, bpy.types.ShaderNodeTree)


def _look(survey: _Survey) -> Found:
    """Find the contacts of a survey, and tell the media."""
    start = perf_counter()
    found = _conclude(replace(survey, contacts=contacts.analyse([row.body for row in survey.bodies], _memory)))
    if _memory.looked_at:
        _seconds[survey.scene.session_uid] = perf_counter() - start
    return found


def _conclude(survey: _Survey) -> Found:
    told = _outsides(survey)
    _tell(survey, told)
    _forget_unused(survey)
    found = _found(survey, told)
    _surveys[survey.scene.session_uid] = survey
    _last[survey.scene.session_uid] = found
    return found


# Looking ------------------------------------------------------------------------------------------------------------


class _Doubt(Exception):
    """Why nothing may be told to anyone: an object may be anywhere, or fill space that it does not show."""


@dataclass(frozen=True)
class _Facts:
    """What matters of a nested dielectric's material.

    :param values: IOR, transmittance and its depth; None if they may change from frame to frame.
    :param priority: None if it may change.
    :param displaces: it moves the surface of its objects.
    :param coefficients: what it absorbs of each colour per length; None if it may change.
    :param has_volume: its absorption is a volume to Cycles, the same everywhere.
    :param has_own_volume: the artist has added a volume, which may scatter rays before they come to a surface.
    """

    values: tuple | None
    priority: int | None
    displaces: bool
    can_be_told: bool
    coefficients: tuple[float, float, float] | None
    has_volume: bool
    has_own_volume: bool


@dataclass(frozen=True, eq=False)
class _Row:
    """An instance of an object.

    :param box: (2, 3) lowest and highest corner of where it may be, in the world.
    :param medium: it is a nested dielectric.
    :param body: the medium's exact shape and place; None if a render may show it with another in the same box.
    :param doubt: empty, or why it may be anywhere.
    """

    obj: bpy.types.Object
    box: np.ndarray
    medium: bool = False
    body: Body | None = None
    doubt: str = ""

    def is_like(self, other: _Row) -> bool:
        """Whether the other differs in place, shape and values at most."""
        return (self.obj, self.medium, self.body is None, self.doubt) == (
            other.obj,
            other.medium,
            other.body is None,
            other.doubt,
        )

    def is_same(self, other: _Row) -> bool:
        """Whether the same follows from the other."""
        return self is other or (
            self.is_like(other)
            and np.array_equal(self.box, other.box)
            and (self.body is None or self.body.is_same(other.body))
        )


@dataclass(frozen=True, eq=False)
class _Survey:
    """Every instance in a scene, and what the bodies among them know.

    :param rows: in the order of the depsgraph.
    :param facts: of the materials.
    :param doubts: names and reasons.
    :param known: objects by name whose rows may be made anew one by one; empty where objects are instanced.
    :param settled: the survey whose contacts these are, if some rows have changed since.
    """

    scene: bpy.types.Scene
    rows: list[_Row]
    facts: dict[bpy.types.Material, _Facts]
    doubts: tuple[tuple[str, str], ...]
    known: dict[str, int]
    contacts: list[Contact]
    settled: _Survey | None = None

    def is_like(self, other: _Survey) -> bool:
        """Whether rows of the other differ in place, shape and values at most."""
        return (len(self.rows), self.doubts, self.facts.keys()) == (
            len(other.rows),
            other.doubts,
            other.facts.keys(),
        ) and all(map(_Row.is_like, self.rows, other.rows))

    @cached_property
    def changed(self) -> list[_Row]:
        """Media whose place, shape or values are others than in the settled survey: as they were and as they are."""
        pairs = zip(self.settled.rows, self.rows) if self.settled else ()
        return [row for before, now in pairs if now.medium and not now.is_same(before) for row in (before, now)]

    @cached_property
    def elsewhere(self) -> set[bpy.types.Object]:
        """Objects of other scenes, where what holds in this one need not."""
        others = [scene for scene in bpy.data.scenes if scene != self.scene]
        return {obj for scene in others for obj in (*scene.objects, *media(scene))}

    @cached_property
    def bodies(self) -> list[_Row]:
        return [row for row in self.rows if row.body is not None]

    @cached_property
    def mixed(self) -> set[int]:
        """Priorities of which bodies overlap that are filled with different media, so that either may be found."""
        return {
            row.body.priority
            for row, contact in zip(self.bodies, self.contacts)
            for other in (self.bodies[partner].body for partner in contact.partners)
            if other.priority == row.body.priority and other.medium != row.body.medium
        }

    @cached_property
    def vague(self) -> list[_Row]:
        return [row for row in self.rows if row.medium and row.body is None]


_shapes: dict[int, Solid] = {}
"""Evaluated meshes, by the session's number of the mesh, or of the object where modifiers make it its own."""

_solids: dict[bytes, Solid] = {}
"""The same by what is in them."""

_memory = Memory()
_surveys: dict[int, _Survey] = {}
_seconds: dict[int, float] = {}
"""How long the last look at a scene took for which meshes were compared."""

_last: dict[int, Found] = {}


def _survey(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> _Survey:
    facts = _all_facts()
    rows: list[_Row] = []
    plain = True
    instancing_doubt = cache(_instancing_doubt)
    for instance in depsgraph.object_instances:
        if instance.object.type in SHAPED:
            row = _row(scene, facts, instance.object, np.array(instance.matrix_world))
            doubt = instance.is_instance and (instancing_doubt() or instancing_doubt(instance.parent.original))
            rows.append(replace(row, box=EVERYWHERE, body=None, doubt=doubt) if doubt else row)
        plain = plain and not instance.is_instance
    hidden = {obj for each in bpy.data.scenes for obj in each.objects} - {row.obj for row in rows}
    rows += [
        _Row(obj, EVERYWHERE)
        for obj in hidden
        if obj.type in SHAPED
        and not obj.hide_render
        and not any(slot.material in facts for slot in obj.material_slots)
    ]
    known = {row.obj.name: index for index, row in enumerate(rows)} if plain else {}
    doubts = dict(_scene_doubts(scene, facts))
    seen = {row.obj for row in rows}
    doubts.update(
        (obj.name, "is hidden in the viewport alone") for obj in media(scene) if obj not in seen and not obj.hide_render
    )
    return _Survey(scene, rows, facts, tuple(doubts.items()), known, [])


def _updated(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> _Survey | None:
    """The survey after an update, without contacts; None if the update concerns nothing in it."""
    changed = {update.id.original: update for update in depsgraph.updates if isinstance(update.id, _CONCERNED)}
    if not changed:
        return None
    for data, update in changed.items():
        if update.is_updated_geometry or isinstance(data, bpy.types.Mesh):
            _shapes.pop(data.session_uid, None)
    survey = _surveys.get(scene.session_uid)
    if survey is None or not all(_is_known(survey, data) for data in changed):
        return _survey(scene, depsgraph)
    if any(isinstance(data, _SHADING) for data in changed) and survey.facts != _all_facts():
        return _survey(scene, depsgraph)
    rows = list(survey.rows)
    for obj in (data for data in changed if isinstance(data, bpy.types.Object)):
        evaluated = obj.evaluated_get(depsgraph)
        rows[survey.known[obj.name]] = _row(scene, survey.facts, evaluated, np.array(evaluated.matrix_world))
    return _Survey(scene, rows, survey.facts, survey.doubts, survey.known, [])


def _is_known(survey: _Survey, data: bpy.types.ID) -> bool:
    """Whether an update of it concerns the rows of the updated objects alone, if it leaves the facts as they are."""
    if isinstance(data, bpy.types.Object):
        return data.name in survey.known
    if isinstance(data, bpy.types.Material):
        return data in survey.facts
    return isinstance(data, (bpy.types.Mesh, bpy.types.ShaderNodeTree))


SHAPED = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD", "VOLUME"}


def _row(
    scene: bpy.types.Scene,
    facts: dict[bpy.types.Material, _Facts],
    evaluated: bpy.types.Object,
    matrix: np.ndarray,
) -> _Row:
    obj = evaluated.original
    corners = np.array([tuple(corner) for corner in evaluated.bound_box]) @ matrix[:3, :3].T + matrix[:3, 3]
    box = np.array([corners.min(axis=0), corners.max(axis=0)])
    dielectric = {
        slot.material.original for slot in evaluated.material_slots if slot.material and slot.material.original in facts
    }
    try:
        _require_still(obj)
        if not dielectric:
            displaced = any(
                slot.material and slot.material.displacement_method != "BUMP" for slot in obj.material_slots
            )
            return _Row(obj, box if _is_exact(scene, obj) and not displaced else EVERYWHERE)
        exact = _is_exact(scene, obj) and dielectric == {slot.material for slot in obj.material_slots} & facts.keys()
        if len(dielectric) == 1:
            (material,) = dielectric
            exact = exact and facts[material].can_be_told
            body = _body(obj, evaluated, matrix, facts[material], exact)
            if body is not None:
                return _Row(obj, box, True, body)
        return _Row(obj, _grown(box, VAGUE), True)
    except _Doubt as doubt:
        return _Row(obj, EVERYWHERE, bool(dielectric), doubt=str(doubt))


def _grown(box: np.ndarray, margin: float) -> np.ndarray:
    """A (2, 3) box with a margin in diagonals of it."""
    return box + np.linalg.norm(box[1] - box[0]) * margin * np.array([[-1.0], [1.0]])


def _instancing_doubt(instancer: bpy.types.Object | None = None) -> str:
    """Why an object's instances may be elsewhere when the file is rendered, or with None those of all; empty if not."""
    instancers = {instancer}
    if instancer is None:
        if any(collection.hide_render != collection.hide_viewport for collection in bpy.data.collections):
            return "is instanced where a collection is hidden in the viewport alone, or in renders alone"
        instancers = {obj for obj in bpy.data.objects if obj.instance_collection is not None}
    try:
        for obj in instancers:
            _require_still(obj)
            if obj.type != "EMPTY":
                raise _Doubt(f"is instanced by {obj.name!r}, which may do so in another way in a render")
    except _Doubt as doubt:
        return str(doubt)
    return ""


def _body(
    obj: bpy.types.Object, evaluated: bpy.types.Object, matrix: np.ndarray, facts: _Facts, exact: bool
) -> Body | None:
    """The exact medium, or None. Raises :class:`_Doubt` if it may be without bounds."""
    if facts.displaces:
        raise _Doubt("is displaced by its material")
    own = own_priority(obj)
    priority = facts.priority if own is None else own
    if priority is None:
        raise _Doubt("has a priority that may change")
    if evaluated.type != "MESH":
        return None
    owner = obj if obj.modifiers or obj.data.shape_keys else obj.data
    solid = _shapes.get(owner.session_uid)
    if solid is None:
        solid = _shapes[owner.session_uid] = _solid(evaluated)
    if not solid.closed:
        raise _Doubt("is not closed")
    medium = (obj.name_full,) if facts.values is None else facts.values
    return Body(solid, matrix, priority, medium, wants_faces=_wants_faces(obj)) if exact else None


def _solid(evaluated: bpy.types.Object) -> Solid:
    """An evaluated mesh, the same object as long as nothing changes it."""
    try:
        vertices, triangles = triangles_of(evaluated.to_mesh())
    finally:
        evaluated.to_mesh_clear()
    content = hashlib.sha256(vertices)
    content.update(triangles)
    key = content.digest()
    if key not in _solids:
        _solids[key] = Solid(vertices.astype(np.float64), triangles)
    return _solids[key]


def triangles_of(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """A mesh's vertices, (n, 3) float32, and the corners of its triangles, (m, 3) int32."""
    mesh.calc_loop_triangles()
    vertices = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    triangles = np.empty((len(mesh.loop_triangles), 3), dtype=np.int32)
    if len(vertices):  # without them it has no attribute
        mesh.attributes["position"].data.foreach_get("vector", vertices.reshape(-1))
    if 0 < len(triangles) == len(mesh.polygons):  # all are triangles, and the attribute is read fifty times as fast
        mesh.attributes[".corner_vert"].data.foreach_get("value", triangles.reshape(-1))
    else:
        mesh.loop_triangles.foreach_get("vertices", triangles.reshape(-1))
    return vertices, triangles


def _forget_unused(survey: _Survey) -> None:
    kept = {id(row.body.solid) for each in (survey, survey.settled) if each for row in each.bodies}
    for shapes in (_shapes, _solids):
        for key in [key for key, solid in shapes.items() if id(solid) not in kept]:
            del shapes[key]


def _all_facts() -> dict[bpy.types.Material, _Facts]:
    return {material: _facts(material) for material in bpy.data.materials if dielectric_node(material) is not None}


def _facts(material: bpy.types.Material) -> _Facts:
    tree = material.node_tree
    node = dielectric_node(material)
    still = tree.animation_data is None and material.animation_data is None
    values = None
    if (
        still
        and not node.inputs["Disperse"].default_value
        and not any(node.inputs[n].is_linked for n in NEIGHBOUR_VALUES)
    ):
        ior, transmittance, depth = (node.inputs[name].default_value for name in NEIGHBOUR_VALUES)
        values = (ior, tuple(transmittance), depth)
    priority = node.inputs["Priority"]
    output = tree.get_output_node("CYCLES")
    linked = any(node.inputs[name].is_linked for name in ABSORPTION_VALUES)
    return _Facts(
        values,
        priority.default_value if still and not priority.is_linked else None,
        output is not None and output.inputs["Displacement"].is_linked and material.displacement_method != "BUMP",
        has_analysis(node),
        absorption_coefficients(node) if still and not linked else None,
        output is not None
        and not linked
        and _adds_to(node.outputs[VOLUME_OUTPUT], output.inputs["Volume"]),
        has_own_volume(material),
    )


def _adds_to(source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> bool:
    """Whether the whole of a shader goes into a socket."""
    return any(
        link.to_socket == target
        or (
            link.to_node.bl_idname in ("ShaderNodeAddShader", "NodeReroute")
            and not link.to_node.mute
            and _adds_to(link.to_node.outputs[0], target)
        )
        for link in source.links
        if not link.is_muted
    )


# Doubting -----------------------------------------------------------------------------------------------------------


def _scene_doubts(scene: bpy.types.Scene, facts: dict[bpy.types.Material, _Facts]) -> Iterator[tuple[str, str]]:
    """What makes a render see other objects than the viewport does."""

    def shown(objects: Iterable[bpy.types.Object]) -> set[bpy.types.Object]:
        return {obj for obj in objects if any(slot.material in facts for slot in obj.material_slots)}

    for collection in scene.collection.children_recursive:
        if collection.hide_viewport != collection.hide_render and shown(collection.all_objects):
            yield collection.name, "is hidden in the viewport alone, or in renders alone"
    first, *others = scene.view_layers
    for layer in others:
        if shown(first.objects) != shown(layer.objects):
            yield layer.name, f"shows other media than {first.name!r}"


def _require_still(obj: bpy.types.Object) -> None:
    """Raise :class:`_Doubt` if an object may be elsewhere, or without bounds, when the file is rendered."""
    if obj.mode == "EDIT":
        raise _Doubt("is being edited")
    if obj.hide_render != obj.hide_viewport:
        raise _Doubt("is hidden in the viewport alone, or in renders alone")
    if _moves(obj):
        raise _Doubt("may move")
    if _is_animated(obj.data) or _is_animated(getattr(obj.data, "shape_keys", None)):
        raise _Doubt("may change its shape")
    for modifier in obj.modifiers:
        if modifier.show_render and not modifier.show_viewport:
            raise _Doubt(f"has the modifier {modifier.name!r} in renders alone")
        if modifier.show_render and not _is_settled(modifier):
            raise _Doubt(f"has the modifier {modifier.name!r}, which may move it")


def _moves(obj: bpy.types.Object) -> bool:
    """Whether anything but the object's own numbers, or those of its parents, may place it."""
    while obj is not None:
        if (
            _is_animated(obj)
            or (obj.parent is not None and _is_animated(obj.parent.data))
            or obj.constraints
            or obj.rigid_body is not None
            or (obj.parent is not None and obj.parent_type != "OBJECT")
            or obj.instance_type not in ("NONE", "COLLECTION")
            or obj.particle_systems
        ):
            return True
        obj = obj.parent
    return False


def _is_animated(data: bpy.types.ID | None) -> bool:
    return data is not None and data.animation_data is not None


def _is_settled(modifier: bpy.types.Modifier) -> bool:
    """Whether it depends on the mesh and on numbers alone."""
    if is_offset(modifier):
        return True
    return modifier.type in SETTLED_MODIFIERS and not any(
        prop.type == "POINTER" and isinstance(getattr(modifier, prop.identifier), bpy.types.ID)
        for prop in modifier.bl_rna.properties
    )


def is_offset(modifier: bpy.types.Modifier) -> bool:
    """Whether it is the modifier that parts faces in the same place, which keeps all faces."""
    return modifier.type == "NODES" and modifier.node_group is not None and modifier.node_group.name == OFFSET_GROUP


def _is_exact(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Whether a render shows the very mesh that the viewport does, to all rays."""
    return (
        not scene.render.use_simplify
        and is_seen_by_all(obj)
        and all(map(_is_same_in_renders, obj.modifiers))
    )


def _is_same_in_renders(modifier: bpy.types.Modifier) -> bool:
    if modifier.show_viewport != modifier.show_render:
        return False
    if modifier.type == "SUBSURF":
        return modifier.levels == modifier.render_levels and not modifier.use_adaptive_subdivision
    return modifier.type != "SCREW" or modifier.steps == modifier.render_steps


def _wants_faces(obj: bpy.types.Object) -> bool:
    """Whether the faces of the mesh are those of the render, and may be written."""
    return (
        obj.mode == "OBJECT"
        and obj.data.shape_keys is None
        and all(modifier.type == "NODES" for modifier in obj.modifiers)
    )


# Telling ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Told:
    """What an object is told; int8 codes of its faces if they differ."""

    outside: Outside
    faces: np.ndarray | None = None

    @property
    def codes(self) -> np.ndarray:
        """Of the faces, or one for all."""
        if self.outside.code != FACES:
            return np.array([self.outside.code])
        return np.array([PROBE]) if self.faces is None else self.faces

    def is_true(self, truth: _Told) -> bool:
        """Whether the truth tells all that this does."""
        outside, codes = self.outside, self.codes
        asks = ((codes == PROBE) | (codes >= LEVELS)).any()
        return bool(
            _are_true(codes, truth.codes)
            and (
                not (codes == MEDIUM).any()
                or (outside.medium, outside.transmittance) == (truth.outside.medium, truth.outside.transmittance)
            )
            and (outside.overlaps_itself or not truth.outside.overlaps_itself)
            and (not asks or outside.foreign or not truth.outside.foreign)
            and (outside.by_volume, outside.gives_back) == (truth.outside.by_volume, truth.outside.gives_back)
            and (not asks or outside.level in (-1.0, truth.outside.level))
        )


def _outsides(survey: _Survey) -> dict[bpy.types.Object, _Told]:
    """What each medium is told: what holds for all of its instances."""
    doubtful = bool(survey.doubts) or any(row.doubt for row in survey.rows if row.medium)
    boxes = np.array([row.box for row in survey.bodies]).reshape(-1, 2, 3)
    foreign = _meets(boxes, [row.box for row in survey.rows if not row.medium])
    foreign |= np.array([bool(_labels(survey, row.obj)) for row in survey.bodies], dtype=bool)
    # Bodies of one priority that overlap are one: a ray may go from one to the next.
    priorities = np.array([row.body.priority for row in survey.bodies])
    foreign = np.isin(priorities, priorities[foreign])
    unclear = [row.box for row in survey.vague] + [_grown(row.box, NEAR) for row in survey.changed]
    near_unclear = _meets(boxes, unclear)
    changed = {row.body.priority for row in survey.changed if row.body is not None}
    asking = {
        index
        for index, contact in enumerate(survey.contacts)
        if doubtful or near_unclear[index] or _speaks_of(survey, contact, changed)
    }
    volumes, givers = _left_to_volumes(survey, boxes, asking)
    told: dict[bpy.types.Object, list[_Told]] = {}
    for index, (row, contact) in enumerate(zip(survey.bodies, survey.contacts)):
        if index in asking:
            one = _Told(Outside(overlaps_itself=contact.robust or row in survey.changed))
        else:
            one = _told(survey, row, contact, bool(foreign[[index, *contact.partners]].any()), volumes)
        told.setdefault(row.obj, []).append(one)
    for row in survey.rows:
        if row.medium and (row.body is None or row.obj in survey.elsewhere):
            told[row.obj] = [_Told(Outside())]
    merged = _merged(told)
    for obj in merged if volumes else ():
        material = _medium_of(survey, obj)
        flags = {"by_volume": material in volumes, "gives_back": material in givers}
        merged[obj] = replace(merged[obj], outside=replace(merged[obj].outside, **flags))
    return merged


def _medium_of(survey: _Survey, obj: bpy.types.Object) -> bpy.types.Material | None:
    """The nested dielectric of an object that has no other."""
    found = {slot.material for slot in obj.material_slots} & survey.facts.keys()
    return found.pop() if len(found) == 1 else None


def _left_to_volumes(survey: _Survey, boxes: np.ndarray, asking: set[int]) -> tuple[set, set]:
    """Materials whose volumes absorb for all rays, and those that give back what volumes take where they win. `asking`:
    bodies that are told nothing.
    """
    materials = [_medium_of(survey, row.obj) for row in survey.bodies]
    if not any(survey.facts[material].coefficients != NOTHING_ABSORBED for material in materials):
        return set(), set()
    unclear = {_medium_of(survey, obj) for obj in survey.elsewhere}
    unclear |= {_medium_of(survey, row.obj) for row in survey.rows if row.medium and row.body is None}
    unclear |= {material for material in survey.facts if not survey.facts[material].can_be_told}
    wanted = _meets(boxes, _beyond_surfaces(survey))
    fillings = []
    for index, (row, material, contact) in enumerate(zip(survey.bodies, materials, survey.contacts)):
        facts = survey.facts[material]
        certain = index not in asking and material not in unclear
        said = _outside_in(material) if material.library and certain else None
        fillings.append(
            Filling(
                material,
                row.body.priority,
                row.body.solid.mean_chord * abs(np.linalg.det(row.body.matrix[:3, :3])) ** (1 / 3),
                facts.coefficients,
                certain and (said is None or said.gives_back),
                certain
                and not contact.robust
                and facts.has_volume
                and row.obj.material_slots[0].material == material
                and not any(map(is_clear, _labels(survey, row.obj)))
                and (said is None or said.by_volume),
                bool(wanted[index]) or facts.has_own_volume,
            )
        )
    pairs = {tuple(sorted((index, other))) for index, each in enumerate(survey.contacts) for other in each.partners}
    return left_to_volumes(fillings, pairs)


def _labels(survey: _Survey, obj: bpy.types.Object) -> list[bpy.types.Material | None]:
    """Materials of a medium that are none."""
    return [slot.material for slot in obj.material_slots if slot.material not in survey.facts]


def _beyond_surfaces(survey: _Survey) -> list[np.ndarray]:
    """Boxes of what lets rays on or scatters them inside a medium, and of lamps, none of which a medium's surface knows."""
    sends_on = cache(sends_light_on)
    boxes = [row.box for row in survey.rows if not row.medium and sends_on(row.obj)]
    boxes += [EVERYWHERE if _moves(lamp) else lamp_box(lamp) for lamp in lamps(survey.scene)]
    instanced = {obj.instance_collection for obj in survey.scene.objects if obj.instance_collection is not None}
    return boxes + [EVERYWHERE for each in instanced if any(obj.type == "LIGHT" for obj in each.all_objects)]


def _are_true(codes: np.ndarray | None, truth: np.ndarray) -> bool:
    """Whether codes tell no more than the true ones."""
    return codes is None or bool(((codes == PROBE) | (codes == truth)).all())


def _speaks_of(survey: _Survey, contact: Contact, priorities: set[int]) -> bool:
    """Whether a contact says anything of the bodies of some priorities."""
    return (
        contact.level in priorities
        or (contact.around is not None and survey.bodies[contact.around].body.priority in priorities)
        or not priorities.isdisjoint(contact.face_levels)
    )


def _merged(told: dict[bpy.types.Object, list[_Told]]) -> dict[bpy.types.Object, _Told]:
    """What holds for all instances of an object, and of the faces of a mesh for all of its users."""
    faces: dict[bpy.types.Mesh, np.ndarray] = {}
    users: dict[bpy.types.Mesh, int] = {}
    for obj, rows in told.items():
        users[obj.data] = users.get(obj.data, 0) + 1
        for codes in (row.faces for row in rows if row.faces is not None):
            before = faces.get(obj.data, codes)
            faces[obj.data] = np.where(before == codes, codes, PROBE)
    busy = _busy(told)
    faces = {
        mesh: _by_polygon(mesh, codes)
        for mesh, codes in faces.items()
        if users[mesh] == mesh.users - mesh.use_fake_user and codes.any() and mesh not in busy
    }
    faces = {mesh: codes for mesh, codes in faces.items() if mesh.library is None or _are_true(_faces_of(mesh), codes)}
    result = {}
    for obj, rows in told.items():
        outside = _common(row.outside for row in rows)
        if outside is None or (outside.code == FACES and obj.data not in faces):
            outside = Outside(overlaps_itself=any(row.outside.overlaps_itself for row in rows))
        result[obj] = _Told(outside, faces.get(obj.data))
    return result


def _busy(objects: Iterable[bpy.types.Object]) -> set[bpy.types.ID]:
    """Meshes that belong to the tool of another mode than Object Mode."""
    return {obj.data for obj in objects if obj.mode != "OBJECT"}


def _meets(boxes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """(n,) whether each of the (n, 2, 3) boxes meets any of the others."""
    meets = np.zeros(len(boxes), dtype=bool)
    for low, high in others:
        meets |= np.all((boxes[:, 0] <= high) & (boxes[:, 1] >= low), axis=1)
    return meets


def _told(survey: _Survey, row: _Row, contact: Contact, foreign: bool, volumes: set) -> _Told:
    level = -1.0 if contact.level is None or contact.robust or survey.vague else float(contact.level)
    outside = Outside(contact.code, level, contact.robust, foreign)
    faces = contact.faces
    if faces is not None and survey.vague:
        faces = np.where(faces >= LEVELS, PROBE, faces)
    if contact.around is not None:
        around = survey.bodies[contact.around].body
        if len(around.medium) == 1 or around.priority in survey.mixed:
            faces = None if faces is None else np.where(faces == MEDIUM, PROBE, faces)
            outside = replace(outside, code=PROBE if contact.code == MEDIUM else contact.code)
        else:
            ior, transmittance, depth = around.medium
            if _medium_of(survey, survey.bodies[contact.around].obj) in volumes:
                transmittance = CLEAR
            outside = replace(outside, medium=(float(around.priority), ior, depth), transmittance=transmittance)
    return _Told(outside, faces)


def _by_polygon(mesh: bpy.types.Mesh, triangles: np.ndarray) -> np.ndarray:
    """Codes of polygons whose triangles agree, or ask with one level where they are not in air; the others' are unknown."""
    if len(triangles) == len(mesh.polygons):
        return triangles
    polygons = np.empty(len(triangles), dtype=np.int32)
    mesh.calc_loop_triangles()
    mesh.loop_triangle_polygons.foreach_get("value", polygons)
    low = np.full(len(mesh.polygons), 127, dtype=np.int8)
    high = np.zeros(len(low), dtype=np.int8)
    np.minimum.at(low, polygons, triangles)
    np.maximum.at(high, polygons, triangles)
    mixed = np.zeros(len(low), dtype=bool)
    mixed[polygons[(triangles != AIR) & (triangles != high[polygons])]] = True
    return np.where((low == high) | ((high >= LEVELS) & ~mixed), high, PROBE).astype(np.int8)


def _tell(survey: _Survey, told: dict[bpy.types.Object, _Told]) -> None:
    """Write what changed. A material speaks for its objects if all of them are told the same."""
    users: dict[bpy.types.Material, list[bpy.types.Object]] = {}
    for obj in told:
        for material in {slot.material for slot in obj.material_slots} & survey.facts.keys():
            users.setdefault(material, []).append(obj)
    slots = _most_slots()
    for material in survey.facts.keys() - users.keys():
        _tell_material(material, Outside(), slots.get(material))
    others = {slot.material for obj in survey.elsewhere - told.keys() for slot in obj.material_slots}
    for material, objects in users.items():
        if not survey.facts[material].can_be_told:
            continue
        common = None if material.library else _common(told[obj].outside for obj in objects)
        if material in others and common is not None:
            common = Outside(overlaps_itself=common.overlaps_itself) if common.code == PROBE else None
        # What concerns volumes is the same for all objects: a volume that read it of each would be noisy.
        first = told[objects[0]].outside
        by_object = Outside(BY_OBJECT, by_volume=first.by_volume, gives_back=first.gives_back)
        _tell_material(material, common or by_object, slots.get(material))
        for obj in objects:
            _tell_object(obj, None if common else told[obj].outside)
    if survey.settled:
        return  # what asks needs no faces, and the faces of the others are as they were
    busy = _busy(told)
    for mesh, faces in {obj.data: one.faces for obj, one in told.items()}.items():
        if isinstance(mesh, bpy.types.Mesh) and mesh not in busy:
            _tell_faces(mesh, faces)


def _common(outsides: Iterable[Outside]) -> Outside | None:
    """What all may be told at once, or None if that is less than some are told."""
    first, *others = outsides
    for other in others:
        first = first and first.merged(other)
    return first


def _most_slots() -> dict[bpy.types.Material, int]:
    """Of all objects of each material; many where modifiers may make more."""
    most: dict[bpy.types.Material, int] = {}
    for obj in bpy.data.objects:
        count = len(obj.material_slots)
        if any(modifier.type == "NODES" and not is_offset(modifier) for modifier in obj.modifiers):
            count = MATERIAL_SLOTS
        for slot in obj.material_slots:
            most[slot.material] = max(most.get(slot.material, 0), count)
    return most


def _tell_material(material: bpy.types.Material, outside: Outside, slots: int | None = None) -> None:
    node = dielectric_node(material)
    if material.library is not None or not has_analysis(node):
        return
    values = {
        OUTSIDE_SOCKET: outside.code,
        LEVEL_SOCKET: outside.level,
        OVERLAP_SOCKET: outside.overlaps_itself,
        FOREIGN_SOCKET: outside.foreign,
        BY_VOLUME_SOCKET: outside.by_volume,
        GIVES_BACK_SOCKET: outside.gives_back,
        SURROUNDINGS_SOCKET: outside.medium,
        SURROUNDINGS_COLOR_SOCKET: outside.transmittance,
        SLOTS_SOCKET: 1 if slots == 1 else MATERIAL_SLOTS,
    }
    for name, value in values.items():
        socket = node.inputs[name]
        before = socket.default_value
        if not np.array_equal(np.float32(before if np.isscalar(before) else tuple(before)), np.float32(value)):
            socket.default_value = value


def _tell_object(obj: bpy.types.Object, outside: Outside | None) -> None:
    """Write an object's custom properties, or with None remove them."""
    if obj.library is not None:
        return
    values: tuple = (None, None)
    if outside is not None:
        values = ((_facts_in_one(outside), *outside.medium), outside.transmittance if outside.absorbs else None)
    for name, value in zip(OBJECT_PROPERTIES, values):
        before = obj.get(name)
        if value is None:
            if before is not None:
                del obj[name]
                obj.update_tag()
        elif before is None or tuple(before) != value:
            obj[name] = value
            obj.update_tag()


def _facts_in_one(outside: Outside) -> float:
    """The number of which osl/outside.h reads the digits; 0 tells nothing."""
    level = int(outside.level) + 1 if outside.level <= HIGHEST_OBJECT_LEVEL else 0
    return float(
        outside.code + 8 * outside.overlaps_itself + 16 * (not outside.foreign) + 32 * outside.absorbs + 64 * level
    )


def _outside_in(material: bpy.types.Material) -> Outside:
    """What a material tells its objects."""
    inputs = dielectric_node(material).inputs
    return Outside(
        inputs[OUTSIDE_SOCKET].default_value,
        inputs[LEVEL_SOCKET].default_value,
        inputs[OVERLAP_SOCKET].default_value,
        inputs[FOREIGN_SOCKET].default_value,
        tuple(inputs[SURROUNDINGS_SOCKET].default_value),
        tuple(inputs[SURROUNDINGS_COLOR_SOCKET].default_value),
        inputs[BY_VOLUME_SOCKET].default_value,
        inputs[GIVES_BACK_SOCKET].default_value,
    )


def _outside_of(obj: bpy.types.Object) -> Outside:
    """What an object's custom properties tell, the other way round than :func:`_facts_in_one`."""
    medium, transmittance = (obj.get(name) for name in OBJECT_PROPERTIES)
    if medium is None:
        return Outside()
    facts = int(medium[0])
    return Outside(
        facts & 7,
        (facts >> 6) - 1.0,
        bool(facts & 8),
        not facts & 16,
        tuple(medium[1:]),
        tuple(transmittance) if facts & 32 and transmittance is not None else CLEAR,
    )


def _faces_of(mesh: bpy.types.Mesh) -> np.ndarray | None:
    """What a mesh tells its faces."""
    attribute = mesh.attributes.get(FACE_ATTRIBUTE)
    if attribute is None:
        return None
    faces = np.empty(len(mesh.polygons), dtype=np.int8)
    attribute.data.foreach_get("value", faces)
    return faces


def _heard(obj: bpy.types.Object, material: bpy.types.Material) -> _Told:
    """What the shader reads of an object's outside."""
    outside = _outside_in(material)
    faces = _faces_of(obj.data) if isinstance(obj.data, bpy.types.Mesh) else None
    if outside.code == BY_OBJECT:
        outside = replace(_outside_of(obj), by_volume=outside.by_volume, gives_back=outside.gives_back)
    return _Told(outside, faces)


def _tell_faces(mesh: bpy.types.Mesh, faces: np.ndarray | None) -> None:
    """Write the attribute of a mesh's faces, or with None remove it."""
    if mesh.library is not None:
        return
    before = _faces_of(mesh)
    if faces is None:
        if before is not None:
            mesh.attributes.remove(mesh.attributes[FACE_ATTRIBUTE])
            mesh.update_tag()
        return
    if before is None:
        mesh.attributes.new(FACE_ATTRIBUTE, "INT8", "FACE")
    if before is None or not np.array_equal(before, faces):
        mesh.attributes[FACE_ATTRIBUTE].data.foreach_set("value", faces)
        mesh.update_tag()


def _found(survey: _Survey, told: dict[bpy.types.Object, _Told]) -> Found:
    def names(*codes: int) -> tuple[str, ...]:
        return tuple(obj.name for obj, one in told.items() if one.outside.code in codes)

    pairs = {
        tuple(sorted((row.obj.name, survey.bodies[other].obj.name)))
        for row, contact in zip(survey.bodies, survey.contacts)
        for other, *_ in contact.coincident
    }
    doubts = survey.doubts + tuple((row.obj.name, row.doubt) for row in survey.rows if row.medium and row.doubt)
    return Found(
        known=names(AIR, MEDIUM, NEVER),
        partly=names(FACES),
        asking=names(PROBE),
        overlapping=tuple(obj.name for obj, one in told.items() if one.outside.overlaps_itself),
        coincident=tuple(sorted(pairs)),
        stale=tuple(obj.name for obj, one in told.items() if _is_stale(survey, obj, one)),
        doubts=tuple(dict(doubts).items()),
    )


def _is_stale(survey: _Survey, obj: bpy.types.Object, told: _Told) -> bool:
    """Whether linked data, which an analysis cannot change, tell an object more than is true."""
    materials = {slot.material for slot in obj.material_slots} & survey.facts.keys()
    return any(
        (material.library or obj.library or obj.data.library)
        and survey.facts[material].can_be_told
        and not _heard(obj, material).is_true(told)
        for material in materials
    )
