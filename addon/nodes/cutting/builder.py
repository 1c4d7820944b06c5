"""A builder of Geometry Nodes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import bpy

from ..wholeness import is_whole, mark_whole
from .names import BOOLEAN_GROUP

GEOMETRY = {"Geometry": "NodeSocketGeometry"}

CUBE_FACES = 6
"""Faces of a cube that no solver has cut."""


@dataclass
class Builder:
    """A tree under construction. Each method adds nodes, and returns their output."""

    tree: bpy.types.NodeTree
    inputs: bpy.types.Node = field(init=False)

    def __post_init__(self) -> None:
        self.inputs = self.tree.nodes.new("NodeGroupInput")

    def node(self, kind: str, *, properties: dict | None = None, **sources) -> bpy.types.Node:
        """Add a node whose inputs, by name with blanks for underscores, are sockets or values."""
        node = self.tree.nodes.new(kind)
        for name, value in (properties or {}).items():
            setattr(node, name, value)
        for name, source in sources.items():
            self.put(enabled_input(node, name.replace("_", " ")), source)
        return node

    def put(self, socket: bpy.types.NodeSocket, source) -> None:
        """Give a socket a value, or link it."""
        if isinstance(source, bpy.types.NodeSocket):
            self.tree.links.new(source, socket)
        else:
            socket.default_value = source

    def returns(self, **sources) -> None:
        """Link what the tree returns, which is whole then."""
        output = self.tree.nodes.new("NodeGroupOutput")
        for name, source in sources.items():
            self.put(output.inputs[name.replace("_", " ")], source)
        mark_whole(self.tree)

    def joined(self, geometries: Sequence[bpy.types.NodeSocket]) -> bpy.types.NodeSocket | None:
        """Join geometries, the materials of the first one first; return None without any."""
        if len(geometries) < 2:
            return geometries[0] if geometries else None
        node = self.tree.nodes.new("GeometryNodeJoinGeometry")
        for geometry in reversed(geometries):
            self.tree.links.new(geometry, node.inputs[0])
        return node.outputs[0]

    def attribute(self, name: str, kind: str) -> bpy.types.NodeSocket:
        """Read a named attribute."""
        return enabled_output(
            self.node("GeometryNodeInputNamedAttribute", properties={"data_type": kind}, Name=name), "Attribute"
        )

    def stored(self, geometry, name: str, value, kind: str, domain: str = "FACE") -> bpy.types.NodeSocket:
        """Store an attribute in a geometry."""
        node = self.node(
            "GeometryNodeStoreNamedAttribute",
            properties={"data_type": kind, "domain": domain},
            Geometry=geometry,
            Name=name,
            Value=value,
        )
        return node.outputs[0]

    def compare(self, first, operation: str, second, kind: str = "INT") -> bpy.types.NodeSocket:
        """Compare two values; two vectors in each component."""
        properties = {"data_type": kind, "operation": operation}
        if kind == "VECTOR":
            properties["mode"] = "ELEMENT"
        return self.node("FunctionNodeCompare", properties=properties, A=first, B=second).outputs[0]

    def all_of(self, conditions: Iterable[bpy.types.NodeSocket], operation: str = "AND") -> bpy.types.NodeSocket:
        """Combine conditions: all of them hold, or with OR any."""
        first, *others = conditions
        for other in others:
            node = self.node("FunctionNodeBooleanMath", properties={"operation": operation})
            self.put(node.inputs[0], first)
            self.put(node.inputs[1], other)
            first = node.outputs[0]
        return first

    def switch(self, condition, no, yes, kind: str = "GEOMETRY") -> bpy.types.NodeSocket:
        """Choose one of two, of which the other is not evaluated; None stands for an empty geometry."""
        node = self.tree.nodes.new("GeometryNodeSwitch")
        node.input_type = kind
        self.put(node.inputs[0], condition)
        for socket, source in zip(node.inputs[1:], (no, yes)):
            if source is not None:
                self.put(socket, source)
        return node.outputs[0]

    def count(self, geometry, domain: str, field_) -> bpy.types.NodeSocket:
        """Count the elements of a geometry that a condition holds of."""
        node = self.node(
            "GeometryNodeAttributeStatistic",
            properties={"data_type": "FLOAT", "domain": domain},
            Geometry=geometry,
            Attribute=field_,
        )
        return enabled_output(node, "Sum")

    def box(self, geometry) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
        """Find the lowest and the highest corner of a geometry."""
        node = self.node("GeometryNodeBoundBox", Geometry=geometry)
        return node.outputs["Min"], node.outputs["Max"]

    def meet(self, first, second) -> bpy.types.NodeSocket:
        """Return whether two boxes, of lowest and highest corners, meet."""
        return self.all_of(
            (
                self.compare(first[0], "LESS_EQUAL", second[1], "VECTOR"),
                self.compare(second[0], "LESS_EQUAL", first[1], "VECTOR"),
            )
        )

    def united(self, first, second) -> bpy.types.NodeSocket:
        """Unite two closed meshes."""
        return self._combined("UNION", first, second)

    def less(self, geometry, other) -> bpy.types.NodeSocket:
        """Take from a closed mesh what is in another."""
        return self._combined("DIFFERENCE", geometry, other)

    def _combined(self, operation: str, first, second) -> bpy.types.NodeSocket:
        """Combine two closed meshes by the group for an operation."""
        node = self.node("GeometryNodeGroup", properties={"node_tree": ensure_boolean_tree(operation)})
        for socket, geometry in zip(node.inputs, (first, second)):
            self.put(socket, geometry)
        return node.outputs[0]

    def solved(self, operation: str, solver: str, first, second) -> bpy.types.NodeSocket:
        """Combine two meshes by one solver."""
        node = self.node("GeometryNodeMeshBoolean", properties={"operation": operation, "solver": solver})
        for name, geometry in zip(("Mesh 1" if operation == "DIFFERENCE" else "Mesh 2", "Mesh 2"), (first, second)):
            self.put(node.inputs[name], geometry)
        return node.outputs["Mesh"]

    def face_count(self, geometry) -> bpy.types.NodeSocket:
        """Count the faces of a mesh."""
        node = self.node("GeometryNodeAttributeDomainSize", properties={"component": "MESH"}, Geometry=geometry)
        return node.outputs["Face Count"]

    def faces(self, geometry, selection) -> bpy.types.NodeSocket:
        """Take the selected faces of a mesh."""
        node = self.node("GeometryNodeSeparateGeometry", properties={"domain": "FACE"}, Geometry=geometry)
        self.put(node.inputs["Selection"], selection)
        return node.outputs["Selection"]

    def flipped(self, geometry) -> bpy.types.NodeSocket:
        """Turn faces to look the other way."""
        return self.node("GeometryNodeFlipFaces", Mesh=geometry).outputs[0]


def enabled_input(node: bpy.types.Node, name: str) -> bpy.types.NodeSocket:
    """Return the input of a name that the node's properties leave in use."""
    return next(socket for socket in node.inputs if socket.name == name and socket.enabled)


def enabled_output(node: bpy.types.Node, name: str) -> bpy.types.NodeSocket:
    """Return the output of a name that the node's properties leave in use."""
    return next(socket for socket in node.outputs if socket.name == name and socket.enabled)


def new_tree(name: str, inputs: dict[str, str], outputs: dict[str, str], description: str) -> bpy.types.NodeTree:
    """Make a group; its inputs and outputs have types of sockets, by name."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.description = description
    for names, way in ((outputs, "OUTPUT"), (inputs, "INPUT")):
        for socket, kind in names.items():
            tree.interface.new_socket(socket, in_out=way, socket_type=kind)
    return tree


def find_tree(name: str) -> bpy.types.NodeTree | None:
    """Return this file's own group of a name, whatever number follows it, or None if there is none that is whole."""
    found = (tree for tree in bpy.data.node_groups if tree.name == name or tree.name.rpartition(".")[0] == name)
    return next((tree for tree in found if tree.library is None and is_whole(tree)), None)


def ensure_boolean_tree(operation: str) -> bpy.types.NodeTree:
    """Return the group that unites two closed meshes, or takes the second from the first.

    Builds of Blender without the Manifold library leave the first as it is, as is seen on a small cube. There the exact solver,
    which takes five times as long, does the work.
    """
    name = f"{BOOLEAN_GROUP} {operation.title()}"
    tree = find_tree(name)
    if tree is not None:
        return tree
    inputs = dict.fromkeys(("First", "Second"), "NodeSocketGeometry")
    tree = new_tree(name, inputs, GEOMETRY, "Two closed meshes as one, or the first without the second")
    build = Builder(tree)
    cube = build.node("GeometryNodeMeshCube").outputs["Mesh"]
    moved = build.node("GeometryNodeTransform", Geometry=cube, Translation=(0.5, 0.5, 0.5)).outputs[0]
    faces = build.face_count(build.solved("DIFFERENCE", "MANIFOLD", cube, moved))
    bodies = [build.inputs.outputs[name] for name in inputs]
    quick, exact = (build.solved(operation, solver, *bodies) for solver in ("MANIFOLD", "EXACT"))
    build.returns(Geometry=build.switch(build.compare(faces, "GREATER_THAN", CUBE_FACES), exact, quick))
    return tree
