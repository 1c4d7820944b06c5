"""The dielectric in Cycles' own nodes: the second body of the group `Nested Dielectric`, for all devices.

It traces no rays to find out what lies outside a surface: an analysis of the scene has told it, or the faces themselves do
where surfaces are cut. Then a surface is Cycles' own Glass with the ratio of both indices. What nobody tells shows the alarm.

Whatever a material does not use is left out before an engine sees it (:func:`~nested_dielectric.shader_nodes.lazily`). Names are
those of osl/nested_dielectric.osl, which does the same.
"""

from __future__ import annotations

from functools import cached_property
from math import e

import bpy

from ..geometry.contacts import AIR, BY_OBJECT, MEDIUM, NEVER, PROBE
from ..model.dispersion import LINE_C, LINE_D, LINE_F, jf_ior
from ..model.parameters import BY_NAME, DISPERSION_MODELS, PARAMETERS, UNLIMITED_REFLECTIONS
from .compatibility import NATIVE_DISPERSION_VERSION
from .shader_nodes import Number, Part, Socket, attribute, lazily, mix_values, plug, view_layer_attribute

NATIVE_GROUP = "Nested Dielectric Native"

CENTRE = "nd_centre"
"""Custom property of a scene: a point amid its media, from which shadow rays measure how far they go through them. Where there
is none volumes absorb of them.
"""

CUT_HIDDEN = 1e6
CUT_SPLITS = 3.0
"""As in osl/cut.h."""

_INDICES = 5000.0, 4999.995
"""Middle and half of a range of numbers that faces with an index tell, and none with nothing to tell or hidden ones."""

TELLS_COLOUR, TELLS_DISPERSION = 2.0, 3.0
"""What a scene's property of cut surfaces is from where faces tell the colour of media outside, and how they disperse."""

INDEX_MATCHED = 2e-5
"""As in osl/lobes.h."""

BLACK_COEFFICIENT = 1e4
"""Of a colour of which nothing is left after Transmittance Depth, times that depth."""

LARGEST_EXPONENT = 60.0
"""Of what a shadow ray is given back; single precision holds a little more."""

FAR = 1e30

_F_REACH, _C_REACH = ((line**-2 - LINE_D**-2) / (LINE_F**-2 - LINE_C**-2) for line in (LINE_F, LINE_C))
"""How far an index at these lines is from that at the d line, in its spread between them, by Cauchy's two terms (1836)."""

_SWITCHES = (
    "Refract Sky",
    "Reflect Sky",
    "Internal Reflections",
    "Caustic Refraction",
    "Caustic Reflection",
    "Caustic Total Reflection",
    "Caustic Internal Reflections",
)
"""Whose being off lets reflection and refraction have different weights."""

_KINDS = {parameter.name: "INT" if parameter.kind == "MENU" else parameter.kind for parameter in PARAMETERS} | {
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
}
"""What the parts below ask for: places of menus' choices, what the analysis tells, and what parts find.

Scene is the number of the scene whose analysis holds; Holds whether the material was told of it; By Volume whether its volume
absorbs for all rays; Cut whether the scene shows cut surfaces, and what their faces tell.
"""


class NativePart(Part):
    """A part of the native body."""

    NAME = ""

    def __init__(self) -> None:
        super().__init__(f"{NATIVE_GROUP} {self.NAME}".rstrip(), _KINDS)
        self._numbers: dict[str, Number] = {}
        self.build()

    def build(self) -> None:
        raise NotImplementedError

    def number(self, name: str) -> Number:
        """A parameter within its limits; what is no number counts as the lower one."""
        if name not in self._numbers:
            low, high, _ = BY_NAME[name].limits
            least = self.raw(name).math("MAXIMUM", low, first=True)
            self._numbers[name] = least.math("MINIMUM", high, first=True)
        return self._numbers[name]

    def menu(self, name: str, kind: str, values: dict[str, Socket | float]) -> Socket:
        """What a menu chooses, by the keywords of its items; the others are left out."""
        first, *others = (values[choice.keyword] for choice in BY_NAME[name].choices)
        chosen = first
        for index, value in enumerate(others, 1):
            chosen = lazily(self.tree, kind, self.raw(name).equals(index).socket, chosen, value)
        return chosen

    def bsdf(self, kind: str, distribution: str, values: dict[str, Socket | Number | float]) -> Socket:
        """A BSDF node."""
        node = self.node(f"ShaderNodeBsdf{kind}")
        node.distribution = distribution
        for name, value in values.items():
            if name in node.inputs:
                plug(self.tree, value.socket if isinstance(value, Number) else value, node.inputs[name])
        return node.outputs[0]

    @cached_property
    def path(self) -> dict[str, Number]:
        node = self.node("ShaderNodeLightPath")
        return {socket.name: Number(self.tree, socket) for socket in node.outputs}

    @cached_property
    def geometry(self) -> dict[str, Socket]:
        return {socket.name: socket for socket in self.node("ShaderNodeNewGeometry").outputs}

    @cached_property
    def backfacing(self) -> Number:
        return Number(self.tree, self.geometry["Backfacing"])

    @cached_property
    def walks(self) -> Number:
        """Cycles' manifold walks: no other ray is diffuse without having been reflected or let through."""
        scattered = self.path["Is Reflection Ray"].math("MAXIMUM", self.path["Is Transmission Ray"])
        return self.path["Is Diffuse Ray"] * (1.0 - scattered.math("MAXIMUM", self.path["Is Shadow Ray"]))

    @cached_property
    def caustic(self) -> Number:
        """Whether the path goes to a diffuse surface's light."""
        return (self.path["Diffuse Depth"] > 0.5) * (1.0 - self.walks)

    @cached_property
    def alone(self) -> Number:
        """The analysis tells all objects of the material that there is air around them."""
        return self.raw("Outside").equals(AIR)

    @cached_property
    def is_entrance(self) -> Number:
        return self.raw("In Air") * (1.0 - self.backfacing)

    @cached_property
    def is_exit(self) -> Number:
        return self.raw("In Air") * self.backfacing

    def fresnel(self, normal: bool) -> Number:
        """Reflectance of a smooth surface (Fresnel 1823), with the artist's normal or without."""
        node = self.node("ShaderNodeFresnel")
        self.tree.links.new(self.socket("Ratio"), node.inputs["IOR"])
        if normal:
            self.tree.links.new(self.socket("Normal"), node.inputs["Normal"])
        return Number(self.tree, node.outputs[0])

    def across(self, vector: Socket, direction: Socket) -> Socket:
        """The part of a vector that is across a unit vector."""
        return self.vector("SUBTRACT", vector, self.scaled(direction, self.dot(vector, direction)))

    def to_world(self, kind: str, source: str, vector: Socket | tuple[float, float, float]) -> Socket:
        node = self.node("ShaderNodeVectorTransform")
        node.vector_type, node.convert_from, node.convert_to = kind, source, "WORLD"
        plug(self.tree, vector, node.inputs["Vector"])
        return node.outputs[0]

    @cached_property
    def bumped(self) -> Socket:
        """The artist's normal, or the surface's."""
        given = self.socket("Normal")
        return self.choose_vector(self.length(given) > 0.0, self.geometry["Normal"], self.vector("NORMALIZE", given))

    @cached_property
    def eta(self) -> Number:
        """The ratio of indices from the ray's side to the other."""
        return self.choose(self.backfacing, self.raw("Ratio"), 1.0 / self.raw("Ratio"))

    @cached_property
    def travelling(self) -> Socket:
        return self.scaled(self.geometry["Incoming"], -1.0)

    @cached_property
    def refracted_way(self) -> Socket:
        """Zero where all is reflected."""
        return self.vector("REFRACT", self.travelling, self.bumped, (1.0 / self.eta).socket)


class Coefficients(NativePart):
    """What a medium absorbs of three colours per length (Beer 1852); nothing without a depth."""

    NAME = "Coefficients"

    def build(self) -> None:
        found = []
        for left in self.split(self.socket("Transmittance"), node="Color").values():
            decay = left.math("MAXIMUM", 1e-38, first=True).math("MINIMUM", 1.0, first=True).math("LOGARITHM", e) * -1.0
            found.append(decay + (left < 1e-37) * BLACK_COEFFICIENT)
        self.give(
            "Coefficients",
            "VECTOR",
            self.scaled(self.join(found), 1.0 / self.raw("Depth").math("MAXIMUM", 0.0, first=True)),
        )


class Surroundings(NativePart):
    """What lies outside the surface, told by the face, by the analysis to all objects of the material, or to this object."""

    NAME = "Surroundings"

    def __init__(self, coefficients: Coefficients) -> None:
        self.coefficients = coefficients
        super().__init__()

    def build(self) -> None:
        self.define("Face", self.face)
        beside = self.surely(1.0 - self.alone)
        told = self.choose(self.face_tells, 1.0 - self.in_medium, self.face.math("COMPARE", 1.0, 1e-7))
        air = self.where(beside, 1.0, told)
        by_analysis = self.choose(self.in_medium, 1.0, self.told("ior").math("MAXIMUM", 0.01))
        ior = self.choose(self.face_tells, by_analysis, abs(self.face).math("MINIMUM", 100.0) + self.face_offset)
        known = (self.outside > AIR - 0.5) * (self.outside < NEVER + 0.5)
        exists = self.choose(self.face_tells, 1.0 - self.outside.equals(NEVER), self.face < 0.5 * CUT_HIDDEN)
        known = self.face_tells.math("MAXIMUM", known)
        by_faces = self.surely(self.raw("Outside").equals(PROBE))
        self.give("Known", "FLOAT", known)
        self.give("Exists", "FLOAT", exists)
        self.give("Shows", "FLOAT", self.where(by_faces, known * exists, abs(self.face).math("COMPARE", *_INDICES)))
        self.give("Face", "FLOAT", self.face)
        self.give("In Air", "FLOAT", air)
        ior = self.where(by_faces, ior, abs(self.face) + self.face_offset)
        self.give("Outer IOR", "FLOAT", self.where(beside, 1.0, ior))
        self.give("Outer Coefficients", "VECTOR", self.outer_coefficients)
        priority = Number(self.tree, attribute(self.tree, "GEOMETRY", "nd_cut_priority").outputs["Fac"])
        outside = self.choose(self.face_tells, self.told("priority"), priority)
        self.give("Priority Outside", "FLOAT", self.choose(air.math("MAXIMUM", 1.0 - exists), outside, -1.0))

    @cached_property
    def by_object(self) -> Number:
        """Each object is told for itself."""
        return self.raw("Outside").equals(BY_OBJECT)

    @cached_property
    def object_told(self) -> dict[str, Number]:
        node = attribute(self.tree, "OBJECT", "nd_outside")
        found = self.split(node.outputs["Color"], ("facts", "priority", "ior"), "Color")
        return found | {"depth": Number(self.tree, node.outputs["Alpha"])}

    @cached_property
    def material_told(self) -> dict[str, Number]:
        return self.split(self.socket("Surroundings"), ("priority", "ior", "depth"))

    def told(self, name: str) -> Number:
        """What the analysis tells of the medium outside: priority, ior or depth."""
        return self.where(self.by_object, self.material_told[name], self.object_told[name])

    @cached_property
    def outside(self) -> Number:
        """What the analysis tells of this very object, 0 where it does not hold."""
        code = self.object_told["facts"].math("FLOORED_MODULO", 8.0)
        return self.where(self.by_object, self.raw("Outside"), code) * self.raw("Holds")

    @cached_property
    def in_medium(self) -> Number:
        """Whether the analysis names the one medium outside."""
        return self.outside.equals(MEDIUM)

    @cached_property
    def face(self) -> Number:
        """What the face tells; 0 where it tells nothing, and where the analysis knows that there is air around."""
        told = Number(self.tree, attribute(self.tree, "GEOMETRY", "nd_cut").outputs["Fac"])
        return self.where(self.alone, told * (self.raw("Cut") > 0.5), 0.0)

    @cached_property
    def face_tells(self) -> Number:
        return abs(self.face) > 0.0

    @cached_property
    def face_offset(self) -> Number:
        """White light's index above that which was typed, in a medium of JF's that disperses."""
        curve = self.split(
            attribute(self.tree, "GEOMETRY", "nd_cut_curve").outputs["Vector"], ("model", "Abbe", "spread")
        )
        disperses = (
            (self.face < 0.0) * (self.raw("Cut") > TELLS_DISPERSION - 0.5) * curve["model"].equals(CUT_SPLITS + 2.0)
        )
        return curve["spread"] * jf_ior(0.0, 1.0, LINE_D) * disperses

    @cached_property
    def outer_coefficients(self) -> Socket:
        """Of the medium outside, as far as its volume does not absorb for all rays."""
        absorbs = (self.object_told["facts"] / 32.0).math("FLOOR").math("FLOORED_MODULO", 2.0)
        told = attribute(self.tree, "OBJECT", "nd_outside_transmittance").outputs["Color"]
        of_object = mix_values(self.tree, "RGBA", absorbs.socket, (1.0, 1.0, 1.0, 1.0), told)
        colour = lazily(self.tree, "RGBA", self.by_object.socket, self.socket("Surroundings Transmittance"), of_object)
        by_analysis = self.scaled(self._coefficients(colour, self.told("depth")), self.in_medium)
        tint = attribute(self.tree, "GEOMETRY", "nd_cut_tint").outputs["Color"]
        depth, volume = (
            Number(self.tree, attribute(self.tree, "GEOMETRY", f"nd_cut_{name}").outputs["Fac"])
            for name in ("depth", "by_volume")
        )
        tells = (self.face < 0.0) * (self.raw("Cut") > TELLS_COLOUR - 0.5) * (1.0 - volume.equals(self.raw("Scene")))
        by_face = self.scaled(self._coefficients(tint, depth), tells)
        either = self.choose_vector(self.face_tells, by_analysis, by_face)
        return lazily(self.tree, "VECTOR", self.alone.socket, either, (0.0, 0.0, 0.0))

    def _coefficients(self, transmittance: Socket, depth: Number) -> Socket:
        return self.call(self.coefficients, Transmittance=transmittance, Depth=depth)["Coefficients"]


class _Light(NativePart):
    """What becomes of light on its way to the surface, and of shadow rays there."""

    NAME = "Light"

    def build(self) -> None:
        self.give("Arrives", "VECTOR", self.unless_clear(self.arrives))
        self.give("Fall-Off", "FLOAT", self.fall_off)
        self.give("Shadow", "VECTOR", self.shadow)
        self.give("Shadow by Volume", "FLOAT", 1.0 - self.surfaces_absorb_shadows)

    def unless_clear(self, left: Socket) -> Socket:
        return lazily(self.tree, "VECTOR", self.clear.socket, left, (1.0, 1.0, 1.0))

    @cached_property
    def clear(self) -> Number:
        """No colour is told on either side, and none can be."""
        red, green, blue = self.split(self.socket("Transmittance"), node="Color").values()
        white = red.math("MINIMUM", green).math("MINIMUM", blue) > 1.0 - 1e-9
        white = white.math("MAXIMUM", 1.0 - (self.raw("Transmittance Depth") > 0.0))
        return self.surely(white * self.alone)

    @cached_property
    def arrives(self) -> Socket:
        """Volumes absorb of rays from the camera and from diffuse surfaces."""
        straight = self.path["Is Camera Ray"].math("MAXIMUM", self.path["Is Diffuse Ray"])
        length = self.path["Ray Length"] * (straight - 1.0)
        crossed = self.choose_vector(
            self.backfacing, self.socket("Outer Coefficients"), self.socket("Own Coefficients")
        )
        return self.exponential(self.scaled(crossed, length))

    @cached_property
    def surfaces_absorb_shadows(self) -> Number:
        """Nothing foreign stands in the media: then surfaces take from shadow rays what media absorb."""
        by_object = self.raw("Outside").equals(BY_OBJECT)
        told = self.raw("Holds") * (1.0 - self.raw("Foreign Objects")) * (1.0 - by_object)
        return told * (Number(self.tree, self.centre.outputs["Alpha"]) > 0.5)

    @cached_property
    def centre(self) -> bpy.types.ShaderNodeAttribute:
        return view_layer_attribute(self.tree, f'["{CENTRE}"]')

    @cached_property
    def shadow_left(self) -> Socket:
        """What media leave of a shadow ray at this surface.

        Such a ray measures every hit from its own origin, so no surface knows how far it went in the medium that it leaves.
        But that is the difference of two distances along the ray, from a plane that all surfaces have in common: one charges
        the way to where the ray comes out, the other gives back the way to where it went in.
        """
        offset = self.vector("SUBTRACT", self.geometry["Position"], self.centre.outputs["Color"])
        way = self.dot(offset, self.geometry["Incoming"])
        inner_less_outer = self.vector("SUBTRACT", self.socket("Own Coefficients"), self.socket("Outer Coefficients"))
        side = (2.0 * self.backfacing - 1.0) * way * self.surfaces_absorb_shadows
        exponents = self.vector("MINIMUM", self.scaled(inner_less_outer, side), (LARGEST_EXPONENT,) * 3)
        return self.exponential(exponents)

    @cached_property
    def shadow(self) -> Socket:
        reflected = self.fresnel(normal=False)
        modes = {
            "BLACK": 0.0,
            "TRANSMISSION": 1.0,
            "OUTSIDE_FRESNEL": (1.0 - reflected * self.is_entrance).socket,
            "ALL_FRESNEL": (1.0 - reflected).socket,
        }
        return self.scaled(
            self.unless_clear(self.shadow_left), Number(self.tree, self.menu("Shadow Mode", "FLOAT", modes))
        )

    @cached_property
    def fall_off(self) -> Number:
        """What is left of light on its way to a diffuse surface further off than the artist wants."""
        most = self.number("Caustic Max Distance")
        near = (1.0 - self.path["Ray Length"] / most).math("MAXIMUM", 0.0)
        fades = self.caustic * self.path["Is Diffuse Ray"] * (1.0 - (most < 0.0))
        return self.where(self.surely(most < 0.0), self.choose(fades, 1.0, near), 1.0)


class _Weights(NativePart):
    """Factors on reflection and on refraction."""

    NAME = "Weights"

    def build(self) -> None:
        reflected, refracted = self.polarised
        self.give("Reflected", "FLOAT", reflected * self.reflected)
        self.give("Refracted", "FLOAT", refracted * self.refracted)

    @cached_property
    def total(self) -> Number:
        return 1.0 - (self.fresnel(normal=True) < 1.0)

    @cached_property
    def inside(self) -> Number:
        """Whether the ray comes from a medium."""
        return (1.0 - self.raw("In Air")).math("MAXIMUM", self.backfacing)

    @cached_property
    def reflected(self) -> Number:
        weak = self.inside * (1.0 - self.total)
        off = weak * (1.0 - self.raw("Internal Reflections") * self.unless_caustic("Caustic Internal Reflections"))
        most = self.number("Max Interior Reflections")
        deep = self.inside * (most < UNLIMITED_REFLECTIONS - 0.5) * (1.0 - (self.path["Glossy Depth"] < most))
        left = self.number("Specular Scale") * (1.0 - off.math("MAXIMUM", deep))
        left = left * (1.0 - self.total * (1.0 - self.unless_caustic("Caustic Total Reflection")))
        outside = 1.0 - self.inside
        left = left * (1.0 - outside * (1.0 - self.unless_caustic("Caustic Reflection")))
        return left * self.sky("Reflect Sky", outside, self.vector("REFLECT", self.travelling, self.bumped))

    @cached_property
    def refracted(self) -> Number:
        left = self.number("Refraction Scale") * self.unless_caustic("Caustic Refraction")
        return left * self.sky("Refract Sky", self.is_exit * (1.0 - self.total), self.refracted_way)

    def unless_caustic(self, name: str) -> Number:
        """0 where a switch leaves light on its way to a diffuse surface out."""
        return 1.0 - self.caustic * (1.0 - self.raw(name))

    def sky(self, name: str, looks: Number, way: Socket) -> Number:
        """0 where a switch leaves out the world that a ray would meet."""
        node = self.node("ShaderNodeRaycast")
        for socket, value in (
            ("Position", self.geometry["Position"]),
            ("Direction", way),
            ("Length", (looks * FAR).socket),
        ):
            plug(self.tree, value, node.inputs[socket])
        met = Number(self.tree, node.outputs["Is Hit"]).math("MAXIMUM", 1.0 - looks)
        return self.where(self.surely(self.raw(name)), self.choose(self.raw(name), met, 1.0), 1.0)

    @cached_property
    def polarised(self) -> tuple[Number, Number]:
        """What a filter before the camera makes of reflection and refraction, as in osl/optics.h."""
        angle = self.number("Polarization Angle")
        vertical = self.join((angle.math("SINE"), angle.math("COSINE"), 0.0))
        towards = self.geometry["Incoming"]
        filtered = self.across(self.to_world("VECTOR", "CAMERA", vertical), towards)
        plane = self.across(self.bumped, towards)
        within = self.dot(filtered, plane)
        within = within * within / (self.dot(filtered, filtered) * self.dot(plane, plane)).math("MAXIMUM", 1e-20)
        cosine = self.dot(towards, self.bumped).math("MAXIMUM", 0.0).math("MINIMUM", 1.0)
        square = self.eta * self.eta
        g = (square - 1.0 + cosine * cosine).math("MAXIMUM", 0.0).math("SQRT")
        across = (cosine - g) / (cosine + g)
        along = (square * cosine - g) / (square * cosine + g)
        across, along = across * across, along * along
        whole = 0.5 * (across + along)
        left = self.choose(within.math("MINIMUM", 1.0), across, along)
        filters = self.path["Is Camera Ray"] * self.raw("Polarize")
        none = self.surely(1.0 - self.raw("Polarize"))
        factors = (left / whole.math("MAXIMUM", 1e-12), (1.0 - left) / (1.0 - whole).math("MAXIMUM", 1e-12))
        return tuple(self.where(none, self.choose(filters, 1.0, factor), 1.0) for factor in factors)


class _Tangents(NativePart):
    """The way along the surface that anisotropy refers to, and what it is made from, as in osl/lobes.h."""

    NAME = "Tangents"

    def build(self) -> None:
        given = self.socket("Tangent")
        has_tangent = self.length(given) > 0.0
        z = self.vector("NORMALIZE", self.to_world("VECTOR", "OBJECT", (0.0, 0.0, 1.0)))
        own = self.choose_vector(has_tangent, z, self.vector("NORMALIZE", given))
        bent = self.length(self.refracted_way) > 0.0
        refraction = self.choose_vector(bent, self.travelling, self.refracted_way)
        origin = self.to_world("POINT", "OBJECT", (0.0, 0.0, 0.0))
        around = self.vector("CROSS_PRODUCT", own, self.vector("SUBTRACT", self.geometry["Position"], origin))
        around = self.choose_vector(has_tangent, around, own)
        self.give("Axis", "VECTOR", self.menu("Tangent From", "VECTOR", {"TANGENT": own, "REFRACTION": refraction}))
        chosen = self.menu("Tangent From", "VECTOR", {"TANGENT": around, "REFRACTION": refraction})
        along = self.across(chosen, self.geometry["Normal"])
        usable = self.length(along) > 1e-6
        self.give(
            "Along", "VECTOR", self.choose_vector(usable, self.geometry["Tangent"], self.vector("NORMALIZE", along))
        )


class _Stretched(NativePart):
    """Roughness and anisotropy as Cycles takes them, made round where the normal points along the tangents' axis."""

    NAME = "Stretched"

    def build(self) -> None:
        alpha = self.raw("Alpha") * self.raw("Alpha")
        stretch = 1.0 - abs(self.raw("Stretch")).math("MINIMUM", 0.99)
        least = alpha * stretch
        most = (alpha / stretch).math("MINIMUM", 1.0)
        blur = self.number("Blur Anisotropic Poles")
        pole = abs(self.dot(self.socket("Axis"), self.geometry["Normal"])).math("POWER", 1.0 / blur - 1.0) * (
            blur > 0.0
        )
        mean = (least * most).math("SQRT")
        least, most = self.choose(pole, least, mean), self.choose(pole, most, mean)
        self.give("Roughness", "FLOAT", (least * most).math("POWER", 0.25))
        ratio = (least / most.math("MAXIMUM", 1e-20)).math("SQRT")
        self.give("Anisotropy", "FLOAT", (1.0 - ratio) * self.raw("Stretch").math("SIGN"))


class _Glass(NativePart):
    """Cycles' own Glass."""

    NAME = "Glass"

    def build(self) -> None:
        values = {
            "Color": self.socket("Light"),
            "Roughness": self.socket("Shown Roughness"),
            "IOR": self.socket("Ratio"),
            "Normal": self.socket("Normal"),
            "Thin Film Thickness": self.number("Thin Film Thickness"),
            "Thin Film IOR": self.socket("Film IOR"),
        }
        found = {
            choice.keyword: self.bsdf("Glass", choice.keyword, values) for choice in BY_NAME["Distribution"].choices
        }
        self.give("BSDF", "SHADER", self.menu("Distribution", "SHADER", found))


class _Special(NativePart):
    """Glass as far as reflection and refraction have the same weight, and the rest of each by itself.

    The rest takes the reflectance of the surface as a whole, which is exact where it is smooth.
    """

    NAME = "Special"

    def build(self) -> None:
        weights = self.call(_Weights())
        reflected, refracted = (Number(self.tree, weights[name]) for name in ("Reflected", "Refracted"))
        alike = reflected.math("MINIMUM", refracted) * (1.0 - self.raw("Separate Reflection"))
        for name, socket in self.call(_Tangents()).items():
            self.define(name, socket)
        self.stretched = _Stretched()
        rough, anisotropy = self.stretch(self.raw("Shown Roughness"), self.number("Anisotropy"))
        shared = {"Normal": self.socket("Normal"), "Tangent": self.socket("Along")}
        glass = shared | {
            "Color": self.scaled(self.socket("Light"), alike),
            "Roughness": rough,
            "Anisotropy": anisotropy,
            "IOR": self.socket("Ratio"),
            "Thin Film Thickness": self.number("Thin Film Thickness"),
            "Thin Film IOR": self.socket("Film IOR"),
        }
        kinds = [choice.keyword for choice in BY_NAME["Distribution"].choices]
        both = self.menu("Distribution", "SHADER", {kind: self.bsdf("Glass", kind, glass) for kind in kinds})
        whole = self.fresnel(normal=True)
        mirror = shared | {"Color": self.scaled(self.socket("Light"), (reflected - alike) * whole)}
        refraction = {
            "Color": self.scaled(self.socket("Light"), (refracted - alike) * (1.0 - whole)),
            "Roughness": self.raw("Shown Roughness"),
            "IOR": self.socket("Ratio"),
            "Normal": self.socket("Normal"),
        }
        lens = {kind: self.bsdf("Refraction", kind.removeprefix("MULTI_"), refraction) for kind in kinds}
        rest = self.add(self.mirror(mirror, rough, anisotropy), self.menu("Distribution", "SHADER", lens))
        self.give("BSDF", "SHADER", self.add(both, rest))

    def stretch(self, roughness: Number, anisotropy: Number) -> tuple[Number, Number]:
        found = self.call(self.stretched, Alpha=roughness, Stretch=anisotropy)
        return Number(self.tree, found["Roughness"]), Number(self.tree, found["Anisotropy"])

    def mirror(self, values: dict[str, Socket], rough: Number, anisotropy: Number) -> Socket:
        """Reflection alone, as rough as refraction or as it is itself."""
        apart = self.raw("Separate Reflection")
        own_rough, own_anisotropy = self.stretch(
            self.number("Reflection Roughness"), self.number("Reflection Anisotropy")
        )
        values = values | {
            "Roughness": self.choose(apart, rough, own_rough),
            "Anisotropy": self.choose(apart, anisotropy, own_anisotropy),
        }
        kinds = [choice.keyword for choice in BY_NAME["Distribution"].choices]
        found = {kind: self.bsdf("Anisotropic", kind, values) for kind in kinds}
        separate = self.menu("Reflection Distribution", "SHADER", found)
        return lazily(self.tree, "SHADER", apart.socket, self.menu("Distribution", "SHADER", found), separate)


class _Spread(NativePart):
    """How much larger an index is at the F line than at the C line, as in osl/dispersion.h."""

    NAME = "Spread"

    def build(self) -> None:
        abbe = self.raw("Abbe").math("MAXIMUM", 0.0, first=True)
        spreads = {
            "ABBE": (self.raw("IOR") - 1.0) / abbe,
            "SELLMEIER": self.sellmeier(LINE_F) - self.sellmeier(LINE_C),
            "JF": self.raw("Dispersion") * (jf_ior(0.0, 1.0, LINE_F) - jf_ior(0.0, 1.0, LINE_C)),
        }
        found = [
            spreads[choice.keyword] * self.raw("Dispersion Model").equals(index)
            for index, choice in enumerate(DISPERSION_MODELS)
        ]
        self.give("Spread", "FLOAT", found[0] + found[1] + found[2])

    def sellmeier(self, wavelength: float) -> Number:
        square = (wavelength * wavelength * 1e-6,) * 3
        terms = self.vector("DIVIDE", square, self.vector("SUBTRACT", square, self.socket("Sellmeier C")))
        return (1.0 + self.dot(self.socket("Sellmeier B"), terms)).math("MAXIMUM", 0.0).math("SQRT")


class _Dispersing(NativePart):
    """Cycles' own dispersion, of the ratio of both indices (Principled).

    That node tints refraction alone, by the root of its colour: so the brightest channel of light that arrives weighs all.
    """

    NAME = "Dispersing"

    def build(self) -> None:
        spread = _Spread()
        curve = self.split(
            attribute(self.tree, "GEOMETRY", "nd_cut_curve").outputs["Vector"], ("model", "Abbe", "Dispersion")
        )
        starts = curve["model"] > CUT_SPLITS - 0.5
        tells = (self.raw("Face") < 0.0) * (self.raw("Cut") > TELLS_DISPERSION - 0.5)
        sellmeier = {
            f"Sellmeier {each}": attribute(self.tree, "GEOMETRY", f"nd_cut_sellmeier_{each.lower()}").outputs["Vector"]
            for each in "BC"
        }
        given = sellmeier | {"IOR": self.raw("Outer IOR"), "Dispersion Model": curve["model"] - starts * CUT_SPLITS}
        outer = Number(self.tree, self.call(spread, **given | curve)["Spread"]) * tells
        inner = Number(self.tree, self.call(spread)["Spread"])
        left_out = self.walks.math("MAXIMUM", self.caustic) * (1.0 - self.raw("Caustic Dispersion"))
        self.give("Disperses", "FLOAT", self.raw("Disperse").math("MAXIMUM", starts * tells) * (1.0 - left_out))
        at_f, at_c = (
            (self.raw("Own IOR") + inner * reach) / (self.raw("Outer IOR") + outer * reach)
            for reach in (_F_REACH, _C_REACH)
        )
        ratio = self.choose(abs(self.raw("Ratio") - 1.0) < 1e-4, self.raw("Ratio"), 1.0001)
        red, green, blue = self.split(self.socket("Light")).values()
        brightest = red.math("MAXIMUM", green).math("MAXIMUM", blue)
        colour = self.scaled(self.socket("Light"), 1.0 / brightest)
        values = {
            "Base Color": self.vector("MULTIPLY", colour, colour),
            "Roughness": self.raw("Shown Roughness"),
            "IOR": ratio,
            "Normal": self.socket("Normal"),
            "Transmission Weight": 1.0,
            "Transmission Dispersion Scale": 1.0,
            "Transmission Dispersion Abbe Number": ((ratio - 1.0) / (at_f - at_c)).math("MAXIMUM", 0.0),
            "Thin Film Thickness": self.number("Thin Film Thickness"),
            "Thin Film IOR": self.raw("Film IOR"),
        }
        found = {kind: self.bsdf("Principled", kind, values) for kind in ("GGX", "MULTI_GGX")}
        shown = self.menu("Distribution", "SHADER", found | {"BECKMANN": found["GGX"]})
        self.give("BSDF", "SHADER", self.mix(brightest, None, shown))


class NativeBody(NativePart):
    """The native body. Outputs: Surface; Shadow by Volume, 1 where the material's volume has to absorb for shadow rays; and what
    the artist's own nodes may ask, by the names of the group's outputs.
    """

    def build(self) -> None:
        coefficients = self.coefficients = Coefficients()
        self.surroundings = Surroundings(coefficients)
        outside = self.call(self.surroundings)
        for name in ("Face", "In Air", "Outer IOR", "Outer Coefficients"):
            self.define(name, outside[name])
        self._define_own(coefficients)
        light = self.call(_Light())
        self.define("Light", self.scaled(light["Arrives"], Number(self.tree, light["Fall-Off"])))
        dark = self.node("ShaderNodeBsdfTransparent")
        self.tree.links.new(light["Shadow"], dark.inputs["Color"])
        seen = self.mix(self.path["Is Shadow Ray"], self.add(self.body, self.emission), dark.outputs[0])
        known, exists, shows = (Number(self.tree, outside[name]) for name in ("Known", "Exists", "Shows"))
        alarm = self.node("ShaderNodeBsdfDiffuse")
        alarm.inputs["Color"].default_value = (1.0, 0.0, 1.0, 1.0)
        other = self.mix(known, alarm.outputs[0], self.node("ShaderNodeBsdfTransparent").outputs[0])
        self.give("Surface", "SHADER", self.mix(shows, other, seen))
        self.give("Shadow by Volume", "FLOAT", light["Shadow by Volume"])
        self.give("Surface Exists", "FLOAT", exists)
        self.give("Is Entrance", "FLOAT", exists * self.is_entrance)
        self.give("Is Exit", "FLOAT", exists * self.is_exit)
        own = attribute(self.tree, "OBJECT", "nd_priority")
        has_own = Number(self.tree, own.outputs["Alpha"]) > 0.5
        self.give(
            "Priority Inside",
            "FLOAT",
            self.choose(has_own, self.raw("Priority"), Number(self.tree, own.outputs["Fac"])),
        )
        self.give("Priority Outside", "FLOAT", outside["Priority Outside"])
        white = self.join((1.0, 1.0, 1.0))
        self.give("Arriving Light", "COLOR", self.choose_vector(exists, white, light["Arrives"]))

    def _define_own(self, coefficients: Coefficients) -> None:
        """What follows from the material's own numbers and from what lies outside."""
        # A medium of JF's that splits no light has its index as it was typed.
        offset = (
            self.number("Dispersion")
            * jf_ior(0.0, 1.0, LINE_D)
            * self.raw("Dispersion Model").equals(2)
            * self.raw("Disperse")
        )
        self.define("Own IOR", self.number("IOR") + offset)
        self.define("Ratio", self.raw("Own IOR") / self.raw("Outer IOR"))
        no_film = self.surely(self.number("Thin Film Thickness") < 1e-9)
        self.define("Film IOR", self.where(no_film, self.number("Thin Film IOR") / self.raw("Outer IOR"), 1.0))
        own = self.call(coefficients, Depth=self.number("Transmittance Depth"))["Coefficients"]
        self.define("Own Coefficients", self.scaled(own, 1.0 - self.raw("By Volume")))
        # Where both indices are the same no half vector is defined.
        differs = abs(self.raw("Ratio") - 1.0) > INDEX_MATCHED
        rough = self.number("Roughness")
        self.define("Shown Roughness", self.where(self.surely(rough < 1e-9), rough * differs, 0.0))

    @cached_property
    def body(self) -> Socket:
        """What is seen of the surface."""
        plain = self.call(_Glass())["BSDF"]
        ordinary = lazily(self.tree, "SHADER", self.surely(self.is_plain).socket, self.call(_Special())["BSDF"], plain)
        if bpy.app.version < NATIVE_DISPERSION_VERSION:
            return ordinary
        dispersing = self.call(_Dispersing())
        splits = self.mix(Number(self.tree, dispersing["Disperses"]), ordinary, dispersing["BSDF"])
        never = self.surely(self.alone * (1.0 - self.raw("Disperse")))
        return lazily(self.tree, "SHADER", never.socket, splits, ordinary)

    @cached_property
    def is_plain(self) -> Number:
        """Reflection and refraction are alike and isotropic."""
        departures = [
            abs(self.raw("Refraction Scale") - 1.0),
            abs(self.raw("Anisotropy")),
            self.raw("Separate Reflection"),
            self.raw("Polarize"),
            UNLIMITED_REFLECTIONS - self.raw("Max Interior Reflections"),
            *(1.0 - self.raw(name) for name in _SWITCHES),
        ]
        return sum(departures, abs(self.raw("Specular Scale") - 1.0)) < 1e-9

    @cached_property
    def emission(self) -> Socket:
        """The artist's shaders, of which a medium's colour leaves its mean."""
        everywhere, entrance, leaving = (
            self.socket(f"Emission at {place}") for place in ("Interfaces", "Entrances", "Exits")
        )
        shone = self.add(
            everywhere, self.add(self.mix(self.is_entrance, None, entrance), self.mix(self.is_exit, None, leaving))
        )
        return self.mix(self.dot(self.socket("Light"), self.join((1.0 / 3.0,) * 3)), None, shone)
