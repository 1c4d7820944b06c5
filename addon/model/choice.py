"""One word of an enumeration, for parameters and the tables they choose from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Choice:
    """One word of an enumeration: its keyword, its name in menus and what it means."""

    keyword: str
    name: str
    description: str
