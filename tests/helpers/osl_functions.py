"""Functions of the shader's headers: those that return the same for the same inputs, and how each is measured."""

from __future__ import annotations

import re

import osl_dispersion
import osl_interfaces
import osl_lights
import osl_lobes
import osl_media
import osl_paths
import osl_surroundings

from nested_dielectric.model.shader_source import OSL_FOLDER, without_comments

FUNCTIONS = (
    *osl_interfaces.FUNCTIONS,
    *osl_dispersion.FUNCTIONS,
    *osl_paths.FUNCTIONS,
    *osl_lobes.FUNCTIONS,
    *osl_lights.FUNCTIONS,
    *osl_media.FUNCTIONS,
    *osl_surroundings.FUNCTIONS,
)
"""All that are measured."""

_DEFINITION = re.compile(r"^(?:closure )?\w+ (\w+)\([^{}]*?\)\n\{\n.*?^\}", re.DOTALL | re.MULTILINE)

_ASKS = re.compile(
    r"\bclosure\b|\b(trace|getmessage|getattribute|raytype|hashnoise|isconnected|transform|backfacing)\(|\b(time|u)\b"
)
"""What hangs on the scene, the path or the renderer."""


def pure_functions() -> dict[str, str]:
    """Return the headers of all functions that hang on nothing but their inputs, I, N and P, by their names."""
    headers: dict[str, str] = {}
    sources: dict[str, str] = {}
    for path in sorted(OSL_FOLDER.glob("*.h")):
        for match in _DEFINITION.finditer(without_comments(path.read_text(encoding="utf-8"))):
            headers[match[1]] = path.name
            sources[match[1]] = sources.get(match[1], "") + match[0]
    impure = {name for name, source in sources.items() if _ASKS.search(source)}
    while more := {
        name
        for name, source in sources.items()
        if name not in impure and any(re.search(rf"\b{other}\(", source) for other in impure)
    }:
        impure |= more
    return {name: header for name, header in headers.items() if name not in impure}


def measured_names() -> set[str]:
    """Return the names of all functions that are measured, by themselves or within another."""
    return {name for function in FUNCTIONS for name in (function.name, *function.covers)}
