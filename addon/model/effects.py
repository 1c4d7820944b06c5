"""Which parameters show in the picture beside the values of others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .parameter import Limit, Parameter
from .parameters import BY_KEYWORD, SOCKETS


def has_effect(parameter: Parameter, values: Mapping[str, Any]) -> bool:
    """Return whether a parameter can show in the picture beside the values of others, by keyword.

    Parameters that are not among them may have any value.
    """
    return not parameter.needs or any(_is_at_work(need, values) for need in parameter.needs)


def limits_at_work(values: Mapping[str, Any], version: tuple[int, int, int]) -> dict[Limit, Parameter]:
    """Return the parameters for which a medium needs the shader in a version of Blender: of each limit the first.

    `values` are those of parameters by keyword, as :func:`has_effect` takes them.
    """
    found: dict[Limit, Parameter] = {}
    for parameter in SOCKETS:
        limit = parameter.limit
        if limit is None or not limit.decides or limit in found or (limit.before and version >= limit.before):
            continue
        neutral = parameter.default if limit.neutral is None else limit.neutral
        if parameter.keyword in values and values[parameter.keyword] == neutral:
            continue
        if has_effect(parameter, values) and (
            not limit.needs or any(_is_at_work(need, values) for need in limit.needs)
        ):
            found[limit] = parameter
    return found


def _is_at_work(keyword: str, values: Mapping[str, Any]) -> bool:
    """Return whether what a parameter needs may be at work: neither 0, nor off, nor white, nor without effect itself."""
    parameter = BY_KEYWORD.get(keyword)
    if keyword in values:
        value = values[keyword]
        if parameter is not None and parameter.kind == "COLOR":
            value = tuple(value)[:3] != parameter.default
        if not value:
            return False
    return parameter is None or has_effect(parameter, values)
