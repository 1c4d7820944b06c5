"""Operators: what the panels' buttons and menus do, each a call of one plain function."""

from functools import cache
from math import isnan

import bpy

from ...model.choice import Choice
from ...model.dispersion import LINE_D, sellmeier_ior
from ...model.parameters import BY_KEYWORD, DISPERSION_MODELS, ParameterError, check_keywords
from ...model.spectra import DISTRIBUTIONS, GAMUTS, SpectrumError, illuminant_names
from ...nodes.compatibility import UnsupportedError
from ...preparation.versions import outdated_materials, update_materials
from ...scene import lights
from ...scene.caustics import set_shadow_caustics
from ...scene.materials import (
    dielectric_node,
    get_parameter,
    medium_material,
    rendered_node,
    set_parameter,
    set_spectrum,
    usable_spectrum_settings,
)
from ...scene.passes import add_passes
from ..polls import has_media, supported

LAMP_CARRIERS = (
    Choice(
        lights.LOBE,
        "Lobe",
        "Media show lamps in a lobe where their light leaves them: for small lamps, which rays hardly find",
    ),
    Choice(lights.RAYS, "Rays", "Cycles' rays find lamps, as they find all else"),
)
"""What brings the light of lamps through media."""

SELLMEIER_REMEDY = "correct Sellmeier B and C; C holds squares of wavelengths in square micrometres"

_FILE = "FILE"
_ILLUMINANT_GROUPS = (
    ("FL", "CIE Fluorescent Lamps"),
    ("HP", "CIE Discharge Lamps"),
    ("LED", "CIE LEDs"),
    ("", "CIE Illuminants"),
)
"""How the names of a column of the menu begin, and its heading; the first that fits."""


def _choice_items(choices: tuple[Choice, ...]) -> tuple[tuple[str, str, str], ...]:
    """An enumeration's words as Blender wants its menus."""
    return tuple((choice.keyword, choice.name, choice.description) for choice in choices)


@cache
def _distribution_items() -> tuple[tuple[str, str, str], ...]:
    """The words for distributions, the CIE's illuminants and a file; kept, because Blender does not hold on to the
    strings itself.

    The first call imports colour-science, which takes a second.
    """
    items = [("", "Lights", ""), *_choice_items(DISTRIBUTIONS)]
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for name in _illuminants():
        heading = next(heading for start, heading in _ILLUMINANT_GROUPS if name.startswith(start))
        groups.setdefault(heading, []).append((name, name, f"CIE {name}"))
    for heading, illuminants in groups.items():
        items += [("", heading, ""), *illuminants]
    return *items, ("", "File", ""), (_FILE, "Custom File", "A CSV file of wavelength (nm) and power")


def _illuminants() -> tuple[str, ...]:
    """The CIE's illuminants; none where colour-science is missing, which baking then reports."""
    try:
        return illuminant_names()
    except SpectrumError:
        return ()


def active_medium(context: bpy.types.Context) -> bpy.types.Material | None:
    """The nested dielectric that the Material properties show, or else that of the active object; None if it has none."""
    shown = getattr(context, "material", None)
    if dielectric_node(shown) is not None:
        return shown
    return None if context.object is None else medium_material(context.object)


def coefficients_ior(node: bpy.types.ShaderNodeGroup) -> float:
    """Index that a material's Sellmeier coefficients have at the d line, whatever its IOR; NaN if they have none."""
    b, c = (get_parameter(node, BY_KEYWORD[keyword]) for keyword in ("sellmeier_b", "sellmeier_c"))
    return sellmeier_ior(b, c, LINE_D)


class _MaterialOperator(bpy.types.Operator):
    """What operators on the active object's nested dielectric material share."""

    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        material = active_medium(context)
        if material is None:
            cls.poll_message_set("The active object is no medium; assign a preset to it first")
            return False
        if not material.is_editable:
            cls.poll_message_set(f"Material {material.name!r} belongs to a library; make it local first")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            self.change(active_medium(context))
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DispersionModel(_MaterialOperator):
    """Choose how the index of refraction changes with the wavelength"""

    bl_idname = "nested_dielectric.dispersion_model"
    bl_label = "Dispersion Model"

    model: bpy.props.EnumProperty(name="Model", items=_choice_items(DISPERSION_MODELS))

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return next(choice.description for choice in DISPERSION_MODELS if choice.keyword == properties.model)

    def change(self, material: bpy.types.Material) -> None:
        parameter = BY_KEYWORD["dispersion_model"]
        set_parameter(rendered_node(material), parameter, parameter.check(self.model))


class SellmeierIor(_MaterialOperator):
    """Set IOR to the index that the Sellmeier coefficients have at 587.6 nm, so that their curve is not shifted"""

    bl_idname = "nested_dielectric.sellmeier_ior"
    bl_label = "Set IOR to Sellmeier's"

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
    """Choose the light that dispersion splits and the colours it is split into"""

    bl_idname = "nested_dielectric.spectrum"
    bl_label = "Spectrum"
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
        items=_choice_items(GAMUTS),
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


class UpdateMaterials(bpy.types.Operator):
    """Bring materials that another version of the extension made, and copies that an append made, to this version. Values,
    links, drivers and keyframes stay
    """

    bl_idname = "nested_dielectric.update_materials"
    bl_label = "Update Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not outdated_materials():
            cls.poll_message_set("All materials are of this version")
            return False
        return supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            changes = update_materials()
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for change in changes:
            self.report({"INFO"}, change)
        return {"FINISHED"}


class LampCarrier(bpy.types.Operator):
    """Let lobes or rays bring the light of the selected lamps, or of all if none is selected, through media"""

    bl_idname = "nested_dielectric.lamp_carrier"
    bl_label = "Refract Lamps by Lobe"
    bl_options = {"REGISTER", "UNDO"}

    carrier: bpy.props.EnumProperty(name="Carrier", items=_choice_items(LAMP_CARRIERS))

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        meaning = next(choice.description for choice in LAMP_CARRIERS if choice.keyword == properties.carrier)
        return f"{meaning}. Sets Ray Visibility > Transmission of the selected lamps, or of all if none is selected"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not any(obj.type == "LIGHT" for obj in context.scene.objects):
            cls.poll_message_set("The scene has no lamp; add one first")
            return False
        return supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        everything = lights.lamps(context.scene)
        chosen = [lamp for lamp in everything if lamp in (context.selected_objects or ())] or everything
        by_rays = self.carrier == lights.RAYS
        changed = []
        for lamp in chosen:
            reason = "" if by_rays else lights.unsuitable(lamp)
            if not lamp.is_editable:
                self.report({"WARNING"}, f"{lamp.name!r} belongs to a library; make it local first")
            elif reason:
                self.report({"WARNING"}, f"{lamp.name!r} stays with rays, because {reason}")
            elif lamp.visible_transmission != by_rays:
                lamp.visible_transmission = by_rays
                changed.append(lamp.name)
        try:
            updated = lights.update_lights(context.scene)
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if changed:
            self.report({"INFO"}, f"{'Rays' if by_rays else 'Lobes'} refract {', '.join(changed)}")
        elif not updated:
            self.report({"INFO"}, "Nothing to change")
        return {"FINISHED"}


class _SceneOperator(bpy.types.Operator):
    """What operators share that change a scene with media and say what they changed."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return has_media(cls, context) and supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        for change in self.change(context.scene) or ("Nothing to change",):
            self.report({"INFO"}, change)
        return {"FINISHED"}


class ShadowCaustics(_SceneOperator):
    """Switch Cycles' shadow caustics on or off: media cast them, all other objects receive them, lamps make them"""

    bl_idname = "nested_dielectric.shadow_caustics"
    bl_label = "Shadow Caustics"

    enable: bpy.props.BoolProperty(name="Enable", description="Switch shadow caustics on", default=True)

    def change(self, scene: bpy.types.Scene) -> tuple[str, ...]:
        return set_shadow_caustics(scene, self.enable)


class AddPasses(_SceneOperator):
    """Write direct and indirect refraction and reflection to the layers of an OpenEXR file beside the output"""

    bl_idname = "nested_dielectric.add_passes"
    bl_label = "Add Passes"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        if context.scene.render.engine != "CYCLES":
            cls.poll_message_set("Passes need Cycles; prepare the scene first")
            return False
        return True

    def change(self, scene: bpy.types.Scene) -> tuple[str, ...]:
        return add_passes(scene)


CLASSES = (
    DispersionModel,
    SellmeierIor,
    Spectrum,
    UpdateMaterials,
    LampCarrier,
    ShadowCaustics,
    AddPasses,
)
