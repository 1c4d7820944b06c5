"""What media are told of their surroundings is what they would find by asking."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from chaos import build_chaos
from mathutils import Matrix
from processes import WITHOUT_EXTENSION, render_in_fresh_process
from scenes import add, add_box, add_mesh, add_plane, add_sun, diffuse, emission, render
from shapes import SHAPE, egg
from told import (
    GREY,
    OUTLIERS,
    SAMPLES,
    TINT,
    asked_and_told,
    assert_same_answers,
    ball,
    balls,
    codes,
    differing,
    fresh,
    inputs,
    instance,
    into_collection,
    magenta,
    medium,
    snapshot,
    stage,
    told_by_object,
)

import nested_dielectric as nd
from nested_dielectric.model.contract import Exterior
from nested_dielectric.nodes.names import OBJECT_PROPERTIES


def prism(bm: bmesh.types.BMesh) -> None:
    """Nine sides, and two caps of a single face each."""
    bmesh.ops.create_cone(bm, cap_ends=True, segments=9, radius1=0.5, radius2=0.5, depth=2.0)


def nested() -> dict[str, int]:
    """Not crossing: one alone, and one around another around a third that wins and a fourth that loses."""
    stage()
    ball("Alone", 0.3, medium("Alone", 1.7), 2, (-1.1, -0.3, 0.9))
    glass = medium("Glass", 1.5)
    ball("Outer", 1.1, glass, 3)
    ball("Water", 0.8, medium("Water", 1.33), 2, (0.1, 0.0, 0.0))
    ball("Inner", 0.4, glass, 1, (0.0, 0.1, 0.1))
    ball("Lost", 0.1, medium("Lost", 1.8), 9, (-0.1, -0.95, 0.0))
    return {
        "Alone": Exterior.AIR,
        "Outer": Exterior.AIR,
        "Water": Exterior.MEDIUM,
        "Inner": Exterior.MEDIUM,
        "Lost": Exterior.WINNER,
    }


def crossing() -> dict[str, int]:
    """Three that cross each other, one of them of few faces, one rough."""
    stage()
    ball("Ball", 0.8, medium("Glass", 1.5), 1, (-0.5, 0.0, 0.0))
    add_box("Box", (-0.3, -0.6, -0.4), (1.1, 0.5, 0.6), medium("Water", 1.33), 2)
    ball("Rough", 0.6, medium("Rough", 1.8, roughness=0.3), 3, (0.5, -0.3, 0.5))
    return {"Ball": Exterior.UNKNOWN, "Box": Exterior.UNKNOWN, "Rough": Exterior.UNKNOWN}


def fused() -> dict[str, int]:
    """Two of one priority and material, a winner that crosses both, and one that coincides with a box."""
    stage()
    glass = medium("Glass", 1.5)
    ball("A", 0.8, glass, 1, (-0.5, 0.0, 0.0))
    ball("B", 0.8, glass, 1, (0.4, 0.1, 0.1))
    water = medium("Water", 1.33)
    ball("Drop", 0.5, water, 0, (0.0, -0.4, 0.5))
    add_box("Lower", (0.3, -1.1, -0.8), (0.9, -0.4, -0.5), water, 0)
    add_box("Upper", (0.4, -1.0, -0.5), (0.7, -0.5, -0.2), glass, 1)
    return {"A": Exterior.UNKNOWN, "B": Exterior.UNKNOWN, "Drop": Exterior.UNKNOWN}


def placed() -> dict[str, int]:
    """Mirrored, scaled by a parent, and a collection instanced three times in different surroundings."""
    stage()
    mirror = Matrix.Diagonal((-1, 1, 1, 1))
    mirrored = add_mesh("Mirrored", egg, medium("Water", 1.33), 2, smooth=True)
    mirrored.data.transform(mirror)
    mirrored.data.flip_normals()
    mirrored.matrix_world = SHAPE @ mirror
    parent = add("Parent", None, (0.5, 0.5, 0.5))
    parent.scale = (2, 1, 1)
    child = ball("Child", 0.5, medium("Glass", 1.5), 1)
    child.parent = parent
    bpy.context.view_layer.update()
    child.matrix_world = Matrix.LocRotScale((0.6, -0.2, 0.1), None, (0.9, 1.3, 0.7))
    collection = into_collection(ball("Bubble", 0.2, medium("Air", 1.0), 0))
    for location in ((0.6, -0.5, 0.2), (-0.5, -0.2, 0.0), (-1.1, -0.6, 0.5)):
        instance(collection, location).scale = (1.0, -1.2, 1.0)
    return {"Mirrored": Exterior.UNKNOWN, "Child": Exterior.UNKNOWN, "Bubble": Exterior.UNKNOWN}


def shaped() -> dict[str, int]:
    """Meshes of several islands, of faces of many corners, and with modifiers."""
    stage()
    places = ((0.3, (0.0, -0.5, 0.0)), (0.3, (0.8, 0.0, 0.0)), (0.25, (-1.1, 0.0, 0.3)), (0.2, (-0.1, -0.1, 0.6)))
    add_mesh("Bubbles", balls(*places), medium("Air", 1.0), 1, smooth=True)
    water = medium("Water", 1.33)
    soft = add_box("Soft", (-1.1, -0.8, -1.0), (1.0, 0.9, 1.0), water, 2)
    modifier = soft.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 2
    glass = medium("Glass", 1.5)
    for index, x in enumerate((0.3, 0.8)):
        add_mesh(f"Prism {index}", prism, glass, 3 + index).location = (x, -0.1, -0.7)
    return {
        "Bubbles": Exterior.UNKNOWN,
        "Soft": Exterior.UNKNOWN,
        "Prism 0": Exterior.UNKNOWN,
        "Prism 1": Exterior.UNKNOWN,
    }


def tinted() -> dict[str, int]:
    """Media that absorb, one in the other, with something foreign in one of them, and their shadows."""
    stage()
    shadows = {"shadow_mode": "TRANSMISSION"}
    ball("Outer", 1.1, medium("Glass", 1.5, **TINT, **shadows), 3)
    inner = medium("Water", 1.33, transmittance=(0.9, 0.8, 0.3), transmittance_depth=0.4, **shadows)
    ball("Inner", 0.6, inner, 2, (0.2, 0.0, 0.1))
    ball("Clear", 0.7, medium("Clear", 1.1), 4, (-0.9, -0.3, -0.3))
    ball("Foreign", 0.3, diffuse(0.8), None, (-0.3, -0.5, 0.2))
    add_plane("Floor", 8.0, (0, 0, -1.3), (0, 0, 1), diffuse(0.8))
    add_sun((0.3, 0.3, -1.0), 2.0)
    return {"Outer": Exterior.UNKNOWN, "Inner": Exterior.MEDIUM, "Clear": Exterior.UNKNOWN}


def tinted_without_foreign_objects() -> dict[str, int]:
    """Media that absorb and have nothing but each other in them."""
    stage()
    ball("Outer", 1.1, medium("Glass", 1.5, **TINT), 3)
    ball("Inner", 0.6, medium("Water", 1.33, transmittance=(0.9, 0.8, 0.3), transmittance_depth=0.4), 2)
    ball("Clear", 0.4, medium("Clear", 1.6), 1, (-0.6, -0.3, -0.3))
    return {"Outer": Exterior.UNKNOWN, "Inner": Exterior.UNKNOWN, "Clear": Exterior.UNKNOWN}


def tinted_chain() -> dict[str, int]:
    """Something foreign in the second of two tinted media that fuse, seen through a clear one in the first."""
    stage()
    ball("First", 0.8, medium("First", 1.33, **GREY), 5, (0.0, -0.4, 0.0))
    ball("Second", 0.8, medium("Second", 1.33, **GREY), 5, (0.0, 0.6, 0.0))
    ball("Bubble", 0.3, medium("Air", 1.0), 1, (0.0, -0.7, 0.0))
    ball("Foreign", 0.3, diffuse(0.8), None, (0.0, 0.8, 0.0))
    return {"First": Exterior.UNKNOWN, "Second": Exterior.UNKNOWN, "Bubble": Exterior.MEDIUM}


def dispersing() -> dict[str, int]:
    """Media that split light, and two in one of them that do not, but whose index depends on the wavelength."""
    scene = stage()
    ball("Flint", 1.1, medium("Flint", 1.8, disperse=True, abbe=20.0), 3)
    ball("Drop", 0.6, medium("Water", 1.33, abbe=15.0), 2, (-0.3, -0.1, 0.1))
    ball("Bubble", 0.3, medium("Air", 1.0), 1, (-0.4, -0.1, 0.1))
    ball("Crown", 0.6, medium("Crown", 1.5, disperse=True, abbe=60.0), 0, (0.8, -0.1, 0.1))
    nd.prepare(scene)
    return {"Flint": Exterior.UNKNOWN, "Drop": Exterior.UNKNOWN, "Bubble": Exterior.MEDIUM, "Crown": Exterior.UNKNOWN}


@pytest.mark.parametrize(
    "build",
    [nested, crossing, fused, placed, shaped, tinted, tinted_without_foreign_objects, tinted_chain, dispersing],
    ids=lambda build: build.__name__,
)
def test_what_media_are_told_changes_no_picture(build):
    expected = build()
    asked, told = asked_and_told(bpy.context.scene)
    assert codes() | expected == codes()
    # Where surfaces tint what is ahead of them, and volumes do not, Cycles' choice between their lobes is another.
    assert_same_answers(told, asked, 10 * OUTLIERS if build is tinted else OUTLIERS)
    if build is not dispersing:
        assert not magenta(told).any()


@pytest.mark.parametrize("shared", [False, True], ids=["own material", "shared material"])
def test_a_mesh_that_overlaps_itself_renders_as_the_union_of_its_parts(shared):
    """As two objects of one priority do, with a tint and something foreign inside."""
    parts = ((0.8, (-0.4, 0.0, 0.0)), (0.8, (0.5, 0.1, 0.1)))

    def build(*meshes) -> bpy.types.Scene:
        scene = stage()
        glass = medium("Glass", 1.5, transmittance=(0.9, 0.6, 0.4), transmittance_depth=0.9)
        water = medium("Water", 1.33)
        ball("Drop", 0.4, water, 1, (0.0, -0.6, 0.5))
        ball("Foreign", 0.2, emission(0.4), None, (0.3, -0.3, 0.0))
        if shared:
            ball("Alone", 0.3, glass, 3, (-1.1, -0.3, 0.9))
        for index, places in enumerate(meshes):
            add_mesh(f"Part {index}", balls(*places), glass, 2, smooth=True)
        return scene

    build(*((part,) for part in parts))
    union = render(SAMPLES)
    scene = build(parts)
    asked, told = asked_and_told(scene)
    assert nd.analyse(scene).overlapping == ("Part 0",)
    assert_same_answers(told, union)
    assert not magenta(told).any()
    assert differing(asked, union) > 10 * OUTLIERS


def test_motion_is_left_to_rays_on_every_frame():
    """An analysis of one frame holds for all others, and for the time between them."""
    scene = stage(24)
    ball("Outer", 1.1, medium("Water", 1.33), 2)
    bead = ball("Ball", 0.5, medium("Glass", 1.5), 1)
    for frame, x in ((1, 0.0), (11, 2.0)):
        bead.location.x = x
        bead.keyframe_insert("location", frame=frame)
    asked = {}
    for frame, blur in ((7, False), (4, True)):
        scene.render.use_motion_blur = blur
        scene.frame_set(1)
        nd.analyse(scene)
        scene.frame_set(frame)
        told = render(SAMPLES)
        nd.clear_analysis(scene)
        asked[frame] = render(SAMPLES)
        assert_same_answers(told, asked[frame])
        assert not magenta(told).any()
    assert differing(asked[4], asked[7]) > 10 * OUTLIERS  # it does move


def test_an_object_that_is_told_nothing_by_itself_asks_all():
    """As an object of a scene that has not been analysed, whose material tells others by themselves."""
    scene = stage(24)
    glass = medium("Glass", 1.5, **GREY)
    water = medium("Water", 1.33)
    ball("Water", 1.0, water, 5)
    ball("Drop", 0.4, water, 0, (0.0, -1.1, 0.3))
    crossing = ball("Crossing", 0.5, glass, 1, (0.0, -0.8, 0.2))
    ball("Far", 0.2, glass, 1, (-1.1, 0.0, 0.9))
    ball("Foreign", 0.15, diffuse(0.8), None, (0.2, -0.8, 0.0))
    asked = render(SAMPLES)
    nd.analyse(scene)
    assert inputs(glass)["Outside"].default_value == Exterior.BY_OBJECT
    for name in OBJECT_PROPERTIES:
        crossing.pop(name, None)
    crossing.update_tag()
    assert_same_answers(render(SAMPLES), asked)


@pytest.mark.parametrize("seed", [4, 12, 19, 21, 40, 55])
def test_flawed_media_that_know_their_surroundings_send_back_no_more_light_than_they_get(seed, monkeypatch):
    scene = build_flawed(seed)
    nd.analyse(scene)
    picture = render(SAMPLES)
    assert np.isfinite(picture).all()
    assert picture.min() >= 0.0 and picture.max() <= 1.0 + 1e-4
    assert not magenta(picture).any()


def build_flawed(seed: int) -> bpy.types.Scene:
    """Without what is not closed, which would leave all to rays: solids there twice, in the same place, mirrored."""
    build_chaos(seed, roughness=0.0)
    scene = bpy.context.scene
    for name, _ in nd.analyse(scene).doubts:
        bpy.data.objects.remove(bpy.data.objects[name])
    return scene


def test_a_saved_file_keeps_what_it_is_told_and_renders_without_the_extension(tmp_path):
    expected = nested()
    scene = bpy.context.scene
    nd.analyse(scene)
    told = render(SAMPLES)
    kept = snapshot()
    assert codes() == expected
    scene.cycles.samples = SAMPLES
    file = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    farm = render_in_fresh_process(WITHOUT_EXTENSION, file, tmp_path / "farm.exr")
    assert_same_answers(farm, told)
    assert not magenta(farm).any()
    fresh()
    assert snapshot() != kept
    bpy.ops.wm.open_mainfile(filepath=file, load_ui=False)
    assert snapshot() == kept


def test_objects_of_one_material_are_told_of_media_that_absorb():
    scene = stage()
    glass = medium("Glass", 1.5, shadow_mode="BLACK")
    grey = {"transmittance": (0.5, 0.25, 1.0), "transmittance_depth": 2.0}
    ball("Wine", 0.8, medium("Wine", 1.33, **grey, shadow_mode="BLACK"), 5, (0.0, 0.0, -0.3))
    inside = ball("Inside", 0.4, glass, 1, (0.0, 0.0, -0.3))
    ball("Outside", 0.3, glass, 2, (0.0, 0.0, 0.9))
    crossing = ball("Crossing", 0.3, glass, 3, (-0.8, 0.1, -0.3))
    asked, told = asked_and_told(scene)
    assert told_by_object(inside) == ((Exterior.MEDIUM + 16 + 32, 5.0, 1.33, 2.0), (0.5, 0.25, 1.0, 1.0))
    assert told_by_object(crossing) == ((Exterior.UNKNOWN + 16 + 64 * 6, 0.0, 1.0, 0.0), None)
    assert_same_answers(told, asked)


def test_materials_whose_objects_have_one_slot_tell_others_of_no_more():
    scene = stage(24)
    glass, water, label = medium("Glass", 1.5), medium("Water", 1.33), diffuse(0.5)
    ball("Glass", 0.7, glass, 2, (-0.3, 0.0, 0.0))
    bead = ball("Water", 0.7, water, 1, (0.4, 0.1, 0.0))
    asked, told = asked_and_told(scene)
    assert [inputs(material)["Material Slots"].default_value for material in (glass, water)] == [1, 1]
    assert_same_answers(told, asked)
    bead.data.materials.clear()
    for material in (label, water):
        bead.data.materials.append(material)
    for face in bead.data.polygons:
        face.material_index = 0 if face.center.x > 0.5 else 1
    asked, told = asked_and_told(scene)
    assert [inputs(material)["Material Slots"].default_value for material in (glass, water)] == [1, 8]
    assert_same_answers(told, asked)
    bead.modifiers.new("Nodes", "NODES").node_group = bpy.data.node_groups.new("Empty", "GeometryNodeTree")
    bead.data.materials.clear()
    bead.data.materials.append(water)
    nd.analyse(scene)
    assert [inputs(material)["Material Slots"].default_value for material in (glass, water)] == [1, 8]
    nd.clear_analysis(scene)
    assert [inputs(material)["Material Slots"].default_value for material in (glass, water)] == [8, 8]
