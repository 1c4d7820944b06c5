"""One word of an enumeration, for parameters and the tables they choose from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Choice:
    """One word of an enumeration: its keyword, its name in menus and what it means."""

    keyword: str
    name: str
    description: str


def keyword_of(value: Any) -> Any:
    """Return the keyword of a choice, and any other value as it is."""
    return value.keyword if isinstance(value, Choice) else value
