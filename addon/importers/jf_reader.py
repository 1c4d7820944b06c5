"""Reading nodes of JF Nested Dielectric from Arnold's scene files (.ass) or from JSON, without Blender."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .jf_parameters import NODE_TYPE, JfError


@dataclass(frozen=True)
class JfNode:
    """A node as its file has it.

    :param parameters: numbers, booleans, strings (words and names of linked nodes) and tuples of these.
    :param repeated: names of those that stand there more than once, of which the last counts.
    """

    name: str
    parameters: dict[str, Any]
    repeated: tuple[str, ...] = ()


def read_nodes(path: Path) -> list[JfNode]:
    """Return the JF nodes of a .ass or .json file.

    :raises JfError: for another ending, text that is not of the format, or a file without such nodes.
    :raises OSError: if the file cannot be read.
    """
    ending = path.suffix.lower()
    if ending not in (".ass", ".json"):
        raise JfError(f"{path}: the ending must be .ass or .json")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise JfError(f"{path}: this is no text; unpack it if it is compressed") from None
    try:
        nodes = parse_ass(text) if ending == ".ass" else parse_json(text, path.stem)
    except JfError as error:
        raise JfError(f"{path}: {error}") from None
    if not nodes:
        raise JfError(f"{path}: no {NODE_TYPE} node in it; export the materials together with the scene")
    return nodes


# A string, a comment, a brace, a word, a quote that is never closed. In nodes of other types words need not be told apart.
_TOKEN, _FOREIGN_TOKEN = (
    re.compile(rf'"((?:[^"\\]|\\.)*)"|((?<![^\s{{}}"])#[^\n]*)|([{{}}])|({word})|(")', re.DOTALL)
    for word in (r'[^\s{}"]+', r'[^"{}#]+|#')
)

_ARRAY_SIZES = {
    **dict.fromkeys(("BYTE", "INT", "UINT", "BOOL", "FLOAT", "STRING", "NODE", "POINTER", "ENUM"), 1),
    **dict.fromkeys(("POINT2", "VECTOR2"), 2),
    **dict.fromkeys(("RGB", "VECTOR", "POINT"), 3),
    "RGBA": 4,
    "MATRIX": 16,
}
"""Numbers of values of an array's element, by its type."""

_NUMBER = re.compile(r"[-+]?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|nan|inf(inity)?)", re.IGNORECASE)
SWITCHES = {"on": True, "true": True, "off": False, "false": False}
"""Words for booleans."""


def parse_ass(text: str) -> list[JfNode]:
    """Return the JF nodes of the text of an Arnold scene file.

    A node need not stand on lines of its own. A value is one word, or numbers, or an array; so no parameter may be
    called by a number. Raises :class:`JfError` for a node that is not closed and for a parameter without a value.
    """
    nodes = []
    before, opened, values = "", "", None
    at = 0
    while match := (_FOREIGN_TOKEN if opened and values is None else _TOKEN).search(text, at):
        at = match.end()
        quoted, comment, brace, bare, stray = match.groups()
        if comment is not None:
            continue
        if stray or brace == ("{" if opened else "}"):
            line = text.count("\n", 0, match.start()) + 1
            raise JfError(f"line {line}: {match.group()} is out of place; {_whole(opened)}")
        if brace == "{":
            opened = before or "?"
            values = [] if _is_jf(opened) else None
        elif brace == "}":
            if values is not None:
                nodes.append(_ass_node(opened, values))
            opened, values = "", None
        elif values is not None:
            is_name = bool(values) and values[-1] == "name"
            values.append(re.sub(r"\\(.)", r"\1", quoted) if bare is None else bare if is_name else _bare_value(bare))
        before = bare or ""
    if opened:
        raise JfError(f"the last node has no closing brace; {_whole(opened)}")
    return nodes


def _whole(node_type: str) -> str:
    """Ask whether a file is whole, naming the node that is not."""
    return f"in {node_type}: is the file whole?" if node_type else "is the file whole?"


def _is_jf(node_type: str) -> bool:
    """Return whether a node is a JF Nested Dielectric; case and underscores do not matter."""
    return node_type.replace("_", "").lower() == NODE_TYPE.replace("_", "")


def _bare_value(word: str) -> Any:
    """Return the boolean or the number that a word without quotes stands for, or the word itself."""
    if word.lower() in SWITCHES:
        return SWITCHES[word.lower()]
    if not _NUMBER.fullmatch(word):
        return word
    try:
        return int(word)
    except ValueError:
        return float(word)


def is_number(value: Any) -> bool:
    """Return whether a value is a number; booleans are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _ass_node(node_type: str, values: list[Any]) -> JfNode:
    """Return a node from what stands between its braces.

    :raises JfError: for a value that follows no name, and for a parameter without a value.
    """
    pairs = []
    at = 0
    while at < len(values):
        parameter = values[at]
        if not isinstance(parameter, str):
            after = f" after {pairs[-1][0]!r}" if pairs else ""
            raise JfError(f"{_name(pairs, node_type)}: {parameter!r}{after} is no name of a parameter; remove it")
        end = _value_end(values, at + 1)
        if end == at + 1 or end > len(values):
            raise JfError(f"{_name(pairs, node_type)}: {parameter}: its value is missing; write it or remove the name")
        if parameter != "declare":  # the value follows, under its own name
            pairs.append((parameter, _value(values[at + 1 : end])))
        at = end
    return _node(pairs, node_type)


def _value_end(values: list[Any], at: int) -> int:
    """Return where the value that begins at ``at`` ends; beyond the end of ``values`` if part of it is missing."""
    if values[at - 1] == "declare":  # declare NAME constant [ARRAY] TYPE
        return at + (4 if values[at + 2 : at + 3] == ["ARRAY"] else 3)
    head = values[at : at + 3]
    if len(head) == 3 and all(type(count) is int and count >= 0 for count in head[:2]) and isinstance(head[2], str):
        if head[2] in _ARRAY_SIZES:
            return at + 3 + head[0] * head[1] * _ARRAY_SIZES[head[2]]
        if head[2].startswith("b85"):  # packed
            return at + 4
    end = min(at + 1, len(values))
    while end > at and is_number(values[end - 1]) and end < len(values) and is_number(values[end]):
        end += 1
    return end


def _value(values: list[Any]) -> Any:
    """Return one value as it is, several as a tuple; an array of one element without its sizes and type."""
    if len(values) > 3 and isinstance(values[2], str) and values[:2] == [1, 1]:
        values = values[3:]  # an array of one
    return values[0] if len(values) == 1 else tuple(values)


def _name(pairs: Iterable[tuple[str, Any]], otherwise: str) -> str:
    """Return the name among a node's parameters, or another where it has none."""
    return str(dict(pairs).get("name") or otherwise)


def _node(pairs: list[tuple[str, Any]], otherwise: str) -> JfNode:
    """Return a node with some parameters, and a name where they give none."""
    parameters = dict(pairs)
    names = [name for name, _ in pairs]
    repeated = tuple(name for name in parameters if names.count(name) > 1)
    parameters.pop("name", None)
    return JfNode(_name(pairs, otherwise), parameters, repeated)


class _Pairs(list):
    """The names and values of an object of a JSON file, with all that it repeats."""


def parse_json(text: str, name: str) -> list[JfNode]:
    """Return the nodes of a JSON text: an object of parameters, a list of such objects, or an object that names them.

    :param name: name of a node that has none of its own.
    :raises JfError: for anything else.
    """
    try:
        data = json.loads(text, object_pairs_hook=_Pairs)
    except (ValueError, RecursionError) as error:
        raise JfError(f"this is no JSON ({error})") from None
    nested = [isinstance(value, _Pairs) for _, value in data] if isinstance(data, _Pairs) else []
    if any(nested):
        if not all(nested):
            raise JfError(f"{data[nested.index(False)][0]!r} stands among materials; move it into one of them")
        named = data
    else:
        items = [data] if isinstance(data, _Pairs) else data
        if not isinstance(items, list) or not all(isinstance(item, _Pairs) for item in items):
            raise JfError("an object of parameters, a list of such objects or an object that names them is needed")
        named = [(name, item) for item in items if item]
    return [_node([(key, _json_value(value)) for key, value in pairs], name) for name, pairs in named]


def _json_value(value: Any) -> Any:
    """Return a value of a JSON file with tuples for lists."""
    return tuple(value) if isinstance(value, list) else value
