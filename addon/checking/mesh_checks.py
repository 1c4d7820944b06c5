"""Checks of the meshes of media: closed, turned outwards, of one medium."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from ..analysis.stability import is_relative
from ..model.parameters import NEIGHBOUR_PARAMETERS
from ..nodes.lookups import cached_by_nodes
from ..nodes.places import socket_value
from ..scene.materials import dielectric_node, medium_material
from ..scene.media import SOLID_TYPES, get_priority
from .evaluated_shapes import Shape
from .finding import Finding
from .inspection import Inspection
from .kinds import INWARD_NORMALS, METABALL_FAMILY, NO_FACES, NOT_FINITE, OPEN_MESH, SEVERAL_MEDIA

_EMPTY = {
    "MESH": "give it a closed mesh, or another material",
    "CURVE": "give it a Bevel Depth and Fill Caps (Curve properties > Geometry), or another material",
    "FONT": "give it letters and an Extrude (Text properties > Geometry), or another material",
    "SURFACE": "close it (Edit Mode > Surface > Cyclic), or give it another material",
    "META": "let it reach its threshold (a larger Radius or Stiffness), or give it another material",
}

CONVERT = "turn it into a mesh (Object > Convert > Mesh)"

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
"""Remedies by the object's type, as in the two tables above."""


def mesh_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield what is wrong with the meshes of media."""
    for shape in inspection.shapes:
        yield from _shape_findings(shape, inspection.shapes)
        yield from _mixture_findings(shape)


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
    edges = shape.mesh.open_edges
    if edges:
        text = f"is not closed or its faces are turned against each other ({edges} edges)"
        return [Finding(OPEN_MESH, name, text, _OPEN.get(obj.type, CONVERT))]
    if shape.mesh.is_inverted:
        remedy = _INVERTED.get(obj.type, f"{CONVERT} and recalculate its normals")
        return [Finding(INWARD_NORMALS, name, "has its normals pointing inwards", remedy)]
    return []


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
    media_of = {_neighbour_values(material): material.name for material in shape.materials}
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


@cached_by_nodes
def _neighbour_values(material: bpy.types.Material) -> tuple:
    """Return what neighbours read of a material, the values of its sockets."""
    node = dielectric_node(material)
    return tuple(socket_value(node.inputs[name]) for name in NEIGHBOUR_PARAMETERS)


def medium_signature(obj: bpy.types.Object) -> tuple:
    """Return what neighbours read of an object's medium, but its priority: the same for objects of one medium."""
    return _neighbour_values(medium_material(obj))[1:]
