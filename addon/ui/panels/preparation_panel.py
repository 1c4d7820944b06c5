"""What the last preparation of a scene found and changed."""

from __future__ import annotations

import bpy

from ...analysis.validity import is_analysed
from ...preparation.prepare_scene import taken_back
from ...preparation.report import Report, last_report
from ..drawing import draw_text
from ..icons import ready_icon
from ..media_list import listed_media
from ..operators.preparation_operators import Prepare, PutBack, ShowProblem
from .notices import render_problem

OPEN_PROBLEMS = 1
"""Problems whose remedies are shown before they are asked for."""


def draw_preparation(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the button that prepares the scene, and what came of it the last time."""
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
    """Draw whether the scene was ready, and still may be."""
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
    """Draw the problems that the last preparation left, each with a button that shows where it is, and the remedy."""
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
    """Draw what preparations have changed, and the button that takes it back."""
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
