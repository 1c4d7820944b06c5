"""The zip that Blender installs."""

import os
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULE = "bl_ext.user_default.nested_dielectric"

USE = f"""
import sys
from pathlib import Path
import bpy, addon_utils, numpy
# What the environment of these tests holds, Blender lacks.
sys.path.remove(str(Path(numpy.__file__).parent.parent))
archive = sys.argv[1]
bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
assert "{MODULE}" in bpy.context.preferences.addons, "not enabled"

from bl_ext.user_default import nested_dielectric as nd
assert nd.__file__.startswith(bpy.utils.user_resource("EXTENSIONS")), nd.__file__
for obj in bpy.data.objects:
    obj.select_set(obj.type == "MESH")
bpy.ops.nested_dielectric.assign_preset(preset="water")
cube = bpy.data.objects["Cube"]
assert nd.get_priority(cube) == 30, nd.get_priority(cube)
assert nd.new_material("Diamond", ior=2.417).node_tree.nodes["Nested Dielectric"].inputs["IOR"].default_value > 2.4
table = nd.addon.model.spectral_tables.spectral_table("LED", "ACESCG")
assert abs(table[:, :3].mean() - 1.0) < 1e-6, table
import colour
assert colour.__file__.startswith(bpy.utils.user_resource("EXTENSIONS")), colour.__file__
assert "scipy" not in sys.modules and "matplotlib" not in sys.modules
assert not addon_utils._extensions_warnings_get().get("{MODULE}"), addon_utils._extensions_warnings_get()

libraries = bpy.context.preferences.filepaths.asset_libraries
listed = [library for library in libraries if library.name == "Nested Dielectric"]
assert [library.import_method for library in listed] == ["APPEND"], listed
folder = Path(listed[0].path)
assert folder.is_relative_to(bpy.utils.user_resource("EXTENSIONS")), folder
bpy.ops.wm.append(directory=str(folder / "nested_dielectric.blend" / "Material") + "/", filename="Diamond")
assert bpy.data.materials["Diamond.001"].node_tree.nodes["Nested Dielectric"].inputs["IOR"].default_value > 2.4
bpy.ops.nested_dielectric.save_preset(name="Mine")
mine = Path(bpy.utils.extension_path_user("{MODULE}", path="presets")) / "mine.toml"
assert mine.is_file() and "mine" in nd.preset_names(), mine
assert bpy.context.preferences.addons["{MODULE}"].preferences.asset_library

bpy.ops.preferences.addon_disable(module="{MODULE}")
assert "Nested Dielectric" not in libraries.keys()
assert not [name for name in dir(bpy.types) if name.upper().startswith("NESTED_DIELECTRIC")]
print("all well")
"""


def manifest() -> dict:
    return tomllib.loads((ROOT / "blender_manifest.toml").read_text())


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """The zip as ``make extension`` builds and validates it.

    -o keeps make from renewing the environments that tests run in.
    """
    folder = tmp_path_factory.mktemp("dist")
    variables = (f"DIST={folder}", f"PYTHON={sys.executable}", f"LTS_PYTHON={sys.executable}")
    kept = ("-o", ".venv/.installed", "-o", ".venv-lts/.installed")
    result = subprocess.run(["make", *kept, "extension", *variables], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    (path,) = folder.glob("*.zip")
    return path


def test_the_zip_holds_the_extension_and_nothing_else(archive):
    names = set(zipfile.ZipFile(archive).namelist())
    sources = {
        path.relative_to(ROOT).as_posix()
        for folder, pattern in (
            ("addon", "**/*.py"),
            ("osl", "*"),
            ("presets", "*.toml"),
            ("presets/previews", "*.jpg"),
            ("library", "*"),
        )
        for path in (ROOT / folder).glob(pattern)
    }
    top = {"__init__.py", "blender_manifest.toml", "README.md", "LICENSE"}
    wheels = {wheel.removeprefix("./") for wheel in manifest()["wheels"]}
    assert names == sources | wheels | {name for name in top if (ROOT / name).is_file()}


def test_the_zip_is_below_15_mb_without_and_40_mb_with_the_asset_library(archive):
    library = [each for each in zipfile.ZipFile(archive).infolist() if each.filename.startswith("library/")]
    assert {each.filename for each in library} == {"library/nested_dielectric.blend", "library/blender_assets.cats.txt"}
    size = archive.stat().st_size
    assert size < 40e6
    assert size - sum(each.compress_size for each in library) < 15e6


def test_the_manifest_names_a_manual_what_it_may_do_and_the_licence_of_the_media():
    assert manifest()["website"].startswith("https://")
    assert manifest()["permissions"].keys() == {"files"}
    assert manifest()["license"] == ["SPDX:GPL-3.0-or-later", "SPDX:CC0-1.0"]


def test_the_extension_and_the_python_package_have_one_version(archive):
    assert manifest()["version"] == project()["version"]
    assert archive.name == f"{manifest()['id']}-{manifest()['version']}.zip"


def test_the_bundled_wheel_is_of_the_version_that_the_tests_run_with():
    (version,) = (name.partition("==")[2] for name in project()["dependencies"] if name.startswith("colour-science=="))
    assert manifest()["wheels"] == [f"./wheels/colour_science-{version}-py3-none-any.whl"]


def test_an_installed_extension_enables_in_a_fresh_profile_and_makes_materials_and_tables(archive, tmp_path):
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "profile")}
    result = subprocess.run(
        [sys.executable, "-c", USE, archive], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.endswith("all well\n")
    assert result.stderr == "Nested Dielectric: updated Diamond.001: was one of several copies\n"
