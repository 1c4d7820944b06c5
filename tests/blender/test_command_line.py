"""The command line, as a process of its own."""

import json
import re
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line import assert_one_line, run, save_scene
from scenes import new_scene, oiio, read_picture

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.commands import render
from nested_dielectric.model.colour_science import colour_science
from nested_dielectric.model.files import require_place
from nested_dielectric.model.spectral_tables import spectral_table


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return save_scene(tmp_path_factory.mktemp("file"))


def test_prepare_saves_the_file_and_a_second_time_has_nothing_to_do(file):
    assert "changed: Render Engine" in run("prepare", file).stdout
    done = run("prepare", file)
    assert done.returncode == 0 and "nothing to change" in done.stdout


def test_prepare_keeps_in_the_file_what_media_are_rendered_with(file, tmp_path):
    done = run("prepare", file, "--backend", "native", "-o", tmp_path / "native.blend")
    assert done.returncode == 0 and "rendered: by Cycles' own nodes: 'Glass'" in done.stdout
    assert "rendered: by Cycles' own nodes" in run("prepare", tmp_path / "native.blend").stdout
    assert "rendered: by OSL: 'Glass'" in run("prepare", tmp_path / "native.blend", "--backend", "osl").stdout
    assert run("prepare", file, "--backend", "cuda").returncode == 2


def test_presets_are_listed():
    done = run("presets")
    assert done.returncode == 0
    assert set(nd.preset_names()) <= {line.split()[0] for line in done.stdout.splitlines()}


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("render", "missing.blend", "-o", "x.png"), ("missing.blend", "no such file")),
        (("import-jf", "missing.json"), ("missing.json: No such file",)),
        (("prepare",), ("no file is open",)),
    ],
)
def test_a_failure_is_one_clear_line_and_exit_code_1(arguments, words):
    done = run(*arguments)
    assert done.returncode == 1
    assert_one_line(done.stderr, *words)


def test_the_folder_of_many_frames_is_tried_once_and_pictures_that_are_there_each(tmp_path, monkeypatch, capsys):
    (tmp_path / "7.png").mkdir()
    tried = []
    monkeypatch.setattr(render, "require_place", lambda path: tried.append(path.name) or require_place(path))
    assert cli.main(["render", "x.blend", "-o", str(tmp_path / "#.png"), "--frames", "1-1000"]) == 1
    assert "7.png: cannot be written, as it is a folder" in capsys.readouterr().err and tried == ["1.png", "7.png"]


@pytest.mark.parametrize("command", [("check",), ("pack", "-o", "out.blend"), ("render", "-o", "out.png")])
def test_a_command_that_fails_says_why_in_json_and_on_the_last_line(command):
    done = run(*command, "missing.blend", "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 1 and report["schema"] == 1 and report["error"] == "missing.blend: no such file"
    assert_one_line(done.stderr.splitlines()[-1], "missing.blend: no such file")  # after what Blender says


def test_a_file_that_is_no_blend_is_named(tmp_path):
    (tmp_path / "text.blend").write_text("no blend")
    done = run("render", tmp_path / "text.blend", "-o", tmp_path / "x.png")
    assert done.returncode == 1
    assert "text.blend" in done.stderr.strip().splitlines()[-1]


def test_an_ending_without_a_format_is_named_before_anything_is_rendered(file, tmp_path):
    done = run("render", file, "-o", tmp_path / "picture.xyz")
    assert done.returncode == 1
    assert_one_line(done.stderr, "picture.xyz", ".png")


def test_bake_writes_the_table_what_it_is_and_a_plot(tmp_path):
    output, plot = tmp_path / "new" / "table.exr", tmp_path / "drawn" / "plot.png"
    done = run(
        "bake", "--distribution", "fluorescent", "--gamut", "Rec2020", "--saturation", 0.5, "--keep-negative",
        "-o", output, "--plot", plot,
    )  # fmt: skip
    assert done.returncode == 0 and done.stderr == "", done.stderr
    said = done.stdout.splitlines()[-1]  # after Blender's own lines
    assert all(word in said for word in ("4096 entries", "REC2020", str(output), str(plot)))
    picture = oiio.ImageBuf(str(output))
    assert picture.spec().channelnames == ("R", "G", "B", "A") and picture.spec().format == oiio.FLOAT
    table = picture.get_pixels(oiio.FLOAT)
    assert np.array_equal(table[0], spectral_table("FLUORESCENT", "REC2020", 0.5, False))
    told = {attribute.name: attribute.value for attribute in picture.spec().extra_attribs}
    assert told["distribution"] == "fluorescent" and told["gamut"] == "REC2020" and told["saturation"] == 0.5
    assert told["clamp_negative"] == 0 and told["alpha"] == "wavelength in nm"
    assert told["wavelength_range"] == "380 to 780 nm" and told["Software"] == "nested-dielectric"
    drawn = read_picture(plot)
    assert min(drawn.shape[:2]) > 400 and drawn.std() > 0.1


def test_bake_takes_the_working_space_of_the_open_file_and_a_csv_file(tmp_path, capsys):
    (tmp_path / "light.csv").write_text("nm,power\n400,1\n700,3\n")
    new_scene()
    bpy.ops.wm.set_working_color_space(convert_colors=False, working_space="ACEScg")
    try:
        capsys.readouterr()
        arguments = ["bake", "--distribution", str(tmp_path / "light.csv"), "-o", str(tmp_path / "table.exr")]
        assert cli.main(arguments) == 0
        assert "ACESCG" in capsys.readouterr().out
    finally:
        new_scene()
    table = oiio.ImageBuf(str(tmp_path / "table.exr")).get_pixels(oiio.FLOAT)
    assert np.array_equal(table[0], spectral_table(tmp_path / "light.csv", "ACESCG"))


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("-o", "table.png"), ("table.png", ".exr")),
        (("-o", "table"), ("table", ".exr")),
        (("-o", "folder.exr"), ("folder.exr", "cannot be written")),
        (("-o", "file/table.exr"), ("file",)),
        (("-o", "table.exr", "--plot", "plot.xyz"), ("plot.xyz", ".png")),
        (("-o", "table.exr", "--distribution", "DAYLITE"), ("DAYLITE", "DAYLIGHT")),
        (("-o", "table.exr", "--saturation", "nan"), ("saturation", "0 to 1")),
        (("-o", "table.exr", "--distribution", "/dev/zero"), ("/dev/zero", "longer")),
        (("-o", "table.exr", "--plot", "file/plot.png"), ("plot.png", "file is no folder")),
    ],
)
def test_bake_names_what_it_cannot_do_and_writes_nothing(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.exr").mkdir()
    (tmp_path / "file").touch()
    assert cli.main(["bake", *arguments]) == 1
    assert_one_line(capsys.readouterr().err, *words)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "folder.exr"]


def test_bake_without_matplotlib_says_so_before_anything_is_written(tmp_path, monkeypatch, capsys):
    colour_science()  # which would be left half imported
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)  # as in Blender's own Python
    arguments = ["bake", "-o", str(tmp_path / "table.exr"), "--plot", str(tmp_path / "plot.png")]
    assert cli.main(arguments) == 1
    assert_one_line(capsys.readouterr().err, "matplotlib", "install")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("rendr",),
        ("render",),
        ("render", "a.blend", "-o", "b.png", "--samples", "0"),
        ("bake",),
        ("bake", "-o", "a.exr", "--gamut", "sRGB"),
        ("render", "a.blend", "-o", "folder.png/"),
        ("demo", "--save", "a.png"),
    ],
)
def test_wrong_usage_has_exit_code_2(arguments):
    assert run(*arguments).returncode == 2


def test_the_manual_has_a_row_for_every_option_of_render(capsys):
    assert cli.main(["render", "--help"]) == 0
    options = set(re.findall(r"--[a-z-]+", capsys.readouterr().out)) - {"--help", "--traceback", "--output"}
    manual = (Path(__file__).parents[2] / "docs" / "command-line.md").read_text(encoding="utf-8")
    rows = "\n".join(line.split("|")[1] for line in manual.splitlines() if line.startswith("| `--"))
    assert options <= set(re.findall(r"--[a-z-]+", rows)) and "--frames" in options
