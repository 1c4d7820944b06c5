"""Geometry Nodes that cut the surfaces of media where they cross, so that every face lies between two known media.

One object holds the whole cut: its modifier reads all media, in layers of one priority and one material each, the strongest
first. What the union of the stronger ones leaves of a layer is bounded by the layer's own faces and by theirs, and outside the
latter is that layer: so each of them is found once, with what lies outside. The union of all layers has the faces in air. For
each medium an object picks its own faces.

Nothing here knows the extension: a file that is rendered without it evaluates the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import bpy

from ..model.parameters import DISPERSION_MODELS
from .node_group import (
    BY_VOLUME_SOCKET,
    CUT,
    CUT_BY_VOLUME,
    CUT_CURVE,
    CUT_DEPTH,
    CUT_PRIORITY,
    CUT_SELLMEIER_B,
    CUT_SELLMEIER_C,
    CUT_TINT,
)

AIR_INDEX = 1.0
"""What a face in air carries in place of an index."""

LIKE_AIR = 1.0000001
"""The index of a medium that bends light as air does."""

HIDDEN_INDEX = 1e6
"""What a face carries that lies inside a winner: the surface does not exist there (osl/cut.h)."""

CHUNK = 24
"""Bodies of one node group: to add a node takes as long as a tree has nodes."""

BODY = "nd_body"
NORMAL = "nd_normal"

ATTRIBUTES = "nd_attributes"
"""Custom property of a group that reads a medium: whose attributes it moves to corners."""

PART = 32
"""Media whose faces stand together: whoever picks one's looks at each of them."""

PART_GROUP = "Nested Dielectric Cut Part"
SURFACE_GROUP = "Nested Dielectric Cut Surface"
KEPT_GROUP = "Nested Dielectric Cut Kept"
BODY_GROUP = "Nested Dielectric Cut Body"
BOOLEAN_GROUP = "Nested Dielectric Cut Boolean"
CUT_GROUP = "Nested Dielectric Cut"

CUBE_FACES = 6

OWN_INPUT, CUT_INPUT, BODY_INPUT, END_INPUT = "Medium", "Cut", "Body", "End"
FRAME_INPUT = "Frame"
"""On which the object's own mesh is its surface."""

VALUES = {
    "IOR": "NodeSocketFloat",
    "Transmittance": "NodeSocketColor",
    "Transmittance Depth": "NodeSocketFloat",
    "Disperse": "NodeSocketBool",
    "Dispersion Model": "NodeSocketInt",
    "Abbe": "NodeSocketFloat",
    "Dispersion": "NodeSocketFloat",
    "Sellmeier B": "NodeSocketVector",
    "Sellmeier C": "NodeSocketVector",
    BY_VOLUME_SOCKET: "NodeSocketInt",
}
"""Sockets of a material that faces outside it carry, and the kinds of inputs that bring them."""


@dataclass(frozen=True)
class Layer:
    """Media of one priority and one material.

    :param crossing: those whose surfaces may cross others'.
    :param constant: media whose whole surface lies in one layer (its place), in air (None) or inside winners (HIDDEN).
    :param overlapping: media of the layer may overlap each other.
    :param tells_more: its colour or dispersion matters to what lies in it, beside its index.
    :param keeps_hidden: its surfaces inside winners stay, passed by light, for volumes and labels.
    """

    priority: int
    material: bpy.types.Material
    crossing: tuple[bpy.types.Object, ...]
    constant: tuple[tuple[bpy.types.Object, int | None], ...] = ()
    overlapping: bool = False
    tells_more: bool = False
    keeps_hidden: bool = False

    @property
    def bodies(self) -> tuple[bpy.types.Object, ...]:
        """All media of the layer, in the order of their numbers."""
        return self.crossing + tuple(obj for obj, _ in self.constant)


HIDDEN = -1
"""In place of a layer: inside winners."""


@dataclass(frozen=True)
class Plan:
    """What is cut, and where.

    :param layers: the strongest first.
    :param pairs: places of layers that may cross, the stronger one's first.
    :param may_part: which of them cross has to be looked at in every frame.
    :param attributes: those of media that are not of corners and that materials read.
    """

    layers: tuple[Layer, ...] = ()
    pairs: frozenset[tuple[int, int]] = frozenset()
    may_part: bool = False
    attributes: dict[bpy.types.Object, tuple[str, ...]] = field(default_factory=dict)

    def numbers(self) -> dict[bpy.types.Object, int]:
        """The number of every medium."""
        return {obj: number for number, obj in enumerate(obj for layer in self.layers for obj in layer.bodies)}


@dataclass
class _Builder:
    """Nodes of one tree, each method the output of new ones."""

    tree: bpy.types.NodeTree
    inputs: bpy.types.Node = field(init=False)

    def __post_init__(self) -> None:
        self.inputs = self.tree.nodes.new("NodeGroupInput")

    def node(self, kind: str, *, properties: dict | None = None, **sources) -> bpy.types.Node:
        """A node whose inputs, by name with blanks for underscores, are sockets or values."""
        node = self.tree.nodes.new(kind)
        for name, value in (properties or {}).items():
            setattr(node, name, value)
        for name, source in sources.items():
            self.put(_input(node, name.replace("_", " ")), source)
        return node

    def put(self, socket: bpy.types.NodeSocket, source) -> None:
        """Give a socket a value, or link it."""
        if isinstance(source, bpy.types.NodeSocket):
            self.tree.links.new(source, socket)
        else:
            socket.default_value = source

    def returns(self, **sources) -> None:
        """Link what the tree returns."""
        output = self.tree.nodes.new("NodeGroupOutput")
        for name, source in sources.items():
            self.put(output.inputs[name.replace("_", " ")], source)

    def joined(self, geometries: Sequence[bpy.types.NodeSocket]) -> bpy.types.NodeSocket | None:
        """All geometries as one, the materials of the first first; None without any."""
        if len(geometries) < 2:
            return geometries[0] if geometries else None
        node = self.tree.nodes.new("GeometryNodeJoinGeometry")
        for geometry in reversed(geometries):
            self.tree.links.new(geometry, node.inputs[0])
        return node.outputs[0]

    def attribute(self, name: str, kind: str) -> bpy.types.NodeSocket:
        """A named attribute."""
        return _output(
            self.node("GeometryNodeInputNamedAttribute", properties={"data_type": kind}, Name=name), "Attribute"
        )

    def stored(self, geometry, name: str, value, kind: str, domain: str = "FACE") -> bpy.types.NodeSocket:
        """A geometry with an attribute."""
        node = self.node(
            "GeometryNodeStoreNamedAttribute",
            properties={"data_type": kind, "domain": domain},
            Geometry=geometry,
            Name=name,
            Value=value,
        )
        return node.outputs[0]

    def compare(self, first, operation: str, second, kind: str = "INT") -> bpy.types.NodeSocket:
        """Whether a comparison holds; of vectors in each component."""
        properties = {"data_type": kind, "operation": operation}
        if kind == "VECTOR":
            properties["mode"] = "ELEMENT"
        return self.node("FunctionNodeCompare", properties=properties, A=first, B=second).outputs[0]

    def all_of(self, conditions: Iterable[bpy.types.NodeSocket], operation: str = "AND") -> bpy.types.NodeSocket:
        """Whether all, or with OR any, conditions hold."""
        first, *others = conditions
        for other in others:
            node = self.node("FunctionNodeBooleanMath", properties={"operation": operation})
            self.put(node.inputs[0], first)
            self.put(node.inputs[1], other)
            first = node.outputs[0]
        return first

    def switch(self, condition, no, yes, kind: str = "GEOMETRY") -> bpy.types.NodeSocket:
        """One of two, of which the other is not evaluated; None stands for an empty geometry."""
        node = self.tree.nodes.new("GeometryNodeSwitch")
        node.input_type = kind
        self.put(node.inputs[0], condition)
        for socket, source in zip(node.inputs[1:], (no, yes)):
            if source is not None:
                self.put(socket, source)
        return node.outputs[0]

    def count(self, geometry, domain: str, field_) -> bpy.types.NodeSocket:
        """How many elements of a geometry a condition holds of."""
        node = self.node(
            "GeometryNodeAttributeStatistic",
            properties={"data_type": "FLOAT", "domain": domain},
            Geometry=geometry,
            Attribute=field_,
        )
        return _output(node, "Sum")

    def box(self, geometry) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
        """Lowest and highest corner of a geometry."""
        node = self.node("GeometryNodeBoundBox", Geometry=geometry)
        return node.outputs["Min"], node.outputs["Max"]

    def meet(self, first, second) -> bpy.types.NodeSocket:
        """Whether two boxes meet."""
        return self.all_of(
            (
                self.compare(first[0], "LESS_EQUAL", second[1], "VECTOR"),
                self.compare(second[0], "LESS_EQUAL", first[1], "VECTOR"),
            )
        )

    def united(self, first, second) -> bpy.types.NodeSocket:
        """Two closed meshes as one."""
        return self._combined("UNION", first, second)

    def less(self, geometry, other) -> bpy.types.NodeSocket:
        """A closed mesh without what is in another."""
        return self._combined("DIFFERENCE", geometry, other)

    def _combined(self, operation: str, first, second) -> bpy.types.NodeSocket:
        node = self.node("GeometryNodeGroup", properties={"node_tree": _ensure_boolean_tree(operation)})
        for socket, geometry in zip(node.inputs, (first, second)):
            self.put(socket, geometry)
        return node.outputs[0]

    def solved(self, operation: str, solver: str, first, second) -> bpy.types.NodeSocket:
        """What a solver makes of two meshes."""
        node = self.node("GeometryNodeMeshBoolean", properties={"operation": operation, "solver": solver})
        for name, geometry in zip(("Mesh 1" if operation == "DIFFERENCE" else "Mesh 2", "Mesh 2"), (first, second)):
            self.put(node.inputs[name], geometry)
        return node.outputs["Mesh"]

    def face_count(self, geometry) -> bpy.types.NodeSocket:
        """How many faces a mesh has."""
        node = self.node("GeometryNodeAttributeDomainSize", properties={"component": "MESH"}, Geometry=geometry)
        return node.outputs["Face Count"]

    def faces(self, geometry, selection) -> bpy.types.NodeSocket:
        """The faces of a mesh that are selected."""
        node = self.node("GeometryNodeSeparateGeometry", properties={"domain": "FACE"}, Geometry=geometry)
        self.put(node.inputs["Selection"], selection)
        return node.outputs["Selection"]

    def flipped(self, geometry) -> bpy.types.NodeSocket:
        """Faces that look the other way."""
        return self.node("GeometryNodeFlipFaces", Mesh=geometry).outputs[0]

    def numbered(self, geometry, first: int, end: int) -> bpy.types.NodeSocket:
        """The faces of bodies from one number to before another."""
        return self.faces(geometry, _is_among(self, first, end))


def _input(node: bpy.types.Node, name: str) -> bpy.types.NodeSocket:
    """The input of a name that the node's properties leave in use."""
    return next(socket for socket in node.inputs if socket.name == name and socket.enabled)


def _output(node: bpy.types.Node, name: str) -> bpy.types.NodeSocket:
    return next(socket for socket in node.outputs if socket.name == name and socket.enabled)


def _new_tree(name: str, inputs: dict[str, str], outputs: dict[str, str], description: str) -> bpy.types.NodeTree:
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.description = description
    for names, way in ((outputs, "OUTPUT"), (inputs, "INPUT")):
        for socket, kind in names.items():
            tree.interface.new_socket(socket, in_out=way, socket_type=kind)
    return tree


def _find_tree(name: str) -> bpy.types.NodeTree | None:
    """A group of this file that stands under a name of ours."""
    tree = bpy.data.node_groups.get(name)
    return tree if tree is not None and tree.library is None and tree.bl_idname == "GeometryNodeTree" else None


GEOMETRY = {"Geometry": "NodeSocketGeometry"}


SURFACE_INPUTS = {OWN_INPUT: "NodeSocketObject", CUT_INPUT: "NodeSocketObject", BODY_INPUT: "NodeSocketInt"}


def ensure_surface_tree() -> bpy.types.NodeTree:
    """Return the group by which an object shows one medium's faces of the cut.

    One point of the medium stands before them: the mesh that comes first brings its slots and its texture space.
    """
    tree = _find_tree(SURFACE_GROUP)
    if tree is not None:
        return tree
    inputs = GEOMETRY | SURFACE_INPUTS
    tree = _new_tree(
        SURFACE_GROUP, inputs, GEOMETRY, "A medium's surface as far as it exists, cut where others cross it"
    )
    tree.is_modifier = True
    build = _Builder(tree)
    own = _mesh_of(build, build.inputs.outputs[OWN_INPUT])
    first = build.node("GeometryNodeSeparateGeometry", properties={"domain": "POINT"}, Geometry=own)
    build.put(
        first.inputs["Selection"], build.compare(build.tree.nodes.new("GeometryNodeInputIndex").outputs[0], "EQUAL", 0)
    )
    cut = _cut_by(build)
    picked = _picked(build, cut, build.compare(build.attribute(BODY, "INT"), "EQUAL", build.inputs.outputs[BODY_INPUT]))
    faces = build.node("GeometryNodeRealizeInstances", Geometry=picked).outputs[0]
    shown = build.joined([first.outputs["Selection"], _as_outside_in(build, cut, faces)])
    smooth = build.count(shown, "FACE", build.tree.nodes.new("GeometryNodeInputShadeSmooth").outputs[0])
    build.returns(
        Geometry=build.switch(
            build.compare(smooth, "GREATER_THAN", 0.5, "FLOAT"), shown, _with_normals(build, shown, cut)
        )
    )
    return tree


def ensure_kept_tree() -> bpy.types.NodeTree:
    """Return the group by which an object shows its own mesh on one frame, and on others what :func:`ensure_surface_tree` does.

    It is another group because whatever asks for the frame is evaluated anew, and taken for another mesh, in every render.
    """
    tree = _find_tree(KEPT_GROUP)
    if tree is not None:
        return tree
    inputs = GEOMETRY | SURFACE_INPUTS | {FRAME_INPUT: "NodeSocketInt"}
    tree = _new_tree(
        KEPT_GROUP, inputs, GEOMETRY, "A medium's surface, cut where others cross it, that is kept for one frame"
    )
    tree.is_modifier = True
    build = _Builder(tree)
    sockets = {name: build.inputs.outputs[name] for name in (*GEOMETRY, *SURFACE_INPUTS)}
    shown = build.node("GeometryNodeGroup", properties={"node_tree": ensure_surface_tree()}, **sockets).outputs[0]
    frame = _output(build.tree.nodes.new("GeometryNodeInputSceneTime"), "Frame")
    then = build.node("FunctionNodeCompare", properties={"data_type": "FLOAT", "operation": "EQUAL"}, A=frame)
    build.put(_input(then, "B"), build.inputs.outputs[FRAME_INPUT])
    _input(then, "Epsilon").default_value = 1e-3
    build.returns(Geometry=build.switch(then.outputs[0], shown, build.inputs.outputs["Geometry"]))
    return tree


def _ensure_boolean_tree(operation: str) -> bpy.types.NodeTree:
    """Return the group that unites two closed meshes, or takes the second from the first.

    Builds of Blender without the Manifold library leave the first as it is: a small cube tells, and the exact solver, which
    takes five times as long, does the work.
    """
    name = f"{BOOLEAN_GROUP} {operation.title()}"
    tree = _find_tree(name)
    if tree is not None:
        return tree
    inputs = dict.fromkeys(("First", "Second"), "NodeSocketGeometry")
    tree = _new_tree(name, inputs, GEOMETRY, "Two closed meshes as one, or the first without the second")
    build = _Builder(tree)
    cube = build.node("GeometryNodeMeshCube").outputs["Mesh"]
    moved = build.node("GeometryNodeTransform", Geometry=cube, Translation=(0.5, 0.5, 0.5)).outputs[0]
    faces = build.face_count(build.solved("DIFFERENCE", "MANIFOLD", cube, moved))
    bodies = [build.inputs.outputs[name] for name in inputs]
    quick, exact = (build.solved(operation, solver, *bodies) for solver in ("MANIFOLD", "EXACT"))
    build.returns(Geometry=build.switch(build.compare(faces, "GREATER_THAN", CUBE_FACES), exact, quick))
    return tree


def ensure_part_tree() -> bpy.types.NodeTree:
    """Return the group by which an object holds the faces of some media of the cut, from one number to before another."""
    tree = _find_tree(PART_GROUP)
    if tree is not None:
        return tree
    inputs = {CUT_INPUT: "NodeSocketObject", BODY_INPUT: "NodeSocketInt", END_INPUT: "NodeSocketInt"}
    tree = _new_tree(PART_GROUP, inputs, GEOMETRY, "Surfaces of some media, cut where they cross")
    tree.is_modifier = True
    build = _Builder(tree)
    build.returns(
        Geometry=_picked(
            build, _cut_by(build), _is_among(build, *(build.inputs.outputs[name] for name in (BODY_INPUT, END_INPUT)))
        )
    )
    return tree


def _cut_by(build: _Builder) -> bpy.types.Node:
    """What the object that cuts shows, seen from this one's space."""
    return build.node(
        "GeometryNodeObjectInfo", properties={"transform_space": "RELATIVE"}, Object=build.inputs.outputs[CUT_INPUT]
    )


def _picked(build: _Builder, cut: bpy.types.Node, selection) -> bpy.types.NodeSocket:
    node = build.node(
        "GeometryNodeSeparateGeometry", properties={"domain": "INSTANCE"}, Geometry=cut.outputs["Geometry"]
    )
    build.put(node.inputs["Selection"], selection)
    return node.outputs["Selection"]


def _is_among(build: _Builder, first, end) -> bpy.types.NodeSocket:
    """Whether the number of a body is one from the first to before the end."""
    number = build.attribute(BODY, "INT")
    return build.all_of((build.compare(number, "GREATER_EQUAL", first), build.compare(number, "LESS_THAN", end)))


def _with_normals(build: _Builder, geometry, cut: bpy.types.Node) -> bpy.types.NodeSocket:
    """A mesh shaded as before it was cut: new corners would have normals of their own."""
    matrix = build.node("FunctionNodeInvertMatrix", Matrix=cut.outputs["Transform"]).outputs[0]
    normal = build.node(
        "FunctionNodeTransformDirection",
        Direction=build.attribute(NORMAL, "FLOAT_VECTOR"),
        Transform=build.node("FunctionNodeTransposeMatrix", Matrix=matrix).outputs[0],
    )
    shaded = build.node("GeometryNodeSetMeshNormal", properties={"mode": "FREE", "domain": "CORNER"}, Mesh=geometry)
    build.put(_input(shaded, "Custom Normal"), normal.outputs[0])
    return shaded.outputs[0]


def _mesh_of(build: _Builder, obj) -> bpy.types.NodeSocket:
    """What another object shows, seen from this one's space."""
    info = build.node("GeometryNodeObjectInfo", properties={"transform_space": "RELATIVE"}, Object=obj)
    mesh = build.node("GeometryNodeRealizeInstances", Geometry=info.outputs["Geometry"]).outputs[0]
    return _as_outside_in(build, info, mesh)


def _as_outside_in(build: _Builder, info: bpy.types.Node, mesh) -> bpy.types.NodeSocket:
    """A mesh whose faces look outwards as they did in the other object's space: mirroring turns them."""
    determinant = build.node("FunctionNodeMatrixDeterminant", Matrix=info.outputs["Transform"]).outputs[0]
    return build.switch(build.compare(determinant, "LESS_THAN", 0.0, "FLOAT"), mesh, build.flipped(mesh))


def _ensure_body_tree(attributes: tuple[str, ...]) -> bpy.types.NodeTree:
    """The group that reads one medium: its faces with its number and normals, and whether it is closed.

    :param attributes: of points, which the solver leaves at 0 where it makes new ones; those of corners are interpolated.
    """
    marked = list(attributes) or [""]
    for tree in bpy.data.node_groups:
        if tree.library is None and ATTRIBUTES in tree and list(tree[ATTRIBUTES]) == marked:
            return tree
    tree = _new_tree(
        BODY_GROUP,
        {OWN_INPUT: "NodeSocketObject", BODY_INPUT: "NodeSocketInt"},
        GEOMETRY | {"Closed": "NodeSocketBool"},
        "A medium that is to be cut",
    )
    tree[ATTRIBUTES] = marked
    build = _Builder(tree)
    mesh = _mesh_of(build, build.inputs.outputs[OWN_INPUT])
    for name in attributes:
        mesh = _by_corner(build, mesh, name)
    smooth = build.count(mesh, "FACE", build.tree.nodes.new("GeometryNodeInputShadeSmooth").outputs[0])
    normal = build.tree.nodes.new("GeometryNodeInputNormal").outputs["Normal"]
    with_normals = build.stored(mesh, NORMAL, normal, "FLOAT_VECTOR", "CORNER")
    mesh = build.switch(build.compare(smooth, "GREATER_THAN", 0.5, "FLOAT"), mesh, with_normals)
    neighbours = build.tree.nodes.new("GeometryNodeInputMeshEdgeNeighbors").outputs[0]
    loose = build.count(mesh, "EDGE", build.compare(neighbours, "NOT_EQUAL", 2))
    build.returns(
        Geometry=build.stored(mesh, BODY, build.inputs.outputs[BODY_INPUT], "INT"),
        Closed=build.compare(loose, "LESS_THAN", 0.5, "FLOAT"),
    )
    return tree


def _by_corner(build: _Builder, mesh, name: str) -> bpy.types.NodeSocket:
    """A mesh with an attribute at its corners in place of its points, as a colour."""
    capture = build.node("GeometryNodeCaptureAttribute", properties={"domain": "CORNER"}, Geometry=mesh)
    capture.capture_items.new("RGBA", name)
    build.put(capture.inputs[name], build.attribute(name, "FLOAT_COLOR"))
    removed = build.node("GeometryNodeRemoveAttribute", Geometry=capture.outputs["Geometry"], Name=name).outputs[0]
    return build.stored(removed, name, capture.outputs[name], "FLOAT_COLOR", "CORNER")


def _bodies_tree(plan: Plan, bodies: Sequence[tuple[bpy.types.Object, int]], overlapping: bool) -> bpy.types.NodeTree:
    """A group that reads some media, as one body where they overlap."""
    tree = _new_tree(f"{BODY_GROUP}s", {}, GEOMETRY | {"Closed": "NodeSocketBool"}, "Media that are to be cut")
    build = _Builder(tree)
    read = [_body(build, plan, obj, number) for obj, number in bodies]
    geometries = [geometry for geometry, _ in read]
    build.returns(
        Geometry=_united_where_they_meet(build, geometries) if overlapping else build.joined(geometries),
        Closed=build.all_of([closed for _, closed in read]),
    )
    return tree


def _body(
    build: _Builder, plan: Plan, obj: bpy.types.Object, number: int
) -> tuple[bpy.types.NodeSocket, bpy.types.NodeSocket]:
    node = build.node("GeometryNodeGroup", properties={"node_tree": _ensure_body_tree(plan.attributes.get(obj, ()))})
    node.inputs[OWN_INPUT].default_value = obj
    node.inputs[BODY_INPUT].default_value = number
    return node.outputs["Geometry"], node.outputs["Closed"]


def _read(
    build: _Builder, plan: Plan, bodies: Sequence[tuple[bpy.types.Object, int]], overlapping: bool = False
) -> tuple[list[bpy.types.NodeSocket], list[bpy.types.NodeSocket]]:
    """Geometries of media, many of them in one, and whether these are closed."""
    if len(bodies) <= CHUNK:
        pairs = [_body(build, plan, *body) for body in bodies]
    else:
        trees = [
            _bodies_tree(plan, bodies[start : start + CHUNK], overlapping) for start in range(0, len(bodies), CHUNK)
        ]
        nodes = [build.node("GeometryNodeGroup", properties={"node_tree": tree}) for tree in trees]
        pairs = [(node.outputs["Geometry"], node.outputs["Closed"]) for node in nodes]
    return [geometry for geometry, _ in pairs], [closed for _, closed in pairs]


def value_name(name: str, place: int) -> str:
    """Return the name of the input that brings a layer's value."""
    return f"{name} {place}"


def told_layers(plan: Plan) -> set[int]:
    """Return the places of the layers that something may lie in."""
    return {weaker for _, weaker in plan.pairs} | {
        around for layer in plan.layers for _, around in layer.constant if around not in (None, HIDDEN)
    }


def values_of(layer: Layer) -> tuple[str, ...]:
    """Return the names of the values that a face in a layer carries."""
    return tuple(VALUES) if layer.tells_more else ("IOR",)


def make_cut_tree(plan: Plan) -> bpy.types.NodeTree:
    """Make the group that cuts: instances, one a medium, with its number and its faces."""
    inputs = {
        value_name(name, place): VALUES[name]
        for place in sorted(told_layers(plan))
        for name in values_of(plan.layers[place])
    }
    tree = _new_tree(CUT_GROUP, inputs, GEOMETRY, "Surfaces of media, cut where they cross")
    tree.is_modifier = True
    build = _Builder(tree)
    numbers = plan.numbers()
    whole: list[bpy.types.NodeSocket] = []
    closed: list[bpy.types.NodeSocket] = []
    pieces: list[bpy.types.NodeSocket] = []
    layers: dict[int, bpy.types.NodeSocket] = {}
    for place, layer in enumerate(plan.layers):
        if layer.crossing:
            geometries, sound = _read(build, plan, [(obj, numbers[obj]) for obj in layer.crossing], layer.overlapping)
            closed += sound
            whole += geometries
            layers[place] = (
                _united_where_they_meet(build, geometries) if layer.overlapping else build.joined(geometries)
            )
        for around in sorted({around for _, around in layer.constant}, key=str):
            alike = [(obj, numbers[obj]) for obj, other in layer.constant if other == around]
            geometries, sound = _read(build, plan, alike)
            closed += sound
            whole += geometries
            pieces.append(_told(build, plan, build.joined(geometries), around))
    if layers:
        pieces += _cut(build, plan, layers, numbers)
    cut = build.joined(pieces)
    raw = build.joined(whole)
    shown = build.switch(_is_sound(build, closed, cut, raw), raw, cut)
    split = build.node("GeometryNodeSplitToInstances", properties={"domain": "FACE"})
    build.put(split.inputs[0], shown)
    build.put(split.inputs["Group ID"], build.attribute(BODY, "INT"))
    instances = build.stored(split.outputs["Instances"], BODY, split.outputs["Group ID"], "INT", "INSTANCE")
    build.returns(Geometry=instances)
    return tree


def _is_sound(build: _Builder, closed: Sequence[bpy.types.NodeSocket], cut, raw) -> bpy.types.NodeSocket:
    """Whether everything was closed, and the solver has returned something of it; else all media ask."""

    some = build.compare(build.face_count(cut), "GREATER_THAN", 0)
    none = build.compare(build.face_count(raw), "EQUAL", 0)
    return build.all_of([*closed, build.all_of((some, none), "OR")])


def _united_where_they_meet(build: _Builder, geometries: Sequence[bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
    """Media of one layer, which are one body where they overlap."""
    geometries = list(geometries)
    while len(geometries) > 1:
        pairs = list(zip(geometries[::2], geometries[1::2]))
        rest = geometries[len(pairs) * 2 :]
        geometries = [
            build.switch(
                build.meet(build.box(first), build.box(second)),
                build.joined([first, second]),
                build.united(first, second),
            )
            for first, second in pairs
        ] + rest
    return geometries[0]


def _cut(
    build: _Builder, plan: Plan, layers: dict[int, bpy.types.NodeSocket], numbers: dict[bpy.types.Object, int]
) -> list[bpy.types.NodeSocket]:
    """Faces of the layers that cross, each with what lies outside it."""
    boxes = {place: build.box(geometry) for place, geometry in layers.items()} if plan.may_part else {}
    pieces = []
    winners = None
    for place, geometry in layers.items():
        stronger = [other for other in layers if (other, place) in plan.pairs]
        if not stronger:
            winners = geometry if winners is None else build.joined([winners, geometry])
            continue
        first = numbers[plan.layers[place].bodies[0]]
        end = first + len(plan.layers[place].bodies)
        left = build.less(geometry, winners)
        found = [_told(build, plan, build.flipped(build.numbered(left, 0, first)), place)]
        is_last = place == max(layers)
        cut = build.less(winners, geometry) if is_last or plan.layers[place].keeps_hidden else None
        if plan.layers[place].keeps_hidden:
            found.append(_told(build, plan, build.flipped(build.numbered(cut, first, end)), HIDDEN))
        # What wins over nothing needs no union: the solver's time goes by what it returns.
        union = (
            build.joined([build.numbered(left, first, end), build.numbered(cut, 0, first)])
            if is_last
            else build.united(winners, geometry)
        )
        found = build.joined(found)
        if plan.may_part:
            meets = build.all_of([build.meet(boxes[other], boxes[place]) for other in stronger], "OR")
            found = build.switch(meets, None, found)
            union = build.switch(meets, build.joined([winners, geometry]), union)
        pieces.append(found)
        winners = union
    return pieces + [_told(build, plan, winners, None)]


def _told(build: _Builder, plan: Plan, geometry, around: int | None) -> bpy.types.NodeSocket:
    """Faces that carry what lies outside them."""
    if around is None or around == HIDDEN:
        return build.stored(geometry, CUT, AIR_INDEX if around is None else HIDDEN_INDEX, "FLOAT")
    layer = plan.layers[around]
    inputs = {name: build.inputs.outputs[value_name(name, around)] for name in values_of(layer)}
    index = build.switch(build.compare(inputs["IOR"], "EQUAL", AIR_INDEX, "FLOAT"), inputs["IOR"], LIKE_AIR, "FLOAT")
    if layer.tells_more:
        negative = build.node("ShaderNodeMath", properties={"operation": "MULTIPLY"})
        build.put(negative.inputs[0], index)
        negative.inputs[1].default_value = -1.0
        index = negative.outputs[0]
    geometry = build.stored(geometry, CUT, index, "FLOAT")
    geometry = build.stored(geometry, CUT_PRIORITY, float(layer.priority), "FLOAT")
    if not layer.tells_more:
        return geometry
    geometry = build.stored(geometry, CUT_TINT, inputs["Transmittance"], "FLOAT_COLOR")
    geometry = build.stored(geometry, CUT_DEPTH, inputs["Transmittance Depth"], "FLOAT")
    geometry = build.stored(geometry, CUT_BY_VOLUME, inputs[BY_VOLUME_SOCKET], "FLOAT")
    curve = build.node("ShaderNodeCombineXYZ", X=_model(build, inputs), Y=inputs["Abbe"], Z=inputs["Dispersion"])
    geometry = build.stored(geometry, CUT_CURVE, curve.outputs[0], "FLOAT_VECTOR")
    geometry = build.stored(geometry, CUT_SELLMEIER_B, inputs["Sellmeier B"], "FLOAT_VECTOR")
    return build.stored(geometry, CUT_SELLMEIER_C, inputs["Sellmeier C"], "FLOAT_VECTOR")


def _model(build: _Builder, inputs: dict[str, bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
    """The number of the dispersion's model, more by how many there are where the medium splits light itself."""
    node = build.node("ShaderNodeMath", properties={"operation": "MULTIPLY_ADD"})
    build.put(node.inputs[0], inputs["Disperse"])
    node.inputs[1].default_value = float(len(DISPERSION_MODELS))
    build.put(node.inputs[2], inputs["Dispersion Model"])
    return node.outputs[0]
