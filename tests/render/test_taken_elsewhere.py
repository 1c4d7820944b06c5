"""Media that are taken into another scene or file are right there."""

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from fluids import SAME, build_scene, differs
from scenes import add, add_box, add_camera, add_sphere, new_scene, render, set_world

import nested_dielectric as nd
from nested_dielectric.nodes.identity import SCENE_PROPERTY
from nested_dielectric.preparation import live


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


def pane(material: bpy.types.Material) -> bpy.types.Scene:
    """Rough glass before the dark."""
    scene = bpy.context.scene
    set_world((0.0, 0.0, 0.0))
    add_box("Pane", (-2, -2, -0.1), (2, 2, 0.1), material, 1)
    add_camera((0.1, 0.05, 4), (0.03, 0.02, 0), width=0.6)
    return scene


def add_light() -> None:
    """One that the lobe of refraction carries, behind the pane."""
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy = 500.0
    light = add("Lamp", light, (0.0, 0.0, -3.0))
    light.rotation_euler.x = np.pi
    light.visible_transmission = False


@pytest.mark.parametrize("own_group", [False, True], ids=["first group", "second group"])
@pytest.mark.parametrize("link", [False, True], ids=["appended", "linked"])
def test_lights_that_lobes_carry_stay_in_their_scene(link, own_group, tmp_path):
    new_scene(16)
    scene = pane(nd.new_material("Frosted", ior=1.5, roughness=0.3))
    add_light()
    nd.prepare(scene)
    lit = render(64).mean()
    file = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    live.remove()
    for has_light in (False, True):
        new_scene(16)
        if own_group:
            nd.new_material("Another")
        with bpy.data.libraries.load(file, link=link) as (_, wanted):
            wanted.materials = ["Frosted"]
        scene = pane(wanted.materials[0])
        if has_light:
            add_light()
        unprepared = render(64).mean()
        problems = [str(problem) for problem in nd.prepare(scene).problems]
        if not has_light:
            assert unprepared == render(64).mean() == 0.0 and problems == []
        elif link:
            assert len(problems) == 1 and "'Frosted'" in problems[0] and "local" in problems[0]
        else:
            # 16,384 samples of a lobe leave 1 % on either side.
            assert problems == [] and render(64).mean() == pytest.approx(lit, rel=0.04)


def test_each_scene_of_a_file_has_its_own_lights():
    new_scene(16)
    scene = pane(nd.new_material("Frosted", ior=1.5, roughness=0.3))
    add_light()
    other = scene.copy()
    other.collection.objects.unlink(bpy.data.objects["Lamp"])
    nd.prepare(scene)
    nd.prepare(other)
    means = {}
    for each in (other, scene):
        bpy.context.window.scene = each
        means[each] = render(64).mean()
    assert means[other] == 0.0 < means[scene]
