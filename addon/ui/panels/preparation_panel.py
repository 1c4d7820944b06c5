"""What the last preparation, or check, of a scene found and changed."""

from __future__ import annotations

import bpy

from ...analysis.validity import is_analysed
from ...checking.finding import Finding
from ...checking.kinds import Severity
from ...preparation.prepare_scene import taken_back
from ...preparation.report import Report, last_report
from ..drawing import draw_text
from ..icons import ready_icon
from ..media_list import listed_media
from ..operators.preparation_operators import Prepare, PutBack
from ..operators.problem_operators import Check, FixAll, FixProblem, ShowProblem
from .notices import render_problem

OPEN_PROBLEMS = 1
"""Problems whose remedies are shown before they are asked for."""

ICONS = {Severity.WRONG: "ERROR", Severity.SLOW: "TIME", Severity.NOTE: "INFO"}


def draw_preparation(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the buttons that prepare the scene and check it, and what came of it the last time."""
    buttons = layout.row(align=True)
    buttons.operator(Prepare.bl_idname, icon="CHECKMARK")
    buttons.operator(Check.bl_idname, text="", icon="VIEWZOOM")
    report = last_report(context.scene)
    if report is None:
        return
    if any(each.severity != Severity.NOTE for each in report.problems):
        draw_problems(layout, context, report)
    elif report.media and not render_problem(context.scene):
        draw_readiness(layout, context, report)
    draw_notes(layout, context, report)
    draw_changes(layout, context, report)


def draw_readiness(layout: bpy.types.UILayout, context: bpy.types.Context, report: Report) -> None:
    """Draw whether the scene was ready, and still may be."""
    count = len(listed_media(context.scene).places)
    if count != report.media:
        draw_text(layout, context, "Media have come or gone since the last Prepare", "FILE_REFRESH")
        return
    rows = layout.column(align=True)
    if not is_analysed(context.scene):
        draw_text(rows, context, "No problems at the last check; Prepare Scene makes it ready", "CHECKMARK")
        return
    rows.label(text="Ready to Render", icon_value=ready_icon())
    draw_age(rows, "As of the last Prepare")


def draw_age(layout: bpy.types.UILayout, text: str) -> None:
    """Draw when what stands above was so, in grey."""
    old = layout.row()
    old.active = False
    old.label(text=text, icon="BLANK1")


def draw_problems(layout: bpy.types.UILayout, context: bpy.types.Context, report: Report) -> None:
    """Draw the problems that were left or found, and the button that mends what is safe to mend."""
    problems = [(index, each) for index, each in enumerate(report.problems) if each.severity != Severity.NOTE]
    count = len(problems) + report.more_problems
    rows = layout.column(align=True)
    title = rows.row()
    words = title.row()
    words.alert = True
    words.label(text=f"{count} Problem{'s' * (count != 1)}", icon="ERROR")
    if any(problem.fix is not None and problem.fix.safe for _, problem in problems):
        title.operator(FixAll.bl_idname, icon="TOOL_SETTINGS")
    draw_age(rows, "As of the last check")
    for place, (index, problem) in enumerate(problems):
        draw_finding(layout, context, index, problem, place < OPEN_PROBLEMS)
    if report.more_problems:
        layout.label(text=f"And {report.more_problems} more", icon="BLANK1")


def draw_finding(
    layout: bpy.types.UILayout, context: bpy.types.Context, index: int, finding: Finding, is_open: bool
) -> None:
    """Draw how bad a finding is, what shows where it is and what mends it; beneath, what is wrong, how it looks, the remedy.

    :param index: its place in the report.
    """
    header, body = layout.panel(f"nested_dielectric_problem_{index}", default_closed=not is_open)
    header.label(text="", icon=ICONS[finding.severity])
    shown = header.operator(ShowProblem.bl_idname, text=finding.name, icon="VIEWZOOM")
    shown.name, shown.index = finding.name, index
    if finding.fix is not None:
        header.operator(FixProblem.bl_idname, text="", icon="TOOL_SETTINGS").index = index
    if body is not None:
        draw_text(body, context, finding.text, "DOT")
        draw_text(body, context, f"Shows: {finding.shows[0].lower()}{finding.shows[1:]}", "IMAGE_DATA")
        draw_text(body, context, finding.remedy, "TOOL_SETTINGS")


def draw_notes(layout: bpy.types.UILayout, context: bpy.types.Context, report: Report) -> None:
    """Draw what else may be worth knowing."""
    notes = [(index, each) for index, each in enumerate(report.problems) if each.severity == Severity.NOTE]
    count = len(notes) + report.more_notes
    if not count:
        return
    header, body = layout.panel("nested_dielectric_notes", default_closed=True)
    header.label(text=f"{count} Note{'s' * (count != 1)}", icon=ICONS[Severity.NOTE])
    if body is not None:
        for index, note in notes:
            draw_finding(body, context, index, note, False)
        if report.more_notes:
            body.label(text=f"And {report.more_notes} more", icon="BLANK1")


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
    if not lines:
        return
    header, body = layout.panel("nested_dielectric_changes", default_closed=True)
    header.label(text=f"{len(lines)} Change{'s' * (len(lines) != 1)}")
    header.operator(PutBack.bl_idname, icon="LOOP_BACK")
    for line in lines if body is not None else ():
        draw_text(body, context, line, "DOT")
