"""The package stands in rooms: what it imports points down, and no file or function is too long for one idea."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "addon"

ROOMS = (
    "model",
    "geometry",
    "nodes",
    "scene",
    "analysis",
    "cutting",
    "checking",
    "preparation",
    "fixing",
    "importers",
    "demo",
    "ui",
    "farm",
    "commands",
    "",
)
"""From the ground up; the last is the package's own folder."""

UI = ("", "operators", "presets", "panels")
"""The same within `ui`, whose own folder is the ground."""

FORBIDDEN = {"model": {"bpy", "bmesh", "mathutils", "bl_ui", "gpu"}, "geometry": {"bpy", "bmesh", "bl_ui", "gpu"}}
"""Modules of Blender's that pure rooms do without, by room."""

LONGEST_FILE = 400
LONGEST_FUNCTION = 60
"""In lines; of shaders, which read like a method section, in statements."""


def modules() -> dict[str, Path]:
    """Return all modules of the package by their dotted names within it; '' is its `__init__`."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


def imported(name: str) -> set[str]:
    """Return what a module of the package imports anywhere in it; names within the package have a leading dot."""
    path = MODULES[name]
    here = name.split(".") if name else []
    package = here if path.name == "__init__.py" else here[:-1]
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {own(each.name.split(".")) for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module.split(".") if node.module else []
            if node.level:
                base = ["nested_dielectric", *package[: len(package) - node.level + 1], *base]
            # What stands in a package's `__init__` is imported from there; else it is a module of the package.
            for each in node.names:
                whole = own([*base, each.name])
                found.add(whole if whole[1:] in MODULES and whole[0] == "." else own(base))
    return found


def own(parts: list[str]) -> str:
    """Return a dotted name, of the package's own modules with a leading dot instead of the package."""
    return "." + ".".join(parts[1:]) if parts[0] == "nested_dielectric" else ".".join(parts)


IMPORTS = {name: imported(name) for name in MODULES}


def room(name: str) -> str:
    """Return the room of a module, '' for what stands above all rooms."""
    first = name.split(".")[0]
    return first if first in ROOMS else ""


def floor_of_ui(name: str) -> int:
    """Return the floor within `ui` on which a module stands."""
    return UI.index("".join(name.split(".")[1:-1]))


def own_imports(name: str) -> list[str]:
    """Return the modules of the package that one imports."""
    return [each[1:] for each in IMPORTS[name] if each.startswith(".") and each[1:] in MODULES]


def test_every_module_stands_in_a_room():
    rooms = {path.name for path in PACKAGE.iterdir() if path.is_dir() and any(path.glob("*.py"))}
    assert rooms == set(ROOMS) - {""}


def test_imports_point_down():
    upwards = [
        f"{name} imports {other}"
        for name in MODULES
        for other in own_imports(name)
        if ROOMS.index(room(other)) > ROOMS.index(room(name))
    ]
    assert upwards == []


def test_within_the_user_interface_imports_point_down():
    inside = [name for name, path in MODULES.items() if room(name) == "ui" and path.name != "__init__.py"]
    upwards = [
        f"{name} imports {other}"
        for name in inside
        for other in own_imports(name)
        if other in inside and floor_of_ui(other) > floor_of_ui(name)
    ]
    assert upwards == []


@pytest.mark.parametrize("pure", FORBIDDEN)
def test_pure_rooms_import_nothing_of_blenders(pure):
    wrong = [
        f"{name} imports {other}"
        for name in MODULES
        if room(name) == pure
        for other in IMPORTS[name]
        if other.split(".")[0] in FORBIDDEN[pure]
    ]
    assert wrong == []


def test_no_modules_import_each_other():
    left = {name: set(own_imports(name)) - {name} for name in MODULES}
    while ready := [name for name, needs in left.items() if not needs & left.keys()]:
        for name in ready:
            del left[name]
    assert left == {}, "a circle of imports"


def test_the_init_of_a_room_is_a_docstring_alone():
    more = []
    for name, path in MODULES.items():
        if path.name == "__init__.py" and name:
            (first, *rest) = ast.parse(path.read_text(encoding="utf-8")).body
            if rest or not isinstance(first, ast.Expr) or not isinstance(first.value, ast.Constant):
                more.append(name)
    assert more == []


def test_nothing_imports_a_test():
    imports = [
        f"{path.name} imports {line}"
        for folder in ("tests", "benchmarks", "docs", "presets")
        for path in (ROOT / folder).rglob("*.py")
        for line in re.findall(r"^\s*(?:from|import) (test_\w+)", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert imports == []


def files(folder: str) -> list[Path]:
    """Return the sources of a folder of the project."""
    return [path for path in (ROOT / folder).rglob("*") if path.suffix in (".py", ".osl", ".h")]


def functions(path: Path) -> list[tuple[str, int]]:
    """Return all functions of a source with their lengths in lines; of shaders alone, in statements."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        found = [
            node for node in ast.walk(ast.parse(text)) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        ]
        return [(node.name, node.end_lineno - node.lineno + 1) for node in found]
    return osl_functions(text)


def osl_functions(text: str) -> list[tuple[str, int]]:
    """Return the functions of OSL source with their lengths in lines, those of shaders in statements."""
    text = re.sub(r"/\*.*?\*/", lambda found: "\n" * found[0].count("\n"), text, flags=re.DOTALL)
    text = re.sub(r'//.*|"(\\.|[^"\\\n])*"', '""', text)
    found = []
    for opening in re.finditer(r"^(?!struct\b)(\w+)\s+(\w+)\s*\(", text, re.MULTILINE):
        body = text.index("{", balanced(text, opening.end() - 1, "()"))
        end = balanced(text, body, "{}")
        is_shader = opening[1] in ("shader", "surface", "volume", "displacement")
        length = text.count(";", body, end) if is_shader else text.count("\n", opening.start(), end) + 1
        found.append((opening[2], length))
    return found


def balanced(text: str, start: int, pair: str) -> int:
    """Return where the bracket that opens at `start` is closed again."""
    depth = 0
    for place in range(start, len(text)):
        depth += (text[place] == pair[0]) - (text[place] == pair[1])
        if depth == 0:
            return place
    raise AssertionError(f"{pair[0]} is never closed")


def test_functions_of_osl_are_measured_as_they_stand():
    source = """/* not a function (
*/
struct Pair { int a; };
float half_of(float x)  // (
{
    if (x > 0.0) { return 0.5 * x; }
    return 0.0;
}
shader thing(
    float a = 0.0,
    output float b = 0.0)
{
    b = half_of(a);
}
"""
    assert osl_functions(source) == [("half_of", 5), ("thing", 1)]


FOLDERS = ("addon", "osl", "tests", "benchmarks")


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_file_is_too_long(folder):
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files(folder)}
    assert {str(path.relative_to(ROOT)): length for path, length in lengths.items() if length > LONGEST_FILE} == {}


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_function_is_too_long(folder):
    lengths = {
        (str(path.relative_to(ROOT)), name): length for path in files(folder) for name, length in functions(path)
    }
    assert {key: length for key, length in lengths.items() if length > LONGEST_FUNCTION} == {}


REFERENCE = re.compile(r":(?:mod|class|func|data|meth|attr):`~?nested_dielectric\.([\w.]+)`")


def defined(name: str) -> set[str]:
    """Return what the top of a module of the package defines or imports."""
    body = ast.parse(MODULES[name].read_text(encoding="utf-8")).body
    found = {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    found |= {each.asname or each.name for node in body if isinstance(node, ast.ImportFrom) for each in node.names}
    for node in body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        found |= {each.id for each in targets if isinstance(each, ast.Name)}
    return found


def test_what_docstrings_refer_to_is_there():
    lost = []
    for path in files("addon") + files("tests") + files("docs"):
        for reference in REFERENCE.findall(path.read_text(encoding="utf-8")):
            module, _, name = reference.rpartition(".")
            if reference not in MODULES and not (module in MODULES and name in defined(module)):
                lost.append(f"{path.name}: {reference}")
    assert lost == []
