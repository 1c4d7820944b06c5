"""An error in a handler or a timer reaches the artist's panels and no console, and leaves media that ask."""

import sys
from types import SimpleNamespace

import bpy
import pytest
from scenes import add_box, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.analysis.validity import validity_of
from nested_dielectric.cutting import views
from nested_dielectric.preparation import guard, idle, render_handlers
from nested_dielectric.scene import scripts
from nested_dielectric.ui.panels import notices, scene_panels
from nested_dielectric.ui.presets import dropped


@pytest.fixture
def scene(registered):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    glass = nd.new_material("Glass", preset="glass")
    add_box("Upper", (-1, -1, 0), (1, 1, 1), glass)
    add_box("Lower", (-1, -1, -1), (1, 1, 0.5), nd.new_material("Water", preset="water"))
    nd.prepare(scene, cut=True)
    return scene


@pytest.fixture
def console(monkeypatch):
    """What reaches the console as an exception that nobody caught."""
    raised = []
    monkeypatch.setattr(sys, "excepthook", lambda *error: raised.append(error))
    return raised


def fail(*_):
    raise KeyError("the scene's\nfault")


def move():
    bpy.data.objects["Upper"].location.x += 0.1
    bpy.context.view_layer.update()


def test_an_error_after_a_change_lets_media_ask_and_is_told_in_panels(scene, console, monkeypatch, capfd, draw):
    monkeypatch.setattr(surroundings, "update", fail)
    for _ in range(3):
        move()
    (fault,) = guard.faults()
    assert fault.error == 'KeyError: "the scene\'s\\nfault"' and "in fail" in fault.details
    assert console == [] and validity_of(scene).holds == 0.0
    assert capfd.readouterr().err.count("Nested Dielectric: an error after a change") == 1
    drawn = draw(scene_panels.SidebarPanel)
    labels = " ".join(keywords.get("text", "") for _, _, keywords in drawn)
    assert "error after a change" in labels and "press Prepare" in labels
    assert ("nested_dielectric.copy_faults",) in [arguments for _, arguments, _ in drawn]
    assert bpy.ops.nested_dielectric.copy_faults() == {"FINISHED"}
    monkeypatch.undo()
    nd.prepare(scene)
    assert guard.faults() == () and validity_of(scene).holds == 1.0
    assert not bpy.ops.nested_dielectric.copy_faults.poll()


def test_a_file_that_is_saved_after_an_error_holds_everything_and_asks(scene, console, monkeypatch, tmp_path):
    move()
    surroundings.invalidate(scene)
    monkeypatch.setattr(surroundings, "analyse", fail)
    monkeypatch.setattr(surroundings, "update", fail)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "x.blend"))
    assert guard.faults()[-1].when == "while the file was saved" and console == []
    monkeypatch.undo()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "x.blend"))
    assert guard.faults() == ()
    assert validity_of(bpy.context.scene).holds == 0.0 and {"Upper", "Lower"} <= set(bpy.data.objects.keys())


def test_an_error_before_a_render_lets_the_render_go_on(scene, console, monkeypatch):
    move()
    monkeypatch.setattr(surroundings, "analyse", fail)
    surroundings.invalidate(scene)
    render_handlers.analyse_before_render(scene)
    assert [fault.when for fault in guard.faults()] == ["before a render"] and console == []
    guard.forget_faults()


def test_media_ask_although_what_lets_them_ask_fails_too(scene, console, monkeypatch):
    monkeypatch.setattr(surroundings, "update", fail)
    monkeypatch.setattr(surroundings, "invalidate", fail)
    move()
    assert console == [] and validity_of(scene).holds == 0.0
    guard.forget_faults()


def test_a_timer_that_fails_is_not_called_again(scene, console, monkeypatch):
    monkeypatch.setattr(idle.windows, "is_at_work", fail)
    monkeypatch.setattr(views, "surfaces_of", fail)
    monkeypatch.setattr(idle.windows, "is_rendering", lambda: False)
    assert idle.update_idle_scenes() is None and idle.update_views() is None
    assert len(guard.faults()) == 2 and console == []
    guard.forget_faults()


def test_every_handler_and_timer_is_guarded(scene):
    handlers = [
        each
        for name in dir(bpy.app.handlers)
        if isinstance(lists := getattr(bpy.app.handlers, name), list)
        for each in lists
    ]
    ours = [each for each in handlers if getattr(each, "__module__", "").startswith(scripts._OURS)]
    assert len(ours) > 15
    timers = [idle.update_idle_scenes, idle.update_views, idle.schedule_views, dropped.fit_appended]
    assert [each for each in ours + timers if not hasattr(each, "__wrapped__")] == []


def test_an_error_in_what_is_drawn_into_blenders_own_panels_is_told_in_it(scene, console, monkeypatch):
    places = [getattr(bpy.types, name) for name, _ in notices.PLACES]
    drawings = [each for place in places for each in place.draw._draw_funcs if each.__module__ == notices.__name__]
    assert len(drawings) == len(places) and all(hasattr(each, "__wrapped__") for each in drawings)
    monkeypatch.setattr(notices, "listed_media", fail)
    for draw in drawings:
        draw(SimpleNamespace(layout=None), bpy.context)
    assert {fault.when for fault in guard.faults()} == {"while a panel was drawn"} and console == []
    assert "an error while a panel was drawn" in notices.render_problem(scene)
    guard.forget_faults()


def test_errors_that_repeat_are_kept_once_and_few(console, capfd):
    new_scene()

    @guard.guarded("in a test", writes=False)
    def count(number):
        raise ValueError(number)

    for number in range(2 * guard.MOST_FAULTS):
        assert count(number) is None and count(number) is None
    assert len(guard.faults()) == guard.MOST_FAULTS == capfd.readouterr().err.count("in a test")
    guard.forget_faults()
