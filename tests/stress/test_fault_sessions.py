"""A session may last: the extension enabled and disabled, files opened one after another, and nothing is left or grows."""

import gc
import os
import sys
from functools import _lru_cache_wrapper
from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add_box, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.preparation import idle
from nested_dielectric.ui import media_list, media_rows, pictures
from nested_dielectric.ui.presets import dropped, preset_pictures

EVERYTHING = "ND_STRESS" in os.environ
TIMES = 50 if EVERYTHING else 4
FILES = 50 if EVERYTHING else 4

MENUS = (
    "VIEW3D_MT_object",
    "NODE_MT_category_shader_shader",
    "RENDER_PT_context",
    "TOPBAR_MT_render",
    "STATUSBAR_HT_header",
)


def left_behind() -> dict[str, object]:
    """All that an extension may leave in Blender."""
    handlers = {
        name: list(found)
        for name in dir(bpy.app.handlers)
        if isinstance(found := getattr(bpy.app.handlers, name), list)
    }
    timers = (idle.update_idle_scenes, idle.update_views, media_rows._make_wanted, dropped.fit_appended)
    return {
        "handlers": {name: [each.__qualname__ for each in found] for name, found in handlers.items()},
        "timers": [timer.__name__ for timer in timers if bpy.app.timers.is_registered(timer)],
        "types": [name for name in dir(bpy.types) if "nested" in name.lower()],
        "operators": dir(bpy.ops.nested_dielectric),
        "properties": [
            prop.identifier
            for kind in (bpy.types.Scene, bpy.types.WindowManager, bpy.types.Object)
            for prop in kind.bl_rna.properties
            if "nested" in prop.identifier
        ],
        "drawings": {name: len(getattr(getattr(bpy.types, name).draw, "_draw_funcs", ())) for name in MENUS},
        "pictures": pictures._pictures,
        "libraries": [library.name for library in bpy.context.preferences.filepaths.asset_libraries],
    }


def resident_bytes() -> int:
    """Memory that the process holds, in bytes; 0 where the system does not say."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if statm.is_file() else 0


def kept() -> dict[str, int]:
    """Lengths of all that the extension's modules keep while a session lasts."""
    gc.collect()
    lengths = {}
    for module_name, module in list(sys.modules.items()):
        if not module_name.startswith("nested_dielectric"):
            continue
        for name, value in vars(module).items():
            if isinstance(value, _lru_cache_wrapper):
                lengths[f"{module_name}.{name}"] = value.cache_info().currsize
            elif isinstance(value, (dict, set, list)) and not name.startswith("__"):
                lengths[f"{module_name}.{name}"] = len(value)
    return lengths


def grows_by(sizes: list[int]) -> float:
    """Bytes that each of a row of sizes is more than the one before, by least squares of its second half."""
    half = sizes[len(sizes) // 2 :]
    return float(np.polyfit(range(len(half)), half, 1)[0])


@pytest.mark.always
def test_enabled_and_disabled_again_and_again_the_extension_leaves_nothing_and_does_not_grow():
    scene = new_scene(8, with_group=True)
    add_sphere("Ball", 0.6, nd.new_material("Glass", preset="glass"), segments=8)
    nd.register()  # once: Blender keeps a list at each of its menus that was ever added to
    nd.unregister()
    before = left_behind()
    sizes = []
    for _ in range(TIMES):
        nd.register()
        assert len(left_behind()["types"]) > len(before["types"])
        preset_pictures.items()
        media_list.listed_lines(scene)
        nd.prepare(scene)
        nd.unregister()
        assert left_behind() == before
        sizes.append(resident_bytes())
    if EVERYTHING:
        assert grows_by(sizes) < 200e3, sizes


def open_and_work(path: str) -> None:
    """Open a file and do in it what is remembered for the session."""
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    nd.prepare(scene)
    media_list.listed_lines(scene)
    media_rows.set_active(scene, 0)
    media_list.open_or_close(bpy.data.materials["Glass"].session_uid)
    bpy.data.objects["Ball"].location.x += 0.1
    bpy.context.view_layer.update()
    media_rows.get_active(scene)
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.wm.save_mainfile()


@pytest.mark.always
def test_files_opened_one_after_another_leave_nothing_of_those_before(tmp_path, registered):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    add_sphere("Ball", 0.6, nd.new_material("Glass", preset="glass"), 1, segments=12)
    add_box("Water", (-1, -1, -1), (1, 1, 0.1), nd.new_material("Water", preset="water"))
    nd.prepare(scene, cut=True)
    path = str(tmp_path / "x.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    open_and_work(path)
    before, sizes = kept(), []
    for _ in range(FILES):
        open_and_work(path)
        sizes.append(resident_bytes())
    after = kept()
    grown = {name: (before.get(name), count) for name, count in after.items() if count > before.get(name, 0)}
    assert grown == {}
    if EVERYTHING:
        assert grows_by(sizes) < 300e3, sizes
