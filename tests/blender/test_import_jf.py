"""The command that imports JF's nodes makes a file of materials, and names what it cannot read."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from nested_dielectric import cli
from nested_dielectric.importers import jf_reader, jf_translation
from nested_dielectric.model.parameters import BY_KEYWORD
from nested_dielectric.scene.material_spectra import spectrum_settings
from nested_dielectric.scene.materials import dielectric_node, get_parameter


def run(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "nested_dielectric", "import-jf", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_command_makes_a_file_of_materials_and_prints_every_note(tmp_path):
    source = tmp_path / "scene.ass"
    source.write_text(
        """
        jf_nested_dielectric { name Water mediumIOR 1.34 mediumPriority 2 mediumTransmittance 0.9 1.2 1 }
        jf_nested_dielectric
        {
         name "Tall Glass"
         mediumIOR noise1
         disperse on
         spectral_distribution "LED"
         spectral_gamut "ACES"
         btdf "ward_rayTangent"
         refraction_roughness_u 0.2
         refraction_roughness_v 0.4
         emission_at_exits 0 2 0.5
         shadow_mode 0
         sparkle 3
        }"""
    )
    done = run(source)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert any(line.startswith("Water: mediumTransmittance: 0.9 1.2 1 -> 0.9 1 1") for line in lines)
    assert any(line.startswith("Tall Glass: mediumIOR: the link to 'noise1'") for line in lines)
    assert any(line.startswith("Tall Glass: sparkle: unknown") for line in lines)
    output = tmp_path / "scene.blend"
    assert lines[-1].startswith("wrote 2 materials to") and lines[-1].endswith(str(output))

    bpy.ops.wm.open_mainfile(filepath=str(output))
    assert not bpy.data.objects
    translations = {node.name: jf_translation.translate(node) for node in jf_reader.read_nodes(source)}
    for name, translation in translations.items():
        material = bpy.data.materials[name]
        node = dielectric_node(material)
        settings = spectrum_settings(material)
        for keyword, value in translation.keywords.items():
            held = settings[keyword] if keyword in settings else get_parameter(node, BY_KEYWORD[keyword])
            same = held == value if isinstance(value, (str, bool)) else held == pytest.approx(value, rel=1e-6)
            assert same, (name, keyword, held, value)
    glass = dielectric_node(bpy.data.materials["Tall Glass"])
    (link,) = glass.inputs["Emission at Exits"].links
    assert tuple(link.from_node.inputs["Color"].default_value) == (0.0, 2.0, 0.5, 1.0)
    assert not glass.inputs["Emission at Entrances"].is_linked


def test_materials_are_added_to_the_file_that_is_open(tmp_path, capsys):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.data.objects.new("Prop", None).use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "open.blend"))
    (tmp_path / "jf.json").write_text('{"Water": {"mediumIOR": 1.4}, "Ice": {}, "Water": {}}')
    output = tmp_path / "new" / "both.blend"
    assert cli.main(["import-jf", str(tmp_path / "jf.json"), "--output", str(output)]) == 0
    assert "Water: name: the material is called 'Water.001'" in capsys.readouterr().out
    with bpy.data.libraries.load(str(output)) as (content, _):
        assert "Prop" in content.objects and set(content.materials) == {"Ice", "Water", "Water.001"}
    bpy.ops.wm.read_factory_settings(use_empty=True)


@pytest.mark.parametrize(
    "name, text, arguments, words",
    [
        (
            "a.ass",
            "jf_nested_dielectric { name Tumbler mediumIOR nan }",
            (),
            ("Tumbler", "mediumIOR", "finite"),
        ),
        ("a.ass", "polymesh { name ball }", (), ("a.ass", "no jf_nested_dielectric")),
        ("a.ass", "jf_nested_dielectric { name X", (), ("a.ass", "closing brace")),
        ("a.json", "{}", (), ("a.json", "no jf_nested_dielectric")),
        ("a.json", "{", (), ("a.json", "JSON")),
        ("a.ma", "", (), ("a.ma", ".ass or .json")),
        ("a.ass", "jf_nested_dielectric { }", ("-o", "b.png"), ("b.png", ".blend")),
    ],
)
def test_the_command_names_what_it_cannot_read_and_writes_nothing(
    name, text, arguments, words, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(text)
    assert cli.main(["import-jf", name, *arguments]) == 1
    error = capsys.readouterr().err.strip()
    assert error.startswith("nested-dielectric: error: ") and len(error.splitlines()) == 1
    assert all(word in error for word in words), error
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_the_command_does_not_overwrite_a_file_that_was_not_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text('{"mediumIOR": 1.4}')
    Path("a.blend").write_text("a scene")
    assert cli.main(["import-jf", "a.json"]) == 1
    assert "a.blend" in capsys.readouterr().err and Path("a.blend").read_text() == "a scene"
    Path("b.ass").write_bytes(b"\x1f\x8b\xff")
    assert cli.main(["import-jf", "b.ass"]) == 1 and "unpack" in capsys.readouterr().err
    assert cli.main(["import-jf", "c.ass"]) == 1 and "c.ass" in capsys.readouterr().err
