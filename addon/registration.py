"""Putting the extension into Blender and taking it out again."""

from __future__ import annotations

import sys
from contextlib import ExitStack

import bpy

from .checking.material_checks import material_problems
from .checking.version_checks import version_problems
from .nodes.compatibility import blender_note, blender_problem
from .nodes.render_settings import settings_problem
from .preparation import live, versions
from .preparation.guard import forget_faults, guarded
from .scene.debug_views import debug_notice
from .scene.media import media
from .ui import asset_library, legend_overlay, media_list, media_rows, pictures, preferences
from .ui.operators import (
    debug_operators,
    dispersion_operators,
    light_operators,
    preparation_operators,
    priority_operators,
    problem_operators,
    suggestion_operators,
    update_operators,
)
from .ui.panels import (
    add_menu,
    debug_panel,
    light_panel,
    media_list_panel,
    medium_panels,
    notices,
    object_menu,
    scene_panels,
)
from .ui.presets import dropped, own_preset_operators, preset_menus, preset_operators, preset_pictures

_CHANGES = tuple(
    getattr(bpy.app.handlers, f"{when}_post") for when in ("depsgraph_update", "frame_change", "undo", "redo", "load")
)
"""Handlers of all that may change which media a scene has."""

CLASSES = (
    *preferences.CLASSES,
    media_rows.NestedDielectricPlace,
    *dispersion_operators.CLASSES,
    *update_operators.CLASSES,
    *light_operators.CLASSES,
    *debug_operators.CLASSES,
    *preset_operators.CLASSES,
    *own_preset_operators.CLASSES,
    *preset_menus.CLASSES,
    *object_menu.CLASSES,
    *add_menu.CLASSES,
    *priority_operators.CLASSES,
    *suggestion_operators.CLASSES,
    *preparation_operators.CLASSES,
    *problem_operators.CLASSES,
    *media_list_panel.CLASSES,
    *scene_panels.CLASSES,
    *medium_panels.CLASSES,
    *light_panel.CLASSES,
    *debug_panel.CLASSES,
    *scene_panels.LAST_CLASSES,
)
"""In the order in which they are registered: panels after those that they stand below."""

_PROPERTIES = (
    (
        bpy.types.Scene,
        "nested_dielectric_active",
        lambda: bpy.props.IntProperty(
            name="Active Medium", get=media_rows.get_active, set=media_rows.set_active, options=set()
        ),
    ),
    (
        bpy.types.WindowManager,
        "nested_dielectric_places",
        lambda: bpy.props.CollectionProperty(type=media_rows.NestedDielectricPlace),
    ),
    (
        bpy.types.WindowManager,
        "nested_dielectric_presets",
        lambda: bpy.props.PointerProperty(type=preset_menus.NestedDielectricPresetChoice, options={"SKIP_SAVE"}),
    ),
)
"""Blender's types, the properties that they get, and what makes these once their own types are registered."""

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
        pictures.open_pictures()
        undo.callback(pictures.close_pictures)
        undo.callback(preset_pictures.forget_items)
        for owner, name, make in _PROPERTIES:
            setattr(owner, name, make())
            undo.callback(delattr, owner, name)
        undo.callback(media_rows.forget_wanted)
        _add_drawings(undo)
        asset_library.follow(preferences.preference("asset_library"))
        undo.callback(asset_library.follow, False)
        undo.callback(legend_overlay.show_legends())
        _add_handlers(undo)
        live.install()
        undo.callback(live.remove)
        command = bpy.utils.register_cli_command("nested_dielectric", run_command)
        undo.callback(bpy.utils.unregister_cli_command, command)
        _registered = undo.pop_all()
    text = blender_problem() or blender_note()
    if text:
        print(f"Nested Dielectric: {text}", file=sys.stderr)


def _add_drawings(undo: ExitStack) -> None:
    """Let Blender's own panels, headers and menus show what the extension adds to them."""
    places = [("append", getattr(bpy.types, name), draw) for name, draw in (*notices.PLACES, *medium_panels.PLACES)]
    places += [
        ("prepend", bpy.types.VIEW3D_MT_object, object_menu.draw_entry),
        ("append", bpy.types.NODE_MT_category_shader_shader, add_menu.draw_entry),
    ]
    for add, place, draw in places:
        getattr(place, add)(draw)
        undo.callback(place.remove, draw)


def _add_handlers(undo: ExitStack) -> None:
    """Let Blender call the handlers of the user interface; :mod:`live` adds those of the analysis after them."""
    for handlers, handler in (
        (bpy.app.handlers.render_init, warn_before_render),
        (bpy.app.handlers.load_pre, forget_old_faults),
        (bpy.app.handlers.load_post, mend_materials),
        (bpy.app.handlers.blend_import_post, mend_materials),
        (bpy.app.handlers.blend_import_pre, dropped.note_before),
        (bpy.app.handlers.blend_import_post, dropped.note_appended),
        *((handlers, media_list.forget_media) for handlers in _CHANGES),
    ):
        handlers.append(handler)
        undo.callback(handlers.remove, handler)
    undo.callback(dropped.forget_appended)


def is_registered() -> bool:
    """Return whether what :func:`register` puts in is in."""
    return _registered is not None


def unregister() -> None:
    """Take out everything that :func:`register` put in."""
    global _registered
    if _registered is not None:
        undo, _registered = _registered, None
        undo.close()


@bpy.app.handlers.persistent
@guarded("before a file was opened", writes=False)
def forget_old_faults(*_: object) -> None:
    """Forget the errors that were caught in the file that is open."""
    forget_faults()


@bpy.app.handlers.persistent
@guarded("before a render", writes=False)
def warn_before_render(scene: bpy.types.Scene, *_: object) -> None:
    """Say on the terminal why the media of a scene will not look right, where no panel is open to say so."""
    problem = blender_problem() or settings_problem(scene)
    if problem and media(scene):
        print(f"Nested Dielectric: {problem}", file=sys.stderr)
    shown = debug_notice(scene)
    if shown and media(scene):
        print(f"Nested Dielectric: {shown}", file=sys.stderr)
    for each in material_problems(scene):
        print(f"Nested Dielectric: {each}", file=sys.stderr)


@bpy.app.handlers.persistent
@guarded("while a file was opened")
def mend_materials(*_: object) -> None:
    """Make materials right that come from a Blender or an extension to which this Blender's Cycles was unknown.

    They come with a file that is opened, or with what is appended from one.
    """
    if blender_problem():
        return
    for change in versions.mend_materials():
        print(f"Nested Dielectric: updated {change}", file=sys.stderr)
    for problem in version_problems():
        print(f"Nested Dielectric: {problem}", file=sys.stderr)


def run_command(arguments: list[str]) -> int:
    """Run ``blender --command nested_dielectric`` and return its exit code."""
    from . import cli

    return cli.main(arguments)
