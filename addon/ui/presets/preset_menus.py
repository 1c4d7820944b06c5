"""Where presets are chosen: a popover with groups, pictures and a search, and menus by groups."""

import textwrap

import bpy

from ...model.presets import GROUPS, Preset
from ...scene.preset_library import USER_GROUP, Catalogue, catalogue
from ..preferences import FIT, MEASURED
from .own_preset_operators import GROUP_ITEMS, DeletePreset, RenamePreset, SavePreset
from .preset_operators import AssignPreset, FitDepth
from .preset_pictures import picture

SHOWN = 24
"""Presets that a search shows."""

COLUMNS = 4
PICTURE_SCALE = 4.0
"""Height of a picture in heights of a button."""


def draw_presets(layout: bpy.types.UILayout, text: str = "Assign Preset") -> None:
    """Draw the button that opens the presets."""
    layout.popover(PresetPopover.bl_idname, text=text, icon="MATERIAL")


def draw_fit_depth(layout: bpy.types.UILayout) -> None:
    """Draw the buttons that fit the active medium's colour to the object, or back to what its preset was measured at."""
    row = layout.row(align=True)
    for depth, text in ((FIT, "Fit Depth"), (MEASURED, "As Measured")):
        row.operator(FitDepth.bl_idname, text=text).depth = depth


class PresetPopover(bpy.types.Panel):
    """All presets with pictures, by groups or by words, and those of the user's to rename and delete."""

    bl_idname = "NESTED_DIELECTRIC_PT_presets"
    bl_label = "Presets"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"INSTANCED"}
    bl_ui_units_x = 36

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        state = context.window_manager.nested_dielectric_presets
        found = catalogue()
        layout.prop(state, "search", text="", icon="VIEWZOOM", placeholder="Search by name or tag")
        columns = layout.split(factor=0.21)
        groups = columns.column(align=True)
        groups.enabled = not state.search.strip()
        shown = found.groups()
        for group in (*shown, *({USER_GROUP: None}.keys() - shown.keys())):
            groups.prop_enum(state, "group", group)
        column = columns.column()
        if state.search.strip():
            draw_found(column, found, found.search(state.search))
        else:
            draw_found(column, found, shown.get(state.group, []))
        layout.separator(type="LINE")
        layout.label(text="Click a name to make the selected objects of it", icon="INFO")
        layout.operator(SavePreset.bl_idname, text="Save Active Medium as Preset...", icon="FILE_TICK")
        for problem in found.problems:
            draw_problem(layout, problem)


def draw_found(layout: bpy.types.UILayout, found: Catalogue, presets: list[Preset]) -> None:
    """Draw presets to be assigned, each with its picture."""
    if not presets:
        layout.label(text="No preset is called so" if found.presets else "No presets", icon="INFO")
        return
    grid = layout.grid_flow(row_major=True, columns=COLUMNS, even_columns=True, even_rows=True, align=False)
    for preset in presets[:SHOWN]:
        draw_preset(grid, preset, preset.key in found.own)
    if len(presets) > SHOWN:
        layout.label(text=f"And {len(presets) - SHOWN} more: type another word", icon="BLANK1")


def draw_preset(layout: bpy.types.UILayout, preset: Preset, own: bool) -> None:
    """Draw one preset: its picture, its name as a button, and those that change one of the user's."""
    cell = layout.column(align=True)
    cell.template_icon(icon_value=picture(preset), scale=PICTURE_SCALE)
    row = cell.row(align=True)
    row.operator(AssignPreset.bl_idname, text=preset.name).preset = preset.key
    if own:
        row.operator(RenamePreset.bl_idname, text="", icon="GREASEPENCIL").preset = preset.key
        row.operator(DeletePreset.bl_idname, text="", icon="TRASH").preset = preset.key


def draw_problem(layout: bpy.types.UILayout, problem: str) -> None:
    """Draw what is wrong with a file that is no preset, in red."""
    lines = layout.column(align=True)
    lines.alert = True
    for index, line in enumerate(textwrap.wrap(problem, 70)):
        lines.label(text=line, icon="BLANK1" if index else "ERROR")


class PresetMenu(bpy.types.Menu):
    """The menu of all presets by groups."""

    bl_idname = "NESTED_DIELECTRIC_MT_presets"
    bl_label = "Assign Preset"
    bl_description = "Presets by groups"
    bl_options = {"SEARCH_ON_KEY_PRESS"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator(AssignPreset.bl_idname, text="Search Presets...", icon="VIEWZOOM")
        layout.separator()
        groups = catalogue().groups()
        for menu in GROUP_MENUS:
            if menu.bl_label in groups:
                layout.menu(menu.bl_idname)


class _GroupMenu:
    """The menu of the presets of one group."""

    bl_options = {"SEARCH_ON_KEY_PRESS"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        for preset in catalogue().groups().get(self.bl_label, ()):
            button = layout.operator(AssignPreset.bl_idname, text=preset.name, icon_value=picture(preset))
            button.preset = preset.key


def _group_menu(index: int, group: str) -> type[bpy.types.Menu]:
    words = {
        "bl_idname": f"NESTED_DIELECTRIC_MT_group_{index}",
        "bl_label": group,
        "bl_description": f"Presets: {group}",
    }
    return type(f"GroupMenu{index}", (_GroupMenu, bpy.types.Menu), words)


GROUP_MENUS = tuple(_group_menu(index, group) for index, group in enumerate((*GROUPS, USER_GROUP)))


class NestedDielectricPresetChoice(bpy.types.PropertyGroup):
    """What the popover shows."""

    group: bpy.props.EnumProperty(name="Group", description="Group of presets to show", items=GROUP_ITEMS)
    search: bpy.props.StringProperty(
        name="Search",
        description="Words in the name, the tags or the description of presets, of all groups",
        options={"TEXTEDIT_UPDATE", "SKIP_SAVE"},
    )


CLASSES = (NestedDielectricPresetChoice, PresetPopover, *GROUP_MENUS, PresetMenu)
