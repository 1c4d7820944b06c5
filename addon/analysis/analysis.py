"""Telling media what surrounds them, so that they need not ask the scene while it is rendered.

:func:`analyse` looks at a scene's media as they are evaluated now and writes what holds whenever the file is rendered: into
the sockets of a material where it holds for all of its objects, else into their custom properties. The shader needs nothing
else of the extension. What holds for part of a surface alone is told to nobody: media that cross ask. Whatever may be different
in a render (things that move, modifiers that depend on more than their mesh, what is hidden in the viewport alone) leaves all
media asking the scene, as they do without an analysis; and the shader checks a share of what it is told (osl/outside.h).

What is told holds in the scene that was looked at, on the frame it showed then, and on all frames while somebody sees to it
that no script changes the scene (:mod:`nested_dielectric.live`): elsewhere the materials themselves fall back to asking.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import cache, cached_property

import bpy
import numpy as np

from ..geometry import contacts, meshes
from ..geometry.contacts import PROBE, Body, Contact, Memory, Solid
from ..model.parameters import BY_NAME
from ..nodes.identity import NO_SCENE, known_number, scene_number
from ..nodes.lookups import unchanged_nodes
from ..nodes.native_nodes import CENTRE, LARGEST_EXPONENT
from ..nodes.node_group import (
    AIR_AROUND,
    ANALYSED,
    BY_OBJECT,
    BY_VOLUME_SOCKET,
    CLEAR,
    FOREIGN_SOCKET,
    GIVES_BACK_SOCKET,
    LEVEL_SOCKET,
    MATERIAL_SLOTS,
    NATIVE_SOCKET,
    NEIGHBOUR_VALUES,
    OBJECT_PROPERTIES,
    OUTSIDE_SOCKET,
    OVERLAP_SOCKET,
    SCENE_SOCKET,
    SLOTS_SOCKET,
    SURROUNDINGS_COLOR_SOCKET,
    SURROUNDINGS_SOCKET,
    TOLD_SCENE,
    VOLUME_OUTPUT,
    follow_frames,
    has_analysis,
    is_offset_group,
)
from ..nodes.trees import is_plugged
from ..scene.foreign import is_clear, lamp_box, sends_light_on
from ..scene.lights import lamps
from ..scene.materials import absorption_coefficients, dielectric_node, has_own_volume
from ..scene.media import CUT_SETTING, SOLID_TYPES, is_cut_surface, is_rendered, material_priority, media, own_priority
from ..scene.rays import is_seen_by_all
from ..scene.shapes import mesh_of
from .charging import Filling, left_to_volumes

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

SHADING_NODES = frozenset(
    (
        "FunctionNodeBooleanMath",
        "FunctionNodeCompare",
        "GeometryNodeInputEdgeSmooth",
        "GeometryNodeInputMeshEdgeAngle",
        "GeometryNodeInputShadeSmooth",
        "GeometryNodeSetShadeSmooth",
        "NodeGroupInput",
        "NodeGroupOutput",
        "NodeReroute",
        "ShaderNodeMath",
    )
)
"""Geometry Nodes that leave all points and faces where they are: those of *Smooth by Angle*, which *Shade Auto Smooth* adds."""

PASSING_NODES = frozenset(("GeometryNodeSetShadeSmooth", "NodeGroupOutput"))
"""Those of them that a mesh goes through."""

ABSORPTION_VALUES = ("Transmittance", "Transmittance Depth")
NOTHING_ABSORBED = (0.0, 0.0, 0.0)

EVERYWHERE = np.array([(-np.inf,) * 3, (np.inf,) * 3])
VAGUE = 0.5
"""Margin around what a render may show with another shape, in diagonals of its box: a subdivided surface stays within
the hull of any coarser one.
"""

VELOCITY = "velocity"
"""Attribute of points by which Cycles moves them while the shutter is open."""

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

    :param known: media that need not ask the scene.
    :param asking: media that ask it.
    :param overlapping: media that overlap themselves.
    :param coincident: pairs of media with faces in the same place.
    :param doubts: why nothing is told to any medium, by name; empty where it is.
    """

    known: tuple[str, ...] = ()
    asking: tuple[str, ...] = ()
    overlapping: tuple[str, ...] = ()
    coincident: tuple[tuple[str, str], ...] = ()
    doubts: tuple[tuple[str, str], ...] = ()

    def without(self, cut: Iterable[str]) -> Found:
        """Return what concerns renders of media of which some are cut, by name: their surfaces ask nothing."""
        cut = set(cut)
        asking = tuple(name for name in self.asking if name not in cut)
        return replace(self, asking=asking, doubts=self.doubts if asking else ())

    def __str__(self) -> str:
        lines = [f"{name!r} {reason}, so all media ask the scene what surrounds them" for name, reason in self.doubts]
        lines += [
            f"{what}: {listed(names)}"
            for names, what in (
                (self.known, "know what surrounds them"),
                (() if self.doubts else self.asking, "ask the scene what surrounds them"),
                (self.overlapping, "overlap themselves, which takes longer"),
            )
            if names
        ]
        return "\n".join(lines)


def listed(names: tuple[str, ...], most: int = 4) -> str:
    """Return names for a sentence: the first few, and how many more there are."""
    shown = ", ".join(map(repr, names[:most]))
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def is_analysed(scene: bpy.types.Scene) -> bool:
    """Whether the media of a scene are kept analysed."""
    return ANALYSED in scene


def clear_analysis(scene: bpy.types.Scene) -> None:
    """Make all media of a scene ask it again while it is rendered, and leave no trace of the analysis on them.

    What another analysed scene shares with it asks there too until that one is analysed again.
    """
    scene.pop(ANALYSED, None)
    for name in (CENTRE, TOLD_SCENE):
        scene.pop(name, None)
    _of(scene).survey = None
    number = known_number(scene)
    for material in bpy.data.materials:
        if _is_told_of(material, number):
            _tell_material(material, Outside(), NO_SCENE)
            _let_ask(material)
    told = {material for material in bpy.data.materials if _is_told_of(material)}
    for obj in bpy.data.objects:
        if not any(slot.material in told for slot in obj.material_slots):
            _tell_object(obj, None)


def analyse(scene: bpy.types.Scene) -> Found:
    """Look at the media of a scene, and tell each what surrounds it. The scene's media are kept analysed from then on.

    Linked materials and objects are left as they are.
    """
    layer = scene.view_layers[0]
    layer.update()
    _shapes.clear()
    return _look(_survey(scene, layer.depsgraph))


def trust(scene: bpy.types.Scene, every_frame: bool) -> None:
    """Let what the media of an analysed scene are told hold on every frame, or on one alone: the present one, if it held on
    every frame before.
    """
    validity = _validity(scene)
    frame = _frame(scene) if validity.every_frame else validity.frame
    _set_validity(scene, _Validity(validity.holds, frame, float(every_frame)))
    analysed = [each for each in bpy.data.scenes if is_analysed(each) and each.library is None]
    follow_frames(not all(_validity(each).every_frame for each in analysed))


def tell_natives(scene: bpy.types.Scene, tell: bool) -> None:
    """Let Cycles' own nodes believe what the media of an analysed scene are told, on every frame, or show the alarm."""
    number = scene_number(scene) if tell else None
    if scene.get(TOLD_SCENE) != number:
        if tell:
            scene[TOLD_SCENE] = number
        else:
            del scene[TOLD_SCENE]
        scene.update_tag()


def distrust(scene: bpy.types.Scene) -> None:
    """Let the media of an analysed scene ask until it is analysed again."""
    _set_validity(scene, replace(_validity(scene), holds=0.0))
    _of(scene).survey = None


def is_distrusted(scene: bpy.types.Scene) -> bool:
    """Whether an analysed scene has to be looked at again."""
    return _of(scene).survey is None


@dataclass(frozen=True)
class _Validity:
    """Where what the media of a scene are told holds; materials read these numbers of the scene (`_analysis_holds` in
    addon/node_group.py).
    """

    holds: float = 0.0
    frame: float = 0.0
    every_frame: float = 0.0


def _validity(scene: bpy.types.Scene) -> _Validity:
    value = scene.get(ANALYSED)
    try:
        return _Validity(*map(float, value))
    except (TypeError, ValueError):  # an older file's, or somebody else's
        return _Validity()


def _set_validity(scene: bpy.types.Scene, validity: _Validity) -> None:
    numbers = astuple(validity)
    before = scene.get(ANALYSED)
    if not hasattr(before, "__len__") or tuple(before) != numbers:
        scene[ANALYSED] = numbers
        scene.update_tag()


def _frame(scene: bpy.types.Scene) -> float:
    return float(scene.frame_current)


def follow(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Analyse again after an update of a scene whose media are kept analysed, as far as the update reaches."""
    changed = _changed(depsgraph)
    if changed:
        _look(_updated(scene, depsgraph, changed))


def follow_or_distrust(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Let all media ask after an update that changes any of them, which takes little time, and return whether they do. What
    else an update changes is followed at once.
    """
    changed = _changed(depsgraph)
    if not changed:
        return False
    latest = _of(scene).survey
    if latest is not None:
        survey = _updated(scene, depsgraph, changed)
        # What was told comes back as an update that changes no medium.
        if survey.has_same_media(latest):
            _look(survey)
            return False
    distrust(scene)
    return True


def forget_shapes() -> None:
    """Look at all meshes anew the next time: after another file, or another state of this one, has been loaded."""
    _shapes.clear()
    for known in _scenes.values():
        known.survey = None


def looked_at(scene: bpy.types.Scene) -> tuple[list[tuple[bpy.types.Object, Body]], list[Contact]]:
    """Return the media of a scene whose exact shape is known, and what the last analysis in this session found of each."""
    survey = _of(scene).survey
    if survey is None:
        return [], []
    return [(row.obj, row.body) for row in survey.bodies], survey.contacts


def last_found(scene: bpy.types.Scene) -> Found | None:
    """What the last analysis of a scene found in this session."""
    return _of(scene).found if is_analysed(scene) else None


_CONCERNED = (
    bpy.types.Object,
    bpy.types.Mesh,
    bpy.types.Material,
    bpy.types.ShaderNodeTree,
    bpy.types.GeometryNodeTree,
    bpy.types.Collection,
)
_SHADING = (bpy.types.Material, bpy.types.ShaderNodeTree)


@unchanged_nodes()
def _look(survey: _Survey) -> Found:
    """Find the contacts of a survey, and tell the media."""
    known = _of(survey.scene)
    survey = replace(survey, contacts=contacts.analyse([row.body for row in survey.bodies], known.memory))
    told = _outsides(survey)
    _tell(survey, told)
    _tell_centre(survey)
    known.survey, known.found = survey, _found(survey, told)
    tell_natives(survey.scene, True)
    _forget_unused()
    _set_validity(survey.scene, _Validity(1.0, _frame(survey.scene), _validity(survey.scene).every_frame))
    return known.found


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

    def is_same(self, other: _Row) -> bool:
        """Whether the same follows from the other."""
        return self is other or (
            (self.obj, self.doubt, self.body is None) == (other.obj, other.doubt, other.body is None)
            and np.array_equal(self.box, other.box)
            and (self.body is None or self.body.is_same(other.body))
        )


@dataclass(frozen=True, eq=False)
class _Survey:
    """Every instance in a scene, and what the bodies among them know.

    :param rows: in the order of the depsgraph.
    :param facts: of the materials.
    :param doubts: names and reasons.
    :param known: rows that may be made anew one by one, by the session's number of their objects; empty where objects are
        instanced.
    """

    scene: bpy.types.Scene
    rows: list[_Row]
    facts: dict[bpy.types.Material, _Facts]
    doubts: tuple[tuple[str, str], ...]
    known: dict[int, int]
    contacts: list[Contact]

    def has_same_media(self, other: _Survey) -> bool:
        """Whether the media of another survey have the same places, shapes and values."""
        first, second = ([row for row in survey.rows if row.medium] for survey in (self, other))
        return (self.doubts, len(first)) == (other.doubts, len(second)) and all(map(_Row.is_same, first, second))

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


@dataclass
class _Known:
    """What this session knows of a scene.

    :ivar survey: as it was looked at last; None if it has to be looked at anew.
    """

    survey: _Survey | None = None
    found: Found | None = None
    memory: Memory = field(default_factory=Memory)


_scenes: dict[int, _Known] = {}
"""By the session's number of the scene."""


def _of(scene: bpy.types.Scene) -> _Known:
    return _scenes.setdefault(scene.session_uid, _Known())


@unchanged_nodes()
def _survey(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> _Survey:
    facts = _all_facts()
    rows: list[_Row] = []
    plain = True
    instancing_doubt = cache(_instancing_doubt)
    for instance in depsgraph.object_instances:
        if instance.object.type != instance.object.original.type:
            continue  # the mesh of a text, a curve or a metaball, which stands before it
        if is_cut_surface(instance.object):
            continue  # what it shows is looked at where it is cut from
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
        and is_rendered(obj)
        and not is_cut_surface(obj)
        and not any(slot.material in facts for slot in obj.material_slots)
    ]
    known = {row.obj.session_uid: index for index, row in enumerate(rows)} if plain else {}
    doubts = dict(_scene_doubts(scene, facts))
    seen = {row.obj for row in rows}
    doubts.update(
        (obj.name, "is hidden in the viewport alone") for obj in media(scene) if obj not in seen and is_rendered(obj)
    )
    return _Survey(scene, rows, facts, tuple(doubts.items()), known, [])


def _changed(depsgraph: bpy.types.Depsgraph) -> set[bpy.types.ID]:
    """What has changed, as far as media may be concerned; meshes and objects of another shape are forgotten."""
    changed = {
        update.id.original: update
        for update in depsgraph.updates
        if isinstance(update.id, _CONCERNED)
        and not (isinstance(update.id, bpy.types.Object) and is_cut_surface(update.id))
    }
    for data, update in changed.items():
        if update.is_updated_geometry or isinstance(data, bpy.types.Mesh):
            _shapes.pop(data.session_uid, None)
    return set(changed)


def _updated(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, changed: set[bpy.types.ID]) -> _Survey:
    """The survey after an update, without contacts."""
    survey = _of(scene).survey
    if survey is None or not all(_is_known(survey, data) for data in changed):
        return _survey(scene, depsgraph)
    if any(isinstance(data, _SHADING) for data in changed) and survey.facts != _all_facts():
        return _survey(scene, depsgraph)
    rows = list(survey.rows)
    for obj in (data for data in changed if isinstance(data, bpy.types.Object)):
        evaluated = obj.evaluated_get(depsgraph)
        rows[survey.known[obj.session_uid]] = _row(scene, survey.facts, evaluated, np.array(evaluated.matrix_world))
    return _Survey(scene, rows, survey.facts, survey.doubts, survey.known, [])


def _is_known(survey: _Survey, data: bpy.types.ID) -> bool:
    """Whether an update of it concerns the rows of the updated objects alone, if it leaves the facts as they are."""
    if isinstance(data, bpy.types.Object):
        return data.session_uid in survey.known
    if isinstance(data, bpy.types.Material):
        return data in survey.facts
    return isinstance(data, (bpy.types.Mesh, bpy.types.ShaderNodeTree))


_CONVERTED = SOLID_TYPES - {"MESH"}
"""Types whose evaluated objects hold a mesh beside them."""

SHAPED = SOLID_TYPES | {"CURVES", "POINTCLOUD", "VOLUME"}


def _row(
    scene: bpy.types.Scene,
    facts: dict[bpy.types.Material, _Facts],
    evaluated: bpy.types.Object,
    matrix: np.ndarray,
) -> _Row:
    obj = evaluated.original
    corners = _corners(evaluated) @ matrix[:3, :3].T + matrix[:3, 3]
    box = np.array([corners.min(axis=0), corners.max(axis=0)])
    dielectric = {
        slot.material.original for slot in evaluated.material_slots if slot.material and slot.material.original in facts
    }
    try:
        _require_still(obj)
        if _has_velocity(evaluated):
            raise _Doubt(f"has the attribute {VELOCITY!r}, by which motion blur moves its points")
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


def _corners(evaluated: bpy.types.Object) -> np.ndarray:
    """(n, 3) points between which an object lies, in its own space. The box of a text does not count its thickness."""
    if evaluated.type in _CONVERTED:
        vertices, _ = mesh_of(evaluated)
        return vertices if len(vertices) else np.zeros((1, 3))
    return np.array([tuple(corner) for corner in evaluated.bound_box])


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
    if evaluated.type not in SOLID_TYPES or obj.type == "META":
        return None  # the shape of metaballs is that of a whole family
    is_shared = isinstance(obj.data, bpy.types.Mesh) and not obj.modifiers and not obj.data.shape_keys
    owner = obj.data if is_shared else obj
    solid = _shapes.get(owner.session_uid)
    if solid is None:
        solid = _shapes[owner.session_uid] = _solid(evaluated)
    if not solid.closed:
        raise _Doubt("is not closed")
    medium = (obj.name_full,) if facts.values is None else facts.values
    return Body(solid, matrix, priority, medium) if exact else None


def _solid(evaluated: bpy.types.Object) -> Solid:
    """An evaluated mesh, the same object as long as nothing changes it."""
    vertices, triangles = mesh_of(evaluated)
    if not meshes.is_closed(triangles):
        triangles = meshes.same_places(vertices)[triangles]
    content = hashlib.sha256(vertices)
    content.update(triangles)
    key = content.digest()
    if key not in _solids:
        _solids[key] = Solid(vertices.astype(np.float64), triangles)
    return _solids[key]


def _forget_unused() -> None:
    for gone in _scenes.keys() - {scene.session_uid for scene in bpy.data.scenes}:
        del _scenes[gone]
    kept = {id(row.body.solid) for known in _scenes.values() if known.survey for row in known.survey.bodies}
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
        values = tuple(BY_NAME[name].bounded(node.inputs[name].default_value) for name in NEIGHBOUR_VALUES)
    priority = node.inputs["Priority"]
    output = tree.get_output_node("CYCLES")
    linked = any(node.inputs[name].is_linked for name in ABSORPTION_VALUES)
    return _Facts(
        values,
        material_priority(material) if still and not priority.is_linked else None,
        output is not None and output.inputs["Displacement"].is_linked and material.displacement_method != "BUMP",
        has_analysis(node) and is_plugged(node),
        absorption_coefficients(node) if still and not linked else None,
        output is not None and not linked and _adds_to(node.outputs[VOLUME_OUTPUT], output.inputs["Volume"]),
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
        return {
            obj
            for obj in objects
            if not is_cut_surface(obj) and any(slot.material in facts for slot in obj.material_slots)
        }

    for collection in scene.collection.children_recursive:
        if collection.hide_viewport != collection.hide_render and shown(collection.all_objects):
            yield collection.name, "is hidden in the viewport alone, or in renders alone"
    first, *others = scene.view_layers
    for layer in others:
        if shown(first.objects) != shown(layer.objects):
            yield layer.name, f"shows other media than {first.name!r}"


def may_change(obj: bpy.types.Object) -> str:
    """Return why an object may be elsewhere or have another shape in a render, or on another frame; empty if it stays."""
    try:
        _require_still(obj)
    except _Doubt as doubt:
        return str(doubt)
    return ""


def is_one_closed_surface(evaluated: bpy.types.Object) -> str:
    """Return why an evaluated object bounds no volume once and for all; empty if it does."""
    solid = _solid(evaluated)
    if not solid.closed:
        return "is not closed"
    return "crosses itself" if solid.overlaps_itself else ""


def _require_still(obj: bpy.types.Object) -> None:
    """Raise :class:`_Doubt` if an object may be elsewhere, or without bounds, when the file is rendered."""
    if obj.mode == "EDIT":
        raise _Doubt("is being edited")
    if is_rendered(obj) == obj.hide_viewport:
        raise _Doubt("is hidden in the viewport alone, or in renders alone")
    if _moves(obj):
        raise _Doubt("may move")
    if _is_animated(obj.data) or _is_animated(getattr(obj.data, "shape_keys", None)):
        raise _Doubt("may change its shape")
    for other in _shapers(obj):
        hidden = obj.type == "META" and other.hide_render != other.hide_viewport
        if hidden or _moves(other) or _is_animated(other.data) or other.modifiers:
            raise _Doubt(f"may change its shape with {other.name!r}")
    for modifier in obj.modifiers:
        if modifier.show_render and not modifier.show_viewport:
            raise _Doubt(f"has the modifier {modifier.name!r} in renders alone")
        if modifier.show_render and not _is_settled(modifier):
            raise _Doubt(f"has the modifier {modifier.name!r}, which may move it")


def _shapers(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Other objects that a curve, a text or a metaball takes its shape from."""
    if obj.type == "META":
        return [other for other in bpy.data.objects if other != obj and is_relative(other, obj)]
    paths = ("bevel_object", "taper_object", "follow_curve")
    return [other for path in paths if (other := getattr(obj.data, path, None)) is not None]


def is_relative(obj: bpy.types.Object, other: bpy.types.Object) -> bool:
    """Whether both are metaballs of one family, which merge into one object: their names differ in a number at most."""
    return obj.type == other.type == "META" and _family(obj) == _family(other)


def _family(obj: bpy.types.Object) -> str:
    stem, _, number = obj.name.rpartition(".")
    return stem if stem and number.isdigit() else obj.name


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


def _has_velocity(evaluated: bpy.types.Object) -> bool:
    """Whether Cycles moves the points of an object by an attribute, as caches of simulations bring it, while it blurs."""
    return VELOCITY in getattr(evaluated.data, "attributes", ())


def _is_animated(data: bpy.types.ID | None) -> bool:
    return data is not None and data.animation_data is not None


def _is_settled(modifier: bpy.types.Modifier) -> bool:
    """Whether it depends on the mesh and on numbers alone."""
    if keeps_mesh(modifier):
        return True
    return modifier.type in SETTLED_MODIFIERS and not any(
        prop.type == "POINTER" and isinstance(getattr(modifier, prop.identifier), bpy.types.ID)
        for prop in modifier.bl_rna.properties
    )


def keeps_mesh(modifier: bpy.types.Modifier) -> bool:
    """Whether it leaves all faces and their materials: it shades them, or parts those in the same place."""
    tree = modifier.node_group if modifier.type == "NODES" else None
    if tree is None or is_offset(modifier):
        return tree is not None
    passed_on = [node.inputs[0].is_linked for node in tree.nodes if node.bl_idname in PASSING_NODES]
    shades = bool(passed_on) and all(passed_on) and all(node.bl_idname in SHADING_NODES for node in tree.nodes)
    return shades and tree.animation_data is None


def is_offset(modifier: bpy.types.Modifier) -> bool:
    """Whether it is the modifier that parts faces in the same place."""
    return modifier.type == "NODES" and is_offset_group(modifier.node_group)


def _is_exact(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Whether a render shows the very mesh that the viewport does, to all rays."""
    return (
        not scene.render.use_simplify
        and is_seen_by_all(obj)
        and all(map(is_same_in_renders, obj.modifiers))
        and (obj.type not in _CONVERTED or _is_as_fine_in_renders(obj))
    )


def is_same_in_renders(modifier: bpy.types.Modifier) -> bool:
    """Tell whether a modifier does the same in the viewport and in renders."""
    if modifier.show_viewport != modifier.show_render:
        return False
    if modifier.type == "SUBSURF":
        return modifier.levels == modifier.render_levels and not modifier.use_adaptive_subdivision
    return modifier.type != "SCREW" or modifier.steps == modifier.render_steps


def _is_as_fine_in_renders(obj: bpy.types.Object) -> bool:
    """Whether a render divides a curve as the viewport does."""
    data = obj.data
    return not _shapers(obj) and all(
        getattr(data, f"render_{resolution}", 0) in (0, getattr(data, resolution, 0))
        for resolution in ("resolution_u", "resolution_v", "resolution")
    )


# Telling ------------------------------------------------------------------------------------------------------------


def _outsides(survey: _Survey) -> dict[bpy.types.Object, Outside]:
    """What each medium is told: what holds for all of its instances."""
    doubtful = bool(survey.doubts) or any(row.doubt for row in survey.rows if row.medium)
    boxes = np.array([row.box for row in survey.bodies]).reshape(-1, 2, 3)
    foreign = meets(boxes, [row.box for row in survey.rows if not row.medium])
    foreign |= np.array([bool(_labels(survey, row.obj)) for row in survey.bodies], dtype=bool)
    # Bodies of one priority that overlap are one: a ray may go from one to the next.
    priorities = np.array([row.body.priority for row in survey.bodies])
    foreign = np.isin(priorities, priorities[foreign])
    near_unclear = meets(boxes, [row.box for row in survey.vague])
    asking = set(np.flatnonzero(near_unclear | doubtful).tolist())
    volumes, givers = _left_to_volumes(survey, boxes, asking)
    told: dict[bpy.types.Object, list[Outside]] = {}
    for index, (row, contact) in enumerate(zip(survey.bodies, survey.contacts)):
        if index in asking:
            one = Outside(overlaps_itself=contact.robust)
        else:
            one = _told(survey, contact, bool(foreign[[index, *contact.partners]].any()), volumes)
        told.setdefault(row.obj, []).append(one)
    for row in survey.rows:
        if row.medium and (row.body is None or _has_linked_material(row.obj, survey.facts)):
            told[row.obj] = [Outside()]
    merged = _merged(told)
    for obj in merged if volumes else ():
        material = _medium_of(survey, obj)
        merged[obj] = replace(merged[obj], by_volume=material in volumes, gives_back=material in givers)
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
    unclear = {_medium_of(survey, row.obj) for row in survey.rows if row.medium and row.body is None}
    unclear |= {each for each, facts in survey.facts.items() if not facts.can_be_told or each.library is not None}
    wanted = meets(boxes, _beyond_surfaces(survey))
    fillings = []
    for index, (row, material, contact) in enumerate(zip(survey.bodies, materials, survey.contacts)):
        facts = survey.facts[material]
        certain = index not in asking and material not in unclear
        fillings.append(
            Filling(
                material,
                row.body.priority,
                row.body.solid.mean_chord * abs(np.linalg.det(row.body.matrix[:3, :3])) ** (1 / 3),
                facts.coefficients,
                certain,
                certain
                and not contact.robust
                and facts.has_volume
                and row.obj.material_slots[0].material == material
                and not any(map(is_clear, _labels(survey, row.obj))),
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


def _has_linked_material(obj: bpy.types.Object, facts: dict[bpy.types.Material, _Facts]) -> bool:
    """Whether an object is made of a medium that only its own file can tell anything."""
    return any(slot.material in facts and slot.material.library is not None for slot in obj.material_slots)


def _merged(told: dict[bpy.types.Object, list[Outside]]) -> dict[bpy.types.Object, Outside]:
    """What holds for all instances of an object."""
    return {
        obj: _common(rows) or Outside(overlaps_itself=any(row.overlaps_itself for row in rows))
        for obj, rows in told.items()
    }


def meets(boxes: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """Return whether each of the (n, 2, 3) boxes meets any of the others, (n,)."""
    found = np.zeros(len(boxes), dtype=bool)
    for low, high in others:
        found |= np.all((boxes[:, 0] <= high) & (boxes[:, 1] >= low), axis=1)
    return found


def _told(survey: _Survey, contact: Contact, foreign: bool, volumes: set) -> Outside:
    """What a body is told whose neighbours are known."""
    level = -1.0 if contact.level is None or survey.vague else float(contact.level)
    outside = Outside(contact.code, level, contact.robust, foreign)
    if contact.around is None:
        return outside
    around = survey.bodies[contact.around].body
    if len(around.medium) == 1 or around.priority in survey.mixed:
        return replace(outside, code=PROBE)
    ior, transmittance, depth = around.medium
    if _medium_of(survey, survey.bodies[contact.around].obj) in volumes:
        transmittance = CLEAR
    return replace(outside, medium=(float(around.priority), ior, depth), transmittance=transmittance)


def _tell(survey: _Survey, told: dict[bpy.types.Object, Outside]) -> None:
    """Write what changed. A material speaks for its objects if all of them are told the same."""
    users: dict[bpy.types.Material, list[bpy.types.Object]] = {}
    for obj in told:
        for material in {slot.material for slot in obj.material_slots} & survey.facts.keys():
            users.setdefault(material, []).append(obj)
    number = scene_number(survey.scene)
    slots = _most_slots()
    for material in survey.facts.keys() - users.keys():
        if _is_told_of(material, number):
            _tell_material(material, Outside(), NO_SCENE)
    for material, objects in users.items():
        if material.library is not None or not survey.facts[material].can_be_told:
            continue
        common = _common(told[obj] for obj in objects)
        if common is None:
            # What a linked object carries is its own file's. What concerns volumes is the same for all objects: a volume that
            # read it of each would be noisy.
            first = told[objects[0]]
            code = PROBE if any(obj.library is not None for obj in objects) else BY_OBJECT
            by_object = Outside(code, by_volume=first.by_volume, gives_back=first.gives_back)
        _tell_material(material, common or by_object, number, slots.get(material))
        for obj in objects:
            _tell_object(obj, None if common else told[obj])


def _tell_centre(survey: _Survey) -> None:
    """Write a point amid the media, from which shadow rays may measure their way; it stays as long as it is among them. None
    where colours may differ from place to place, or are too deep for single precision.
    """
    nodes = [dielectric_node(material) for material in survey.facts]
    varies = any(facts.coefficients is None for facts in survey.facts.values())
    black = any(min(node.inputs["Transmittance"].default_value[:3]) <= 1e-6 for node in nodes)
    deepest = max((max(absorption_coefficients(node)) for node in nodes), default=0.0)
    boxes = np.array([row.box for row in survey.bodies]).reshape(-1, 2, 3)
    low, high = boxes[:, 0].min(axis=0, initial=np.inf), boxes[:, 1].max(axis=0, initial=-np.inf)
    before = np.array(survey.scene.get(CENTRE, (np.inf,) * 3), dtype=float)
    if varies or black or not len(boxes) or deepest * np.linalg.norm(high - low) > LARGEST_EXPONENT:
        if survey.scene.pop(CENTRE, None) is not None:
            survey.scene.update_tag()
    elif before.shape != (3,) or not np.all((before >= low) & (before <= high)):
        survey.scene[CENTRE] = tuple(map(float, (low + high) / 2.0))
        survey.scene.update_tag()


def _common(outsides: Iterable[Outside]) -> Outside | None:
    """What all may be told at once, or None if that is less than some are told."""
    first, *others = outsides
    for other in others:
        first = first and first.merged(other)
    return first


def _most_slots() -> dict[bpy.types.Material, int]:
    """Of all objects of each material; many where modifiers may make more, as those of cut surfaces do."""
    most: dict[bpy.types.Material, int] = {}
    may_be_cut = any(scene.get(CUT_SETTING) for scene in bpy.data.scenes)
    for obj in itertools.filterfalse(is_cut_surface, bpy.data.objects):
        count = len(obj.material_slots)
        if may_be_cut or any(
            modifier.type in ("NODES", "BOOLEAN") and not keeps_mesh(modifier) for modifier in obj.modifiers
        ):
            count = MATERIAL_SLOTS
        for slot in obj.material_slots:
            most[slot.material] = max(most.get(slot.material, 0), count)
    return most


def _is_told_of(material: bpy.types.Material, number: int | None = None) -> bool:
    """Whether a material carries what an analysis found, of the scene of that number or with None of any."""
    node = dielectric_node(material)
    if node is None or not has_analysis(node):
        return False
    told_of = node.inputs[SCENE_SOCKET].default_value
    return told_of != NO_SCENE if number is None else told_of == number


def _tell_material(material: bpy.types.Material, outside: Outside, number: int, slots: int | None = None) -> None:
    """Write what holds for all objects of a material in the scene of that number."""
    node = dielectric_node(material)
    if material.library is not None or not has_analysis(node):
        return
    values = {
        SCENE_SOCKET: number,
        OUTSIDE_SOCKET: outside.code,
        LEVEL_SOCKET: outside.level,
        OVERLAP_SOCKET: outside.overlaps_itself,
        FOREIGN_SOCKET: outside.foreign,
        BY_VOLUME_SOCKET: number if outside.by_volume else NO_SCENE,
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


def _let_ask(material: bpy.types.Material) -> None:
    """Leave a material to the shader, as Cycles' own nodes cannot ask."""
    socket = dielectric_node(material).inputs.get(NATIVE_SOCKET)
    if material.library is None and socket is not None and socket.default_value:
        socket.default_value = False


def _tell_object(obj: bpy.types.Object, outside: Outside | None) -> None:
    """Write an object's custom properties, or with None remove them."""
    if obj.library is not None:
        return
    _forget_faces(obj)
    values: tuple = (None, None)
    if outside is not None:
        values = ((_facts_in_one(outside), *outside.medium), outside.transmittance if outside.absorbs else None)
    for name, value in zip(OBJECT_PROPERTIES, values):
        before = obj.get(name)
        if value is None:
            if before is not None:
                del obj[name]
                obj.update_tag()
        elif _four(before) != value:
            obj.pop(name, None)  # or it may keep another type
            obj[name] = value
            obj.update_tag()


def _four(value: object) -> tuple | None:
    """The four numbers that a custom property holds, or None if others have put anything else there."""
    return tuple(value) if getattr(value, "typecode", None) in ("f", "d") and len(value) == 4 else None


def _facts_in_one(outside: Outside) -> float:
    """The number of which osl/outside.h reads the digits; 0 tells nothing."""
    level = int(outside.level) + 1 if outside.level <= HIGHEST_OBJECT_LEVEL else 0
    return float(
        outside.code + 8 * outside.overlaps_itself + 16 * (not outside.foreign) + 32 * outside.absorbs + 64 * level
    )


def told_foreign(obj: bpy.types.Object) -> bool:
    """Tell whether an object's own properties leave it open that something that is no medium stands in it."""
    values = _four(obj.get(OBJECT_PROPERTIES[0]))
    return values is None or not int(values[0]) & 16


def _forget_faces(obj: bpy.types.Object) -> None:
    """Take away what older versions told the faces of a mesh."""
    mesh = obj.data
    if isinstance(mesh, bpy.types.Mesh) and mesh.library is None and obj.mode == "OBJECT":
        attribute = mesh.attributes.get(OBJECT_PROPERTIES[0])
        if attribute is not None and (attribute.data_type, attribute.domain) == ("INT8", "FACE"):
            mesh.attributes.remove(attribute)


def _found(survey: _Survey, told: dict[bpy.types.Object, Outside]) -> Found:
    pairs = {
        tuple(sorted((row.obj.name, survey.bodies[other].obj.name)))
        for row, contact in zip(survey.bodies, survey.contacts)
        for other, *_ in contact.coincident
    }
    doubts = survey.doubts + tuple((row.obj.name, row.doubt) for row in survey.rows if row.medium and row.doubt)
    return Found(
        known=tuple(obj.name for obj, one in told.items() if one.code != PROBE),
        asking=tuple(obj.name for obj, one in told.items() if one.code == PROBE),
        overlapping=tuple(obj.name for obj, one in told.items() if one.overlaps_itself),
        coincident=tuple(sorted(pairs)),
        doubts=tuple(dict(doubts).items()),
    )
