"""Tests import their helpers as plain modules from this folder."""

import sys
from pathlib import Path

import pytest

sys.path[:0] = [str(Path(__file__).parent / room) for room in ("helpers", "blender", "render")]


def pytest_collection_modifyitems(items):
    """What takes no time comes first."""
    items.sort(key=lambda item: item.get_closest_marker("quick") is None)


@pytest.fixture(autouse=True)
def nothing_is_followed_any_more():
    """An analysis keeps a session's scenes analysed; each test begins as a session does."""
    yield
    live = sys.modules.get("nested_dielectric.preparation.live")
    if live is not None and not sys.modules["nested_dielectric.registration"].is_registered():
        live.remove()


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
    """The extension is registered in an empty scene."""
    import bpy

    import nested_dielectric as nd

    bpy.ops.wm.read_factory_settings(use_empty=True)
    nd.register()
    yield
    nd.unregister()


@pytest.fixture
def draw(capfd):
    """Draw a panel in a region of some width, 220 if none is given; see :func:`ui.draw_panel`."""
    from ui import draw_panel

    return lambda panel, width=220: draw_panel(panel, width, capfd.readouterr)
