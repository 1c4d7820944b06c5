"""Compiled shaders in Open Shading Language, as Script nodes hold them."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import bpy

from .compatibility import UnsupportedError
from .shader_nodes import SOCKET_TYPES

SHADER_FILE = "nested_dielectric.osl"

COORDINATE_FILE = "spectral_coordinate.osl"

LIGHT_FILE = "light.osl"

MASK_FILE = "volume_mask.osl"


@dataclass(frozen=True)
class Script:
    """A shader's file name, source and bytecode."""

    name: str
    source: str
    bytecode: str

    def text(self) -> bpy.types.Text:
        """Return the source as a text of this file, made on first use."""
        for text in bpy.data.texts:
            if text.name.startswith(self.name) and text.as_string() == self.source:
                return text
        text = bpy.data.texts.new(self.name)
        text.from_string(self.source)
        return text


def make_script(name: str, source: str) -> Script:
    """Compile a shader. Raise as :func:`compiled` does."""
    return Script(name, source, compiled(source))


def compiled(source: str) -> str:
    """Return the bytecode of an OSL shader.

    Raise :class:`~nested_dielectric.nodes.compatibility.UnsupportedError` when this Blender compiles no OSL, or the folder of
    temporary files takes none.
    """
    import _cycles

    if not _cycles.with_osl:
        raise UnsupportedError("this Blender compiles no OSL; use the build from blender.org or the bpy wheel")
    try:
        with tempfile.TemporaryDirectory() as folder:
            source_path, bytecode_path = Path(folder, "shader.osl"), Path(folder, "shader.oso")
            source_path.write_text(source, encoding="utf-8")
            if _cycles.osl_compile(str(source_path), str(bytecode_path)):
                return bytecode_path.read_text(encoding="utf-8")
            reason = f"nothing came of it in {folder}; is the disk full?"
    except OSError as error:
        reason = f"{error.strerror}; make room in {error.filename or 'the folder of temporary files'}"
    raise UnsupportedError(f"the shader was not compiled: {reason}")


def add_script(
    tree: bpy.types.NodeTree, name: str, script: Script, inputs: dict[str, str], outputs: dict[str, str]
) -> bpy.types.ShaderNodeScript:
    """Add a Script node with its sockets, and with the compiled shader in it, where it stays with the file.

    Cycles adds both by itself when the scene's engine is Cycles and its own helper modules can be imported; under the
    wheel or another engine it does neither.
    """
    node = tree.nodes.new("ShaderNodeScript")
    node.name = node.label = name
    with _temporary_files_removed():
        node.mode = "INTERNAL"
        node.script = script.text()
    set_bytecode(node, script.bytecode)
    for sockets, kinds in ((node.inputs, inputs), (node.outputs, outputs)):
        for socket, kind in kinds.items():
            _ensure_socket(sockets, kind, socket)
    return node


@contextmanager
def _temporary_files_removed() -> Iterator[None]:
    """Remove what Python makes as temporary files: Cycles compiles a script that it is given, and leaves the result there."""
    with ExitStack() as undo:
        usual = tempfile.tempdir
        with suppress(OSError):
            tempfile.tempdir = undo.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        undo.callback(setattr, tempfile, "tempdir", usual)
        yield


def set_bytecode(node: bpy.types.ShaderNodeScript, bytecode: str) -> None:
    """Put bytecode into a node with the hash that Cycles knows it by; none where it is empty, which Cycles shows magenta."""
    node.bytecode = bytecode
    node.bytecode_hash = hashlib.md5(bytecode.encode(), usedforsecurity=False).hexdigest() if bytecode else ""


def _ensure_socket(sockets: bpy.types.NodeInputs, kind: str, name: str) -> None:
    """Add a socket of a kind, unless there is one of that name."""
    if name not in sockets:
        sockets.new(type=SOCKET_TYPES[kind], name=name, identifier=name)
