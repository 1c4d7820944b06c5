"""The manual: its pages, and where their links lead."""

import re
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "pictures"
PAGES = tuple(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "examples/README.md")) + tuple(
    sorted((ROOT / "docs").glob("*.md"))
)

LINK = re.compile(r"\[[^]]*\]\(([^)\s]+)\)")


def links(page: Path) -> list[tuple[Path, str]]:
    """The files that a page links to or shows, each with the heading that is meant there."""
    found = []
    for address in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" not in address:
            file, _, heading = unquote(address).partition("#")
            found.append(((page.parent / file).resolve() if file else page, heading))
    return found
