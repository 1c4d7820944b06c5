"""Panels of a scene: whether it is ready to render, its media in winning order, and what they know of each other."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import bpy

from ...analysis.analysis import is_analysed, last_found
from ...cutting.backends import last_chosen
from ...cutting.cutting import is_cut, is_kept, last_cut
from ...model.parameters import GROUP_NAME, PRIORITY_PROPERTY
from ...nodes.compatibility import BACKENDS, blender_note, blender_problem, get_backend
from ...nodes.lookups import unchanged_nodes
from ...nodes.trees import is_plugged
from ...preparation.preparation import taken_back
from ...preparation.report import Report, last_report
from ...preparation.versions import outdated_materials, version_problems
from ...scene.materials import medium_material, parameter_socket
from ...scene.media import get_priority, own_priority
from ...scene.priorities import in_words
from ..drawing import ObjectProperties, Sidebar, draw_alert, draw_text
from ..icons import ready_icon
from ..notices import render_problem
from ..operators.operators import UpdateMaterials
from ..operators.preparation_operators import (
    ClearAnalysis,
    CutSurfaces,
    KeepCut,
    Prepare,
    PutBack,
    RenderWith,
    ShowProblem,
)
from ..operators.priority_operators import OpenMaterial, PriorityMove, PriorityOwn, SelectObjects, SpaceOut
from ..presets.preset_menus import draw_presets
from .media_list import Line, is_open, listed_lines, listed_media
from .media_rows import active_line, make_places

OPEN_PROBLEMS = 1
"""Problems whose remedies are shown before they are asked for."""

MOST_LINES = 20
"""Names whose reasons are listed."""

NAME_WIDTH = 0.68
"""Part of a row that a name takes; the rest holds a priority of four digits at the default width of the sidebar."""


class MediaList(bpy.types.UIList):
    """The scene's media, the one that wins over all others on top."""

    bl_idname = "NESTED_DIELECTRIC_UL_media"

    def filter_items(self, context: bpy.types.Context, data: bpy.types.WindowManager, property: str) -> tuple:
        lines = listed_lines(context.scene).lines
        text = self.filter_name.lower()
        flags = [self.bitflag_filter_item if not text or _holds(line, text) else 0 for line in lines]
        places = len(getattr(data, property))
        return (flags + [0] * places)[:places], []

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "filter_name", text="", icon="VIEWZOOM")

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index) -> None:
        lines = listed_lines(context.scene).lines
        if index >= len(lines):
            return
        line = lines[index]
        if isinstance(line.chosen, bpy.types.Material):
            draw_material(layout, line)
        else:
            draw_object(layout, line, context.scene)


def _holds(line: Line, text: str) -> bool:
    return text in line.chosen.name.lower() or any(text in obj.name.lower() for obj in line.row.objects if not line.obj)


def draw_material(layout: bpy.types.UILayout, line: Line) -> None:
    """A material: whether its objects are shown, its colour, its name, how many objects rely on it, and its priority."""
    columns = layout.split(factor=NAME_WIDTH, align=True)
    row = columns.row(align=True)
    material = line.row.owner
    icon = "DISCLOSURE_TRI_DOWN" if is_open(line.row) else "DISCLOSURE_TRI_RIGHT"
    row.operator(OpenMaterial.bl_idname, text="", icon=icon, emboss=False).number = material.session_uid
    swatch = row.row(align=True)
    swatch.ui_units_x = 0.7
    colour = _socket(material, "Transmittance")
    if colour is not None:
        swatch.prop(colour, "default_value", text="")
    else:
        swatch.prop(material, "diffuse_color", text="")
    row.separator(factor=0.4)
    row.label(text=f"{material.name} ({len(line.row.objects)})")
    priority = _socket(material, "Priority")
    if priority is not None:
        columns.prop(priority, "default_value", text="")
    else:
        columns.label(text=str(line.row.priority), icon="NODETREE")


def _socket(material: bpy.types.Material, name: str) -> bpy.types.NodeSocket | None:
    """As :func:`parameter_socket`; in a hundredth of the time where the node is plugged in itself."""
    node = material.node_tree.nodes.get(GROUP_NAME)
    socket = node.inputs.get(name) if node is not None and is_plugged(node) else None
    return socket if socket is not None and not socket.is_linked else parameter_socket(material, name)


def draw_object(layout: bpy.types.UILayout, line: Line, scene: bpy.types.Scene) -> None:
    """An object: its name, and its own priority or the button that gives it one."""
    obj = line.chosen
    is_here = scene.objects.get(obj.name) == obj
    icon = "OBJECT_DATA" if is_here else "OUTLINER_OB_GROUP_INSTANCE"
    columns = layout.split(factor=NAME_WIDTH, align=True) if line.row.is_own else layout.row(align=True)
    names = columns.row(align=True)
    if not line.row.is_own:
        names.label(text="", icon="BLANK1")
    name = names.row(align=True)
    name.active = is_here
    name.prop(obj, "name", text="", emboss=False, icon=icon)
    _draw_pin(names, obj)
    if line.row.is_own:
        columns.prop(obj, f'["{PRIORITY_PROPERTY}"]', text="")


def _draw_pin(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    own = own_priority(obj) is not None
    icon = "PINNED" if own else "UNPINNED"
    layout.operator(PriorityOwn.bl_idname, text="", icon=icon, emboss=not own, depress=own).name = obj.name


@unchanged_nodes()
def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Everything a panel shows, for the Object properties and the 3D view alike."""
    draw_problem(layout, context)
    draw_preparation(layout, context)
    draw_backend(layout, context)
    draw_cut(layout, context)
    draw_media(layout, context)
    draw_active(layout, context)


def draw_problem(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Why nothing would render as it should, in as many lines as it takes; in a scene without media what they would need."""
    problem = render_problem(context.scene)
    note = blender_note()
    if problem:
        draw_alert(layout, context, problem)
    elif not listed_media(context.scene).rows:
        wrong = blender_problem()
        text = (
            f"They would not render here: {wrong}"
            if wrong
            else (
                "Select an object and assign a preset; Prepare Scene then sets what they need, such as Cycles and enough bounces"
            )
        )
        draw_text(layout, context, f"No media yet. {text}", "INFO")
    if note:
        draw_text(layout, context, note, "INFO")
    draw_versions(layout, context)


def draw_versions(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Materials of another version and copies, and the button that updates them; what cannot be updated here."""
    outdated = outdated_materials()
    if outdated:
        text = f"From another version, or a copy: {', '.join(outdated)}"
        draw_text(layout, context, textwrap.shorten(text, 200, placeholder=" ..."), "FILE_REFRESH")
        layout.operator(UpdateMaterials.bl_idname, icon="FILE_REFRESH")
    shown = render_problem(context.scene)
    for problem in version_problems() if listed_media(context.scene).rows else ():
        if str(problem) != shown:
            draw_alert(layout, context, str(problem))


def draw_preparation(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The button that prepares the scene, and what came of it the last time."""
    layout.operator(Prepare.bl_idname, icon="CHECKMARK")
    report = last_report(context.scene)
    if report is None:
        return
    if report.problems:
        draw_problems(layout, context, report)
    elif report.media and not render_problem(context.scene):
        draw_readiness(layout, context, report)
    draw_changes(layout, context, report)


def draw_readiness(layout: bpy.types.UILayout, context: bpy.types.Context, report: Report) -> None:
    """Whether the scene was ready, and still may be."""
    count = len(listed_media(context.scene).places)
    if count != report.media:
        draw_text(layout, context, "Media have come or gone since the last Prepare", "FILE_REFRESH")
        return
    rows = layout.column(align=True)
    rows.label(text="Ready to Render", icon_value=ready_icon())
    old = rows.row()
    old.active = False
    old.label(text="As of the last Prepare", icon="BLANK1")


def draw_problems(layout: bpy.types.UILayout, context: bpy.types.Context, report: Report) -> None:
    """The problems that the last preparation left, each with a button that shows where it is, and the remedy."""
    count = len(report.problems) + report.more_problems
    title = layout.row()
    title.alert = True
    title.label(text=f"{count} Problem{'s' * (count != 1)} at the Last Prepare", icon="ERROR")
    for index, problem in enumerate(report.problems):
        header, body = layout.panel(f"nested_dielectric_problem_{index}", default_closed=index >= OPEN_PROBLEMS)
        header.operator(ShowProblem.bl_idname, text=problem.name, icon="VIEWZOOM").name = problem.name
        if body is not None:
            draw_text(body, context, problem.text, "DOT")
            draw_text(body, context, problem.remedy, "TOOL_SETTINGS")
    if report.more_problems:
        layout.label(text=f"And {report.more_problems} more", icon="BLANK1")


def draw_changes(layout: bpy.types.UILayout, context: bpy.types.Context, report: Report) -> None:
    """What preparations have changed, and the button that takes it back."""
    lines = [*taken_back(context.scene, report), *report.changes]
    if report.more_changes:
        lines.append(f"And {report.more_changes} more")
    parted = listed_media(context.scene).parted
    if parted:
        lines.append(f"Faces in the same place: parted in {parted} object{'s' * (parted != 1)}")
    if is_analysed(context.scene):
        lines.append("Media are told what surrounds them")
    header, body = layout.panel("nested_dielectric_changes", default_closed=True)
    header.label(text=f"{len(lines)} Change{'s' * (len(lines) != 1)}")
    header.operator(PutBack.bl_idname, icon="LOOP_BACK")
    for line in lines if body is not None else ():
        draw_text(body, context, line, "DOT")


def draw_backend(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The choice of what renders the media, and which materials are left to the shader and why."""
    scene = context.scene
    if not listed_media(scene).rows:
        return
    backend = get_backend(scene)
    name = next(choice.name for choice in BACKENDS if choice.keyword == backend)
    layout.operator_menu_enum(RenderWith.bl_idname, "backend", text=f"Render With: {name}")
    chosen = last_chosen(scene)
    if chosen is None or not chosen.headline:
        return
    if not chosen.osl:
        draw_text(layout, context, chosen.headline, "INFO")
        return
    header, body = layout.panel("nested_dielectric_backends", default_closed=True)
    header.label(text=chosen.headline, icon="INFO")
    if body is not None:
        _draw_reasons(body, context, chosen.osl)


def _draw_reasons(layout: bpy.types.UILayout, context: bpy.types.Context, reasons: Sequence[tuple[str, str]]) -> None:
    """Names, each with a button that shows what has it, and reasons; of very many the first."""
    for name, reason in reasons[:MOST_LINES]:
        layout.row().operator(ShowProblem.bl_idname, text=name, icon="VIEWZOOM").name = name
        draw_text(layout, context, reason, "DOT")
    if len(reasons) > MOST_LINES:
        layout.label(text=f"And {len(reasons) - MOST_LINES} more", icon="BLANK1")


def draw_cut(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The switch of whether surfaces are cut in renders, and what cannot be and why."""
    scene = context.scene
    cut = is_cut(scene)
    if not cut and not listed_media(scene).rows:
        return
    row = layout.row(align=True)
    row.operator(CutSurfaces.bl_idname, icon="CHECKBOX_HLT" if cut else "CHECKBOX_DEHLT", depress=cut)
    if cut:
        row.operator(KeepCut.bl_idname, depress=is_kept(scene))
    found = last_cut(scene)
    if found is None or not found.asking:
        return
    header, body = layout.panel("nested_dielectric_uncut", default_closed=True)
    header.label(text=f"{len(found.asking)} of {len(found.asking) + len(found.media)} Not Cut", icon="INFO")
    if body is not None:
        _draw_reasons(body, context, found.asking)


def draw_media(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The scene's media by material, to choose and to move, and what the active row's priority means."""
    scene = context.scene
    make_places(scene)
    manager = bpy.context.window_manager
    layout.template_list(
        MediaList.bl_idname,
        "",
        manager,
        "nested_dielectric_places",
        scene,
        "nested_dielectric_active",
        rows=4,
        sort_lock=True,
    )
    line = active_line(scene)
    if not listed_media(scene).rows:
        return
    buttons = layout.row(align=True)
    arrows = buttons.row(align=True)
    arrows.enabled = line is not None
    for direction, icon in (("UP", "TRIA_UP"), ("DOWN", "TRIA_DOWN")):
        arrows.operator(PriorityMove.bl_idname, text="", icon=icon).direction = direction
    buttons.operator(SelectObjects.bl_idname)
    buttons.operator(SpaceOut.bl_idname, text="Space Out")
    if line is not None:
        draw_text(layout, context, f"{line.row.owner.name} {in_words(listed_media(scene).rows, line.row)}", "INFO")


def draw_active(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The active object's material and priority, and the presets to give it another."""
    obj = context.object
    material = medium_material(obj) if obj is not None else None
    if material is not None:
        column = layout.column(align=True)
        column.label(text=f"{obj.name}: {material.name}", icon="MATERIAL")
        draw_priority(column.row(align=True), obj, text="Priority")
    draw_presets(layout)


def draw_priority(layout: bpy.types.UILayout, obj: bpy.types.Object, text: str = "") -> None:
    """An object's own priority to edit, or its material's to read, marked as such, and the button between the two."""
    if own_priority(obj) is not None:
        layout.prop(obj, f'["{PRIORITY_PROPERTY}"]', text=text)
    else:
        value = layout.row(align=True)
        value.active = False
        odd = PRIORITY_PROPERTY in obj
        value.alert = odd
        value.label(text=f"{text} {get_priority(obj)}, its material's", icon="ERROR" if odd else "BLANK1")
    _draw_pin(layout, obj)


def draw_analysis(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Which media spare rays, which do not, and why."""
    found = last_found(context.scene)
    if found is None:
        draw_text(
            layout, context, "All media ask the scene what surrounds them; Prepare Scene looks at it beforehand", "INFO"
        )
    else:
        cut = last_cut(context.scene)
        for line in str(found.without(cut.media) if cut else found).splitlines():
            draw_text(layout, context, line, "INFO")
    layout.operator(ClearAnalysis.bl_idname, icon="X")


class _MediaPanel:
    """What both panels show."""

    bl_label = "Nested Dielectric"

    def draw(self, context: bpy.types.Context) -> None:
        draw(self.layout, context)


class ObjectPanel(_MediaPanel, ObjectProperties, bpy.types.Panel):
    """Media of the scene, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object"


class SidebarPanel(_MediaPanel, Sidebar, bpy.types.Panel):
    """Media of the scene, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar"


class SidebarAnalysisPanel(Sidebar, bpy.types.Panel):
    """What the media know of each other, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_analysis"
    bl_parent_id = SidebarPanel.bl_idname
    bl_label = "Scene Analysis"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_analysis(self.layout, context)


CLASSES = (MediaList, ObjectPanel, SidebarPanel)
LAST_CLASSES = (SidebarAnalysisPanel,)
"""Panels below those of the active medium."""
