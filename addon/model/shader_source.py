"""The OSL source as one text, so that a .blend can carry it without the files beside it."""

from __future__ import annotations

import re
from pathlib import Path

from .folders import ROOT
from .osl_contract import osl_contract

OSL_FOLDER = ROOT / "osl"

_CONTRACT_FILE = "contract.h"
"""A header that is made of what Python knows."""

_INCLUDE = re.compile(r'^#include "(.+)"\n', re.MULTILINE)


def inlined_source(name: str, folder: Path = OSL_FOLDER) -> str:
    """Return shader ``name`` with every header it includes in place, each once.

    Raises :class:`FileNotFoundError` with the path of what is missing.
    """
    seen: set[str] = set()

    def inline(filename: str) -> str:
        if filename in seen:
            return ""
        seen.add(filename)
        if filename == _CONTRACT_FILE:
            return osl_contract()
        text = (folder / filename).read_text(encoding="utf-8").replace("#pragma once\n", "")
        return _INCLUDE.sub(lambda match: inline(match.group(1)), text)

    return inline(name)


def without_comments(source: str) -> str:
    """Return OSL source without its comments and blank lines, which no picture depends on."""
    code = re.sub(r"/\*.*?\*/|//[^\n]*", "", source, flags=re.DOTALL)
    return "\n".join(line.rstrip() for line in code.splitlines() if line.strip())
