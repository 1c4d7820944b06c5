"""Preparing a scene: what it changes, what stays to be read, and how it is taken back."""

import bpy
import numpy as np
import pytest
from scenes import add_box, add_plane, add_sphere

import nested_dielectric as nd
from nested_dielectric.analysis.changes import REPORT_PROPERTY
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.checking.finding import Finding
from nested_dielectric.checking.kinds import OPEN_MESH
from nested_dielectric.preparation.prepare_scene import put_back
from nested_dielectric.preparation.report import Report, keep_report, last_report
from nested_dielectric.scene import settings
from nested_dielectric.scene.materials import dielectric_node

CUBE = (0, 0, 0), (1, 1, 1)
PATHS = (*settings.LABELS, *settings.AT_LEAST)


@pytest.fixture(autouse=True)
def scene():
    """A scene of an artist's, as unlike what media need as can be."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_EEVEE"
    scene.cycles.device = "CPU"
    scene.cycles.shading_system = False
    for path in settings.AT_LEAST:
        setattr(scene.cycles, path.removeprefix("cycles."), 3)
    scene.render.motion_blur_shutter = 0.3
    scene.cycles.rolling_shutter_type = "TOP"
    curve = scene.render.motion_blur_shutter_curve
    for index, point in enumerate(curve.curves[0].points):
        point.location[1] = 0.1 + 0.17 * index
    curve.update()
    return scene


def ball(**keywords):
    material = nd.new_material("Glass", preset="bk7", **keywords)
    add_sphere("Ball", 1.0, material, segments=8)
    return material


def values(owner):
    """All plain settings of an owner."""
    found = {}
    for name, kind in owner.bl_rna.properties.items():
        if kind.type in ("INT", "FLOAT", "BOOLEAN", "ENUM", "STRING") and not kind.is_readonly:
            value = getattr(owner, name)
            found[name] = value if isinstance(value, (int, float, str, set)) else tuple(value)
    return found


def state(scene):
    """Every setting of a scene's renders, and all that preparing may have written on its media."""
    curve = scene.render.motion_blur_shutter_curve.curves[0]
    return {
        "render": values(scene.render),
        "cycles": values(scene.cycles),
        "curve": [(*point.location, point.handle_type) for point in curve.points],
        "modifiers": {obj.name: obj.modifiers.keys() for obj in scene.objects},
        "attributes": {mesh.name: mesh.attributes.keys() for mesh in bpy.data.meshes},
        "properties": {obj.name: sorted(obj.keys()) for obj in scene.objects},
        "sockets": {
            material.name: [
                tuple(value)
                if hasattr(value := socket.default_value, "__len__") and not isinstance(value, str)
                else value
                for socket in node.inputs
                if hasattr(socket, "default_value")
            ]
            for material in bpy.data.materials
            if (node := dielectric_node(material)) is not None
        },
        "groups": sorted(tree.name for tree in bpy.data.node_groups if tree.bl_idname == "GeometryNodeTree"),
    }


def ours(scene):
    return {path: settings.read(scene, path) for path in PATHS}


def test_without_media_nothing_changes_and_that_is_said(scene):
    nd.new_material("Nobody's")
    add_box("Wall", *CUBE, bpy.data.materials.new("Plain"))
    before, properties = state(scene), sorted(scene.keys())
    preparation = nd.prepare(scene)
    assert str(preparation).splitlines() == ["No media: assign a preset first", "nothing to change"]
    assert state(scene) == before and sorted(scene.keys()) == properties and last_report(scene) is None


def test_the_first_line_says_whether_the_scene_is_ready(scene):
    ball()
    assert str(nd.prepare(scene)).splitlines()[0] == "Ready to render"
    sheet = add_plane("Sheet", 1.0, (0, 0, 5), (0, 0, 1), bpy.data.materials["Glass"])
    assert str(nd.prepare(scene)).splitlines()[0] == "1 problem to look at before rendering"
    other = sheet.copy()
    scene.collection.objects.link(other)
    other.location.z = 9.0
    preparation = nd.prepare(scene)
    assert str(preparation).splitlines()[0] == "2 problems to look at before rendering"
    report = last_report(scene)
    assert report.problems == preparation.problems and report.media == 3 and report.more_problems == 0


@pytest.mark.parametrize("disperse", (False, True))
def test_a_second_preparation_changes_nothing_and_keeps_what_was_before_the_first(scene, disperse):
    ball(disperse=disperse)
    nd.prepare(scene)
    after, known = state(scene), last_report(scene).settings
    assert scene.render.engine == "CYCLES" and scene.render.use_motion_blur == disperse
    assert nd.prepare(scene).changes == ()
    assert state(scene) == after and last_report(scene).settings == known


def test_put_back_restores_everything_to_the_bit(scene):
    material = ball(disperse=True)
    other = nd.new_material("Other", priority=20)
    # Faces in the same place, which are parted.
    add_box("Block", (3, 0, 0), (4, 1, 1), material)
    add_box("Beside", (4, 0, 0), (5, 1, 1), other)
    before = state(scene)
    changes = nd.prepare(scene).changes
    assert any("parted" in change for change in changes) and state(scene) != before
    assert any("Beside" in name or "Block" in name for name in changes)
    said = put_back(scene)
    assert state(scene) == before
    assert "Render Engine: Cycles -> EEVEE" in said and "Shutter Curve: as it was" in said
    assert any("faces are where they were" in line for line in said)
    assert not is_analysed(scene) and last_report(scene) is None
    assert put_back(scene) == []


def test_put_back_leaves_what_the_artist_has_changed_since(scene):
    ball(disperse=True)
    scene.cycles.device = "GPU"
    nd.prepare(scene, backend="OSL")
    scene.cycles.max_bounces = 100
    scene.cycles.device = "GPU"
    scene.cycles.rolling_shutter_type = "TOP"
    scene.render.motion_blur_shutter = 0.7  # so motion blur is in use
    put_back(scene)
    found = ours(scene)
    assert found["cycles.max_bounces"] == 100 and found["cycles.device"] == "GPU"
    assert found["cycles.rolling_shutter_type"] == "TOP"
    assert found["render.motion_blur_shutter"] == pytest.approx(0.7) and found["render.use_motion_blur"]
    assert found["cycles.glossy_bounces"] == 3 and found["render.engine"] == "BLENDER_EEVEE"


def test_what_an_artist_changes_between_two_preparations_is_what_goes_back(scene):
    ball()
    nd.prepare(scene)
    scene.cycles.max_bounces = 20
    nd.prepare(scene)
    assert scene.cycles.max_bounces == 64
    put_back(scene)
    assert scene.cycles.max_bounces == 20 and scene.cycles.glossy_bounces == 3


def test_motion_blur_goes_back_when_nothing_disperses_any_more(scene):
    before = ours(scene)
    material = ball(disperse=True)
    nd.prepare(scene)
    assert scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.0
    dielectric_node(material).inputs["Disperse"].default_value = False
    changes = nd.prepare(scene).changes
    found = ours(scene)
    assert {path: found[path] for path in settings.RANDOM_TIME} == {path: before[path] for path in settings.RANDOM_TIME}
    assert len(changes) >= 3 and scene.render.engine == "CYCLES"
    assert nd.prepare(scene).changes == ()
    put_back(scene)
    assert ours(scene) == before


def test_motion_blur_that_is_in_use_since_stays_when_nothing_disperses_any_more(scene):
    material = ball(disperse=True)
    nd.prepare(scene)
    scene.render.motion_blur_shutter = 0.9
    dielectric_node(material).inputs["Disperse"].default_value = False
    nd.prepare(scene)
    assert scene.render.use_motion_blur and scene.render.motion_blur_shutter == pytest.approx(0.9)


def test_everything_goes_back_when_no_medium_is_left(scene):
    before = ours(scene)
    ball(disperse=True)
    nd.prepare(scene)
    scene.cycles.glossy_bounces = 50
    bpy.data.objects.remove(bpy.data.objects["Ball"])
    preparation = nd.prepare(scene)
    assert str(preparation).splitlines()[:2] == [
        "No media: assign a preset first",
        "changed: Render Engine: Cycles -> EEVEE",
    ]
    assert ours(scene) == before | {"cycles.glossy_bounces": 50}
    assert last_report(scene) is None and nd.prepare(scene).changes == ()


def test_a_report_survives_saving_and_opening_and_so_does_what_it_puts_back(scene, tmp_path):
    before = ours(scene)
    ball(disperse=True)
    nd.prepare(scene)
    report, path = last_report(scene), str(tmp_path / "file.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    assert last_report(scene) == report
    put_back(scene)
    assert ours(scene) == before


def test_a_report_of_thousands_of_problems_takes_a_few_kilobytes(scene):
    problems = [Finding(OPEN_MESH, f"Object {index}", "is not closed " * 5, "close it " * 10) for index in range(5000)]
    keep_report(scene, 5000, problems, [f"Change {index}" for index in range(5000)], {"render.engine": ("A", "CYCLES")})
    assert len(scene[REPORT_PROPERTY].encode()) < 12_000
    report = last_report(scene)
    assert report.problems == tuple(problems[: len(report.problems)]) and len(report.problems) > 10
    assert len(report.problems) + report.more_problems == len(report.changes) + report.more_changes == 5000
    assert report.settings == {"render.engine": ("A", "CYCLES")}


@pytest.mark.parametrize(
    "value",
    ("", "{}", "[]", "null", 7, [1, 2], '{"media":1}', '{"media":"x","problems":[],"more_problems":0,"settings":{}}'),
)
def test_what_is_no_report_of_ours_is_none(scene, value):
    scene[REPORT_PROPERTY] = value
    assert last_report(scene) is None
    put_back(scene)
    assert REPORT_PROPERTY not in scene


def test_a_report_names_no_other_settings_than_ours(scene):
    keep_report(scene, 1, (), (), {"render.filepath": ("/etc/passwd", "/tmp\\"), "render.engine": ("X", "Y")})
    assert last_report(scene) == Report(1, settings={"render.engine": ("X", "Y")})


def test_an_engine_that_is_not_installed_any_more_stays_away(scene):
    ball()
    nd.prepare(scene)
    known = last_report(scene).settings
    keep_report(scene, 1, (), (), known | {"render.engine": ("GONE_ENGINE", "CYCLES")})
    said = put_back(scene)
    assert scene.render.engine == "CYCLES" and scene.cycles.max_bounces == 3
    assert not any("Render Engine" in line for line in said)


def test_parted_faces_that_another_prepared_scene_shows_stay_parted(scene):
    glass, water = nd.new_material("Glass", priority=1), nd.new_material("Water", priority=2)
    for name, low, high, material in (("A", (0, 0, 0), (1, 1, 1), glass), ("B", (1, 0, 0), (2, 1, 1), water)):
        add_box(name, low, high, material)
    other = bpy.data.scenes.new("Other")
    for name in "AB":
        other.collection.objects.link(bpy.data.objects[name])
    nd.prepare(scene)
    nd.prepare(other)
    parted = [obj for obj in scene.objects if obj.modifiers]
    assert parted
    put_back(scene)
    assert [obj for obj in scene.objects if obj.modifiers] == parted
    put_back(other)
    assert not any(obj.modifiers for obj in scene.objects)
    low = np.array([vertex.co for vertex in bpy.data.objects["B"].data.vertices]).min(axis=0)
    assert low[0] == 1.0


def test_a_scene_that_is_not_prepared_has_nothing_to_put_back(scene):
    ball()
    before = state(scene)
    assert put_back(scene) == []
    assert state(scene) == before
