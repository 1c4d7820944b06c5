"""Scripts may change a scene on every frame: each picture is that of one that asks."""

import subprocess
import sys

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from fluids import FRAMES, SAME, build_scene, change_the_index, differs, move_object, place, sphere
from scenes import mostly_again, read_picture, render

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.preparation import live


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
def change_the_priority(scene: bpy.types.Scene, *_: object) -> None:
    bpy.data.objects["Fluid"].location.x = 2.3
    nd.set_priority(bpy.data.objects["Fluid"], 2 - scene.frame_current % 2 * 2)


def frames(scene: bpy.types.Scene, folder) -> np.ndarray:
    """The pictures of an animation job."""
    scene.render.filepath = str(folder / "frame")
    bpy.ops.render.render(animation=True)
    return np.stack([read_picture(folder / f"frame{frame:04d}.exr") for frame in FRAMES])


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
        surroundings.clear_analysis(scene)
        assert differs(told, frames(scene, tmp_path)) < SAME
    finally:
        bpy.app.handlers.frame_change_post.remove(move_object)
    nd.prepare(scene)
    pictures = []
    for x in (1.4, 2.0):
        bpy.data.objects["Fluid"].location.x = x
        pictures.append(render(16))
    surroundings.clear_analysis(scene)
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
