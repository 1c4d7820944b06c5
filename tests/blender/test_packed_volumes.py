"""Volumes stay files of their own: Blender packs them, but shows nothing of what it has packed."""

import bpy
import pytest
from scenes import new_scene

from nested_dielectric.farm.packing import pack


@pytest.fixture
def cloud(tmp_path):
    bpy.utils.expose_bundled_modules()
    import openvdb

    grid = openvdb.FloatGrid()
    grid.fill((0, 0, 0), (3, 3, 3), 1.0)
    openvdb.write(str(tmp_path / "cloud.vdb"), grids=[grid])
    scene = new_scene()
    volume = bpy.data.volumes.new("Cloud")
    volume.filepath = str(tmp_path / "cloud.vdb")
    scene.collection.objects.link(bpy.data.objects.new("Cloud", volume))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    return volume


def test_a_volume_is_named_as_what_cannot_be_packed_and_nothing_is_written(cloud, tmp_path):
    packed = pack(tmp_path / "out.blend")
    assert packed.saved is None and packed.done == ()
    (lack,) = packed.lacks
    assert lack.name == "Cloud" and "cloud.vdb" in lack.text and "--keep-outside" in lack.remedy
    assert pack(tmp_path / "out.blend", keep_outside=True).saved
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out.blend"))
    assert bpy.data.volumes["Cloud"].filepath == "//cloud.vdb" and bpy.data.volumes["Cloud"].grids.load()


def test_blender_shows_no_volume_that_it_has_packed(cloud, tmp_path):
    """As soon as it does, volumes need to be named no more."""
    bpy.ops.file.pack_all()
    assert cloud.packed_file is not None
    bpy.ops.wm.save_mainfile()
    (tmp_path / "cloud.vdb").unlink()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert not bpy.data.volumes["Cloud"].grids.load()
