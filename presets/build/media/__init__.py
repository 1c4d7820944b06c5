"""The media, by group: tables of published numbers with their sources."""

from __future__ import annotations

from ..recipe import Recipe
from . import drinks, films, gems, glass, laboratory, liquids, plastics, water

MEDIA: tuple[Recipe, ...] = (
    *glass.MEDIA,
    *water.MEDIA,
    *drinks.MEDIA,
    *liquids.MEDIA,
    *gems.MEDIA,
    *plastics.MEDIA,
    *films.MEDIA,
    *laboratory.MEDIA,
)
