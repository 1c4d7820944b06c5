"""Panels: a scene's media in winning order, and what keeps them from rendering."""

from __future__ import annotations

import textwrap

import bpy
import bpy.utils.previews
import numpy as np

from .analysis import last_found
from .compatibility import achromatic_reason, blender_note, blender_problem, settings_problem, shows_front_ior
from .dispersion import LINE_C, LINE_D, LINE_F, abbe_number, material_ior
from .lights import LOBE, NOTHING, RAYS, light_carriers
from .materials import (
    get_parameter,
    material_table,
    medium_material,
    parameter_socket,
    rendered_node,
    usable_spectrum_settings,
)
from .media import get_priority, own_priority
from .media_list import listed_media
from .operators import (
    LAMP_CARRIERS,
    SELLMEIER_REMEDY,
    AddPasses,
    ClearAnalysis,
    DispersionModel,
    LampCarrier,
    Prepare,
    PriorityMove,
    PriorityOwn,
    SellmeierIor,
    ShadowCaustics,
    Spectrum,
    UpdateMaterials,
    active_medium,
    coefficients_ior,
)
from .parameters import BY_KEYWORD, DISPERSION_MODELS, PRIORITY_PROPERTY
from .preset_menus import draw_presets
from .spectra import DISTRIBUTIONS, GAMUTS, preview
from .spectral_images import digest
from .versions import outdated_materials, version_problems

MODEL_SOCKETS = {
    "ABBE": ("ior", "abbe"),
    "SELLMEIER": ("ior", "sellmeier_b", "sellmeier_c"),
    "JF": ("ior", "dispersion"),
}
"""What each dispersion model reads."""

REMEDIES = {
    "ABBE": "set a larger Abbe number, or 0 for no dispersion",
    "SELLMEIER": SELLMEIER_REMEDY,
    "JF": "bring Dispersion nearer to 0",
}
"""What to do when a model has no index above 0."""

IOR_TOLERANCE = 1e-4
"""How far IOR may be from the index of the Sellmeier coefficients before the panel says so."""

CARRIERS = {RAYS: "Rays", LOBE: "Lobe", NOTHING: "None"}
"""What carries a lamp's light, in the panel's words."""

MAX_LAMPS = 24
"""Lamps that the panel lists; a scene may have thousands."""

PICTURE_SIZE = (256, 256)
MAX_PICTURES = 32

_pictures: bpy.utils.previews.ImagePreviewCollection | None = None
"""Pictures of spectral tables by the tables' digests, while the extension is registered."""


class MediaList(bpy.types.UIList):
    """The scene's media, the one that wins over all others on top."""

    bl_idname = "NESTED_DIELECTRIC_UL_media"

    def filter_items(self, context: bpy.types.Context, data: bpy.types.Scene, property: str) -> tuple[list, list]:
        objects = list(getattr(data, property))
        ordered = list(listed_media(data).own)
        found = set(ordered)
        ordered += [obj for obj in objects if obj not in found]
        place = {obj: index for index, obj in enumerate(ordered)}
        shown = bpy.types.UI_UL_list.filter_items_by_name(self.filter_name, self.bitflag_filter_item, objects)
        shown = shown or [self.bitflag_filter_item] * len(objects)
        flags = [flag if obj in found else 0 for flag, obj in zip(shown, objects)]
        return flags, [place[obj] for obj in objects]

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "filter_name", text="", icon="VIEWZOOM")

    def draw_item(self, context, layout, data, item, icon, active_data, active_property) -> None:
        draw_medium(layout, item, icon)


def get_active(scene: bpy.types.Scene) -> int:
    """The row of the active object, so that the list follows every selection."""
    active = bpy.context.view_layer.objects.active
    return -1 if active is None else scene.objects.find(active.name)


def set_active(scene: bpy.types.Scene, index: int) -> None:
    """Make the object of a row the active and only selected one; as in the Outliner, no other than in Object Mode."""
    layer = bpy.context.view_layer
    obj = scene.objects[index]
    active = layer.objects.active
    if layer.objects.get(obj.name) != obj or (active is not None and active.mode != "OBJECT"):
        return
    for other in layer.objects.selected:
        other.select_set(False, view_layer=layer)
    obj.select_set(True, view_layer=layer)
    layer.objects.active = obj


def draw_medium(layout: bpy.types.UILayout, obj: bpy.types.Object, icon: int) -> None:
    """One row: the object, its priority and whose priority that is."""
    columns = layout.split(factor=0.55, align=True)
    columns.enabled = obj.is_editable
    columns.prop(obj, "name", text="", emboss=False, icon_value=icon)
    draw_priority(columns.row(align=True), obj)


def draw_priority(layout: bpy.types.UILayout, obj: bpy.types.Object, text: str = "") -> None:
    """An object's own priority to edit, or its material's to read, marked as such, and the button between the two."""
    own = own_priority(obj) is not None
    if own:
        layout.prop(obj, f'["{PRIORITY_PROPERTY}"]', text=text)
    else:
        value = layout.row(align=True)
        value.active = False
        odd = PRIORITY_PROPERTY in obj
        value.alert = odd
        value.label(text=f"{text} {get_priority(obj)}", icon="ERROR" if odd else "MATERIAL")
    toggle = layout.operator(PriorityOwn.bl_idname, text="", icon="PINNED" if own else "UNPINNED", depress=own)
    toggle.name = obj.name


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Everything a panel shows, for the Object properties and the 3D view alike."""
    draw_problem(layout, context)
    draw_media(layout, context)
    draw_active(layout, context)


def draw_problem(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Why nothing would render as it should, in as many lines as it takes, and the button that mends the scene."""
    problem = blender_problem() or settings_problem(context.scene)
    note = blender_note()
    if problem:
        draw_alert(layout, context, problem)
    elif note:
        draw_text(layout, context, note, "INFO")
    draw_versions(layout, context)
    layout.operator(Prepare.bl_idname, icon="CHECKMARK")


def draw_versions(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Materials of another version and copies, and the button that updates them; what cannot be updated here."""
    outdated = outdated_materials()
    if outdated:
        text = f"From another version, or a copy: {', '.join(outdated)}"
        draw_text(layout, context, textwrap.shorten(text, 200, placeholder=" ..."), "FILE_REFRESH")
        layout.operator(UpdateMaterials.bl_idname, icon="FILE_REFRESH")
    for problem in version_problems():
        draw_alert(layout, context, str(problem))


def draw_alert(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    """A problem, in red."""
    lines = layout.column()
    lines.alert = True
    draw_text(lines, context, text, "ERROR")


def draw_text(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """A text in as many lines as the region's width makes of it, the first with an icon."""
    lines = layout.column(align=True)
    characters = int(context.region.width / context.preferences.system.ui_scale / 8.0)
    for index, line in enumerate(textwrap.wrap(text[0].upper() + text[1:], max(characters, 20))):
        lines.label(text=line, icon="BLANK1" if index else icon)


def draw_media(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The scene's own objects as a list to select and move in, then those that instances bring in."""
    scene = context.scene
    row = layout.row()
    row.template_list(
        MediaList.bl_idname, "", scene, "objects", scene, "nested_dielectric_active", rows=4, sort_lock=True
    )
    buttons = row.column(align=True)
    buttons.enabled = context.object is not None and medium_material(context.object) is not None
    for direction, icon in (("UP", "TRIA_UP"), ("DOWN", "TRIA_DOWN")):
        buttons.operator(PriorityMove.bl_idname, text="", icon=icon).direction = direction

    instanced = listed_media(scene).instanced
    if instanced:
        rows = layout.box().column(align=True)
        rows.label(text="In Instanced Collections", icon="OUTLINER_OB_GROUP_INSTANCE")
        for obj in instanced:
            draw_medium(rows, obj, layout.icon(obj))


def draw_active(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The active object's material and priority, and the presets to give it another."""
    obj = context.object
    material = medium_material(obj) if obj is not None else None
    if material is not None:
        column = layout.column(align=True)
        column.label(text=f"{obj.name}: {material.name}", icon="MATERIAL")
        socket = parameter_socket(material, "Priority")
        if socket is not None:
            column.prop(socket, "default_value", text="Priority of Material")
        draw_priority(column.row(align=True), obj, text="Priority")
    draw_presets(layout)


def draw_analysis(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Which media spare rays, which do not, and why."""
    found = last_found(context.scene)
    if found is None:
        draw_text(
            layout, context, "All media ask the scene what surrounds them; Prepare Scene looks at it beforehand", "INFO"
        )
    else:
        for line in str(found).splitlines():
            draw_text(layout, context, line, "INFO")
    layout.operator(ClearAnalysis.bl_idname, icon="X")


def draw_dispersion(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The dispersion of the active medium: its sockets, what they come to, and what keeps colours from showing."""
    node = rendered_node(active_medium(context))
    layout.use_property_split = True
    layout.use_property_decorate = False
    disperse = node.inputs["Disperse"]
    layout.prop(disperse, "default_value", text=disperse.name)
    if disperse.default_value:
        reason = achromatic_reason(context.scene)
        if reason is not None:
            draw_alert(layout, context, reason)
        viewport = "Cycles' own colours for it, in daylight" if shows_front_ior() else "it as at 587.6 nm"
        draw_text(layout, context, f"The viewport shows {viewport}; see its spectrum's colours in a render", "INFO")

    model = get_parameter(node, BY_KEYWORD["dispersion_model"])
    buttons = layout.row(align=True)
    for choice in DISPERSION_MODELS:
        button = buttons.operator(DispersionModel.bl_idname, text=choice.name, depress=choice.keyword == model)
        button.model = choice.keyword
    sockets = layout.column()
    for keyword in MODEL_SOCKETS[model]:
        name = BY_KEYWORD[keyword].name
        sockets.prop(node.inputs[name], "default_value", text=name)
    draw_indices(layout, context, node)


def draw_indices(layout: bpy.types.UILayout, context: bpy.types.Context, node: bpy.types.ShaderNodeGroup) -> None:
    """A medium's index at Fraunhofer's lines and its Abbe number, or what to do where it has none."""
    model = get_parameter(node, BY_KEYWORD["dispersion_model"])
    values = {keyword: get_parameter(node, BY_KEYWORD[keyword]) for keyword in MODEL_SOCKETS[model]}
    values["dispersion_model"] = model
    lines = {"n_C": LINE_C, "n_d": LINE_D, "n_F": LINE_F}
    indices = {name: material_ior(values, wavelength) for name, wavelength in lines.items()}
    unreal = [f"{lines[name]:.1f}" for name, index in indices.items() if not index > 0.0]
    if unreal:
        draw_alert(layout, context, f"No real index above 0 at {', '.join(unreal)} nm; {REMEDIES[model]}")
        return
    rows = layout.column(align=True)
    for name, index in indices.items():
        draw_value(rows, name, f"{index:.5f} ({lines[name]:.1f} nm)")
    abbe = abbe_number(values)
    draw_value(rows, "V_d", f"{abbe:.2f}" if np.isfinite(abbe) else "no dispersion")

    own = coefficients_ior(node)
    if model == "SELLMEIER" and abs(own - values["ior"]) > IOR_TOLERANCE:
        text = f"IOR is not the coefficients' own {own:.5f}; their curve is shifted to go through IOR"
        draw_text(layout, context, text, "INFO")
        layout.operator(SellmeierIor.bl_idname, text=f"Set IOR to {own:.5f}")


def draw_value(layout: bpy.types.UILayout, name: str, value: str) -> None:
    """A name and a value to read, placed as a property's."""
    columns = layout.split(factor=0.4)
    label = columns.row()
    label.alignment = "RIGHT"
    label.label(text=name)
    columns.label(text=value)


def draw_spectrum(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The active medium's spectral table: its picture, what it was baked from, and the button to bake another."""
    material = active_medium(context)
    settings = usable_spectrum_settings(material)
    table = material_table(material)
    if table is not None:
        layout.template_icon(icon_value=picture(table), scale=6.0)
    names = {choice.keyword: choice.name for choice in (*DISTRIBUTIONS, *GAMUTS)}
    distribution = str(settings["spectral_distribution"])
    gamut = str(settings["spectral_gamut"])
    rows = layout.column(align=True)
    draw_value(rows, "Distribution", names.get(distribution.upper()) or bpy.path.basename(distribution))
    draw_value(rows, "Gamut", names.get(gamut, gamut))
    draw_value(rows, "Saturation", f"{settings['spectral_saturation']:.3g}")
    draw_value(rows, "Negative", "clamped" if settings["clamp_negative"] else "kept")
    layout.operator(Spectrum.bl_idname, text="Spectrum...")


def draw_lamps(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What brings each lamp's light through media and off them, and the buttons to change it."""
    carriers = sorted(light_carriers(context.scene), key=lambda carrier: not carrier.reason)
    if carriers:
        rows = layout.box().column(align=True)
        draw_lamp(rows, "Lamp", "Refraction", "Reflection").active = False
        for carrier in carriers[:MAX_LAMPS]:
            words = CARRIERS[carrier.refraction], CARRIERS[carrier.reflection]
            draw_lamp(rows, carrier.lamp, *words, alert=bool(carrier.reason))
        if len(carriers) > MAX_LAMPS:
            rows.label(text=f"And {len(carriers) - MAX_LAMPS} more", icon="BLANK1")
    reasons: dict[str, list[str]] = {}
    for carrier in carriers:
        if carrier.reason:
            reasons.setdefault(carrier.reason, []).append(repr(carrier.lamp))
    for reason, names in reasons.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        draw_alert(layout, context, f"No lobe can carry {', '.join(names[:3])}{more}: {reason}")

    buttons = layout.row(align=True)
    for choice in LAMP_CARRIERS:
        button = buttons.operator(LampCarrier.bl_idname, text=f"Refract by {choice.name}")
        button.carrier = choice.keyword
    layout.separator()
    columns = layout.split(factor=0.5, align=True)
    columns.label(text="Shadow Caustics")
    for enable, text in ((True, "On"), (False, "Off")):
        columns.operator(ShadowCaustics.bl_idname, text=text).enable = enable
    layout.operator(AddPasses.bl_idname, text="Add Passes", icon="RENDERLAYERS")


def draw_lamp(
    layout: bpy.types.UILayout, name: str, refraction: str, reflection: str, alert: bool = False
) -> bpy.types.UILayout:
    """One row: a lamp and what carries its light through media and off them."""
    row = layout.row(align=True)
    row.alert = alert
    columns = row.split(factor=0.4)
    columns.label(text=name)
    for text in (refraction, reflection):
        columns.label(text=text)
    return row


def picture(table: np.ndarray) -> int:
    """The icon that shows a spectral table, drawn on first use."""
    name = digest(table)
    if name not in _pictures:
        if len(_pictures) >= MAX_PICTURES:
            del _pictures[next(iter(_pictures))]
        pixels = preview(table, *PICTURE_SIZE)
        linear = pixels[..., :3]
        # sRGB's transfer curve (IEC 61966-2-1): icons are not managed.
        pixels[..., :3] = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
        drawn = _pictures.new(name)
        drawn.image_size = PICTURE_SIZE
        drawn.image_pixels_float.foreach_set(pixels.ravel())
    return _pictures[name].icon_id


def open_pictures() -> None:
    """Make room for the panels' pictures."""
    global _pictures
    _pictures = bpy.utils.previews.new()


def close_pictures() -> None:
    """Give back what the panels' pictures take."""
    global _pictures
    bpy.utils.previews.remove(_pictures)
    _pictures = None


class _ObjectProperties:
    """Where a panel of the Object properties stands."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}


class _Sidebar:
    """Where a panel of the 3D view's sidebar stands."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Nested Dielectric"


class _MediaPanel:
    """What both panels show."""

    bl_label = "Nested Dielectric"

    def draw(self, context: bpy.types.Context) -> None:
        draw(self.layout, context)


class _ActiveMediumPanel:
    """Shown while the active object is a medium."""

    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return active_medium(context) is not None


class _DispersionPanel(_ActiveMediumPanel):
    """What both panels show of dispersion."""

    bl_label = "Dispersion"

    def draw(self, context: bpy.types.Context) -> None:
        draw_dispersion(self.layout, context)


class _SpectrumPanel(_ActiveMediumPanel):
    """What both panels show of the spectral table."""

    bl_label = "Spectrum"

    def draw(self, context: bpy.types.Context) -> None:
        draw_spectrum(self.layout, context)


class ObjectPanel(_MediaPanel, _ObjectProperties, bpy.types.Panel):
    """Media of the scene, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object"


class ObjectDispersionPanel(_DispersionPanel, _ObjectProperties, bpy.types.Panel):
    """The active medium's dispersion, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object_dispersion"
    bl_parent_id = ObjectPanel.bl_idname


class ObjectSpectrumPanel(_SpectrumPanel, _ObjectProperties, bpy.types.Panel):
    """The active medium's spectral table, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object_spectrum"
    bl_parent_id = ObjectDispersionPanel.bl_idname


class SidebarPanel(_MediaPanel, _Sidebar, bpy.types.Panel):
    """Media of the scene, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar"


class SidebarDispersionPanel(_DispersionPanel, _Sidebar, bpy.types.Panel):
    """The active medium's dispersion, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_dispersion"
    bl_parent_id = SidebarPanel.bl_idname


class SidebarSpectrumPanel(_SpectrumPanel, _Sidebar, bpy.types.Panel):
    """The active medium's spectral table, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_spectrum"
    bl_parent_id = SidebarDispersionPanel.bl_idname


class SidebarLampsPanel(_Sidebar, bpy.types.Panel):
    """The scene's lamps and what carries their light, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_lamps"
    bl_parent_id = SidebarPanel.bl_idname
    bl_label = "Lamps"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_lamps(self.layout, context)


class SidebarAnalysisPanel(_Sidebar, bpy.types.Panel):
    """What the media know of each other, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_analysis"
    bl_parent_id = SidebarPanel.bl_idname
    bl_label = "Scene Analysis"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_analysis(self.layout, context)


CLASSES = (
    MediaList,
    ObjectPanel,
    ObjectDispersionPanel,
    ObjectSpectrumPanel,
    SidebarPanel,
    SidebarDispersionPanel,
    SidebarSpectrumPanel,
    SidebarLampsPanel,
    SidebarAnalysisPanel,
)
