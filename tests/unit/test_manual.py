"""The manual: its links lead somewhere, and what comes from the code is as the code is."""

import re
from pathlib import Path

from manual import PAGES, PICTURES, ROOT, links

HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)


def headings(page: Path) -> set[str]:
    """The headings of a page, as links name them."""
    words = HEADING.findall(page.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in words}


def test_every_link_and_picture_of_the_manual_is_there():
    missing = {file for page in PAGES for file, _ in links(page) if not file.exists()}
    assert missing == set()
    named = [(file, heading) for page in PAGES for file, heading in links(page) if heading and file.suffix == ".md"]
    assert [(file.name, heading) for file, heading in named if heading not in headings(file)] == []


def test_every_page_can_be_reached_from_the_front_page():
    reached, new = set(), {ROOT / "README.md"}
    while new:
        reached |= new
        new = {file for page in new for file, _ in links(page) if file.suffix == ".md"} - reached
    assert set(PAGES) - reached == set()


def test_the_front_page_is_short_and_the_pictures_are_light():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 90
    assert sum(path.stat().st_size for path in PICTURES.iterdir()) < 3_000_000


def test_the_manual_gives_every_parameter_of_jf_a_home():
    from nested_dielectric.importers import jf_parameters

    manual = (ROOT / "docs" / "coming-from.md").read_text(encoding="utf-8")
    assert [name for name in jf_parameters.JF_PARAMETERS if f"`{name}`" not in manual] == []


def test_every_place_that_contributors_are_sent_to_is_there_and_the_words_are_few():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    places = re.findall(r"`((?:addon|osl|presets|tests|benchmarks|docs)/[^`]*)`", text)
    assert len(places) > 60
    assert [place for place in places if not list(ROOT.glob(place.rstrip("/")))] == []
    words = text.split("## Words\n", 1)[1].split("\n\n", 2)[1]
    assert len(words.splitlines()) <= 20
