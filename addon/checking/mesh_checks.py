"""Checks of the meshes of media: closed, turned outwards, of one medium."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..analysis.stability import is_relative
from ..geometry import meshes
from ..geometry.mesh_faults import mesh_faults
from ..scene.media import SOLID_TYPES, get_priority
from .evaluated_shapes import Shape
from .finding import NOWHERE, Action, Finding, Fix, Place
from .inspection import Inspection, listed_faces
from .kinds import (
    INWARD_NORMALS,
    METABALL_FAMILY,
    MIXED_NORMALS,
    NO_FACES,
    NOT_FINITE,
    OPEN_MESH,
    SELF_OVERLAP,
    SEVERAL_MEDIA,
)
from .own_mesh import CONVERT, can_change
from .signatures import medium_signature, neighbour_values

_EMPTY = {
    "MESH": "give it a closed mesh, or another material",
    "CURVE": "give it a Bevel Depth and Fill Caps (Curve properties > Geometry), or another material",
    "FONT": "give it letters and an Extrude (Text properties > Geometry), or another material",
    "SURFACE": "close it (Edit Mode > Surface > Cyclic), or give it another material",
    "META": "let it reach its threshold (a larger Radius or Stiffness), or give it another material",
}

_OPEN = {
    "MESH": "close it (Mesh > Clean Up > Fill Holes, Merge > By Distance, or a Solidify modifier) and recalculate its "
    "normals",
    "CURVE": "switch on Fill Caps (Curve properties > Geometry > Bevel) or make it Cyclic; turn around a bevel object that "
    "faces the other way (Edit Mode > Segments > Switch Direction)",
    "FONT": "give it an Extrude and the Fill Mode Both (Text properties)",
    "SURFACE": f"close it (Edit Mode > Surface > Cyclic), or {CONVERT} and merge its vertices by distance",
    "META": f"{CONVERT} and close that",
}

_INVERTED = {
    "MESH": "recalculate them in Edit Mode (Mesh > Normals > Recalculate Outside)",
    "SURFACE": f"turn it around (Edit Mode > Segments > Switch Direction), or {CONVERT} and recalculate its normals",
    "META": "make its elements positive",
}
_TURN = f"{CONVERT} and recalculate its normals"

_UNITE = "make its parts one (Edit Mode > Face > Intersect (Boolean) > Self Union, or a Remesh modifier)"

_JOIN = {"MESH": f"nothing to do but for speed; else {_UNITE}"}
"""Remedies by the object's type, as in the two tables above."""


def mesh_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield what is wrong with the meshes of media."""
    for shape in inspection.shapes:
        several = _mixture_findings(shape)
        # Media that are to be separated overlap for that reason.
        yield from (
            each for each in _shape_findings(shape, inspection.shapes) if not several or each.kind != SELF_OVERLAP
        )
        yield from several


def _shape_findings(shape: Shape, shapes: list[Shape]) -> list[Finding]:
    """Return the first thing that is wrong with the mesh of a shape among those of a scene, or nothing."""
    obj, name = shape.obj, shape.obj.name
    if len(shape.triangles) == 0:
        family = next((other.obj for other in shapes if is_relative(other.obj, obj) and len(other.triangles)), None)
        if family is not None:
            return _family_findings(obj, family)
        return [Finding(NO_FACES, name, "has no faces", _EMPTY[obj.type])] if obj.type in SOLID_TYPES else []
    if not np.isfinite(shape.vertices).all():
        return [
            Finding(
                NOT_FINITE,
                name,
                "has coordinates that are not numbers",
                "remove those vertices, or the modifier that makes them",
            )
        ]
    if shape.mesh.open_edges:
        return [_open_finding(shape)]
    if shape.mesh.is_inverted:
        text, faces = "has its normals pointing inwards", np.arange(len(shape.triangles))
        return [_inward_finding(shape, text, faces)]
    found = shape.mesh.solid.overlapping_triangle
    return [] if found is None else [_overlap_finding(shape, found)]


def _open_finding(shape: Shape) -> Finding:
    """Return where a mesh is not closed, or which of its faces are turned against others."""
    obj = shape.obj
    corners = meshes.same_places(shape.mesh.vertices)[shape.mesh.triangles]
    faults = mesh_faults(shape.mesh.vertices, corners)
    changeable = can_change(obj)
    if len(faults.turned):
        text = f"has faces turned against each other ({len(np.unique(shape.mesh.faces[faults.turned]))} of them)"
        fix = Fix(Action.RECALCULATE_NORMALS, (obj.name,)) if changeable else None
        remedy = _INVERTED.get(obj.type, _TURN)
        return Finding(MIXED_NORMALS, obj.name, text, remedy, place=_place(shape, faults.turned), fix=fix)
    text = f"is not closed ({shape.mesh.open_edges} edges)"
    if len(faults.crowded):
        text = f"is not closed where several faces share an edge ({shape.mesh.open_edges} edges are open or shared)"
    fix = None
    if len(faults.crowded) == 0 and changeable:
        fix = Fix(Action.CLOSE_HOLES, (obj.name,))
    elif obj.type == "CURVE" and _takes_caps(obj):
        fix = Fix(Action.FILL_CAPS, (obj.name,))
    place = _place(shape, faults.crowded if len(faults.crowded) else faults.holes)
    return Finding(OPEN_MESH, obj.name, text, _OPEN.get(obj.type, CONVERT), place=place, fix=fix)


def _takes_caps(obj: bpy.types.Object) -> bool:
    """Return whether caps close a curve: it is a tube that is open at its ends."""
    curve = obj.data
    return (
        obj.is_editable
        and curve.is_editable
        and not obj.modifiers
        and not curve.use_fill_caps
        and curve.dimensions == "3D"
        and (curve.bevel_depth > 0.0 or curve.bevel_mode == "OBJECT")
        and curve.fill_mode == "FULL"
    )


def _inward_finding(shape: Shape, text: str, triangles: np.ndarray) -> Finding:
    """Return that some triangles of a closed mesh look inwards."""
    obj = shape.obj
    fix = Fix(Action.RECALCULATE_NORMALS, (obj.name,)) if can_change(obj) else None
    remedy = _INVERTED.get(obj.type, _TURN)
    return Finding(INWARD_NORMALS, obj.name, text, remedy, place=_place(shape, triangles), fix=fix)


def _overlap_finding(shape: Shape, triangle: int) -> Finding:
    """Return that a mesh overlaps itself, or that parts of it look inwards.

    :param triangle: where it does.
    """
    inward = shape.mesh.solid.inward_triangles()
    if len(inward):
        return _inward_finding(shape, "has parts with their normals pointing inwards", inward)
    text = "overlaps itself, so rays ask there what lies around them, which takes longer"
    remedy = _JOIN.get(shape.obj.type, f"nothing to do but for speed; else {CONVERT} and {_UNITE}")
    place = _place(shape, np.array([triangle]))
    return Finding(SELF_OVERLAP, shape.obj.name, text, remedy, place=place)


def _place(shape: Shape, triangles: np.ndarray) -> Place:
    """Return the place of some triangles of a shape."""
    if len(triangles) == 0:
        return NOWHERE
    point = shape.vertices[shape.mesh.triangles[triangles[0]]].mean(axis=0)
    return Place(listed_faces(shape.mesh.faces[triangles]), tuple(point.tolist()))


def _family_findings(obj: bpy.types.Object, family: bpy.types.Object) -> list[Finding]:
    """Return what is wrong with a metaball that merges into another one.

    Metaballs of one name are one object, which the first of them gives its material and its priority.
    """
    if get_priority(obj) == get_priority(family) and medium_signature(obj) == medium_signature(family):
        return []
    return [
        Finding(
            METABALL_FAMILY,
            obj.name,
            f"merges into the metaball {family.name!r}, whose medium and priority are not its own",
            "give it the same, or a name of its own that differs in more than a number",
        )
    ]


def _mixture_findings(shape: Shape) -> list[Finding]:
    """Return the problem of an object with several media: which of them it is inside cannot be told by faces."""
    media_of = {neighbour_values(material): material.name for material in shape.materials}
    if len(media_of) < 2:
        return []
    return [
        Finding(
            SEVERAL_MEDIA,
            shape.obj.name,
            f"has {len(media_of)} media in one object, {' and '.join(map(repr, media_of.values()))}",
            "separate them (Edit Mode > Mesh > Separate > By Material) and close each"
            if shape.obj.type == "MESH"
            else f"{CONVERT} and separate them (Edit Mode > Mesh > Separate > By Material)",
        )
    ]
