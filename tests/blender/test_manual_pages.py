"""The manual's pages and pictures that come from the code are as the code is."""

import sys
from pathlib import Path

import pytest
from manual import PAGES, PICTURES, ROOT, links

TAKEN = {PICTURES / "panel.png"}
"""Pictures that are taken in a window, by hand."""


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


def test_the_pages_of_parameters_and_presets_are_as_the_code_is(build):
    import pages

    old = [name for name, page in pages.PAGES.items() if (build.parent / name).read_text(encoding="utf-8") != page()]
    assert old == [], "run make docs"


def test_every_picture_of_the_manual_has_a_script_and_a_place(build):
    import pictures

    made = {PICTURES / f"{name}.jpg" for name in (*pictures.everything(), pictures.SHEET)}
    shown = {file for page in PAGES for file, _ in links(page) if PICTURES in file.parents}
    assert shown - made == TAKEN and made - shown == set()
