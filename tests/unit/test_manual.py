"""The manual: its links lead somewhere, and what comes from the code is as the code is."""

import re
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "pictures"
PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md")))

TAKEN = {PICTURES / "panel.png"}
"""Pictures that are taken in a window, by hand."""

LINK = re.compile(r"\[[^]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)


def links(page: Path) -> list[tuple[Path, str]]:
    """The files that a page links to or shows, each with the heading that is meant there."""
    found = []
    for address in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" not in address:
            file, _, heading = unquote(address).partition("#")
            found.append(((page.parent / file).resolve() if file else page, heading))
    return found


def headings(page: Path) -> set[str]:
    """The headings of a page, as links name them."""
    words = HEADING.findall(page.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in words}


@pytest.mark.pure
@pytest.mark.quick
def test_every_link_and_picture_of_the_manual_is_there():
    missing = {file for page in PAGES for file, _ in links(page) if not file.exists()}
    assert missing == set()
    named = [(file, heading) for page in PAGES for file, heading in links(page) if heading and file.suffix == ".md"]
    assert [(file.name, heading) for file, heading in named if heading not in headings(file)] == []


@pytest.mark.pure
@pytest.mark.quick
def test_every_page_can_be_reached_from_the_front_page():
    reached, new = set(), {ROOT / "README.md"}
    while new:
        reached |= new
        new = {file for page in new for file, _ in links(page) if file.suffix == ".md"} - reached
    assert set(PAGES) - reached == set()


@pytest.mark.pure
@pytest.mark.quick
def test_the_front_page_is_short_and_the_pictures_are_light():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 90
    assert sum(path.stat().st_size for path in PICTURES.iterdir()) < 3_000_000


@pytest.fixture
def build(monkeypatch):
    """The folder of what ``make docs`` runs, among those that modules come from."""
    import bpy  # noqa: F401  before bmesh and mathutils, which live inside it

    known = set(sys.modules)
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "build"))
    yield ROOT / "docs" / "build"
    for name in set(sys.modules) - known:
        file = getattr(sys.modules[name], "__file__", None)
        if file and ROOT / "docs" / "build" in Path(file).parents:
            del sys.modules[name]


@pytest.mark.quick
def test_the_pages_of_parameters_and_presets_are_as_the_code_is(build):
    import pages

    old = [name for name, page in pages.PAGES.items() if (build.parent / name).read_text(encoding="utf-8") != page()]
    assert old == [], "run make docs"


@pytest.mark.quick
def test_every_picture_of_the_manual_has_a_script_and_a_place(build):
    import pictures

    made = {PICTURES / f"{name}.jpg" for name in (*pictures.everything(), pictures.SHEET)}
    shown = {file for page in PAGES for file, _ in links(page) if PICTURES in file.parents}
    assert shown - made == TAKEN and made - shown == set()


@pytest.mark.quick
def test_the_manual_gives_every_parameter_of_jf_a_home():
    from nested_dielectric.importers import jf

    manual = (ROOT / "docs" / "coming-from.md").read_text(encoding="utf-8")
    assert [name for name in jf.JF_PARAMETERS if f"`{name}`" not in manual] == []
