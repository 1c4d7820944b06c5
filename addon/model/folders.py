"""Where the extension's files are, and what Blender calls it."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""The folder that holds the manifest, ``osl/`` and ``presets/``."""

PACKAGE = __package__.removesuffix(".model").removesuffix(".addon")
"""Name of the extension among Blender's."""
