"""Every fact that the design leans on names tests, and those exist."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
NAMED = re.compile(r"`(test_\w+)`")


def facts() -> list[str]:
    """The items of all lists of the page."""
    text = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    return re.findall(r"^- (.+(?:\n  .+)*)", text, re.MULTILINE)


def known_tests() -> set[str]:
    """The names of all tests."""
    return {
        node.name
        for file in (ROOT / "tests").rglob("test_*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


def test_every_fact_names_tests_that_exist():
    known = known_tests()
    assert len(facts()) > 50
    unnamed = [fact for fact in facts() if not NAMED.search(fact)]
    assert not unnamed
    gone = {name for fact in facts() for name in NAMED.findall(fact) if name not in known}
    assert not gone
