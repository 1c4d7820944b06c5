"""What lies outside a surface of the native body."""

from __future__ import annotations

from functools import cached_property

from ...model.contract import (
    CUT,
    CUT_AIR,
    CUT_BY_VOLUME,
    CUT_CURVE,
    CUT_DEPTH,
    CUT_HIDDEN,
    CUT_PRIORITY,
    CUT_SPLITS,
    CUT_TINT,
    FACTS_ABSORBS,
    FACTS_CODES,
    NO_PRIORITY,
    OUTSIDE_PROPERTY,
    OUTSIDE_TRANSMITTANCE_PROPERTY,
    TOLD_BY_FACE,
    DispersionModel,
    Exterior,
)
from ...model.dispersion import LINE_D, jf_ior
from ...model.parameters import BY_NAME
from ..cut_faces import CUT_WITH_COLOUR, CUT_WITH_DISPERSION
from ..names import LEFT_TO_SHADER
from ..numbers import Number
from ..shader_nodes import Socket, attribute, lazily, mix_values
from .coefficients import Coefficients
from .part import NativePart

_INDICES = 5000.0, 4999.995
"""Middle and half width of the numbers of faces with an index; hidden faces, and those without facts, have others."""


class Surroundings(NativePart):
    """What lies outside the surface: by the face, by the material's facts, or by this object's."""

    NAME = "Surroundings"

    def __init__(self, coefficients: Coefficients) -> None:
        self.coefficients = coefficients
        super().__init__()

    def build(self) -> None:
        least, most, _ = BY_NAME["IOR"].limits
        self.define("Face", self.face)
        beside = self.surely(1.0 - self.is_surrounded_by_air)
        stored = self.choose(self.face_has_facts, 1.0 - self.in_medium, self.face.math("COMPARE", CUT_AIR, 1e-7))
        air = self.where(beside, 1.0, stored)
        by_analysis = self.choose(self.in_medium, 1.0, self.fact("ior").math("MAXIMUM", least))
        ior = self.choose(self.face_has_facts, by_analysis, abs(self.face).math("MINIMUM", most) + self.face_offset)
        known = (self.outside > Exterior.AIR - 0.5) * (self.outside < Exterior.WINNER + 0.5)
        exists = self.choose(
            self.face_has_facts, 1.0 - self.outside.equals(Exterior.WINNER), self.face < 0.5 * CUT_HIDDEN
        )
        known = self.face_has_facts.math("MAXIMUM", known) * self.may_render
        by_faces = self.surely(self.raw("Outside").equals(Exterior.UNKNOWN))
        self.add_output("Told", "FLOAT", self.choose(self.face_has_facts, self.outside, TOLD_BY_FACE))
        self.add_output("Known", "FLOAT", known)
        self.add_output("Exists", "FLOAT", exists)
        shows = abs(self.face).math("COMPARE", *_INDICES) * self.may_render
        self.add_output("Shows", "FLOAT", self.where(by_faces, known * exists, shows))
        self.add_output("Face", "FLOAT", self.face)
        self.add_output("In Air", "FLOAT", air)
        ior = self.where(by_faces, ior, abs(self.face) + self.face_offset)
        self.add_output("Outer IOR", "FLOAT", self.where(beside, 1.0, ior))
        self.add_output("Outer Coefficients", "VECTOR", self.outer_coefficients)
        priority = self.attribute_number("GEOMETRY", CUT_PRIORITY)
        outside = self.choose(self.face_has_facts, self.fact("priority"), priority)
        self.add_output(
            "Priority Outside", "FLOAT", self.choose(air.math("MAXIMUM", 1.0 - exists), outside, NO_PRIORITY)
        )

    @cached_property
    def may_render(self) -> Number:
        """1 unless the scene leaves its media to the shader alone, and 0 for the alarm."""
        return self.raw("Scene") > LEFT_TO_SHADER + 0.5

    @cached_property
    def by_object(self) -> Number:
        """1 where each object has facts of its own."""
        return self.raw("Outside").equals(Exterior.BY_OBJECT)

    @cached_property
    def object_facts(self) -> dict[str, Number]:
        """Facts of this object: packed ones, then the medium outside."""
        node = attribute(self.tree, "OBJECT", OUTSIDE_PROPERTY)
        found = self.split(node.outputs["Color"], ("facts", "priority", "ior"), "Color")
        return found | {"depth": Number(self.tree, node.outputs["Alpha"])}

    @cached_property
    def material_facts(self) -> dict[str, Number]:
        """The medium outside all objects of the material."""
        return self.split(self.socket("Surroundings"), ("priority", "ior", "depth"))

    def fact(self, name: str) -> Number:
        """Return what is stored of the medium outside: priority, ior or depth."""
        return self.where(self.by_object, self.material_facts[name], self.object_facts[name])

    @cached_property
    def outside(self) -> Number:
        """The code of what is stored of this object's exterior; 0, as for unknown, where the analysis does not hold."""
        code = self.object_facts["facts"].math("FLOORED_MODULO", float(FACTS_CODES))
        return self.where(self.by_object, self.raw("Outside"), code) * self.raw("Holds")

    @cached_property
    def in_medium(self) -> Number:
        """1 where the analysis names the one medium outside."""
        return self.outside.equals(Exterior.MEDIUM)

    @cached_property
    def face(self) -> Number:
        """The face's number; 0 where it has none, and where the analysis knows that there is air around."""
        stored = self.attribute_number("GEOMETRY", CUT)
        return self.where(self.is_surrounded_by_air, stored * (self.raw("Cut") > 0.5), 0.0)

    @cached_property
    def face_has_facts(self) -> Number:
        """1 where the face itself says what lies outside."""
        return abs(self.face) > 0.0

    @cached_property
    def face_offset(self) -> Number:
        """The index of white light above the one that was typed, in a medium of JF's that disperses."""
        curve = self.split(attribute(self.tree, "GEOMETRY", CUT_CURVE).outputs["Vector"], ("model", "Abbe", "spread"))
        disperses = (
            (self.face < 0.0)
            * (self.raw("Cut") > CUT_WITH_DISPERSION - 0.5)
            * curve["model"].equals(CUT_SPLITS + DispersionModel.JF)
        )
        return curve["spread"] * jf_ior(0.0, 1.0, LINE_D) * disperses

    @cached_property
    def outer_coefficients(self) -> Socket:
        """Absorption coefficients of the medium outside; none where its volume absorbs for all rays."""
        absorbs = (self.object_facts["facts"] / float(FACTS_ABSORBS)).math("FLOOR").math("FLOORED_MODULO", 2.0)
        stored = attribute(self.tree, "OBJECT", OUTSIDE_TRANSMITTANCE_PROPERTY).outputs["Color"]
        of_object = mix_values(self.tree, "RGBA", absorbs.socket, (1.0, 1.0, 1.0, 1.0), stored)
        colour = lazily(self.tree, "RGBA", self.by_object.socket, self.socket("Surroundings Transmittance"), of_object)
        by_analysis = self.scaled(self._coefficients(colour, self.fact("depth")), self.in_medium)
        tint = attribute(self.tree, "GEOMETRY", CUT_TINT).outputs["Color"]
        depth, volume = (self.attribute_number("GEOMETRY", name) for name in (CUT_DEPTH, CUT_BY_VOLUME))
        absorbs = (
            (self.face < 0.0) * (self.raw("Cut") > CUT_WITH_COLOUR - 0.5) * (1.0 - volume.equals(self.raw("Scene")))
        )
        by_face = self.scaled(self._coefficients(tint, depth), absorbs)
        either = self.choose_vector(self.face_has_facts, by_analysis, by_face)
        return lazily(self.tree, "VECTOR", self.is_surrounded_by_air.socket, either, (0.0, 0.0, 0.0))

    def _coefficients(self, transmittance: Socket, depth: Number) -> Socket:
        """Return the absorption coefficients of a medium."""
        return self.call(self.coefficients, Transmittance=transmittance, Depth=depth)["Coefficients"]
