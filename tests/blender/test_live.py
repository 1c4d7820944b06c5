"""What an analysis found is believed only while it is true: whatever changes a scene, each picture is that of one that asks."""

import subprocess
import sys
from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix
from scenes import (
    add,
    add_box,
    add_camera,
    add_mesh,
    add_sphere,
    mostly_again,
    new_scene,
    read_picture,
    render,
    set_striped_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.analysis import analysis
from nested_dielectric.cutting import cutting
from nested_dielectric.nodes import node_group
from nested_dielectric.nodes.identity import SCENE_PROPERTY
from nested_dielectric.nodes.node_group import ANALYSED
from nested_dielectric.preparation import live

FRAMES = (1, 2, 3)

# The same samples meet the same surfaces; only the last bits of sums may differ, and where those decide, single samples.
SAME = 1e-3


def differs(picture: np.ndarray, other: np.ndarray) -> float:
    return float(np.sqrt(((picture - other) ** 2).mean()))


def build_scene() -> bpy.types.Scene:
    """A bead that lies still, and a liquid that scripts move through it."""
    scene = new_scene(24)
    set_striped_world()
    add_sphere("Bead", 0.5, nd.new_material("Glass", ior=1.5), 1)
    fluid = add_mesh("Fluid", sphere(-2.0), nd.new_material("Water", ior=1.33), 2)
    fluid.location.x = 0.0
    add_camera((0.1, -8, 0.3), (0.05, 0, 0), angle=26)
    scene.frame_start, scene.frame_end = FRAMES[0], FRAMES[-1]
    scene.cycles.samples = 16
    return scene


def sphere(x: float) -> Callable[[bmesh.types.BMesh], None]:
    def build(bm: bmesh.types.BMesh) -> None:
        bmesh.ops.create_icosphere(bm, subdivisions=3, radius=0.9, matrix=Matrix.Translation((x, 0.0, 0.0)))

    return build


def place(scene: bpy.types.Scene) -> float:
    return -2.0 + 0.9 * (scene.frame_current - 1)


@bpy.app.handlers.persistent
def swap_mesh(scene: bpy.types.Scene, *_: object) -> None:
    """As add-ons for fluids and stop motion do."""
    fluid = bpy.data.objects["Fluid"]
    old, fluid.data = fluid.data, bpy.data.meshes.new("Fluid")
    bm = bmesh.new()
    sphere(place(scene))(bm)
    bm.to_mesh(fluid.data)
    bm.free()
    fluid.data.materials.append(old.materials[0])
    bpy.data.meshes.remove(old)


@bpy.app.handlers.persistent
def fill_mesh(scene: bpy.types.Scene, *_: object) -> None:
    """As add-ons do that evaluate a tree of nodes of their own."""
    mesh = bpy.data.objects["Fluid"].data
    bm = bmesh.new()
    sphere(place(scene))(bm)
    bm.to_mesh(mesh)
    bm.free()
    mesh.update()


@bpy.app.handlers.persistent
def move_object(scene: bpy.types.Scene, *_: object) -> None:
    bpy.data.objects["Fluid"].location.x = place(scene) + 2.0


@bpy.app.handlers.persistent
def change_the_index(scene: bpy.types.Scene, *_: object) -> None:
    bpy.data.objects["Fluid"].location.x = 2.1
    inputs = bpy.data.materials["Water"].node_tree.nodes["Nested Dielectric"].inputs
    inputs["IOR"].default_value = 1.2 + 0.1 * scene.frame_current


@bpy.app.handlers.persistent
def change_the_priority(scene: bpy.types.Scene, *_: object) -> None:
    bpy.data.objects["Fluid"].location.x = 2.3
    nd.set_priority(bpy.data.objects["Fluid"], 2 - scene.frame_current % 2 * 2)


def frames(scene: bpy.types.Scene, folder) -> np.ndarray:
    """The pictures of an animation job."""
    scene.render.filepath = str(folder / "frame")
    bpy.ops.render.render(animation=True)
    return np.stack([read_picture(folder / f"frame{frame:04d}.exr") for frame in FRAMES])


@pytest.fixture
def looks(monkeypatch):
    """The scenes that are looked at, for what surrounds their media and for what is cut of them."""
    found = []
    for module, name in ((analysis, "analyse"), (cutting, "cut_surfaces")):
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
    tree = node_group.find_group()
    tree.nodes.remove(tree.nodes[node_group.SHADER_NODE])


def undo(scene: bpy.types.Scene) -> None:
    live.forget_shapes()


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


@pytest.mark.quick
def test_nothing_is_looked_at_before_a_render_of_what_has_not_changed(looks):
    """Each on its own leaves the scene as it was."""
    scene = build_scene()
    nd.prepare(scene, cut=True)
    looks.clear()
    for change in (*NO_CHANGES, change_the_world):
        change(scene)
        live.analyse_before_render(scene)
        if change is change_the_world:
            looks.clear()  # its nodes are shading to the depsgraph
        assert looks == [], change
    change_the_index(scene)
    live.analyse_before_render(scene)
    assert looks == ["analyse", "cut_surfaces"]
    live.analyse_before_render(scene)
    assert looks == ["analyse", "cut_surfaces"]


@pytest.mark.quick
@pytest.mark.parametrize("change", CHANGES)
def test_what_has_changed_is_looked_at_before_a_render(change, looks):
    scene = build_scene()
    nd.prepare(scene, cut=True)
    looks.clear()
    handlers = list(bpy.app.handlers.depsgraph_update_post)
    try:
        change(scene)
        live.analyse_before_render(scene)
    finally:
        bpy.app.handlers.depsgraph_update_post[:] = handlers
    assert looks == ["analyse", "cut_surfaces"]


def test_of_data_that_cycles_keeps_nothing_is_evaluated_again():
    """Neither media nor what is cut of them: only the settings of the scene have changed."""
    scene = build_scene()
    bpy.data.objects["Fluid"].location.x = 2.8
    scene.render.use_persistent_data = True
    nd.prepare(scene, cut=True)
    updates: list[set[str]] = []

    def watch(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        if depsgraph.mode == "RENDER":
            updates.append({update.id.name for update in depsgraph.updates})

    watch.__module__ = live.__name__  # a script that may change anything is another matter
    bpy.app.handlers.frame_change_post.append(watch)
    try:
        pictures = [render(4) for _ in range(2)]
    finally:
        bpy.app.handlers.frame_change_post.remove(watch)
    assert "Fluid (cut)" in updates[0] and updates[1] <= {"Scene"}
    assert np.array_equal(*pictures)


@pytest.mark.quick
def test_media_are_tied_to_frames_in_files_and_where_scripts_run(tmp_path):
    scene = build_scene()
    nd.prepare(scene)
    node = node_group.find_group().nodes[node_group.FRAME_NODE]
    assert node.attribute_name == node_group.FRAME_PATH
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    assert node.attribute_name == node_group.FRAME_PATH
    bpy.app.handlers.frame_change_post.append(move_object)
    try:
        nd.analyse(scene)
        assert node.attribute_name == node_group.TIMED_FRAME_PATH
    finally:
        bpy.app.handlers.frame_change_post.remove(move_object)
    nd.analyse(scene)
    assert node.attribute_name == node_group.FRAME_PATH
    live.remove()
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False)
    assert node_group.find_group().nodes[node_group.FRAME_NODE].attribute_name == node_group.TIMED_FRAME_PATH


@pytest.fixture
def script(request):
    """A handler that changes the scene on every frame."""
    bpy.app.handlers.frame_change_post.append(request.param)
    yield request.param
    bpy.app.handlers.frame_change_post.remove(request.param)


SCRIPTS = pytest.mark.parametrize(
    "script",
    mostly_again([swap_mesh, fill_mesh, move_object, change_the_index, change_the_priority], 2),
    indirect=True,
    ids=lambda script: script.__name__,
)


@SCRIPTS
def test_an_animation_that_a_script_changes_on_every_frame_is_right(script, tmp_path):
    """With the extension and without it, each frame loaded anew and from data that Cycles keeps, sharp and blurred."""
    for number, (registered, kept, blurred) in enumerate(
        ((True, False, True), (False, True, False), (False, False, True))
    ):
        pictures = []
        for prepared in (False, True):
            scene = build_scene()
            scene.render.use_persistent_data = kept
            scene.render.use_motion_blur, scene.render.motion_blur_shutter = blurred, 0.5
            scene.frame_set(1)
            if registered:
                nd.register()
            if prepared:
                assert not nd.prepare(scene).found.doubts
            pictures.append(frames(scene, tmp_path))
            nd.unregister()
            live.remove()
        assert differs(*pictures) < SAME, number
        assert differs(pictures[1][0], pictures[1][1]) > 0.02  # the script does work


def test_a_script_that_comes_last_is_seen_too(tmp_path):
    """Also one that was added after the scene was prepared, and one that no handler announces."""
    scene = build_scene()
    nd.prepare(scene)
    bpy.app.handlers.frame_change_post.append(move_object)
    try:
        told = frames(scene, tmp_path)
        analysis.clear_analysis(scene)
        assert differs(told, frames(scene, tmp_path)) < SAME
    finally:
        bpy.app.handlers.frame_change_post.remove(move_object)
    nd.prepare(scene)
    pictures = []
    for x in (1.4, 2.0):
        bpy.data.objects["Fluid"].location.x = x
        pictures.append(render(16))
    analysis.clear_analysis(scene)
    assert differs(pictures[1], render(16)) < SAME < differs(*pictures)


FARM = """
import sys
sys.modules["nested_dielectric"] = None  # any import of it fails
import bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
scene = bpy.context.scene
def change(scene, *_):
    bpy.data.objects["Fluid"].location.x = 0.9 * (scene.frame_current - 1)
bpy.app.handlers.frame_change_post.append(change)
scene.render.use_persistent_data = True
scene.render.filepath = sys.argv[2]
bpy.ops.render.render(animation=True)
"""


def test_on_a_farm_without_the_extension_scripts_may_change_what_a_file_was_saved_with(tmp_path):
    pictures = []
    for prepared in (False, True):
        scene = build_scene()
        move_object(scene)
        if prepared:
            nd.prepare(scene)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
        command = [sys.executable, "-c", FARM, str(tmp_path / "scene.blend"), str(tmp_path / "farm")]
        subprocess.run(command, check=True, capture_output=True)
        pictures.append(np.stack([read_picture(tmp_path / f"farm{frame:04d}.exr") for frame in FRAMES]))
    assert differs(*pictures) < SAME


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
    assert validity(scene)[0] == 0 and analysis.is_analysed(scene)
    live.analyse_before_render(scene)
    assert validity(scene) == (1, 1, 1)


def test_in_a_window_a_frame_that_a_script_changed_asks_until_all_rests(monkeypatch):
    monkeypatch.setattr(live, "has_window", lambda: True)
    monkeypatch.setattr(live, "REST", 1e9)
    scene = build_scene()
    nd.prepare(scene)
    bpy.app.handlers.frame_change_post.append(move_object)
    try:
        scene.frame_set(3)
        live.come_last()
        scene.frame_set(2)
        assert validity(scene)[0] == 0 and bpy.app.timers.is_registered(live.analyse_at_rest)
        live.analyse_at_rest()
        assert validity(scene) == (1, 2, 0)
    finally:
        bpy.app.handlers.frame_change_post.remove(move_object)


def move_by_velocity(fluid: bpy.types.Object) -> None:
    """As caches of simulations bring it; one unit a frame."""
    attribute = fluid.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.tile(np.float32((24.0, 0.0, 0.0)), len(fluid.data.vertices)))


def move_the_bead_by_velocity(fluid: bpy.types.Object) -> None:
    move_by_velocity(bpy.data.objects["Bead"])


def move_by_a_velocity_from_nodes(fluid: bpy.types.Object) -> None:
    tree = bpy.data.node_groups.new("Velocity", "GeometryNodeTree")
    tree.is_modifier = True
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    store = tree.nodes.new("GeometryNodeStoreNamedAttribute")
    store.data_type = "FLOAT_VECTOR"
    store.inputs["Name"].default_value = "velocity"
    next(socket for socket in store.inputs if socket.name == "Value" and socket.enabled).default_value = (
        24.0,
        0.0,
        0.0,
    )
    tree.links.new(source.outputs[0], store.inputs["Geometry"])
    tree.links.new(store.outputs[0], sink.inputs[0])
    fluid.modifiers.new("Velocity", "NODES").node_group = tree


@pytest.mark.parametrize(
    "moves",
    mostly_again([move_by_velocity, move_the_bead_by_velocity, move_by_a_velocity_from_nodes], 1),
    ids=lambda moves: moves.__name__,
)
def test_what_motion_blur_moves_by_an_attribute_asks(moves):
    scene = build_scene()
    fluid = bpy.data.objects["Fluid"]
    fluid.location.x = 2.6
    moves(fluid)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    asked = render(64)
    assert nd.prepare(scene).found.doubts
    assert differs(render(64), asked) < SAME


def library(folder, *objects: str) -> str:
    """A file with a prepared bead that is alone in it."""
    scene = build_scene()
    bpy.data.objects.remove(bpy.data.objects["Fluid"])
    nd.prepare(scene)
    file = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    return file


@pytest.mark.parametrize("link", [False, True], ids=["appended", "linked"])
@pytest.mark.parametrize("what", ["materials", "objects", "collections"])
def test_what_was_prepared_elsewhere_is_right_where_it_is_taken(what, link, tmp_path):
    file = library(tmp_path)
    pictures = []
    for taken in (False, True):
        live.remove()
        scene = build_scene()
        bpy.data.objects["Fluid"].location.x = 2.4
        if taken:
            bpy.data.objects.remove(bpy.data.objects["Bead"])
            with bpy.data.libraries.load(file, link=link) as (source, wanted):
                names = {"materials": ["Glass"], "objects": ["Bead"], "collections": source.collections}
                setattr(wanted, what, names[what])
            found = getattr(wanted, what)
            if what == "materials":
                add_sphere("Bead", 0.5, found[0], 1)
            elif what == "objects":
                scene.collection.objects.link(found[0])
            else:
                add_sphere("Bead", 0.5, nd.new_material("Glass", ior=1.5), 1)
                for collection in found:
                    scene.collection.children.link(collection)
        pictures.append(render(16))
    assert differs(*pictures) < SAME
    nd.prepare(scene)
    assert differs(pictures[0], render(16)) < SAME


def test_a_scene_is_simplified_without_a_look_at_it():
    """What is simplified has another shape, and nobody may have followed the switch."""
    scene = build_scene()
    bead = bpy.data.objects["Bead"]
    bpy.data.objects["Fluid"].location.x = 2.4
    bead.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bead.modifiers["Subdivision"].render_levels = 2
    nd.prepare(scene)
    live.remove()
    scene.render.use_simplify = True
    scene.render.simplify_subdivision_render = 0
    told = render(16)
    nd.clear_analysis(scene)
    assert differs(told, render(16)) < SAME


def test_a_copied_scene_is_right_whatever_becomes_of_it():
    scene = build_scene()
    bpy.data.objects["Fluid"].location.x = 2.4
    nd.prepare(scene)
    copy = scene.copy()
    fluid = bpy.data.objects["Fluid"]
    copy.collection.objects.unlink(fluid)
    bpy.context.window.scene = copy
    told = render(16)
    assert copy[SCENE_PROPERTY] != scene[SCENE_PROPERTY]
    bpy.context.window.scene = scene
    both = render(16)
    nd.clear_analysis(scene)
    nd.clear_analysis(copy)
    assert differs(both, render(16)) < SAME
    bpy.context.window.scene = copy
    assert differs(told, render(16)) < SAME < differs(told, both)


@pytest.mark.parametrize("outermost", [1, 100], ids=["winning outside", "winning inside"])
def test_a_hundred_priorities_one_in_another_raise_no_alarm(outermost):
    """A ray may have all of them open at once."""
    scene = new_scene(16)
    set_striped_world()
    materials = [nd.new_material("Shell", ior=1.0 + 0.01 * index) for index in range(7)]
    for index in range(100):
        priority = abs(outermost - index)
        add_sphere(f"Shell {index}", 1.0 - 0.009 * index, materials[index % 7], priority, segments=16)
    add_camera((0, -5, 0.1), (0, 0, 0))
    asked = render(16)
    assert not nd.prepare(scene).found.doubts
    assert differs(render(16), asked) < 5e-3  # 100 surfaces a path: one that a last bit decides changes all behind it
    told = render(128)
    assert (told[..., 0] < told[..., 1] + 1e-3).all()


def test_many_shells_that_a_ray_enters_before_it_leaves_any_are_told_apart():
    """The 80 shells beside the ball lie between it and nothing else: it is in air."""
    scene = new_scene(16)
    set_striped_world()
    add_sphere("Ball", 0.5, nd.new_material("Glass", ior=1.5), 500)
    clear = nd.new_material("Clear", ior=1.0)
    add_camera((0, -5, 0.1), (0, 0, 0))
    alone = render(16)
    for index in range(80):
        for side in (-1.0, 1.0):
            add_sphere(f"Shell {index} {side}", 0.9 - 0.01 * index, clear, index, (side * 2.0, 0.0, 0.0), segments=16)
    assert differs(render(16), alone) < 2e-2


def pane(material: bpy.types.Material) -> bpy.types.Scene:
    """Rough glass before the dark."""
    scene = bpy.context.scene
    set_world((0.0, 0.0, 0.0))
    add_box("Pane", (-2, -2, -0.1), (2, 2, 0.1), material, 1)
    add_camera((0.1, 0.05, 4), (0.03, 0.02, 0), width=0.6)
    return scene


def add_lamp() -> None:
    """One that the lobe of refraction carries, behind the pane."""
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy = 500.0
    lamp = add("Lamp", light, (0.0, 0.0, -3.0))
    lamp.rotation_euler.x = np.pi
    lamp.visible_transmission = False


@pytest.mark.parametrize("own_group", [False, True], ids=["first group", "second group"])
@pytest.mark.parametrize("link", [False, True], ids=["appended", "linked"])
def test_lamps_that_lobes_carry_stay_in_their_scene(link, own_group, tmp_path):
    new_scene(16)
    scene = pane(nd.new_material("Frosted", ior=1.5, roughness=0.3))
    add_lamp()
    nd.prepare(scene)
    lit = render(64).mean()
    file = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    live.remove()
    for has_lamp in (False, True):
        new_scene(16)
        if own_group:
            nd.new_material("Another")
        with bpy.data.libraries.load(file, link=link) as (_, wanted):
            wanted.materials = ["Frosted"]
        scene = pane(wanted.materials[0])
        if has_lamp:
            add_lamp()
        unprepared = render(64).mean()
        problems = [str(problem) for problem in nd.prepare(scene).problems]
        if not has_lamp:
            assert unprepared == render(64).mean() == 0.0 and problems == []
        elif link:
            assert len(problems) == 1 and "'Frosted'" in problems[0] and "local" in problems[0]
        else:
            # 16,384 samples of a lobe leave 1 % on either side.
            assert problems == [] and render(64).mean() == pytest.approx(lit, rel=0.04)


def test_each_scene_of_a_file_has_its_own_lamps():
    new_scene(16)
    scene = pane(nd.new_material("Frosted", ior=1.5, roughness=0.3))
    add_lamp()
    other = scene.copy()
    other.collection.objects.unlink(bpy.data.objects["Lamp"])
    nd.prepare(scene)
    nd.prepare(other)
    means = {}
    for each in (other, scene):
        bpy.context.window.scene = each
        means[each] = render(64).mean()
    assert means[other] == 0.0 < means[scene]
