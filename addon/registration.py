"""Putting the extension into Blender and taking it out again."""

from __future__ import annotations

import sys
from contextlib import ExitStack

import bpy

from .nodes.compatibility import blender_note, blender_problem, settings_problem
from .preparation import live, versions
from .preparation.checks import material_problems
from .scene.media import media
from .ui import add_menu, icons, notices, object_menu, preferences
from .ui.operators import operators, preparation_operators, priority_operators
from .ui.panels import dispersion_panels, lamp_panel, media_list, media_rows, medium_panels, scene_panels
from .ui.presets import asset_library, dropped, preset_menus, preset_operators, preset_pictures

_CHANGES = tuple(
    getattr(bpy.app.handlers, f"{when}_post") for when in ("depsgraph_update", "frame_change", "undo", "redo", "load")
)
"""Handlers of all that may change which media a scene has."""

CLASSES = (
    *preferences.CLASSES,
    media_rows.NestedDielectricPlace,
    *operators.CLASSES,
    *preset_operators.CLASSES,
    *preset_menus.CLASSES,
    *object_menu.CLASSES,
    *add_menu.CLASSES,
    *priority_operators.CLASSES,
    *preparation_operators.CLASSES,
    *scene_panels.CLASSES,
    *medium_panels.CLASSES,
    *lamp_panel.CLASSES,
    *scene_panels.LAST_CLASSES,
)

_registered: ExitStack | None = None
"""How to take out what :func:`register` put in; None while nothing is in."""


def register() -> None:
    """Put operators, panels, menus and the command line's command into Blender; a second call changes nothing.

    If any of it fails, what went before is taken out again and the error is raised.
    """
    global _registered
    if _registered is not None:
        return
    with ExitStack() as undo:
        for cls in CLASSES:
            bpy.utils.register_class(cls)
            undo.callback(bpy.utils.unregister_class, cls)

        icons.open_icons()
        undo.callback(icons.close_icons)
        for pictures in (dispersion_panels, preset_pictures):
            pictures.open_pictures()
            undo.callback(pictures.close_pictures)

        bpy.types.Scene.nested_dielectric_active = bpy.props.IntProperty(
            name="Active Medium", get=media_rows.get_active, set=media_rows.set_active, options=set()
        )
        undo.callback(delattr, bpy.types.Scene, "nested_dielectric_active")
        bpy.types.WindowManager.nested_dielectric_places = bpy.props.CollectionProperty(
            type=media_rows.NestedDielectricPlace
        )
        undo.callback(delattr, bpy.types.WindowManager, "nested_dielectric_places")
        undo.callback(media_rows.forget_wanted)

        for name, draw in (*notices.PLACES, *medium_panels.PLACES):
            place = getattr(bpy.types, name)
            place.append(draw)
            undo.callback(place.remove, draw)

        bpy.types.WindowManager.nested_dielectric_presets = bpy.props.PointerProperty(
            type=preset_menus.NestedDielectricPresetChoice, options={"SKIP_SAVE"}
        )
        undo.callback(delattr, bpy.types.WindowManager, "nested_dielectric_presets")

        for add, menu, entry in (
            ("prepend", bpy.types.VIEW3D_MT_object, object_menu.draw_entry),
            ("append", bpy.types.NODE_MT_category_shader_shader, add_menu.draw_entry),
        ):
            getattr(menu, add)(entry)
            undo.callback(menu.remove, entry)

        asset_library.follow(preferences.preference("asset_library"))
        undo.callback(asset_library.follow, False)

        for handlers, handler in (
            (bpy.app.handlers.render_init, warn_before_render),
            (bpy.app.handlers.load_post, mend_materials),
            (bpy.app.handlers.blend_import_post, mend_materials),
            (bpy.app.handlers.blend_import_pre, dropped.note_before),
            (bpy.app.handlers.blend_import_post, dropped.note_appended),
            *((handlers, media_list.forget_media) for handlers in _CHANGES),
        ):
            handlers.append(handler)
            undo.callback(handlers.remove, handler)

        undo.callback(dropped.forget_appended)

        live.install()
        undo.callback(live.remove)

        command = bpy.utils.register_cli_command("nested_dielectric", run_command)
        undo.callback(bpy.utils.unregister_cli_command, command)

        _registered = undo.pop_all()
    text = blender_problem() or blender_note()
    if text:
        print(f"Nested Dielectric: {text}", file=sys.stderr)


def is_registered() -> bool:
    """Whether what :func:`register` puts in is in."""
    return _registered is not None


def unregister() -> None:
    """Take out everything that :func:`register` put in."""
    global _registered
    if _registered is not None:
        undo, _registered = _registered, None
        undo.close()


@bpy.app.handlers.persistent
def warn_before_render(scene: bpy.types.Scene, *_: object) -> None:
    """Say on the terminal why the media of a scene will not look right, where no panel is open to say so."""
    problem = blender_problem() or settings_problem(scene)
    if problem and media(scene):
        print(f"Nested Dielectric: {problem}", file=sys.stderr)
    for each in material_problems(scene):
        print(f"Nested Dielectric: {each}", file=sys.stderr)


@bpy.app.handlers.persistent
def mend_materials(*_: object) -> None:
    """Make materials right that a file, or what is appended from one, has from a Blender or an extension to which this
    Blender's Cycles was unknown.
    """
    if blender_problem():
        return
    for change in versions.mend_materials():
        print(f"Nested Dielectric: updated {change}", file=sys.stderr)
    for problem in versions.version_problems():
        print(f"Nested Dielectric: {problem}", file=sys.stderr)


def run_command(arguments: list[str]) -> int:
    """``blender --command nested_dielectric``."""
    from . import cli

    return cli.main(arguments)
