"""Files are packed so that they need no other, or what they lack is named."""

import json

import bpy
import pytest
from command_line import assert_one_line, run, save_scene
from crossing_blocks import add_crossing
from packed import packed_away
from released_files import FIRST, open_file
from scenes import add_plane, add_sphere, new_scene
from structures import by_override

import nested_dielectric as nd
from nested_dielectric.cutting import baked_cut, cut_scene
from nested_dielectric.farm import needs, outside
from nested_dielectric.farm.packing import pack
from nested_dielectric.model.files import WriteError
from nested_dielectric.nodes import compatibility
from nested_dielectric.nodes.material_version import MATERIAL_VERSION, group_version
from nested_dielectric.nodes.names import VERSION_PROPERTY
from nested_dielectric.scene.materials import dielectric_node


def picture(folder, name="texture.png"):
    """An image in a file."""
    image = bpy.data.images.new(name, 4, 4)
    image.filepath_raw, image.file_format = str(folder / name), "PNG"
    image.save()
    image.source = "FILE"
    return image


def painted(image):
    """A plane of an ordinary material that shows an image; the image's node."""
    material = bpy.data.materials.new("Paint")
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.links.new(
        node.outputs["Color"], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    )
    add_plane("Canvas", 1.0, (0, 0, 5), (0, 0, 1), material)
    return node


def needed_paths():
    """All files that the open file's data name and do not hold, and its libraries."""
    paths = {path for paths in bpy.data.file_path_map().values() for path in paths}
    return paths | {library.filepath for library in bpy.data.libraries}


def test_a_packed_file_needs_no_other_and_the_file_itself_stays(tmp_path):
    new_scene(with_group=True)
    add_crossing()
    by_override(nd.new_material("Egg", ior=1.5, priority=3), tmp_path)
    painted(picture(tmp_path))
    lamp = bpy.data.lights.new("Lamp", "POINT")
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Lamp", lamp))
    beam = lamp.node_tree.nodes.new("ShaderNodeTexIES")
    (tmp_path / "beam.ies").write_text("IESNA:LM-63-2002\nTILT=NONE\n", encoding="latin-1")
    beam.mode, beam.filepath = "EXTERNAL", str(tmp_path / "beam.ies")
    file = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    before = file.read_bytes()
    assert needed_paths() >= {"//texture.png", "//beam.ies", "//library.blend"}
    packed = pack(tmp_path / "farm" / "out.blend")
    assert packed.saved == tmp_path / "farm" / "out.blend" and packed.lacks == () and file.read_bytes() == before
    assert any("library.blend" in each for each in packed.done) and any("texture.png" in each for each in packed.done)
    bpy.ops.wm.open_mainfile(filepath=str(packed.saved))
    assert needed_paths() == set()
    egg = bpy.data.objects["Egg"]
    assert egg.library is None and egg.override_library is None and tuple(egg.location) == (0.0, 0.0, 0.0)
    groups = [tree for tree in bpy.data.node_groups if group_version(tree) == MATERIAL_VERSION]
    assert len(groups) == 1 and dielectric_node(egg.active_material).node_tree == groups[0]
    (beam,) = (node for node in bpy.data.lights["Lamp"].node_tree.nodes if node.type == "TEX_IES")
    assert beam.mode == "INTERNAL" and beam.ies.as_string().startswith("IESNA")


def lack_picture(folder):
    image = picture(folder)
    (folder / "texture.png").unlink()
    painted(image)


def lack_sequence(folder):
    painted(picture(folder)).image.source = "SEQUENCE"


def lack_script(folder):
    tree = painted(None).id_data
    node = tree.nodes.new("ShaderNodeScript")
    (folder / "mine.osl").write_text("shader mine() {}", encoding="utf-8")
    node.mode, node.filepath = "EXTERNAL", str(folder / "mine.osl")


def lack_library(folder):
    by_override(nd.new_material("Egg"), folder)
    (folder / "library.blend").unlink()
    file = str(folder / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.open_mainfile(filepath=file)


def lack_bake(folder):
    add_sphere("Cloth", 0.3).modifiers.new("Cloth", "CLOTH")


def lack_disk_cache(folder):
    add_sphere("Cloth", 0.3).modifiers.new("Cloth", "CLOTH").point_cache.use_disk_cache = True


def lack_mesh_cache(folder):
    (folder / "shapes.pc2").write_bytes(b"none")
    add_sphere("Shape", 0.3).modifiers.new("Shapes", "MESH_CACHE").filepath = str(folder / "shapes.pc2")


def lack_strip(folder):
    picture(folder)
    strips = bpy.context.scene.sequence_editor_create().strips
    strips.new_image("Titles", str(folder / "texture.png"), 1, 1)


LACKS = {
    lack_picture: ("texture.png", "is not there", "choose another"),
    lack_sequence: ("texture.png", "one by one", "--keep-outside"),
    lack_script: ("Paint", "mine.osl", "make it internal"),
    lack_library: ("library.blend", "lacks it", "find that file"),
    lack_bake: ("Cloth", "not baked", "bake it"),
    lack_disk_cache: ("Cloth", "beside the .blend", "Disk Cache off"),
    lack_mesh_cache: ("Shape", "shapes.pc2", "cannot be packed"),
    lack_strip: ("Scene", "Titles", "cannot be packed"),
}


@pytest.mark.parametrize("lack", LACKS, ids=lambda lack: lack.__name__.removeprefix("lack_"))
def test_what_a_file_lacks_is_named_and_nothing_is_written_unless_it_may_stay_outside(lack, tmp_path):
    new_scene(with_group=True)
    add_crossing()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    lack(tmp_path)
    packed = pack(tmp_path / "out.blend")
    assert packed.saved is None and not (tmp_path / "out.blend").exists()
    assert packed.lacks and all(any(word in str(each) for each in packed.lacks) for word in LACKS[lack])
    assert str(packed).endswith("nothing was written")
    kept = pack(tmp_path / "out.blend", keep_outside=True)
    assert kept.saved and kept.lacks == packed.lacks
    assert all(path.startswith("//") for path in needed_paths())


def test_what_no_scene_shows_may_be_missing(tmp_path):
    new_scene(with_group=True)
    add_crossing()
    image = picture(tmp_path)
    material = bpy.data.materials.new("Unused")
    material.use_fake_user = True
    material.node_tree.nodes.new("ShaderNodeTexImage").image = image
    bpy.context.scene.camera = camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.background_images.new().image = picture(tmp_path, "backdrop.png")
    bpy.context.scene.collection.objects.link(camera)
    for path in tmp_path.glob("*.png"):
        path.unlink()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert outside.find_lacks() == [] and pack(tmp_path / "out.blend").saved


def test_simulations_of_a_still_need_no_bake(tmp_path):
    new_scene(with_group=True)
    lack_bake(tmp_path)
    assert len(outside.find_lacks()) == 1
    bpy.context.scene.frame_end = bpy.context.scene.frame_start
    assert outside.find_lacks() == []


def test_a_file_is_never_packed_over_itself(tmp_path):
    new_scene(with_group=True)
    add_crossing()
    file = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    before = file.read_bytes()
    (tmp_path / "link.blend").symlink_to(file)
    for path in (file, tmp_path / "link.blend"):
        with pytest.raises(WriteError, match="is the file itself"):
            pack(path)
    assert file.read_bytes() == before


def test_every_scene_with_media_is_prepared_and_its_frame_kept_cut(tmp_path):
    scene = new_scene(with_group=True)
    add_crossing()
    bpy.ops.scene.new(type="FULL_COPY")
    other = bpy.context.scene
    other.name = "Other"
    bpy.data.scenes.new("Empty")
    _, packed = packed_away(tmp_path)
    assert packed.findings.keys() == {"Scene", "Other"} and len(packed.needs) == 3
    assert all(cut_scene.is_cut(each) and baked_cut.is_baked(each) for each in (scene, other))
    _, whole = packed_away(tmp_path, cut=False)
    assert not cut_scene.is_cut(scene) and "is in the file" in str(packed) and "is in the file" not in str(whole)


def test_materials_of_older_versions_are_updated_and_newer_ones_refused(tmp_path):
    open_file(FIRST)
    packed = pack(tmp_path / "out.blend", keep_outside=True)
    assert packed.saved and any("was version 1" in each for each in packed.done)
    new_scene(with_group=True)
    add_crossing()
    bpy.data.node_groups["Nested Dielectric"][VERSION_PROPERTY] = MATERIAL_VERSION + 1
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    packed = pack(tmp_path / "newer.blend")
    assert packed.saved is None and "was made by a newer version" in str(packed)


def test_what_machines_must_have_is_reported(tmp_path):
    scene = new_scene(with_group=True)
    add_crossing()
    scene.frame_start, scene.frame_end, scene.frame_step, scene.render.filepath = 3, 9, 2, "//frames/"
    _, packed = packed_away(tmp_path)
    (found,) = packed.needs
    assert found.osl == () and found.devices == ("CPU", "GPU") and found.versions == needs.VERSIONS
    assert "frames 3 to 9 by 2, OPEN_EXR, to //frames/" in str(found) and "CPU or GPU" in str(found)
    dielectric_node(bpy.data.materials["Glass"]).inputs["Disperse"].default_value = True
    _, packed = packed_away(tmp_path)
    (found,) = packed.needs
    assert found.devices == ("CPU",) and "'Glass' has Disperse" in str(found) and "magenta" in str(found)
    assert "motion blur" in str(found).lower()
    # Own nodes split light from 5.3 on alone.
    _, packed = packed_away(tmp_path, backend="NATIVE")
    (found,) = packed.needs
    assert found.devices == ("CPU", "GPU") and found.versions == (".".join(map(str, bpy.app.version[:2])),)


def test_a_medium_that_appears_on_another_frame_needs_the_shader(tmp_path):
    scene = new_scene(with_group=True)
    add_crossing()
    ball = add_sphere("Ball", 0.5, nd.new_material("Ice", ior=1.31), location=(5, 0, 0))
    for frame, hidden in ((1, True), (2, False)):
        ball.hide_render = hidden
        ball.keyframe_insert("hide_render", frame=frame)
    scene.frame_set(1)
    _, packed = packed_away(tmp_path)
    assert packed.needs[0].devices == ("CPU",) and "'Ball' may appear" in str(packed)


def test_the_versions_in_reports_are_those_that_render_media():
    first, last = (tuple(map(int, name.split("."))) for name in (needs.VERSIONS[0], needs.VERSIONS[-1]))
    assert first == compatibility.MINIMUM_VERSION[:2]
    assert (last[0], last[1] + 1) == compatibility.UNTESTED_VERSION[:2]


def test_what_needs_a_files_scripts_is_named_and_drivers_without_python_are_not(tmp_path):
    new_scene(with_group=True)
    add_crossing()
    water = bpy.data.objects["Water"]
    for index, expression in enumerate(("frame * 0.1", "len(str(frame))")):
        water.driver_add("location", index).driver.expression = expression
    text = bpy.data.texts.new("rig.py")
    text.use_module = True
    light = bpy.data.lights.new("Lamp", "AREA")
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.visible_transmission = False
    bpy.context.scene.collection.objects.link(lamp)
    _, packed = packed_away(tmp_path)
    assert len(packed.notes) == 2
    assert "'rig.py'" in packed.notes[0] and "location of 'Water'" in packed.notes[1]
    assert any(any(data.animation_data.drivers) for data in bpy.data.node_groups if data.animation_data), (
        "no driver of ours"
    )


def test_the_command_packs_and_reports_in_json(tmp_path):
    file = save_scene(tmp_path)
    before = file.read_bytes()
    done = run("pack", file, "-o", tmp_path / "out.blend", "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0 and report["schema"] == 1 and report["saved"] == str(tmp_path / "out.blend")
    assert report["needs"][0]["devices"] == ["CPU", "GPU"] and report["lacks"] == [] and file.read_bytes() == before
    done = run("pack", file, "-o", file)
    assert done.returncode == 1
    assert_one_line(done.stderr, "is the file itself")


def test_files_that_a_check_finds_wrong_are_not_written(tmp_path):
    new_scene(with_group=True)
    add_crossing(open_one=True)
    file = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    for command in ("pack", "prepare"):
        out = tmp_path / f"{command}.blend"
        done = run(command, file, "-o", out, "--check", "wrong")
        assert done.returncode == 3 and not out.exists() and "wrong picture: 'Water'" in done.stdout
    assert run("prepare", file, "-o", tmp_path / "prepared.blend").returncode == 0


def test_a_strict_check_refuses_what_is_slow_too(tmp_path):
    new_scene(with_group=True)
    one = add_sphere("Ball", 1.0, nd.new_material("Glass", ior=1.5))
    other = one.data.copy()
    for vertex in other.vertices:
        vertex.co.x += 0.9
    two = bpy.data.objects.new("Two", other)
    bpy.context.scene.collection.objects.link(two)
    with bpy.context.temp_override(active_object=one, selected_editable_objects=[one, two]):
        bpy.ops.object.join()
    file = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    codes = [
        run("prepare", file, "-o", tmp_path / "a.blend", "--check", level).returncode for level in ("wrong", "strict")
    ]
    assert codes == [0, 3]


def test_a_place_that_cannot_be_written_is_named_before_the_work(tmp_path):
    file = save_scene(tmp_path)
    (tmp_path / "out.blend").mkdir()
    for command in (["pack"], ["prepare"], ["check", "--fix"]):
        done = run(*command, file, "-o", tmp_path / "out.blend")
        said = [line for line in done.stdout.splitlines() if line and "|" not in line]  # but for Blender's log
        assert done.returncode == 1 and not said
        assert_one_line(done.stderr, "out.blend: cannot be written, as it is a folder")
