"""What an analysis found is looked at again when something may have changed, and not before."""

import bpy  # before bmesh, which lives inside it
import pytest
from fluids import build_scene, change_the_index, move_object
from scenes import add_sphere

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.cutting import cut_scene
from nested_dielectric.nodes.material_version import find_group
from nested_dielectric.nodes.names import ANALYSED, FRAME_NODE, SHADER_NODE
from nested_dielectric.nodes.validity import FRAME_PATH, TIMED_FRAME_PATH
from nested_dielectric.preparation import file_handlers, idle, live, render_handlers, windows


@pytest.fixture
def looks(monkeypatch):
    """The scenes that are looked at, for what surrounds their media and for what is cut of them."""
    found = []
    for module, name in ((surroundings, "analyse"), (cut_scene, "cut_surfaces")):
        look = getattr(module, name)
        monkeypatch.setattr(
            module, name, lambda scene, look=look, name=name, **keywords: found.append(name) or look(scene, **keywords)
        )
    return found


def set_samples(scene: bpy.types.Scene) -> None:
    scene.cycles.samples, scene.cycles.seed, scene.render.filepath = 7, 3, "//other"


def change_the_world(scene: bpy.types.Scene) -> None:
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5


NO_CHANGES = [lambda scene: None, set_samples, lambda scene: scene.frame_set(scene.frame_current)]


def move_and_set_a_frame(scene: bpy.types.Scene) -> None:
    """To set a frame evaluates what was moved before."""
    bpy.data.objects["Fluid"].location.x = 1.0
    scene.frame_set(scene.frame_current)


def write_a_priority(scene: bpy.types.Scene) -> None:
    """No tag tells of what is written into a custom property."""
    bpy.data.objects["Bead"]["nd_priority"] = 5


def take_what_is_told(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Bead"]["nd_outside"] = "x"


def animate(scene: bpy.types.Scene) -> None:
    bpy.data.objects["Bead"].animation_data_create()


def add_a_medium(scene: bpy.types.Scene) -> None:
    add_sphere("Bubble", 0.2, nd.new_material("Air", ior=1.0), 0)


def rename_the_node(scene: bpy.types.Scene) -> None:
    bpy.data.materials["Water"].node_tree.nodes["Nested Dielectric"].name = "Mine"


def damage_the_group(scene: bpy.types.Scene) -> None:
    tree = find_group()
    tree.nodes.remove(tree.nodes[SHADER_NODE])


def undo(scene: bpy.types.Scene) -> None:
    file_handlers.forget_shapes()


def listen(scene: bpy.types.Scene) -> None:
    """Another's handler may change anything after ours has seen an update."""
    bpy.app.handlers.depsgraph_update_post.append(lambda *_: None)


CHANGES = [
    move_object,
    move_and_set_a_frame,
    write_a_priority,
    take_what_is_told,
    animate,
    change_the_index,
    add_a_medium,
    lambda scene: bpy.data.objects.remove(bpy.data.objects["Bead"]),
    lambda scene: setattr(bpy.data.objects["Bead"], "hide_render", True),
    lambda scene: bpy.data.objects["Bead"].hide_set(True),
    lambda scene: setattr(bpy.data.objects["Bead"].data.vertices[0], "co", (0.0, 0.0, 2.0)),
    lambda scene: setattr(scene.render, "use_simplify", True),
    lambda scene: bpy.data.objects["Bead"].modifiers.new("More", "SUBSURF"),
    lambda scene: bpy.data.objects["Bead"].constraints.new("COPY_LOCATION"),
    lambda scene: setattr(scene.camera, "location", (0.0, 0.0, 0.0)),
    lambda scene: scene.frame_set(2),
    rename_the_node,
    damage_the_group,
    undo,
    listen,
]


def test_nothing_is_looked_at_before_a_render_of_what_has_not_changed(looks):
    """Each on its own leaves the scene as it was."""
    scene = build_scene()
    nd.prepare(scene, cut=True)
    looks.clear()
    for change in (*NO_CHANGES, change_the_world):
        change(scene)
        render_handlers.analyse_before_render(scene)
        if change is change_the_world:
            looks.clear()  # its nodes are shading to the depsgraph
        assert looks == [], change
    change_the_index(scene)
    render_handlers.analyse_before_render(scene)
    assert looks == ["analyse", "cut_surfaces"]
    render_handlers.analyse_before_render(scene)
    assert looks == ["analyse", "cut_surfaces"]


@pytest.mark.parametrize("change", CHANGES)
def test_what_has_changed_is_looked_at_before_a_render(change, looks):
    scene = build_scene()
    nd.prepare(scene, cut=True)
    looks.clear()
    handlers = list(bpy.app.handlers.depsgraph_update_post)
    try:
        change(scene)
        render_handlers.analyse_before_render(scene)
    finally:
        bpy.app.handlers.depsgraph_update_post[:] = handlers
    assert looks == ["analyse", "cut_surfaces"]


def test_media_are_tied_to_frames_in_files_and_where_scripts_run(tmp_path):
    scene = build_scene()
    nd.prepare(scene)
    node = find_group().nodes[FRAME_NODE]
    assert node.attribute_name == FRAME_PATH
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    assert node.attribute_name == FRAME_PATH
    bpy.app.handlers.frame_change_post.append(move_object)
    try:
        nd.analyse(scene)
        assert node.attribute_name == TIMED_FRAME_PATH
    finally:
        bpy.app.handlers.frame_change_post.remove(move_object)
    nd.analyse(scene)
    assert node.attribute_name == FRAME_PATH
    live.remove()
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False)
    assert find_group().nodes[FRAME_NODE].attribute_name == TIMED_FRAME_PATH


def validity(scene: bpy.types.Scene) -> tuple[float, ...]:
    """Whether what is told holds, on which frame, and whether on all."""
    return tuple(scene[ANALYSED])


def test_a_file_is_saved_with_what_holds_on_its_frame_alone(tmp_path):
    scene = build_scene()
    scene.frame_set(2)
    nd.prepare(scene)
    assert validity(scene) == (1, 2, 1)
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    assert validity(scene) == (1, 2, 1)
    live.remove()
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False)
    assert validity(bpy.context.scene) == (1, 2, 0)


def test_what_a_file_tells_is_not_believed_before_it_is_looked_at(tmp_path, monkeypatch):
    """Nobody waits for that when it is opened."""
    scene = build_scene()
    nd.prepare(scene)
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False)
    scene = bpy.context.scene
    assert validity(scene)[0] == 0 and is_analysed(scene)
    render_handlers.analyse_before_render(scene)
    assert validity(scene) == (1, 1, 1)


def test_in_a_window_a_frame_that_a_script_changed_asks_until_all_rests(monkeypatch):
    monkeypatch.setattr(windows, "has_window", lambda: True)
    monkeypatch.setattr(idle, "IDLE_SECONDS", 1e9)
    scene = build_scene()
    nd.prepare(scene)
    bpy.app.handlers.frame_change_post.append(move_object)
    try:
        scene.frame_set(3)
        render_handlers.move_frame_handler_last()
        scene.frame_set(2)
        assert validity(scene)[0] == 0 and bpy.app.timers.is_registered(idle.update_idle_scenes)
        idle.update_idle_scenes()
        assert validity(scene) == (1, 2, 0)
    finally:
        bpy.app.handlers.frame_change_post.remove(move_object)
