"""What functions of the shader's headers return for thousands of inputs at once, one a pixel, to the last bit.

Each input is an attribute of the faces of a plane that has one face a pixel, so nothing interpolates or converts it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

import bpy
import numpy as np
from scenes import add, add_camera, new_scene, render
from shading import source_of

from nested_dielectric.nodes.osl import add_script, make_script

NO_NUMBER = -1.2345e36
"""What is shown of a result that is not finite: Cycles leaves such light out, and all whose three channels sum up to that."""

LEAST_SIDE = 4
"""Blender renders no smaller pictures."""

GLOBALS = {"I": "vector", "N": "normal", "P": "point"}
"""Of OSL, that headers read: an input of that name takes its place."""

BACKFACING = """int asked_backfacing() { vector x = vector(0.0); getattribute("given_back", x); return (int)x[0]; }
#define backfacing() asked_backfacing()"""
"""Lines of OSL before a header that take the side from an input ``back``."""

VECTOR = ("FLOAT_VECTOR", "vector", "VECTOR", "Vector")
"""Of inputs of up to three components: attribute and its field, kind of socket, output of an Attribute node. An attribute of
one number would lose its last bit: Cycles takes the mean of three."""

FOUR = ("FLOAT_COLOR", "color", "RGBA", "Color")
"""Of inputs of four components, which headers read by name."""

SHADER = """
%(globals)s
float component(vector x, int i)
{
  return x[i];
}
%(includes)s
%(functions)s
float shown(float x)
{
  return isfinite(x) ? x : %(no_number)r;
}
shader test(%(parameters)s, output color Result = color(0.0))
{
%(locals)s
  float r[%(size)d];
  for (int i = 0; i < %(size)d; i++)
    r[i] = 0.0;
%(statements)s
  int shown_from = 3 * (int)given_part[0];
  Result = color(shown(r[shown_from]), shown(r[shown_from + 1]), shown(r[shown_from + 2]));
}
"""


def evaluate(
    headers: Sequence[str], statements: str, inputs: Mapping[str, np.ndarray], count: int, functions: str = ""
) -> np.ndarray:
    """Return what statements of OSL leave in the first ``count`` of ``r[0]``, ``r[1]`` and on, (n, count) float64.

    :param headers: names of files in ``osl/``, or lines of OSL between them.
    :param inputs: (n,) or (n, 3) numbers by the name that the statements read them by, rounded to single precision;
        of the name of one of :data:`GLOBALS` what the headers read as that; (n, 4) what headers read as an attribute of
        that name.
    :param functions: more functions of OSL that the statements call.
    """
    parts = math.ceil(count / 3)
    inputs = {name: np.asarray(values, dtype=np.float32) for name, values in inputs.items()}
    number = len(next(iter(inputs.values())))
    tiled = {name: np.tile(values, (parts,) + (1,) * (values.ndim - 1)) for name, values in inputs.items()}
    tiled["part"] = np.repeat(np.arange(parts, dtype=np.float32), number)
    text = SHADER % {
        "globals": "\n".join(_global(name) for name in GLOBALS if name in inputs),
        "includes": "".join(f'#include "{line}"\n' if line.endswith(".h") else f"{line}\n" for line in headers),
        "functions": functions,
        "no_number": NO_NUMBER,
        "parameters": ", ".join(f"{'color' if _is_four(v) else 'vector'} given_{k} = 0.0" for k, v in tiled.items()),
        "locals": "\n".join(_local(k, v) for k, v in inputs.items() if k not in GLOBALS and not _is_four(v)),
        "size": 3 * parts,
        "statements": statements,
    }
    picture = _picture(text, tiled)
    return picture.reshape(parts, number, 3).transpose(1, 0, 2).reshape(number, -1)[:, :count]


def _is_four(values: np.ndarray) -> bool:
    return values.ndim == 2 and values.shape[1] == 4


def _local(name: str, values: np.ndarray) -> str:
    """Declare an input as what the statements read."""
    return f"  float {name} = given_{name}[0];" if values.ndim == 1 else f"  vector {name} = given_{name};"


def _global(name: str) -> str:
    """Put an attribute in the place of a global variable."""
    kind = GLOBALS[name]
    return (
        f'{kind} global_{name}() {{ {kind} x = {kind}(0.0); getattribute("given_{name}", x); return x; }}\n'
        f"#define {name} global_{name}()"
    )


def _picture(text: str, inputs: Mapping[str, np.ndarray]) -> np.ndarray:
    """Render a shader with other inputs at each pixel, (n, 3)."""
    number = len(inputs["part"])
    width = max(math.ceil(math.sqrt(number)), LEAST_SIDE)
    height = max(math.ceil(number / width), LEAST_SIDE)
    scene = new_scene()
    scene.render.resolution_x, scene.render.resolution_y = width, height
    mesh = _faces(width, height)
    material = bpy.data.materials.new("Shader")
    mesh.materials.append(material)
    tree = material.node_tree
    tree.nodes.clear()
    sockets = {f"given_{name}": (FOUR if _is_four(values) else VECTOR)[2] for name, values in inputs.items()}
    # What a function returns has no components in OSL.
    source = re.sub(rf"\b({'|'.join(GLOBALS)})\[(\w+)\]", r"component(\1, \2)", source_of(text))
    script = make_script("test.osl", source)
    node = add_script(tree, "Shader", script, sockets, {"Result": "RGBA"})
    for name, values in inputs.items():
        attribute_kind, field, _, output = FOUR if _is_four(values) else VECTOR
        padded = np.zeros((width * height, 4 if _is_four(values) else 3), dtype=np.float32)
        padded[:number, : values.shape[1] if values.ndim == 2 else 1] = values.reshape(number, -1)
        # Headers read four components by the name, others by the shader's parameter.
        attribute = mesh.attributes.new(name if _is_four(values) else f"given_{name}", attribute_kind, "FACE")
        attribute.data.foreach_set(field, padded.ravel())
        reads = tree.nodes.new("ShaderNodeAttribute")
        reads.attribute_name = attribute.name
        tree.links.new(reads.outputs[output], node.inputs[f"given_{name}"])
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["Result"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    add("Plane", mesh)
    middle = (0.5 * width, 0.5 * height)
    add_camera((*middle, 1.0), (*middle, 0.0), width=max(width, height))
    return render(1)[::-1].reshape(-1, 3)[:number]


def _faces(width: int, height: int) -> bpy.types.Mesh:
    """Make a mesh of unit squares, those of the lowest row first."""
    x, y = np.meshgrid(np.arange(width + 1), np.arange(height + 1))
    points = np.stack([x, y, np.zeros_like(x)], axis=2).reshape(-1, 3)
    first = (np.arange(width) + (width + 1) * np.arange(height)[:, None]).ravel()
    corners = np.stack([first, first + 1, first + width + 2, first + width + 1], axis=1)
    mesh = bpy.data.meshes.new("Faces")
    mesh.from_pydata(points.tolist(), [], corners.tolist())
    return mesh
