"""Nodes that groups of shaders are made of, and arithmetic on their sockets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import e

import bpy

from ..model.parameters import LARGEST

Socket = bpy.types.NodeSocket


def math_node(tree: bpy.types.NodeTree, operation: str, *operands: Socket | float) -> Socket:
    """The result of a Math node on sockets and numbers."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, operand in zip(node.inputs, operands):
        plug(tree, operand, socket)
    return node.outputs[0]


def vector_math(tree: bpy.types.NodeTree, operation: str, *operands: Socket | Sequence[float] | float) -> Socket:
    """The result of a Vector Math node; a number where that is one."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    for socket, operand in zip((socket for socket in node.inputs if socket.enabled), operands):
        plug(tree, operand, socket)
    return next(socket for socket in node.outputs if socket.enabled)


def plug(tree: bpy.types.NodeTree, source: Socket | Sequence[float] | float, socket: Socket) -> None:
    """Link a socket into another, or give that one a value."""
    if isinstance(source, bpy.types.NodeSocket):
        tree.links.new(source, socket)
    else:
        socket.default_value = source


def bounded(
    tree: bpy.types.NodeTree,
    source: Socket,
    number: Socket,
    limits: tuple[float, float, float],
) -> Socket:
    """A number within limits, or where `number` is none the default, as osl/bounds.h has it.

    Minimum and Maximum whose first operand is a constant return it for NaN; no other node tells NaN reliably.
    """
    math = partial(math_node, tree)
    low, high, default = map(float, limits)
    usable = math("LESS_THAN", math("ABSOLUTE", math("MAXIMUM", -LARGEST, number)), LARGEST)
    within = math("MINIMUM", high, math("MAXIMUM", low, source))
    return math("ADD", math("MULTIPLY", within, usable), math("MULTIPLY", default, math("SUBTRACT", 1.0, usable)))


def mix_shaders(tree: bpy.types.NodeTree, factor: Socket, first: Socket | None, second: Socket | None) -> Socket:
    """What a Mix Shader shows: the first shader where nothing drives its factor."""
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.0
    for source, socket in zip((factor, first, second), mix.inputs):
        if source is not None:
            tree.links.new(source, socket)
    return mix.outputs[0]


def mix_values(
    tree: bpy.types.NodeTree, kind: str, factor: Socket, first: Socket | float, second: Socket | float
) -> Socket:
    """The first of two values of a kind (FLOAT, VECTOR or RGBA) where a factor is 0, the second where it is 1."""
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = kind
    mix.clamp_factor = False
    factors, *values = (socket for socket in mix.inputs if socket.enabled)
    factors.default_value = 0.0
    for source, socket in zip((factor, first, second), (factors, *values)):
        plug(tree, source, socket)
    return next(socket for socket in mix.outputs if socket.enabled)


def attribute(tree: bpy.types.NodeTree, kind: str, name: str) -> bpy.types.ShaderNodeAttribute:
    """An Attribute node: of GEOMETRY, an OBJECT or the VIEW_LAYER. What is not there reads 0, its alpha, too."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_type = kind
    node.attribute_name = name
    return node


def view_layer_attribute(tree: bpy.types.NodeTree, path: str) -> bpy.types.ShaderNodeAttribute:
    """A property of the scene that is rendered; a constant to Cycles, which leaves out what it makes needless."""
    return attribute(tree, "VIEW_LAYER", path)


def lazily(
    tree: bpy.types.NodeTree,
    kind: str,
    condition: Socket,
    otherwise: Socket | Sequence[float] | float | None,
    chosen: Socket | Sequence[float] | float | None,
) -> Socket:
    """`chosen` where a condition is 1, else `otherwise`: values of a kind (FLOAT, INT, VECTOR, RGBA or SHADER).

    A Repeat Zone of one iteration or none. Blender follows only the way that counts when it hands nodes to an engine, so the
    other costs nothing. The condition has to follow from unlinked sockets, else it is taken for 0.
    """
    start = tree.nodes.new("GeometryNodeRepeatInput")
    end = tree.nodes.new("GeometryNodeRepeatOutput")
    start.pair_with_output(end)
    end.repeat_items.clear()
    end.repeat_items.new(kind, "Value")
    tree.links.new(condition, start.inputs[0])
    for source, socket in ((otherwise, start.inputs[1]), (chosen, end.inputs[0])):
        if source is not None:
            plug(tree, source, socket)
    return end.outputs[0]


@dataclass(frozen=True)
class Number:
    """A number in a node tree, whose arithmetic makes Math nodes."""

    tree: bpy.types.NodeTree
    socket: Socket

    def math(self, operation: str, *others: Number | float, first: bool = False) -> Number:
        """The result of a Math node of which this is the first operand; or with `first`, the last."""
        return self._of(operation, *others, self) if first else self._of(operation, self, *others)

    def _of(self, operation: str, *operands: Number | float) -> Number:
        sockets = (each.socket if isinstance(each, Number) else float(each) for each in operands)
        return Number(self.tree, math_node(self.tree, operation, *sockets))

    def __add__(self, other: Number | float) -> Number:
        return self.math("ADD", other)

    def __sub__(self, other: Number | float) -> Number:
        return self.math("SUBTRACT", other)

    def __mul__(self, other: Number | float) -> Number:
        return self.math("MULTIPLY", other)

    def __truediv__(self, other: Number | float) -> Number:
        return self.math("DIVIDE", other)

    def __radd__(self, other: float) -> Number:
        return self._of("ADD", other, self)

    def __rsub__(self, other: float) -> Number:
        return self._of("SUBTRACT", other, self)

    def __rmul__(self, other: float) -> Number:
        return self._of("MULTIPLY", other, self)

    def __rtruediv__(self, other: float) -> Number:
        return self._of("DIVIDE", other, self)

    def __gt__(self, other: Number | float) -> Number:
        return self.math("GREATER_THAN", other)

    def __lt__(self, other: Number | float) -> Number:
        return self.math("LESS_THAN", other)

    def __abs__(self) -> Number:
        return self.math("ABSOLUTE")

    def equals(self, other: Number | float) -> Number:
        """1 for the same whole number, else 0."""
        return self.math("COMPARE", other, 0.5)


SOCKET_TYPES = {
    "INT": "NodeSocketInt",
    "FLOAT": "NodeSocketFloat",
    "BOOL": "NodeSocketBool",
    "COLOR": "NodeSocketColor",
    "RGBA": "NodeSocketColor",
    "VECTOR": "NodeSocketVector",
    "MENU": "NodeSocketMenu",
    "INDEX": "NodeSocketInt",
    "SHADER": "NodeSocketShader",
}
"""By the kinds of parameters and of nodes."""


class Part:
    """A group of nodes within another one, whose inputs are made where they are first asked for.

    Small trees are built far faster than large ones: Blender looks at all of a tree after each link.
    """

    def __init__(self, name: str, kinds: Mapping[str, str]) -> None:
        """Begin a group; :param kinds: kinds of all that it may ask for, by name. Its leading dot hides it from menus."""
        self.tree = bpy.data.node_groups.new(f".{name}", "ShaderNodeTree")
        self.kinds = kinds
        self.start = self.tree.nodes.new("NodeGroupInput")
        self.end = self.tree.nodes.new("NodeGroupOutput")
        self.known: dict[str, Socket] = {}
        self.asked: list[str] = []
        self.vector = partial(vector_math, self.tree)
        self.node = self.tree.nodes.new

    def socket(self, name: str) -> Socket:
        """What a name stands for in this group: one of its inputs, or what was defined here."""
        if name not in self.known:
            self.tree.interface.new_socket(name, in_out="INPUT", socket_type=SOCKET_TYPES[self.kinds[name]])
            self.asked.append(name)
            self.known[name] = self.start.outputs[name]
        return self.known[name]

    def raw(self, name: str) -> Number:
        """A number of that name as it is."""
        return Number(self.tree, self.socket(name))

    def define(self, name: str, value: Number | Socket) -> None:
        """Give a name a meaning, for this group and those within it."""
        self.known[name] = value.socket if isinstance(value, Number) else value

    def give(self, name: str, kind: str, value: Number | Socket) -> None:
        """Make an output."""
        self.tree.interface.new_socket(name, in_out="OUTPUT", socket_type=SOCKET_TYPES[kind])
        self.tree.links.new(value.socket if isinstance(value, Number) else value, self.end.inputs[name])

    def call(self, part: Part, **given: Number | Socket | float) -> dict[str, Socket]:
        """Use another group within this one; what is not given means here what it means there. Returns its outputs."""
        node = self.node("ShaderNodeGroup")
        node.node_tree = part.tree
        for name in part.asked:
            value = given[name] if name in given else self.socket(name)
            plug(self.tree, value.socket if isinstance(value, Number) else value, node.inputs[name])
        return dict(zip((socket.name for socket in node.outputs), node.outputs))

    def mix(self, factor: Number, first: Socket | None, second: Socket | None) -> Socket:
        """One of two shaders, or both."""
        return mix_shaders(self.tree, factor.socket, first, second)

    def add(self, first: Socket | None, second: Socket | None) -> Socket:
        """The sum of two shaders."""
        node = self.node("ShaderNodeAddShader")
        for source, socket in zip((first, second), node.inputs):
            if source is not None:
                self.tree.links.new(source, socket)
        return node.outputs[0]

    def choose(self, condition: Number, otherwise: Number | float, chosen: Number | float) -> Number:
        """One of two numbers, as a condition has it that may differ from hit to hit."""
        values = (each.socket if isinstance(each, Number) else each for each in (otherwise, chosen))
        return Number(self.tree, mix_values(self.tree, "FLOAT", condition.socket, *values))

    def choose_vector(self, condition: Number, otherwise: Socket, chosen: Socket) -> Socket:
        """One of two vectors."""
        return mix_values(self.tree, "VECTOR", condition.socket, otherwise, chosen)

    def surely(self, condition: Number) -> Number:
        """1 where a condition holds and follows from unlinked sockets."""
        return Number(self.tree, lazily(self.tree, "INT", condition.socket, 0, 1))

    def where(self, condition: Number, otherwise: Number | float, chosen: Number | float) -> Number:
        """One of two numbers, of which the other is left out; see :func:`lazily`."""
        values = (each.socket if isinstance(each, Number) else each for each in (otherwise, chosen))
        return Number(self.tree, lazily(self.tree, "FLOAT", condition.socket, *values))

    def split(self, value: Socket, names: Sequence[str] = ("x", "y", "z"), node: str = "XYZ") -> dict[str, Number]:
        """The components of a vector, or of a colour."""
        separate = self.node(f"ShaderNodeSeparate{node}")
        self.tree.links.new(value, separate.inputs[0])
        return {name: Number(self.tree, socket) for name, socket in zip(names, separate.outputs)}

    def join(self, components: Sequence[Number | float]) -> Socket:
        """A vector of three numbers."""
        combine = self.node("ShaderNodeCombineXYZ")
        for component, socket in zip(components, combine.inputs):
            plug(self.tree, component.socket if isinstance(component, Number) else component, socket)
        return combine.outputs[0]

    def dot(self, first: Socket, second: Socket) -> Number:
        """The dot product of two vectors."""
        return Number(self.tree, self.vector("DOT_PRODUCT", first, second))

    def length(self, vector: Socket) -> Number:
        """The length of a vector."""
        return Number(self.tree, self.vector("LENGTH", vector))

    def scaled(self, vector: Socket, factor: Number | float) -> Socket:
        """A vector times a number."""
        return self.vector("SCALE", vector, factor.socket if isinstance(factor, Number) else factor)

    def exponential(self, exponents: Socket) -> Socket:
        """e to the power of each component."""
        return self.vector("POWER", (e, e, e), exponents)
