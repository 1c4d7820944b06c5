"""The base of all parts of the native body."""

from __future__ import annotations

from functools import cached_property

from ...model.contract import Exterior
from ...model.parameters import BY_NAME, PARAMETERS
from ..names import NATIVE_GROUP
from ..numbers import Number
from ..parts import Part
from ..shader_nodes import Socket, attribute, lazily, plug

KINDS = {parameter.name: "INT" if parameter.kind == "MENU" else parameter.kind for parameter in PARAMETERS} | {
    "Outside": "INT",
    "Foreign Objects": "BOOL",
    "Surroundings": "VECTOR",
    "Surroundings Transmittance": "COLOR",
    "Scene": "FLOAT",
    "Holds": "FLOAT",
    "By Volume": "FLOAT",
    "Cut": "FLOAT",
    "Face": "FLOAT",
    "In Air": "FLOAT",
    "Outer IOR": "FLOAT",
    "Outer Coefficients": "VECTOR",
    "Own IOR": "FLOAT",
    "Own Coefficients": "VECTOR",
    "Ratio": "FLOAT",
    "Film IOR": "FLOAT",
    "Light": "VECTOR",
    "Depth": "FLOAT",
    "Curve": "VECTOR",
    "Axis": "VECTOR",
    "Along": "VECTOR",
    "Alpha": "FLOAT",
    "Stretch": "FLOAT",
    "Reflected": "FLOAT",
    "Refracted": "FLOAT",
    "Shown Roughness": "FLOAT",
    "Debug View": "FLOAT",
    "Known": "FLOAT",
    "Exists": "FLOAT",
    "Told": "FLOAT",
    "Priority Inside": "FLOAT",
    "Priority Outside": "FLOAT",
}
"""Kinds of the parts' inputs: parameters, of menus the places of their choices; stored facts; results of parts.

Scene is the number of the scene whose analysis holds; Holds whether the material's facts are of it; By Volume whether its
volume absorbs for all rays; Cut whether the scene shows cut surfaces, and what their faces store.
"""


class NativePart(Part):
    """A part of the native body, named by what it finds."""

    NAME = ""

    def __init__(self) -> None:
        super().__init__(f"{NATIVE_GROUP} {self.NAME}".rstrip(), KINDS)
        self._numbers: dict[str, Number] = {}
        self.build()

    def build(self) -> None:
        """Add the nodes and outputs of the part."""
        raise NotImplementedError

    def number(self, name: str) -> Number:
        """Return a parameter within its limits; what is no number counts as the lower one."""
        if name not in self._numbers:
            low, high, _ = BY_NAME[name].limits
            least = self.raw(name).math("MAXIMUM", low, last=True)
            self._numbers[name] = least.math("MINIMUM", high, last=True)
        return self._numbers[name]

    def menu(self, name: str, kind: str, values: dict[str, Socket | float]) -> Socket:
        """Return the value that a menu chooses of these by the keywords of its items; the others are left out."""
        first, *others = (values[choice.keyword] for choice in BY_NAME[name].choices)
        chosen = first
        for index, value in enumerate(others, 1):
            chosen = lazily(self.tree, kind, self.raw(name).equals(index).socket, chosen, value)
        return chosen

    def bsdf(self, kind: str, distribution: str, values: dict[str, Socket | Number | float]) -> Socket:
        """Add a BSDF node; leave out values that it has no input for."""
        node = self.node(f"ShaderNodeBsdf{kind}")
        node.distribution = distribution
        for name, value in values.items():
            if name in node.inputs:
                plug(self.tree, value.socket if isinstance(value, Number) else value, node.inputs[name])
        return node.outputs[0]

    def attribute_number(self, kind: str, name: str) -> Number:
        """Return an attribute's value: of GEOMETRY or an OBJECT. What is not there reads 0."""
        return Number(self.tree, attribute(self.tree, kind, name).outputs["Fac"])

    @cached_property
    def path(self) -> dict[str, Number]:
        """Outputs of the node Light Path, by name."""
        node = self.node("ShaderNodeLightPath")
        return {socket.name: Number(self.tree, socket) for socket in node.outputs}

    @cached_property
    def geometry(self) -> dict[str, Socket]:
        """Outputs of the node Geometry, by name."""
        return {socket.name: socket for socket in self.node("ShaderNodeNewGeometry").outputs}

    @cached_property
    def backfacing(self) -> Number:
        """1 where the ray meets the surface from inside."""
        return Number(self.tree, self.geometry["Backfacing"])

    @cached_property
    def is_manifold_walk(self) -> Number:
        """1 for Cycles' manifold walks (MNEE): no other ray is diffuse without having been reflected or let through."""
        scattered = self.path["Is Reflection Ray"].math("MAXIMUM", self.path["Is Transmission Ray"])
        return self.path["Is Diffuse Ray"] * (1.0 - scattered.math("MAXIMUM", self.path["Is Shadow Ray"]))

    @cached_property
    def is_caustic(self) -> Number:
        """1 where the path goes to a diffuse surface's light."""
        return (self.path["Diffuse Depth"] > 0.5) * (1.0 - self.is_manifold_walk)

    @cached_property
    def is_surrounded_by_air(self) -> Number:
        """1 where the analysis has found air around all objects of the material."""
        return self.raw("Outside").equals(Exterior.AIR)

    @cached_property
    def is_entrance(self) -> Number:
        """1 where the ray comes from air."""
        return self.raw("In Air") * (1.0 - self.backfacing)

    @cached_property
    def is_exit(self) -> Number:
        """1 where the ray goes into air."""
        return self.raw("In Air") * self.backfacing

    def fresnel(self, normal: bool) -> Number:
        """Return the reflectance of a smooth surface (Fresnel 1823), with the artist's normal or without."""
        node = self.node("ShaderNodeFresnel")
        self.tree.links.new(self.socket("Ratio"), node.inputs["IOR"])
        if normal:
            self.tree.links.new(self.socket("Normal"), node.inputs["Normal"])
        return Number(self.tree, node.outputs[0])

    def across(self, vector: Socket, direction: Socket) -> Socket:
        """Return the part of a vector that is perpendicular to a unit vector."""
        return self.vector("SUBTRACT", vector, self.scaled(direction, self.dot(vector, direction)))

    def to_world(self, kind: str, source: str, vector: Socket | tuple[float, float, float]) -> Socket:
        """Return a VECTOR or POINT of the space of an OBJECT or the CAMERA in world space."""
        node = self.node("ShaderNodeVectorTransform")
        node.vector_type, node.convert_from, node.convert_to = kind, source, "WORLD"
        plug(self.tree, vector, node.inputs["Vector"])
        return node.outputs[0]

    @cached_property
    def shading_normal(self) -> Socket:
        """The artist's normal, or the surface's."""
        given = self.socket("Normal")
        return self.choose_vector(self.length(given) > 0.0, self.geometry["Normal"], self.vector("NORMALIZE", given))

    @cached_property
    def eta(self) -> Number:
        """The ratio of indices from the ray's side to the other."""
        return self.choose(self.backfacing, self.raw("Ratio"), 1.0 / self.raw("Ratio"))

    @cached_property
    def ray_direction(self) -> Socket:
        """The way that the ray goes, of length 1."""
        return self.scaled(self.geometry["Incoming"], -1.0)

    @cached_property
    def refracted_direction(self) -> Socket:
        """The way that the refracted ray goes; zero where all is reflected."""
        return self.vector("REFRACT", self.ray_direction, self.shading_normal, (1.0 / self.eta).socket)
