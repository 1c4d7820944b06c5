"""Tests by what they need: the folder of a test is its mark, and tests import from `helpers` alone.

- `unit`: no scene, and nothing of Blender but `mathutils`. Marked `quick`, and `pure` where the file does not import Blender.
- `blender`: Blender's data, panels, files and processes, but no picture of Cycles. Marked `quick`.
- `render`: whatever renders, here or in a process of its own.
- `stress`: whether anything breaks, over many scenes and far out. A run takes those that are marked `always` alone, but with
  `--stress` all.
"""

import os
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent

sys.path.insert(0, str(FOLDER / "helpers"))


def pytest_addoption(parser):
    """Let a run take the whole stress suite."""
    parser.addoption("--stress", action="store_true", help="run all of tests/stress, which takes up to an hour")


def pytest_configure(config):
    """Let modules of the stress suite know, which repeat more where all of it runs."""
    if config.getoption("--stress"):
        os.environ["ND_STRESS"] = "1"


def pytest_collection_modifyitems(config, items):
    """Mark tests by their folders; what takes no time comes first, and of the stress suite a part alone."""
    for item in items:
        room = item.path.relative_to(FOLDER).parts[0]
        if room in ("unit", "blender"):
            item.add_marker(pytest.mark.quick)
        if room == "unit" and not hasattr(item.module, "bpy"):
            item.add_marker(pytest.mark.pure)
        if room == "stress":
            item.add_marker(pytest.mark.stress)
    if not config.getoption("--stress"):
        left_out = [
            item for item in items if item.get_closest_marker("stress") and not item.get_closest_marker("always")
        ]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in set(left_out)]
    items.sort(key=lambda item: item.get_closest_marker("quick") is None)


@pytest.fixture(autouse=True, scope="module")
def nothing_is_left_open():
    """Each file begins with an empty scene."""
    yield
    if bpy := sys.modules.get("bpy"):
        bpy.ops.wm.read_factory_settings(use_empty=True)


@pytest.fixture(autouse=True)
def nothing_is_followed_any_more():
    """An analysis keeps a session's scenes analysed; each test begins as a session does."""
    yield
    live = sys.modules.get("nested_dielectric.preparation.live")
    if live is not None and not sys.modules["nested_dielectric.registration"].is_registered():
        live.remove()


@pytest.fixture(autouse=True)
def no_handler_raises_anything():
    """What handlers, timers and drawing raise is caught in Blender, and told to artists; here it is a failure."""
    yield
    guard = sys.modules.get("nested_dielectric.preparation.guard")
    if guard is not None:
        details = [fault.details for fault in guard.faults()]
        guard.forget_faults()
        assert not details, "\n".join(details)


@pytest.fixture(autouse=True)
def renders_nothing(request):
    """Hold tests that are marked as quick to it."""
    if request.node.get_closest_marker("quick") is None:
        yield
        return
    import bpy

    renders = []
    watch = bpy.app.handlers.persistent(lambda *_: renders.append(request.node.name))
    # Of all handlers of renders the one that is not taken for a script that may change the scene.
    bpy.app.handlers.render_stats.append(watch)
    yield
    bpy.app.handlers.render_stats.remove(watch)
    assert not renders


@pytest.fixture
def registered():
    """The extension is registered in an empty scene, where the node group stands already."""
    from scenes import empty_file

    import nested_dielectric as nd

    empty_file(with_group=True)
    nd.register()
    yield
    nd.unregister()


@pytest.fixture
def draw(capfd):
    """Draw a panel in a region of some width, 220 if none is given; see :func:`ui.draw_panel`."""
    from ui import draw_panel

    return lambda panel, width=220: draw_panel(panel, width, capfd.readouterr)


@pytest.fixture
def preset_folder(monkeypatch, tmp_path):
    """The user's folder of presets, which is not there yet."""
    from nested_dielectric.scene import preset_library
    from nested_dielectric.ui import preferences

    path = tmp_path / "mine"
    for module in (preset_library, preferences):
        monkeypatch.setattr(module, "user_folder", lambda: path)
    return path
