"""What media are told of their surroundings is what they would find by asking, and where it is wrong it shows."""

import functools
from collections.abc import Callable, Iterator

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
    add_plane,
    add_sphere,
    add_sun,
    diffuse,
    emission,
    new_scene,
    render,
    set_striped_world,
)
from test_files import WITHOUT_EXTENSION, render_in_fresh_process
from test_placement import SHAPE, egg
from test_robustness import build_chaos

import nested_dielectric as nd
from nested_dielectric.analysis import analysis
from nested_dielectric.analysis.analysis import Found
from nested_dielectric.geometry.contacts import AIR, MEDIUM, NEVER, PROBE
from nested_dielectric.nodes.identity import SCENE_PROPERTY
from nested_dielectric.nodes.node_group import ANALYSED, BY_OBJECT, MATERIAL_SLOTS, OBJECT_PROPERTIES, SCENE_SOCKET
from nested_dielectric.preparation import live

TOLD = (
    "Outside",
    "Outside Priority",
    "Overlaps Itself",
    "Foreign Objects",
    "Surroundings",
    "Surroundings Transmittance",
    "Absorbs by Volume",
    "Gives Back",
)
"""Sockets of a material that an analysis writes."""

SAMPLES = 16
ALARM_SAMPLES = 16 * SAMPLES
"""So many that some of a few hundred pixels are checked."""

UNTOLD = (None,) * len(OBJECT_PROPERTIES)
TINT = {"transmittance": (0.9, 0.6, 0.4), "transmittance_depth": 0.5}
GREY = {"transmittance": (0.7, 0.7, 0.7), "transmittance_depth": 0.5}

# The same rays meet the same answers. Only the last bits of sums may differ, and where those decide, whole samples.
OUTLIERS = 0.005
MEAN_TOLERANCE = 1e-3

# The world is grey and no tint here takes more from green than from blue, so nothing but the alarm lacks green.
MAGENTA = 1e-3

_template = ""


@pytest.fixture(autouse=True, scope="module")
def template(tmp_path_factory) -> Iterator[None]:
    """An empty file that has the node group, which takes longer to make than most scenes here."""
    global _template
    _template = str(tmp_path_factory.mktemp("analysis") / "template.blend")
    new_scene()
    bpy.data.materials.remove(nd.new_material("Nested Dielectric"))
    for tree in bpy.data.node_groups:
        tree.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=_template)
    yield
    bpy.ops.wm.read_factory_settings(use_empty=True)


def fresh(resolution: int = 32) -> bpy.types.Scene:
    """As new_scene()."""
    bpy.ops.wm.open_mainfile(filepath=_template, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = resolution
    return scene


def stage(resolution: int = 32) -> bpy.types.Scene:
    scene = fresh(resolution)
    set_striped_world()
    add_camera((0.3, -5, 0.8), (0, 0, 0), angle=30)
    return scene


def ball(name: str, radius: float, material=None, priority=None, location=(0.0, 0.0, 0.0)) -> bpy.types.Object:
    return add_sphere(name, radius, material, priority, location, segments=32)


def medium(name: str, ior: float, **keywords) -> bpy.types.Material:
    return nd.new_material(name, ior=ior, **keywords)


def inputs(material: bpy.types.Material) -> bpy.types.NodeInputs:
    return material.node_tree.nodes["Nested Dielectric"].inputs


def plain(value):
    """Numbers of a socket or a custom property, rounded to what single precision keeps."""
    return tuple(round(float(v), 5) for v in value) if hasattr(value, "__len__") else round(float(value), 5)


def told_by_material(material: bpy.types.Material) -> tuple:
    return tuple(plain(inputs(material)[name].default_value) for name in TOLD)


def told_by_object(obj: bpy.types.Object) -> tuple:
    return tuple(plain(obj[name]) if name in obj else None for name in OBJECT_PROPERTIES)


def told_code(obj: bpy.types.Object) -> int:
    """What the shader takes for the object's code; of several materials the one that is told most."""
    own = int(obj[OBJECT_PROPERTIES[0]][0]) % 8 if OBJECT_PROPERTIES[0] in obj else PROBE
    by_material = [inputs(material)["Outside"].default_value for material in media_of(obj)]
    return max(own if code == BY_OBJECT else code for code in by_material)


def media_of(obj: bpy.types.Object) -> list[bpy.types.Material]:
    return [slot.material for slot in obj.material_slots if "Nested Dielectric" in slot.material.node_tree.nodes]


def told_foreign(obj: bpy.types.Object) -> bool:
    """Whether the shader looks out for foreign objects."""
    sockets = inputs(obj.active_material)
    if sockets["Outside"].default_value == BY_OBJECT:
        return OBJECT_PROPERTIES[0] not in obj or int(obj[OBJECT_PROPERTIES[0]][0]) // 16 % 2 == 0
    return sockets["Foreign Objects"].default_value


def snapshot() -> dict:
    """All that is told in this file."""
    told = {
        material.name: told_by_material(material)
        for material in bpy.data.materials
        if "Nested Dielectric" in material.node_tree.nodes
    }
    for obj in bpy.data.objects:
        told["object " + obj.name] = told_by_object(obj)
    return told


def codes() -> dict[str, int]:
    return {obj.name: told_code(obj) for obj in bpy.data.objects if obj.type == "MESH" and media_of(obj)}


def magenta(picture: np.ndarray) -> np.ndarray:
    """Which pixels the alarm of a wrong analysis is in."""
    return np.minimum(picture[..., 0], picture[..., 2]) - picture[..., 1] > MAGENTA


def differing(told: np.ndarray, asked: np.ndarray) -> float:
    """Share of the pixels that differ by more than rounding."""
    return float((np.abs(told - asked).max(axis=2) > 1e-4).mean())


def assert_same_answers(told: np.ndarray, asked: np.ndarray, outliers: float = OUTLIERS) -> None:
    assert differing(told, asked) < outliers
    assert abs(told.mean() / asked.mean() - 1.0) < MEAN_TOLERANCE


def asked_and_told(scene: bpy.types.Scene, samples: int = SAMPLES) -> tuple[np.ndarray, np.ndarray]:
    """Pictures without and with an analysis."""
    nd.clear_analysis(scene)
    asked = render(samples)
    nd.analyse(scene)
    return asked, render(samples)


def balls(*places: tuple[float, tuple[float, float, float]]) -> Callable[[bmesh.types.BMesh], None]:
    """Icospheres in one mesh, by radius and centre."""

    def build(bm: bmesh.types.BMesh) -> None:
        for radius, centre in places:
            bmesh.ops.create_icosphere(bm, subdivisions=3, radius=radius, matrix=Matrix.Translation(centre))

    return build


def prism(bm: bmesh.types.BMesh) -> None:
    """Nine sides, and two caps of a single face each."""
    bmesh.ops.create_cone(bm, cap_ends=True, segments=9, radius1=0.5, radius2=0.5, depth=2.0)


def instance(collection: bpy.types.Collection, location=(0.0, 0.0, 0.0)) -> bpy.types.Object:
    empty = add("Instance", None, location)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    return empty


def into_collection(*objects: bpy.types.Object) -> bpy.types.Collection:
    """A new collection that takes objects out of the scene's own."""
    collection = bpy.data.collections.new("Collection")
    for obj in objects:
        bpy.context.scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
    return collection


# Pictures -----------------------------------------------------------------------------------------------------------


def nested() -> dict[str, int]:
    """Not crossing: one alone, and one around another around a third that wins and a fourth that loses."""
    stage()
    ball("Alone", 0.3, medium("Alone", 1.7), 2, (-1.1, -0.3, 0.9))
    glass = medium("Glass", 1.5)
    ball("Outer", 1.1, glass, 3)
    ball("Water", 0.8, medium("Water", 1.33), 2, (0.1, 0.0, 0.0))
    ball("Inner", 0.4, glass, 1, (0.0, 0.1, 0.1))
    ball("Lost", 0.1, medium("Lost", 1.8), 9, (-0.1, -0.95, 0.0))
    return {"Alone": AIR, "Outer": AIR, "Water": MEDIUM, "Inner": MEDIUM, "Lost": NEVER}


def crossing() -> dict[str, int]:
    """Three that cross each other, one of them of few faces, one rough."""
    stage()
    ball("Ball", 0.8, medium("Glass", 1.5), 1, (-0.5, 0.0, 0.0))
    add_box("Box", (-0.3, -0.6, -0.4), (1.1, 0.5, 0.6), medium("Water", 1.33), 2)
    ball("Rough", 0.6, medium("Rough", 1.8, roughness=0.3), 3, (0.5, -0.3, 0.5))
    return {"Ball": PROBE, "Box": PROBE, "Rough": PROBE}


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
    return {"A": PROBE, "B": PROBE, "Drop": PROBE}


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
    return {"Mirrored": PROBE, "Child": PROBE, "Bubble": PROBE}


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
    return {"Bubbles": PROBE, "Soft": PROBE, "Prism 0": PROBE, "Prism 1": PROBE}


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
    return {"Outer": PROBE, "Inner": MEDIUM, "Clear": PROBE}


def tinted_without_foreign_objects() -> dict[str, int]:
    """Media that absorb and have nothing but each other in them."""
    stage()
    ball("Outer", 1.1, medium("Glass", 1.5, **TINT), 3)
    ball("Inner", 0.6, medium("Water", 1.33, transmittance=(0.9, 0.8, 0.3), transmittance_depth=0.4), 2)
    ball("Clear", 0.4, medium("Clear", 1.6), 1, (-0.6, -0.3, -0.3))
    return {"Outer": PROBE, "Inner": PROBE, "Clear": PROBE}


def tinted_chain() -> dict[str, int]:
    """Something foreign in the second of two tinted media that fuse, seen through a clear one in the first."""
    stage()
    ball("First", 0.8, medium("First", 1.33, **GREY), 5, (0.0, -0.4, 0.0))
    ball("Second", 0.8, medium("Second", 1.33, **GREY), 5, (0.0, 0.6, 0.0))
    ball("Bubble", 0.3, medium("Air", 1.0), 1, (0.0, -0.7, 0.0))
    ball("Foreign", 0.3, diffuse(0.8), None, (0.0, 0.8, 0.0))
    return {"First": PROBE, "Second": PROBE, "Bubble": MEDIUM}


def dispersing() -> dict[str, int]:
    """Media that split light, and two in one of them that do not, but whose index depends on the wavelength."""
    scene = stage()
    ball("Flint", 1.1, medium("Flint", 1.8, disperse=True, abbe=20.0), 3)
    ball("Drop", 0.6, medium("Water", 1.33, abbe=15.0), 2, (-0.3, -0.1, 0.1))
    ball("Bubble", 0.3, medium("Air", 1.0), 1, (-0.4, -0.1, 0.1))
    ball("Crown", 0.6, medium("Crown", 1.5, disperse=True, abbe=60.0), 0, (0.8, -0.1, 0.1))
    nd.prepare(scene)
    return {"Flint": PROBE, "Drop": PROBE, "Bubble": MEDIUM, "Crown": PROBE}


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
    assert inputs(glass)["Outside"].default_value == BY_OBJECT
    for name in OBJECT_PROPERTIES:
        crossing.pop(name, None)
    crossing.update_tag()
    assert_same_answers(render(SAMPLES), asked)


@pytest.mark.parametrize("seed", [4, 12, 19, 21, 40, 55])
def test_flawed_media_that_know_their_surroundings_send_back_no_more_light_than_they_get(seed, monkeypatch):
    monkeypatch.setattr("test_robustness.new_scene", fresh)
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


# What is told ------------------------------------------------------------------------------------------------------


def test_a_medium_alone_is_told_of_air_through_its_material():
    scene = fresh()
    bead = ball("Ball", 1.0, medium("Glass", 1.5))
    found = nd.analyse(scene)
    sockets = inputs(bead.active_material)
    assert sockets["Outside"].default_value == AIR == 1
    assert sockets["Outside Priority"].default_value < 0.0
    assert not sockets["Overlaps Itself"].default_value
    assert not sockets["Foreign Objects"].default_value
    assert told_by_object(bead) == UNTOLD
    assert (found.known, found.asking, found.doubts) == (("Ball",), (), ())


def test_a_medium_in_another_is_told_of_its_values():
    scene = fresh()
    water = medium("Water", 1.33, **TINT)
    ball("Water", 1.0, water, 5)
    ball("Around", 2.0, medium("Around", 1.2), 7)
    bead = ball("Ball", 0.5, medium("Glass", 1.5), 1)
    nd.analyse(scene)
    sockets = inputs(bead.active_material)
    assert sockets["Outside"].default_value == MEDIUM == 2
    assert plain(sockets["Surroundings"].default_value) == (5.0, 1.33, TINT["transmittance_depth"])
    assert plain(sockets["Surroundings Transmittance"].default_value[:3]) == TINT["transmittance"]
    inputs(water)["IOR"].default_value = 1.4
    nd.set_priority(bpy.data.objects["Water"], 6)
    nd.analyse(scene)
    assert plain(sockets["Surroundings"].default_value) == (6.0, 1.4, TINT["transmittance_depth"])


def test_a_medium_inside_a_stronger_or_equal_one_is_told_that_it_is_not_there():
    scene = fresh()
    glass = medium("Glass", 1.5)
    ball("Glass", 1.0, glass, 2)
    ball("Weaker", 0.3, medium("Weaker", 1.3), 3, (0.4, 0, 0))
    ball("Equal", 0.3, medium("Equal", 1.3), 2, (-0.4, 0, 0))
    nd.analyse(scene)
    assert codes() == {"Glass": AIR, "Weaker": NEVER, "Equal": NEVER}


def test_objects_of_one_material_are_told_each_for_itself_where_their_surroundings_differ():
    scene = fresh()
    glass = medium("Glass", 1.5)
    ball("Water", 1.0, medium("Water", 1.33), 5)
    inside, outside = ball("Inside", 0.5, glass, 1), ball("Outside", 0.5, glass, 2, (3, 0, 0))
    nd.analyse(scene)
    assert inputs(glass)["Outside"].default_value == BY_OBJECT == 5
    assert told_by_object(inside) == ((MEDIUM + 16, 5.0, 1.33, 1.0), None)
    assert told_by_object(outside) == ((AIR + 16, 0.0, 1.0, 0.0), None)
    inside.location.x = 30.0
    nd.analyse(scene)
    assert inputs(glass)["Outside"].default_value == AIR
    assert told_by_object(inside) == told_by_object(outside) == UNTOLD


def test_objects_of_one_material_are_told_of_media_that_absorb():
    scene = stage()
    glass = medium("Glass", 1.5, shadow_mode="BLACK")
    grey = {"transmittance": (0.5, 0.25, 1.0), "transmittance_depth": 2.0}
    ball("Wine", 0.8, medium("Wine", 1.33, **grey, shadow_mode="BLACK"), 5, (0.0, 0.0, -0.3))
    inside = ball("Inside", 0.4, glass, 1, (0.0, 0.0, -0.3))
    ball("Outside", 0.3, glass, 2, (0.0, 0.0, 0.9))
    crossing = ball("Crossing", 0.3, glass, 3, (-0.8, 0.1, -0.3))
    asked, told = asked_and_told(scene)
    assert told_by_object(inside) == ((MEDIUM + 16 + 32, 5.0, 1.33, 2.0), (0.5, 0.25, 1.0, 1.0))
    assert told_by_object(crossing) == ((PROBE + 16 + 64 * 6, 0.0, 1.0, 0.0), None)
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


def test_a_boolean_may_bring_materials_of_another_object():
    scene, bead = ordinary_scene()
    nd.analyse(scene)
    assert inputs(bead.active_material)["Material Slots"].default_value == 1
    bead.modifiers.new("Boolean", "BOOLEAN")
    nd.analyse(scene)
    assert inputs(bead.active_material)["Material Slots"].default_value == MATERIAL_SLOTS


def test_a_medium_that_changes_or_disperses_is_asked_for_its_values():
    scene = fresh()
    water = medium("Water", 1.33)
    ball("Water", 1.0, water, 5)
    ball("Ball", 0.5, medium("Glass", 1.5), 1)
    nd.analyse(scene)
    assert codes() == {"Water": AIR, "Ball": MEDIUM}
    inputs(water)["Disperse"].default_value = True
    nd.analyse(scene)
    assert codes() == {"Water": AIR, "Ball": PROBE}
    inputs(water)["Disperse"].default_value = False
    inputs(water)["IOR"].keyframe_insert("default_value", frame=1)
    nd.analyse(scene)
    assert codes() == {"Water": AIR, "Ball": PROBE}


def test_media_that_cross_ask_and_know_of_the_only_priority_around():
    """The first surface of that priority decides."""
    scene = fresh()
    bead = ball("Ball", 1.0, medium("Ball", 1.5), 1)
    other = ball("Other", 1.0, medium("Other", 1.33), 2, (1.1, 0.1, 0.2))
    found = nd.analyse(scene)
    assert (found.known, found.asking) == ((), ("Ball", "Other"))
    for obj, priority in ((bead, 2), (other, 1)):
        sockets = inputs(obj.active_material)
        assert (sockets["Outside"].default_value, sockets["Outside Priority"].default_value) == (PROBE, priority)
    ball("Third", 0.2, medium("Third", 1.4), 3, (1.1, 1.1, 0.2))
    nd.analyse(scene)
    assert inputs(other.active_material)["Outside Priority"].default_value < 0.0


def smooth_by_angle() -> bpy.types.NodeTree:
    """The group that Shade Auto Smooth adds, in short: edges below an angle are smooth."""
    tree = bpy.data.node_groups.new("Smooth by Angle", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Mesh", in_out=in_out, socket_type="NodeSocketGeometry")
    first, angle, compare, smooth, last = (
        tree.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "GeometryNodeInputMeshEdgeAngle",
            "FunctionNodeCompare",
            "GeometryNodeSetShadeSmooth",
            "NodeGroupOutput",
        )
    )
    smooth.domain = "EDGE"
    compare.operation = "LESS_EQUAL"
    tree.links.new(first.outputs[0], smooth.inputs["Mesh"])
    tree.links.new(angle.outputs["Unsigned Angle"], compare.inputs[0])
    tree.links.new(compare.outputs[0], smooth.inputs["Shade Smooth"])
    tree.links.new(smooth.outputs[0], last.inputs[0])
    return tree


def test_media_that_are_shaded_smooth_by_angle_are_told_as_without():
    scene, bead = ordinary_scene()
    nd.analyse(scene)
    known = snapshot()
    group = smooth_by_angle()
    for obj in (bead, bpy.data.objects["Water"]):
        obj.modifiers.new("Smooth by Angle", "NODES").node_group = group
    nd.analyse(scene)
    del known["Water"], known["Bead"]  # modifiers of nodes may bring materials
    assert known.items() <= snapshot().items()
    assert told_code(bead) == MEDIUM
    group.nodes.new("GeometryNodeInputSceneTime")
    nd.analyse(scene)
    assert set(codes().values()) == {PROBE}


def test_a_mesh_that_overlaps_itself_is_found():
    scene = fresh()
    add_mesh("Double", balls((0.8, (-0.4, 0, 0)), (0.8, (0.4, 0.1, 0.1))), medium("Double", 1.5), 1)
    add_mesh("Apart", balls((0.8, (-0.9, 5, 0)), (0.8, (0.9, 5, 0))), medium("Apart", 1.5), 1)
    found = nd.analyse(scene)
    assert found.overlapping == ("Double",) == found.asking
    assert inputs(bpy.data.materials["Double"])["Overlaps Itself"].default_value
    assert not inputs(bpy.data.materials["Apart"])["Overlaps Itself"].default_value


def test_what_stands_in_the_same_place_is_named():
    scene = fresh()
    add_box("Lower", (-1, -1, -1), (1, 1, 0), medium("Lower", 1.5), 1)
    add_box("Upper", (-0.6, -0.7, 0), (0.5, 0.6, 1), medium("Upper", 1.5), 2)
    add_box("Elsewhere", (5, -0.7, 0), (6, 0.6, 1), medium("Elsewhere", 1.5), 2)
    assert nd.analyse(scene).coincident == (("Lower", "Upper"),)


# Foreign objects ----------------------------------------------------------------------------------------------------


def far() -> None:
    ball("Foreign", 0.3, diffuse(), None, (9, 0, 0))


def hidden_everywhere() -> None:
    foreign = ball("Foreign", 0.3, diffuse())
    foreign.hide_viewport = foreign.hide_render = True


def without_a_surface() -> None:
    add("Empty", None)
    add("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    add_camera((0, 0, 0), (0, 1, 0))


def inside() -> None:
    ball("Foreign", 0.1, diffuse())


def in_the_medium_around() -> None:
    ball("Sea", 3.0, medium("Sea", 1.2), 9)
    ball("Foreign", 0.3, diffuse(), None, (2, 0, 0))


def in_the_last_of_a_chain_of_one_priority() -> None:
    for index in range(2):
        ball(f"Link {index}", 0.7, medium(f"Link {index}", 1.33, **TINT), 5, (1 + index, 0, 0))
    ball("Foreign", 0.1, diffuse(), None, (2.5, 0, 0))


def moving() -> None:
    foreign = ball("Foreign", 0.3, diffuse())
    foreign.location = (9, 0, 0)
    foreign.keyframe_insert("location", frame=1)


def instanced_by_what_moves() -> None:
    instancer = instance(into_collection(ball("Foreign", 0.3, diffuse())), (9, 0, 0))
    instancer.keyframe_insert("location", frame=1)


def displaced() -> None:
    add_plane("Foreign", 3.0, (0, 0, -1.5), (0, 0, 1), displacing(diffuse()))


def with_another_shape_in_renders() -> None:
    foreign = add_box("Foreign", (-3, -3, -1.5), (3, 3, -1.2), diffuse())
    modifier = foreign.modifiers.new("Solidify", "SOLIDIFY")
    modifier.thickness, modifier.offset, modifier.show_viewport = 3.0, 1.0, False


def hidden_in_the_viewport_alone() -> None:
    ball("Foreign", 0.3, diffuse()).hide_viewport = True


def hidden_by_the_eye() -> None:
    ball("Foreign", 0.3, diffuse()).hide_set(True)


def in_a_collection_hidden_in_the_viewport() -> None:
    collection = into_collection(ball("Foreign", 0.3, diffuse()))
    bpy.context.scene.collection.children.link(collection)
    collection.hide_viewport = True


def in_another_view_layer() -> None:
    collection = into_collection(ball("Foreign", 0.3, diffuse()))
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.view_layers.new("Second")
    bpy.context.scene.view_layers[0].layer_collection.children["Collection"].exclude = True


def displacing(material: bpy.types.Material) -> bpy.types.Material:
    """The material, made to push surfaces out by 1.5."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeDisplacement")
    for name, value in (("Height", 1.0), ("Midlevel", 0.0), ("Scale", 1.5)):
        node.inputs[name].default_value = value
    output = tree.get_output_node("CYCLES")
    tree.links.new(node.outputs[0], output.inputs["Displacement"])
    material.displacement_method = "DISPLACEMENT"
    return material


def foreign_looked_out_for(place: Callable[[], None]) -> bool:
    """Whether a tinted medium about the origin looks out for foreign objects."""
    scene = fresh()
    water = ball("Water", 0.7, medium("Water", 1.33, **TINT), 5)
    place()
    found = nd.analyse(scene)
    assert not found.doubts
    return told_foreign(water)


@pytest.mark.parametrize("place", [far, hidden_everywhere, without_a_surface], ids=lambda place: place.__name__)
def test_media_do_not_look_out_for_foreign_objects_out_of_reach(place):
    assert not foreign_looked_out_for(place)


@pytest.mark.parametrize(
    "place",
    [
        inside,
        in_the_medium_around,
        in_the_last_of_a_chain_of_one_priority,
        moving,
        instanced_by_what_moves,
        displaced,
        with_another_shape_in_renders,
        hidden_in_the_viewport_alone,
        hidden_by_the_eye,
        in_a_collection_hidden_in_the_viewport,
        in_another_view_layer,
    ],
    ids=lambda place: place.__name__,
)
def test_media_look_out_for_foreign_objects_that_may_be_in_reach(place):
    assert foreign_looked_out_for(place)


# Doubts -------------------------------------------------------------------------------------------------------------


def keyframed(obj) -> None:
    obj.keyframe_insert("location", frame=1)


def driven(obj) -> None:
    obj.driver_add("location", 0)


def constrained(obj) -> None:
    obj.constraints.new("LIMIT_LOCATION")


def child_of_what_is_keyframed(obj) -> None:
    obj.parent = add("Parent", None)
    obj.parent.keyframe_insert("location", frame=1)


def grandchild_of_what_is_constrained(obj) -> None:
    obj.parent = add("Parent", None)
    obj.parent.parent = add("Grandparent", None)
    obj.parent.parent.constraints.new("LIMIT_LOCATION")


def child_of_a_vertex(obj) -> None:
    obj.parent = add_box("Parent", (8, 8, 8), (9, 9, 9))
    obj.parent_type = "VERTEX"


def child_of_a_keyframed_path(obj) -> None:
    curve = bpy.data.curves.new("Path", "CURVE")
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (3.0, 0.0, 0.0, 1.0)
    curve.use_path = True
    curve.keyframe_insert("eval_time", frame=1)
    obj.parent = add("Path", curve)


def with_a_keyframed_shape(obj) -> None:
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Other").keyframe_insert("value", frame=1)


def with_a_modifier_of_time(obj) -> None:
    obj.modifiers.new("Build", "BUILD")


def with_a_modifier_that_looks_elsewhere(obj) -> None:
    obj.modifiers.new("Displace", "DISPLACE").texture = bpy.data.textures.new("Clouds", "CLOUDS")


def with_geometry_nodes(obj) -> None:
    obj.modifiers.new("Nodes", "NODES").node_group = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")


def with_a_modifier_in_the_viewport_alone(obj) -> None:
    obj.modifiers.new("Bevel", "BEVEL").show_render = False


def subdivided_otherwise_in_renders(obj) -> None:
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2


def subdivided_and_simplified(obj) -> None:
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    bpy.context.scene.render.use_simplify = True
    bpy.context.scene.render.simplify_subdivision_render = 0


def with_other_steps_in_renders(obj) -> None:
    mesh = bpy.data.meshes.new("Profile")
    corners = [(0.2, 0, -0.2), (0.4, 0, -0.2), (0.4, 0, 0.2), (0.2, 0, 0.2)]
    mesh.from_pydata(corners, [(0, 1), (1, 2), (2, 3), (3, 0)], [])
    mesh.materials.append(obj.active_material)
    obj.data = mesh
    modifier = obj.modifiers.new("Screw", "SCREW")
    modifier.steps, modifier.render_steps = 8, 32
    modifier.use_merge_vertices = modifier.use_normal_flip = True


def displaced_by_its_material(obj) -> None:
    displacing(obj.active_material)


def hidden_from_the_viewport(obj) -> None:
    obj.hide_viewport = True


def hidden_from_renders(obj) -> None:
    obj.hide_render = True


def closed_by_the_eye(obj) -> None:
    obj.hide_set(True)


def in_a_collection_hidden_from_renders(obj) -> str:
    collection = into_collection(obj)
    bpy.context.scene.collection.children.link(collection)
    collection.hide_render = True
    return collection.name


def instanced_with_a_collection_hidden_from_renders(obj) -> tuple[str, ...]:
    inner, outer = into_collection(obj), bpy.data.collections.new("Outer")
    outer.children.link(inner)
    inner.hide_render = True
    instance(outer)
    return obj.name, inner.name


def not_in_the_second_view_layer(obj) -> str:
    collection = into_collection(obj)
    bpy.context.scene.collection.children.link(collection)
    second = bpy.context.scene.view_layers.new("Second")
    second.layer_collection.children[collection.name].exclude = True
    return second.name


def seen_by_no_ray(obj) -> None:
    for kind in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(obj, f"visible_{kind}", False)


def culled_by_its_distance(obj) -> None:
    scene = bpy.context.scene
    scene.render.use_simplify = scene.cycles.use_distance_cull = obj.cycles.use_distance_cull = True
    scene.cycles.distance_cull_margin = 0.1


def culled_by_the_camera(obj) -> None:
    scene = bpy.context.scene
    scene.render.use_simplify = scene.cycles.use_camera_cull = obj.cycles.use_camera_cull = True


def being_edited(obj) -> None:
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")


def with_a_hole(obj) -> None:
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=[bm.faces[3]], context="FACES_ONLY")
    bm.to_mesh(obj.data)
    bm.free()


def inside_out(obj) -> None:
    obj.data.flip_normals()


def with_a_linked_priority(obj) -> None:
    nd.set_priority(obj, None)
    tree = obj.active_material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], inputs(obj.active_material)["Priority"])


def with_a_keyframed_priority_of_its_own(obj) -> None:
    obj.keyframe_insert('["nd_priority"]', frame=1)


def with_a_keyframed_priority_of_its_material(obj) -> None:
    nd.set_priority(obj, None)
    inputs(obj.active_material)["Priority"].keyframe_insert("default_value", frame=1)


def of_two_media(obj) -> None:
    obj.data.materials.append(bpy.data.materials["Water"])


def instanced_by_what_is_keyframed(obj) -> tuple[str, ...]:
    instancer = instance(into_collection(obj))
    instancer.keyframe_insert("location", frame=1)
    return obj.name, instancer.name


def instanced_by_what_is_constrained_in_another_instance(obj) -> tuple[str, ...]:
    inner = instance(into_collection(obj))
    inner.constraints.new("LIMIT_LOCATION")
    outer = instance(into_collection(inner))
    return obj.name, inner.name, outer.name


def instanced_by_what_is_hidden_from_renders(obj) -> tuple[str, ...]:
    instancer = instance(into_collection(obj))
    instancer.hide_render = True
    return obj.name, instancer.name


def instanced_on_vertices(obj) -> tuple[str, ...]:
    obj.parent = add_box("Parent", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1))
    obj.parent.instance_type = "VERTS"
    return obj.name, "Parent"


def instanced_by_particles(obj) -> tuple[str, ...]:
    host = add_plane("Host", 0.2, (0, 0, 0), (0, 0, 1))
    host.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = host.particle_systems[0].settings
    settings.type, settings.render_type, settings.instance_object = "HAIR", "OBJECT", obj
    settings.count, settings.display_percentage, settings.particle_size = 10, 50, 0.1
    return obj.name, host.name


def instanced_by_geometry_nodes(obj) -> tuple[str, ...]:
    tree = bpy.data.node_groups.new("Instance", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = obj
    info.inputs["As Instance"].default_value = True
    time = tree.nodes.new("GeometryNodeInputSceneTime")
    place = tree.nodes.new("GeometryNodeTransform")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(info.outputs["Geometry"], place.inputs["Geometry"])
    tree.links.new(time.outputs["Seconds"], place.inputs["Translation"])
    tree.links.new(place.outputs["Geometry"], output.inputs[0])
    bpy.context.scene.collection.objects.unlink(obj)
    host = add("Host", bpy.data.meshes.new("Host"))
    host.modifiers.new("Nodes", "NODES").node_group = tree
    return obj.name, host.name


def of_a_material_from_geometry_nodes(obj) -> None:
    tree = bpy.data.node_groups.new("Material", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    given, node, output = map(tree.nodes.new, ("NodeGroupInput", "GeometryNodeSetMaterial", "NodeGroupOutput"))
    node.inputs["Material"].default_value = obj.active_material
    tree.links.new(given.outputs[0], node.inputs["Geometry"])
    tree.links.new(node.outputs[0], output.inputs[0])
    obj.data.materials.clear()
    obj.modifiers.new("Nodes", "NODES").node_group = tree


def curved(obj) -> str:
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.splines.new("POLY").points.add(1)
    curve.materials.append(obj.active_material)
    return add("Curve", curve).name


ORDINARY = {"Water": PROBE, "Bead": MEDIUM, "Crossing": PROBE, "Bystander": AIR}


def ordinary_scene() -> tuple[bpy.types.Scene, bpy.types.Object]:
    """Media that are told of air and of a medium, and two that cross; the bead is in the water."""
    scene = fresh()
    ball("Water", 1.0, medium("Water", 1.33), 5)
    bead = ball("Bead", 0.4, medium("Bead", 1.5), 1)
    ball("Crossing", 0.5, medium("Crossing", 1.4), 2, (1.0, 0.1, 0.2))
    ball("Bystander", 0.5, medium("Bystander", 1.6), 3, (5.0, 0.0, 0.0))
    return scene, bead


def doubted(doubtful: Callable) -> tuple[set[str], Found]:
    """Names of which one must be doubted or asking, and what an analysis finds, after one that told the media."""
    scene, bead = ordinary_scene()
    assert not nd.analyse(scene).doubts
    assert codes() == ORDINARY
    named = doubtful(bead) or bead.name
    return {named} if isinstance(named, str) else set(named), nd.analyse(scene)


@pytest.mark.parametrize(
    "doubtful",
    [
        keyframed,
        driven,
        constrained,
        child_of_what_is_keyframed,
        grandchild_of_what_is_constrained,
        child_of_a_vertex,
        child_of_a_keyframed_path,
        with_a_keyframed_shape,
        with_a_modifier_of_time,
        with_a_modifier_that_looks_elsewhere,
        with_geometry_nodes,
        displaced_by_its_material,
        hidden_from_the_viewport,
        hidden_from_renders,
        closed_by_the_eye,
        in_a_collection_hidden_from_renders,
        not_in_the_second_view_layer,
        being_edited,
        with_a_hole,
        inside_out,
        with_a_linked_priority,
        with_a_keyframed_priority_of_its_own,
        with_a_keyframed_priority_of_its_material,
        instanced_by_what_is_keyframed,
        instanced_by_what_is_constrained_in_another_instance,
        instanced_on_vertices,
        instanced_by_particles,
        instanced_by_geometry_nodes,
        of_a_material_from_geometry_nodes,
    ],
    ids=lambda doubtful: doubtful.__name__,
)
def test_a_medium_that_may_be_anywhere_leaves_all_to_rays(doubtful):
    named, found = doubted(doubtful)
    assert named & {name for name, _ in found.doubts}, found
    assert found.known == ()
    for material in bpy.data.materials:
        sockets = inputs(material)
        assert sockets["Outside"].default_value == PROBE, material.name
        assert sockets["Outside Priority"].default_value < 0.0
        assert sockets["Foreign Objects"].default_value
    for obj in bpy.data.objects:
        assert told_by_object(obj) == UNTOLD


@pytest.mark.parametrize(
    "doubtful",
    [
        with_a_modifier_in_the_viewport_alone,
        subdivided_otherwise_in_renders,
        subdivided_and_simplified,
        with_other_steps_in_renders,
        seen_by_no_ray,
        culled_by_its_distance,
        culled_by_the_camera,
        of_two_media,
        curved,
        instanced_by_what_is_hidden_from_renders,
        instanced_with_a_collection_hidden_from_renders,
    ],
    ids=lambda doubtful: doubtful.__name__,
)
def test_a_medium_that_may_have_another_shape_leaves_its_neighbours_to_rays(doubtful):
    named, found = doubted(doubtful)
    assert named & ({name for name, _ in found.doubts} | set(found.asking)), found
    assert {codes()[name] for name in ("Water", "Crossing")} == {PROBE}
    assert all(
        inputs(bpy.data.materials[name])["Outside Priority"].default_value < 0.0 for name in ("Water", "Crossing")
    )
    assert all(
        inputs(material)["Outside"].default_value in (PROBE, BY_OBJECT)
        for material in bpy.data.materials
        if material.name != "Bystander"
    )


def subdivided_in_the_viewport_alone(obj) -> None:
    """A needle, whose surface in the viewport is a fraction as long."""
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 4, 0


def repeated_in_renders_alone(obj) -> None:
    modifier = obj.modifiers.new("Array", "ARRAY")
    modifier.use_relative_offset, modifier.use_constant_offset = False, True
    modifier.constant_offset_displace = (0.0, 0.0, 3.0)
    modifier.show_viewport = False


def mirrored_in_renders_alone(obj) -> None:
    obj.data.transform(Matrix.Translation((0, 0, -3.0)))
    obj.location.z = 3.0
    modifier = obj.modifiers.new("Mirror", "MIRROR")
    modifier.use_axis = (False, False, True)
    modifier.show_viewport = False


@pytest.mark.parametrize(
    "reach",
    [subdivided_in_the_viewport_alone, repeated_in_renders_alone, mirrored_in_renders_alone],
    ids=lambda reach: reach.__name__,
)
def test_what_a_medium_reaches_in_renders_alone_is_not_told_of_air(reach):
    scene = fresh()

    def needle(bm) -> None:
        bmesh.ops.create_cone(bm, cap_ends=True, segments=3, radius1=0.1, radius2=0.0, depth=5.0)

    long = add_mesh("Needle", needle, medium("Needle", 1.5), 1)
    reached = ball("Reached", 0.1, medium("Reached", 1.33), 2)
    reached.location.z = 2.4
    if reach is not subdivided_in_the_viewport_alone:
        long.data.transform(Matrix.Scale(0.1, 4))
        reached.location.z = 3.0
        assert nd.analyse(scene).known == ("Needle", "Reached")
    reach(long)
    nd.analyse(scene)
    assert told_code(reached) == PROBE


def test_what_is_the_same_in_renders_is_not_doubted():
    scene, bead = ordinary_scene()
    bead.parent = add("Parent", None)
    bead.modifiers.new("Hidden", "BUILD").show_viewport = False
    bead.modifiers["Hidden"].show_render = False
    subdivision = bead.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 1
    bead.shape_key_add(name="Basis")
    hidden = ball("Hidden", 1.0, medium("Hidden", 1.2), 0)
    hidden.hide_viewport = hidden.hide_render = True
    ball("Foreign", 0.3, diffuse(), None, (0.0, 0.0, 9.0)).keyframe_insert("location", frame=1)
    assert not nd.analyse(scene).doubts
    assert told_code(bead) == MEDIUM


# Others' files and scenes -------------------------------------------------------------------------------------------


def holds_in(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Whether an object's medium believes in a scene what it carries."""
    number = inputs(media_of(obj)[0])[SCENE_SOCKET].default_value
    return number != 0 and number == scene.get(SCENE_PROPERTY)


@pytest.mark.parametrize("instanced", [False, True], ids=["linked", "instanced"])
def test_an_object_in_two_scenes_is_told_of_the_one_that_was_analysed_last(instanced):
    """In the other something else may surround it."""
    scene, bead = ordinary_scene()
    if instanced:
        instance(into_collection(bead))
    other = scene.copy()
    other.collection.objects.unlink(bpy.data.objects["Water"])
    nd.analyse(scene)
    assert told_code(bead) == MEDIUM and holds_in(scene, bead) and not holds_in(other, bead)
    nd.analyse(other)
    assert told_code(bead) == AIR and holds_in(other, bead) and not holds_in(scene, bead)


def test_what_one_scene_tells_stays_when_another_is_analysed_or_cleared():
    scene, bead = ordinary_scene()
    other = bpy.data.scenes.new("Other")
    far = bpy.data.objects.new("Far", bpy.data.meshes["Bead"].copy())
    far.data.materials[0] = medium("Far", 1.5)
    other.collection.objects.link(far)
    nd.analyse(scene)
    before = {name: told for name, told in snapshot().items() if "Far" not in name}
    nd.analyse(other)
    assert told_code(far) == AIR
    nd.clear_analysis(other)
    assert told_code(far) == PROBE
    assert {name: told for name, told in snapshot().items() if "Far" not in name} == before
    live.analyse_before_render(scene)
    assert analysis.last_found(scene).known and analysis.last_found(other) is None


def test_a_copied_scene_gets_a_number_of_its_own():
    scene, _ = ordinary_scene()
    nd.analyse(scene)
    copy = scene.copy()
    nd.analyse(copy)
    assert copy[SCENE_PROPERTY] != scene[SCENE_PROPERTY]


def test_a_scene_that_is_not_in_the_window_is_looked_at():
    scene, _ = ordinary_scene()
    other = scene.copy()
    other.name = "Other"
    for obj in scene.collection.objects:
        scene.collection.objects.unlink(obj)
    assert not nd.analyse(other).doubts
    assert codes() == ORDINARY


def test_a_linked_material_is_left_as_it_is(tmp_path):
    _, bead = ordinary_scene()
    file = str(tmp_path / "library.blend")
    bpy.data.libraries.write(file, {bead.active_material})
    scene = fresh()
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.materials = ["Bead"]
    (linked,) = wanted.materials
    own = medium("Own", 1.33)
    before = told_by_material(linked)
    inside, outside = ball("Inside", 0.5, linked, 1), ball("Outside", 1.0, own, 2)
    crossing = ball("Crossing", 0.5, linked, 1, (1.0, 0.1, 0.0))
    for _ in range(2):
        assert not nd.analyse(scene).doubts
        assert told_by_material(linked) == before
        assert told_code(inside) == told_code(crossing) == PROBE
        assert (told_code(outside), inputs(own)["Outside Priority"].default_value) == (PROBE, 1.0)
    nd.clear_analysis(scene)
    assert told_by_material(linked) == before and inputs(own)["Outside Priority"].default_value < 0.0


def test_linked_media_ask_whatever_their_file_tells_them(tmp_path):
    ordinary_scene()
    nd.analyse(bpy.context.scene)
    file = str(tmp_path / "library.blend")
    collection = into_collection(*bpy.data.objects)
    collection.name = "Linked"
    known = codes()
    bpy.data.libraries.write(file, {collection})
    scene = fresh()
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.collections = ["Linked"]
    instance(wanted.collections[0], (0.0, 3.0, 0.0))
    own = ball("Own", 0.3, medium("Own", 1.7), 0, (5.0, 3.0, 0.0))
    found = nd.analyse(scene)
    assert codes() == known | {"Own": MEDIUM} and not found.doubts
    assert holds_in(scene, own) and not any(holds_in(scene, bpy.data.objects[name]) for name in known)
    assert set(found.asking) == set(known) and found.known == ("Own",)


def test_a_linked_object_and_a_local_one_of_its_name_are_two(tmp_path):
    ordinary_scene()
    file = str(tmp_path / "library.blend")
    bpy.data.libraries.write(file, {bpy.data.objects["Bead"]})
    scene, bead = ordinary_scene()
    with bpy.data.libraries.load(file, link=True) as (_, wanted):
        wanted.objects = ["Bead"]
    (linked,) = wanted.objects
    scene.collection.objects.link(linked)
    bead.location.x = 30.0
    nd.register()
    try:
        nd.analyse(scene)
        before = codes()
        bead.location.x = 31.0
        bpy.context.view_layer.update()
        followed = snapshot()
        nd.analyse(scene)
        assert followed == snapshot() and codes() == before
    finally:
        nd.unregister()


# Writing ------------------------------------------------------------------------------------------------------------


def everything_told() -> bpy.types.Scene:
    """Media told by their materials and for themselves, one of them in instances, and one that is doubled."""
    scene, bead = ordinary_scene()
    ball("Second", 0.3, bead.active_material, 4, (-5.0, 0.0, 0.0))
    ball("Third", 0.3, bpy.data.materials["Water"], 4, (-5.2, 0.0, 0.0))
    ball("Alone", 0.3, medium("Alone", 1.5), 1, (0.0, 5.0, 0.0))
    add_mesh("Double", balls((0.8, (-0.4, 9, 0)), (0.8, (0.4, 9, 0))), bpy.data.materials["Bystander"], 1)
    instance(into_collection(ball("Instanced", 0.3, medium("Instanced", 1.5), 1, (0.0, 0.0, 0.7))), (0.2, 0.0, 0.0))
    return scene


def test_a_second_analysis_changes_nothing():
    """Not even what Blender would have to evaluate again."""
    scene = everything_told()
    first = nd.analyse(scene)
    told = snapshot()
    assert {BY_OBJECT, AIR} <= {values[0] for key, values in told.items() if not key.startswith("object ")}
    scene.view_layers[0].update()
    updates = []

    def note(_, depsgraph) -> None:
        updates.extend(update.id.name for update in depsgraph.updates)

    bpy.app.handlers.depsgraph_update_post.append(note)
    try:
        second = nd.analyse(scene)
        scene.view_layers[0].update()
        assert updates == []
        bpy.data.objects["Bead"].location.x += 0.01  # the handler does work
        scene.view_layers[0].update()
        assert updates
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(note)
    assert second == first
    assert snapshot() == told


def traces() -> list:
    """Names of all custom properties and attributes, and all that is told."""
    named = [(data.name, sorted(data.keys())) for data in (*bpy.data.scenes, *bpy.data.objects, *bpy.data.meshes)]
    attributes = [(mesh.name, sorted(mesh.attributes.keys())) for mesh in bpy.data.meshes]
    return [named, attributes, snapshot()]


def test_clearing_leaves_no_trace():
    scene = everything_told()
    before = traces()
    nd.analyse(scene)
    assert traces()[2] != before[2]
    nd.clear_analysis(scene)
    del scene[SCENE_PROPERTY]  # a scene keeps its number
    assert traces() == before


def test_clearing_reaches_what_geometry_nodes_show():
    scene, bead = ordinary_scene()
    before = snapshot()
    nd.analyse(scene)
    instanced_by_geometry_nodes(bead)
    nd.clear_analysis(scene)
    assert {name: told for name, told in snapshot().items() if name in before} == before


def test_media_that_lose_their_material_keep_no_trace():
    scene, _ = ordinary_scene()
    before = traces()
    nd.analyse(scene)
    for name in ("Water", "Crossing"):
        bpy.data.objects[name].active_material = diffuse()
    nd.analyse(scene)
    nd.clear_analysis(scene)
    del scene[SCENE_PROPERTY]
    assert traces()[:2] == before[:2]


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


# Alarms -------------------------------------------------------------------------------------------------------------

CELL = 12
"""Pixels along the edge of a cell of the pictures below; each has one thing in it that an analysis has not seen."""

SPACING = 3.0


class Cells:
    """Small arrangements side by side, each with a change to come."""

    def __init__(self, names: list[str]) -> None:
        self.names = names
        self.columns = 4
        rows = -(-len(names) // self.columns)
        self.scene = fresh()
        # Blender keeps the scene between renders, and must learn of all that an analysis changes.
        self.scene.render.use_persistent_data = True
        self.scene.render.resolution_x = CELL * self.columns
        self.scene.render.resolution_y = CELL * rows
        set_striped_world()
        centre = ((self.columns - 1) / 2 * SPACING, 0.0, -(rows - 1) / 2 * SPACING)
        add_camera((centre[0], -50.0, centre[2]), centre, width=SPACING * max(self.columns, rows))
        self.changes: dict[str, Callable[[], object]] = {}

    def place(self, name: str, *offset: float) -> tuple[float, float, float]:
        row, column = divmod(self.names.index(name), self.columns)
        return column * SPACING + offset[0], offset[1], -row * SPACING + offset[2]

    def cut(self, picture: np.ndarray) -> dict[str, np.ndarray]:
        cells = {}
        for index, name in enumerate(self.names):
            row, column = divmod(index, self.columns)
            cells[name] = picture[row * CELL : (row + 1) * CELL, column * CELL : (column + 1) * CELL]
        return cells


SHAPES = [
    "a medium moves in",
    "a medium grows",
    "a medium is copied in",
    "a mesh changes",
    "a parent moves",
    "an instance moves",
    "the medium around goes",
    "its own priority changes",
    "the priority around changes",
    "a third medium comes to two that cross",
    "what it is told by itself is wrong",
]


@functools.cache
def stale_shapes() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Pictures of cells that have changed since the analysis, of the same analysed again, and without an analysis."""
    cells = Cells(SHAPES)
    glass, water = medium("Glass", 1.5), medium("Water", 1.33)  # all alone: told of air by their materials
    ice, sea = medium("Ice", 1.3), medium("Sea", 1.4)  # told by objects
    objects: dict[tuple[str, str], bpy.types.Object] = {}
    for number, name in enumerate(SHAPES):
        first, second, weak, strong = ("Glass", "Water", 2, 1) if number < 6 else ("Sea", "Ice", 5, 1)
        outer = ball(f"{first} {number}", 0.9, bpy.data.materials[first], weak)
        outer.location = cells.place(name, 0.0, 0.0, 0.0)
        inner = ball(f"{second} {number}", 0.5, bpy.data.materials[second], strong)
        inner.location = cells.place(name, 0.1, -0.2, 0.1) if number >= 6 else (4.0 * number, 0.0, 100.0)
        objects[name, "outer"], objects[name, "inner"] = outer, inner
    assert glass and water and ice and sea

    def inside(name: str) -> tuple[float, float, float]:
        return cells.place(name, 0.2, -0.7, 0.1)

    changes = cells.changes
    moved = objects["a medium moves in", "inner"]
    changes["a medium moves in"] = lambda: setattr(moved, "location", inside("a medium moves in"))
    grown = objects["a medium grows", "inner"]
    grown.location, grown.scale = cells.place("a medium grows", 1.0, 0.0, 0.0), (0.1, 0.1, 0.1)
    changes["a medium grows"] = lambda: setattr(grown, "scale", (1.2, 1.2, 1.2))

    def copy_in() -> None:
        twin = objects["a medium is copied in", "inner"].copy()
        cells.scene.collection.objects.link(twin)
        twin.location = inside("a medium is copied in")

    changes["a medium is copied in"] = copy_in
    bent = objects["a mesh changes", "inner"]
    bent.location = cells.place("a mesh changes", 0.2, -0.7, 0.1)
    bent.data.transform(Matrix.Translation((0.0, 60.0, 100.0)))

    def bend() -> None:
        bent.data.transform(Matrix.Translation((0.0, -60.0, -100.0)))
        bent.data.update()

    changes["a mesh changes"] = bend
    child, parent = objects["a parent moves", "inner"], add("Parent", None)
    child.parent = parent
    changes["a parent moves"] = lambda: setattr(
        parent, "location", Matrix.Translation(inside("a parent moves")) @ -child.location
    )
    instanced = objects["an instance moves", "inner"]
    instanced.location = (0.0, 0.0, 0.0)
    instancer = instance(into_collection(instanced), (40.0, 0.0, 100.0))
    changes["an instance moves"] = lambda: setattr(instancer, "location", inside("an instance moves"))
    around = objects["the medium around goes", "outer"]
    changes["the medium around goes"] = lambda: bpy.data.objects.remove(around)
    own = objects["its own priority changes", "inner"]
    changes["its own priority changes"] = lambda: nd.set_priority(own, 9)
    strengthened = objects["the priority around changes", "outer"]
    changes["the priority around changes"] = lambda: nd.set_priority(strengthened, 0)
    pair = objects["a third medium comes to two that cross", "inner"]
    pair.location = cells.place("a third medium comes to two that cross", 0.8, 0.0, 0.0)
    third = ball("Third", 0.5, ice, 0)
    third.location = (60.0, 0.0, 100.0)
    changes["a third medium comes to two that cross"] = lambda: setattr(
        third, "location", cells.place("a third medium comes to two that cross", 0.4, -0.8, 0.3)
    )
    wrong = objects["what it is told by itself is wrong", "inner"]

    def tell_wrongly() -> None:
        values = list(wrong[OBJECT_PROPERTIES[0]])
        assert values[0] % 8 == MEDIUM
        wrong[OBJECT_PROPERTIES[0]] = [values[0] - MEDIUM + AIR, *values[1:]]
        wrong.update_tag()

    changes["what it is told by itself is wrong"] = tell_wrongly

    assert not nd.analyse(cells.scene).doubts
    live.remove()
    for name in SHAPES:
        changes[name]()
    stale = render(ALARM_SAMPLES)
    nd.analyse(cells.scene)
    told = render(ALARM_SAMPLES)
    nd.clear_analysis(cells.scene)
    pictures = [cells.cut(picture) for picture in (stale, told, render(ALARM_SAMPLES))]
    return {name: tuple(picture[name] for picture in pictures) for name in SHAPES}


@pytest.mark.parametrize("change", SHAPES)
def test_a_change_that_nobody_analysed_shows(change):
    stale, told, asked = stale_shapes()[change]
    assert magenta(stale).sum() >= 3
    assert not magenta(told).any()
    assert differing(told, asked) < OUTLIERS


VALUES = [
    "its index changes",
    "its colour changes",
    "its depth changes",
    "something foreign comes in",
    "it gets a second material",
]


@functools.cache
def stale_values() -> dict[str, np.ndarray]:
    """Pictures of balls in tinted media that change after the analysis."""
    cells = Cells(VALUES)
    ice = medium("Ice", 1.3)
    for name in VALUES:
        around = ball(name, 0.95, medium(name, 1.33, **GREY), 5)
        around.location = cells.place(name, 0.0, 0.0, 0.0)
        # A medium that nothing wins over is left to its volume, which need not know what stands in it.
        radius, height = (0.1, 0.8) if name == "something foreign comes in" else (0.7, 0.0)
        ball(f"{name} inside", radius, ice, 1).location = cells.place(name, 0.0, 0.0, height)
    foreign = ball("Foreign", 0.5, diffuse(0.8))
    foreign.location.z = 100.0
    assert not nd.analyse(cells.scene).doubts
    live.remove()
    for name, socket, value in zip(
        VALUES, ("IOR", "Transmittance", "Transmittance Depth"), (1.5, (0.4, 0.4, 0.4, 1.0), 0.1)
    ):
        inputs(bpy.data.materials[name])[socket].default_value = value
    foreign.location = cells.place("something foreign comes in", 0.0, 0.0, 0.0)
    bpy.data.objects["it gets a second material"].data.materials.append(foreign.active_material)
    return cells.cut(render(ALARM_SAMPLES))


@pytest.mark.parametrize("change", VALUES)
def test_a_value_that_changed_after_the_analysis_shows(change):
    assert magenta(stale_values()[change]).sum() >= 3


# With the extension -------------------------------------------------------------------------------------------------


def move(bead) -> None:
    bead.location.x = 0.7


def bend_mesh(bead) -> None:
    bead.data.transform(Matrix.Translation((0.7, 0.0, 0.0)))
    bead.data.update()


def turn_on_a_modifier(bead) -> None:
    bead.modifiers.new("Array", "ARRAY").relative_offset_displace = (0.7, 0.0, 0.0)


def change_a_priority(bead) -> None:
    nd.set_priority(bead, 9)


def change_a_value(bead) -> None:
    inputs(bpy.data.materials["Water"])["IOR"].default_value = 1.4


def link_a_value(bead) -> None:
    tree = bpy.data.materials["Water"].node_tree
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], inputs(bpy.data.materials["Water"])["IOR"])


def copy_the_medium_around(bead) -> None:
    twin = bpy.data.objects["Water"].copy()
    twin.location.x = 5.3
    bpy.context.scene.collection.objects.link(twin)


def remove_the_medium_around(bead) -> None:
    bpy.data.objects.remove(bpy.data.objects["Water"])


def give_another_material(bead) -> None:
    bpy.data.objects["Water"].active_material = bpy.data.materials["Bystander"]


def keyframe(bead) -> None:
    bead.keyframe_insert("location", frame=1)


def parent_to_what_moves(bead) -> None:
    parent = add("Parent", None)
    parent.keyframe_insert("location", frame=1)
    bead.parent = parent


def hide_the_medium_around(bead) -> None:
    bpy.data.objects["Water"].hide_viewport = bpy.data.objects["Water"].hide_render = True


def add_something_foreign(bead) -> None:
    ball("Foreign", 0.2, diffuse())


def move_something_foreign_away(bead) -> None:
    bpy.data.objects["Nearby"].location.x = -50.0


def swap_meshes(bead) -> None:
    bead.data = bpy.data.objects["Water"].data


EVERY_CHANGE = pytest.mark.parametrize(
    "change",
    [
        move,
        bend_mesh,
        turn_on_a_modifier,
        change_a_priority,
        change_a_value,
        link_a_value,
        copy_the_medium_around,
        remove_the_medium_around,
        give_another_material,
        keyframe,
        parent_to_what_moves,
        hide_the_medium_around,
        add_something_foreign,
        move_something_foreign_away,
        swap_meshes,
    ],
    ids=lambda change: change.__name__,
)


@pytest.fixture
def with_extension():
    nd.register()
    yield
    nd.unregister()


@pytest.fixture
def in_window(with_extension, monkeypatch):
    """As in a window, except that nothing comes to rest by itself."""
    monkeypatch.setattr(live, "has_window", lambda: True)
    monkeypatch.setattr(live, "REST", 1e9)


def analysed_scene() -> tuple[bpy.types.Scene, bpy.types.Object]:
    """The ordinary scene with something foreign nearby, and all that was told evaluated."""
    scene, bead = ordinary_scene()
    ball("Nearby", 0.2, diffuse(), None, (-0.6, 0.0, 0.0))
    nd.analyse(scene)
    bpy.context.view_layer.update()
    return scene, bead


@EVERY_CHANGE
def test_with_the_extension_every_change_is_followed(change, with_extension):
    """Without being asked to, it tells what an analysis from scratch would."""
    scene, bead = analysed_scene()
    before = snapshot()
    change(bead)
    bpy.context.view_layer.update()
    followed = snapshot()
    nd.analyse(scene)
    assert followed == snapshot()
    assert followed != before


def holds(scene: bpy.types.Scene) -> bool:
    """Whether media believe what they are told."""
    return scene[ANALYSED][0] == 1.0


@EVERY_CHANGE
def test_in_a_window_media_that_change_ask_until_all_rests(change, in_window):
    """What is told comes back as updates, which are no change. Other objects are followed at once."""
    scene, bead = analysed_scene()
    change(bead)
    for _ in range(3):
        bpy.context.view_layer.update()
    assert holds(scene) == (change in (add_something_foreign, move_something_foreign_away))
    assert live.analyse_at_rest() is None
    for _ in range(3):
        bpy.context.view_layer.update()
    assert holds(scene)
    at_rest = snapshot()
    nd.analyse(scene)
    assert at_rest == snapshot()


def test_in_a_window_a_file_is_saved_with_what_an_analysis_tells(in_window, tmp_path):
    scene, bead = analysed_scene()
    bead.location.x = 0.1
    bpy.context.view_layer.update()
    assert not holds(scene)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"), copy=True)
    assert holds(scene) and codes() == ORDINARY


def test_in_a_window_nothing_is_analysed_while_the_mouse_works(in_window, monkeypatch):
    scene, bead = analysed_scene()
    bead.location.x = 0.1
    bpy.context.view_layer.update()
    assert bpy.app.timers.is_registered(live.analyse_at_rest)
    monkeypatch.setattr(live, "is_at_work", lambda: True)
    assert live.analyse_at_rest() == live.REST
    assert not holds(scene)
