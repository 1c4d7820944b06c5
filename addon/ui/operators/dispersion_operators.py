"""Operators of how a medium splits light: its dispersion, and the spectrum that it is split by."""

from functools import cache
from math import isnan

import bpy

from ...model.colour_science import SpectrumError
from ...model.dispersion import LINE_D, sellmeier_ior
from ...model.distributions import DISTRIBUTIONS, illuminant_names
from ...model.enumerations import DISPERSION_MODELS
from ...model.gamuts import GAMUTS
from ...model.parameter import ParameterError
from ...model.parameters import BY_KEYWORD, check_keywords
from ...scene.material_spectra import set_spectrum, usable_spectrum_settings
from ...scene.materials import get_parameter, rendered_node, set_parameter
from ..active_medium import active_medium, has_editable_medium
from ..choice_items import choice_items

SELLMEIER_REMEDY = "correct Sellmeier B and C; C holds squares of wavelengths in square micrometres"

_FILE = "FILE"

_ILLUMINANT_GROUPS = (
    ("FL", "CIE Fluorescent Lamps"),
    ("HP", "CIE Discharge Lamps"),
    ("LED", "CIE LEDs"),
    ("", "CIE Illuminants"),
)
"""How the names of a column of the menu begin, and its heading; the first that fits."""


@cache
def _distribution_items() -> tuple[tuple[str, str, str], ...]:
    """Return the words for distributions, the CIE's illuminants and a file.

    They are kept, because Blender does not hold on to the strings itself. The first call imports colour-science, which
    takes a second.
    """
    items = [("", "Lights", ""), *choice_items(DISTRIBUTIONS)]
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for name in _illuminants():
        heading = next(heading for start, heading in _ILLUMINANT_GROUPS if name.startswith(start))
        groups.setdefault(heading, []).append((name, name, f"CIE {name}"))
    for heading, illuminants in groups.items():
        items += [("", heading, ""), *illuminants]
    return *items, ("", "File", ""), (_FILE, "Custom File", "A CSV file of wavelength (nm) and power")


def _illuminants() -> tuple[str, ...]:
    """Return the CIE's illuminants; none where colour-science is missing, which baking then reports."""
    try:
        return illuminant_names()
    except SpectrumError:
        return ()


def coefficients_ior(node: bpy.types.ShaderNodeGroup) -> float:
    """Return the index that a node's Sellmeier coefficients have at the d line, whatever its IOR; NaN if they have none."""
    b, c = (get_parameter(node, BY_KEYWORD[keyword]) for keyword in ("sellmeier_b", "sellmeier_c"))
    return sellmeier_ior(b, c, LINE_D)


class _MaterialOperator(bpy.types.Operator):
    """What operators on the active object's nested dielectric material share."""

    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_editable_medium(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            self.change(active_medium(context))
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DispersionModel(_MaterialOperator):
    """Choose the dispersion model of a medium."""

    bl_idname = "nested_dielectric.dispersion_model"
    bl_label = "Dispersion Model"
    bl_description = "Choose how the index of refraction changes with the wavelength"

    model: bpy.props.EnumProperty(name="Model", items=choice_items(DISPERSION_MODELS))

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return next(choice.description for choice in DISPERSION_MODELS if choice.keyword == properties.model)

    def change(self, material: bpy.types.Material) -> None:
        parameter = BY_KEYWORD["dispersion_model"]
        set_parameter(rendered_node(material), parameter, parameter.check(self.model))


class SellmeierIor(_MaterialOperator):
    """Set IOR to that of the Sellmeier coefficients."""

    bl_idname = "nested_dielectric.sellmeier_ior"
    bl_label = "Set IOR to Sellmeier's"
    bl_description = (
        "Set IOR to the index that the Sellmeier coefficients have at 587.6 nm, so that their curve is not shifted"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        node = rendered_node(active_medium(context))
        if get_parameter(node, BY_KEYWORD["dispersion_model"]) != "SELLMEIER":
            cls.poll_message_set("Choose Sellmeier as the dispersion model first")
            return False
        return True

    def change(self, material: bpy.types.Material) -> None:
        node = rendered_node(material)
        index = coefficients_ior(node)
        if isnan(index):
            raise ParameterError(f"these coefficients have no real index at 587.6 nm; {SELLMEIER_REMEDY}")
        parameter = BY_KEYWORD["ior"]
        set_parameter(node, parameter, parameter.check(index))


class Spectrum(_MaterialOperator):
    """Bake another spectral table for a medium."""

    bl_idname = "nested_dielectric.spectrum"
    bl_label = "Spectrum"
    bl_description = "Choose the light that dispersion splits and the colours it is split into"
    bl_options = {"REGISTER", "UNDO"}

    distribution: bpy.props.EnumProperty(
        name="Distribution",
        description="Light that is split into colours; its mix is always white",
        items=lambda self, context: _distribution_items(),
        options={"SKIP_SAVE"},
    )
    filepath: bpy.props.StringProperty(
        name="File",
        description="CSV file of wavelength (nm) and power",
        subtype="FILE_PATH",
        options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    gamut: bpy.props.EnumProperty(
        name="Gamut",
        description=BY_KEYWORD["spectral_gamut"].description,
        items=choice_items(GAMUTS),
        options={"SKIP_SAVE"},
    )
    saturation: bpy.props.FloatProperty(
        name="Saturation",
        description=BY_KEYWORD["spectral_saturation"].description,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        options={"SKIP_SAVE"},
    )
    clamp_negative: bpy.props.BoolProperty(
        name="Clamp Negative", description=BY_KEYWORD["clamp_negative"].description, options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        group = rendered_node(active_medium(context)).node_tree
        if not group.is_editable:
            cls.poll_message_set(f"Node group {group.name!r} belongs to a library; make it local first")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        try:
            self.complete(active_medium(context))
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return context.window_manager.invoke_props_dialog(self, width=360)

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "distribution")
        if self.distribution == _FILE:
            layout.prop(self, "filepath")
        layout.prop(self, "gamut")
        layout.prop(self, "saturation", slider=True)
        layout.prop(self, "clamp_negative")

    def complete(self, material: bpy.types.Material) -> None:
        """Take from the material what was not given; a file that was given alone is the distribution."""
        given = self.properties.is_property_set
        settings = {
            parameter.keyword: value for parameter, value in check_keywords(usable_spectrum_settings(material)).items()
        }
        if not given("distribution"):
            distribution = settings["spectral_distribution"]
            words = {word.upper(): word for word, _, _ in _distribution_items() if word}
            self.distribution = _FILE if given("filepath") else words.get(distribution.upper(), _FILE)
            if not given("filepath") and self.distribution == _FILE:
                self.filepath = distribution
        if not given("gamut"):
            self.gamut = settings["spectral_gamut"].keyword
        if not given("saturation"):
            self.saturation = settings["spectral_saturation"]
        if not given("clamp_negative"):
            self.clamp_negative = settings["clamp_negative"]

    def change(self, material: bpy.types.Material) -> None:
        self.complete(material)
        set_spectrum(
            material,
            spectral_distribution=self.filepath if self.distribution == _FILE else self.distribution,
            spectral_gamut=self.gamut,
            spectral_saturation=round(self.saturation, 6),
            clamp_negative=self.clamp_negative,
        )


CLASSES = (DispersionModel, SellmeierIor, Spectrum)
