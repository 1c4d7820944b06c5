"""What cannot render is said in one clear line."""

import bpy  # before bmesh, which lives inside it

from nested_dielectric.nodes.render_settings import settings_problem
from nested_dielectric.nodes.render_with import set_backend

import bmesh  # isort: skip
import pytest
from furnace import ball_in_furnace
from scenes import add_mesh, add_sphere, new_scene, set_world

import nested_dielectric as nd
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.nodes import compatibility, osl


@pytest.mark.parametrize("version", [(5, 1, 2), (4, 5, 0)])
def test_an_unsuitable_blender_is_named_with_the_remedy(version):
    problem = compatibility.blender_problem(version)
    assert "too old" in problem and "use " in problem
    assert "\n" not in problem


def test_a_blender_without_osl_is_suitable(monkeypatch):
    monkeypatch.setattr(compatibility, "has_osl", lambda: False)
    assert compatibility.blender_problem() is None


def test_this_blender_is_suitable():
    assert compatibility.blender_problem() is None and compatibility.blender_note() is None


def test_a_newer_blender_that_takes_indices_as_known_works_with_a_note():
    assert compatibility.blender_problem((5, 9, 0)) is None
    assert "newer than this extension was tested with" in compatibility.blender_note((5, 9, 0))


@pytest.mark.parametrize("answer", [None, "the other way"])
def test_a_blender_whose_way_with_indices_files_cannot_tell_is_refused(monkeypatch, answer):
    if answer is not None:
        answer = not compatibility.takes_front_ior()
    monkeypatch.setattr(compatibility, "takes_front_ior", lambda: answer)
    assert "in a way that files cannot tell" in compatibility.blender_problem((5, 9, 0))
    new_scene()
    with pytest.raises(nd.UnsupportedError):
        nd.prepare(bpy.context.scene)


def test_a_blender_without_open_shading_language_needs_no_closures_of_its(monkeypatch):
    monkeypatch.setattr(compatibility, "takes_front_ior", lambda: None)
    assert "in a way that files cannot tell" in compatibility.blender_problem()
    monkeypatch.setattr(compatibility, "has_osl", lambda: False)
    assert compatibility.blender_problem() is None


def test_preparing_a_scene_in_an_unsuitable_blender_raises_and_changes_nothing(monkeypatch):
    new_scene()
    bpy.context.scene.cycles.shading_system = False
    monkeypatch.setattr(compatibility, "blender_problem", lambda: "too old")
    with pytest.raises(nd.UnsupportedError, match="too old"):
        nd.prepare(bpy.context.scene)
    assert not bpy.context.scene.cycles.shading_system


def test_a_blender_without_osl_makes_no_half_of_a_material(monkeypatch):
    new_scene()

    def fail(source):
        raise nd.UnsupportedError("no OSL")

    monkeypatch.setattr(osl, "compiled", fail)
    with pytest.raises(nd.UnsupportedError):
        nd.new_material("Water", preset="water")
    assert not bpy.data.materials and not bpy.data.node_groups and not bpy.data.texts


@pytest.mark.parametrize(
    "setting, value, words",
    [("shading_system", False, "without Open Shading Language"), ("device", "GPU", "on the GPU")],
)
def test_render_settings_that_the_shader_cannot_work_with_are_named_and_prepare_mends_them(setting, value, words):
    ball_in_furnace()
    scene = bpy.context.scene
    setattr(scene.cycles, setting, value)
    assert settings_problem(scene) is None
    set_backend(scene, "OSL")
    assert words in settings_problem(scene)
    nd.prepare(scene)
    assert settings_problem(scene) is None


def test_glass_is_not_taken_for_a_light():
    """Cycles counts meshes whose shader may emit among the lights it sends shadow rays to. An unlit diffuse plane
    would have noise from them.
    """
    new_scene(16)
    set_world((0, 0, 0))
    ball = add_sphere("Ball", 1.0, nd.new_material("Glass", preset="glass"))
    shader = next(
        node
        for node in ball.active_material.node_tree.nodes["Nested Dielectric"].node_tree.nodes
        if node.type == "SCRIPT"
    )
    assert '"emission"' not in shader.bytecode


def problems() -> str:
    return "\n".join(map(str, find_problems(bpy.context.scene)))


def test_an_open_mesh_is_named_with_the_remedy():
    new_scene()

    def bowl(bm):
        bmesh.ops.create_cube(bm, size=1.0)
        bm.faces.ensure_lookup_table()
        bmesh.ops.delete(bm, geom=[bm.faces[0]], context="FACES_ONLY")

    add_mesh("Bowl", bowl, nd.new_material("Glass", preset="glass"))
    assert "'Bowl' is not closed" in problems() and "Fill Holes" in problems()


def test_inverted_normals_are_named_with_the_remedy():
    new_scene()
    ball = add_sphere("Ball", 1.0, nd.new_material("Glass", preset="glass"))
    assert problems() == ""
    ball.scale.x = -1.0  # mirroring alone turns no normal
    assert problems() == ""
    ball.data.flip_normals()
    assert "'Ball' has its normals pointing inwards" in problems()


def test_different_media_of_equal_priority_that_overlap_are_named():
    new_scene()
    add_sphere("Ice", 1.0, nd.new_material("Ice", ior=1.31), 1)
    water = nd.new_material("Water", ior=1.33)
    other = add_sphere("Water", 1.0, water, 1, (0.5, 0, 0))
    assert "overlaps" in problems() and "'Ice'" in problems() and "'Water'" in problems()
    nd.set_priority(other, 2)
    assert problems() == ""
    far = add_sphere("Far", 1.0, water, 1, (9, 0, 0))
    assert far is not None and problems() == ""


def test_a_link_that_neighbours_cannot_follow_is_named():
    new_scene()
    material = nd.new_material("Water", preset="water")
    add_sphere("Ball", 1.0, material)
    value = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(value.outputs[0], material.node_tree.nodes["Nested Dielectric"].inputs["IOR"])
    assert "a link into 'IOR'" in problems() and "unlink it" in problems()


def test_a_renamed_node_is_named():
    new_scene()
    material = nd.new_material("Water", preset="water")
    add_sphere("Ball", 1.0, material)
    material.node_tree.nodes["Nested Dielectric"].name = "Renamed"
    assert "'Ball'" in problems() and "rename the node to 'Nested Dielectric'" in problems()


def test_a_scene_that_is_not_in_the_window_is_looked_at_as_evaluated():
    new_scene()
    other = bpy.data.scenes.new("Other")
    ball = add_sphere("Ball", 1.0, nd.new_material("Water", preset="water"))
    ball.modifiers.new("Open", "BUILD").frame_duration = 1e4
    bpy.context.scene.collection.objects.unlink(ball)
    other.collection.objects.link(ball)
    assert any("'Ball'" in str(problem) for problem in find_problems(other))
