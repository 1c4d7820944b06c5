"""Enumerations as Blender wants its menus."""

from __future__ import annotations

from ..model.choice import Choice


def choice_items(choices: tuple[Choice, ...]) -> tuple[tuple[str, str, str], ...]:
    """Return the words of an enumeration as Blender wants its menus."""
    return tuple((choice.keyword, choice.name, choice.description) for choice in choices)
