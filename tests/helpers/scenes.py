"""Small scenes with a known answer, and the renders of them as arrays."""

from __future__ import annotations

import atexit
import functools
import math
import os
import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import bpy  # before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix, Vector

import nested_dielectric as nd
from nested_dielectric.model.parameter import GROUP_NAME
from nested_dielectric.nodes.group import ensure_group

bpy.utils.expose_bundled_modules()
import OpenImageIO as oiio  # noqa: E402

BOUNCES = 256


def mostly_again(values, first: int = 1) -> list:
    """Parameters of which all but the first few repeat a claim on other input: the long-term release leaves them out."""
    values = list(values)
    return values[:first] + [pytest.param(value, marks=pytest.mark.again) for value in values[first:]]


def rarely(values, always=()) -> list:
    """Parameters of which runs take a few alone, and the long-term release the first of these: `make stress` takes them all."""
    marks = {value: [pytest.mark.always] + [pytest.mark.again] * (place > 0) for place, value in enumerate(always)}
    return [pytest.param(value, marks=marks.get(value, [])) for value in values]


@functools.cache
def group_file() -> str:
    """Write the node group into a file, as it takes longer to make than most scenes do to render; return its path."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.data.libraries.write(f"{folder}/group.blend", {ensure_group()})
    return f"{folder}/group.blend"


def empty_file(with_group: bool = False) -> None:
    """Open an empty file; with the node group, which the first medium would make, where a test is not about that."""
    path = group_file() if with_group else ""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if with_group:
        with bpy.data.libraries.load(path) as (_, wanted):
            wanted.node_groups = [GROUP_NAME]
        for text in bpy.data.texts:
            text.use_fake_user = True


def new_scene(resolution: int = 32, with_group: bool = False) -> bpy.types.Scene:
    """An empty scene whose renders are unbiased: no clamping, denoising or adaptive sampling, a box filter.

    For `with_group` see :func:`empty_file`.
    """
    empty_file(with_group)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = resolution
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.shading_system = True
    cycles.device = "CPU"
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.light_sampling_threshold = 0.0
    for limit in ("max_bounces", "transmission_bounces", "glossy_bounces", "transparent_max_bounces"):
        setattr(cycles, limit, BOUNCES)
    return scene


def render(samples: int = 16, seed: int = 0) -> np.ndarray:
    """Render the current scene; (height, width, 3) linear floats, the top row first."""
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.cycles.seed = seed
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder, "picture.exr"))
        bpy.ops.render.render(write_still=True)
        return read_picture(scene.render.filepath)


def read_picture(path: str | Path) -> np.ndarray:
    """Read a picture; (height, width, 3) floats."""
    return np.array(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))[..., :3].astype(np.float64)


def write_picture(path: str | Path, picture: np.ndarray) -> None:
    """Write a picture of (height, width, 3) floats as 32-bit OpenEXR."""
    height, width, channels = picture.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(picture, dtype=np.float32))
    assert buffer.write(str(path)), buffer.geterror()


def failure_folder() -> Path:
    """Make the folder for pictures of the test that runs: ``out/tests/`` and its name."""
    name = os.environ.get("PYTEST_CURRENT_TEST", "no test").split("::", 1)[-1].removesuffix(" (call)")
    folder = Path(__file__).parents[2] / "out" / "tests" / re.sub(r"[^\w.\-]+", "_", name).strip("_")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


SUBPIXELS = 4
"""Parts of a pixel's side that batches are made of."""


def batches(samples: int, count: int) -> np.ndarray:
    """`count` independent pictures of samples / count samples each; (count, height, width, 3)."""
    scene = bpy.context.scene
    scene.render.resolution_percentage = 100 * SUBPIXELS
    try:
        return split_into_batches(render(samples // SUBPIXELS**2), count)
    finally:
        scene.render.resolution_percentage = 100


def split_into_batches(picture: np.ndarray, count: int) -> np.ndarray:
    """Make `count` pictures of one that is SUBPIXELS times as wide and high: each takes its own share of every pixel, drawn at
    random. So shaders are compiled once, and the spread of the batches is that of independent renders.
    """
    height, width, channels = picture.shape
    parts = picture.reshape(height // SUBPIXELS, SUBPIXELS, width // SUBPIXELS, SUBPIXELS, channels)
    parts = parts.transpose(0, 2, 1, 3, 4).reshape(-1, SUBPIXELS**2, channels)
    order = np.random.default_rng(0).permuted(np.tile(np.arange(SUBPIXELS**2), (len(parts), 1)), axis=1)
    parts = np.take_along_axis(parts, order[:, :, None], axis=1)
    parts = parts.reshape(height // SUBPIXELS, width // SUBPIXELS, count, SUBPIXELS**2 // count, channels)
    return np.moveaxis(parts.mean(axis=3), 2, 0)


def set_world(color: tuple[float, float, float] = (1.0, 1.0, 1.0), strength: float = 1.0) -> bpy.types.NodeTree:
    """A uniform world; returns its nodes."""
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.cycles.sampling_method = "MANUAL"  # the automatic importance map takes longer than the pictures here
    world.cycles.sample_map_resolution = 64
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength
    return world.node_tree


def set_striped_world() -> None:
    """Bright and dark bands in every direction, so that a wrong direction shows."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    wave = tree.nodes.new("ShaderNodeTexWave")
    wave.inputs["Scale"].default_value = 1.5
    tree.links.new(coordinates.outputs["Generated"], wave.inputs["Vector"])
    tree.links.new(wave.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def set_half_world(axis: int, sign: float) -> None:
    """A world that is white where the direction's component `axis` has `sign`, black elsewhere."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    separate = tree.nodes.new("ShaderNodeSeparateXYZ")
    compare = tree.nodes.new("ShaderNodeMath")
    compare.operation = "GREATER_THAN" if sign > 0 else "LESS_THAN"
    compare.inputs[1].default_value = 0.1 * sign  # what is seen edge-on belongs to neither half
    tree.links.new(coordinates.outputs["Generated"], separate.inputs[0])
    tree.links.new(separate.outputs[axis], compare.inputs[0])
    tree.links.new(compare.outputs[0], tree.nodes["Background"].inputs["Strength"])


def add(name: str, data: bpy.types.ID | None, location=(0.0, 0.0, 0.0)) -> bpy.types.Object:
    """Put an object with that data into the scene."""
    obj = bpy.data.objects.new(name, data)
    obj.location = location
    bpy.context.scene.collection.objects.link(obj)
    return obj


def add_camera(location, target, width: float | None = None, angle: float = 40.0) -> bpy.types.Object:
    """A camera that looks at a target: orthographic if it has a width, else with that field of view in degrees."""
    data = bpy.data.cameras.new("Camera")
    data.clip_start = 1e-6
    if width is not None:
        data.type = "ORTHO"
        data.ortho_scale = width
    else:
        data.angle = math.radians(angle)
    camera = add("Camera", data, location)
    camera.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = camera
    return camera


def add_mesh(
    name: str, build, material: bpy.types.Material | None = None, priority: int | None = None, smooth: bool = False
):
    """An object of the mesh that `build(bm)` makes; a nested dielectric if its material is one."""
    bm = bmesh.new()
    build(bm)
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    bm.free()
    if smooth:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    obj = add(name, mesh)
    if material is not None:
        mesh.materials.append(material)
    if priority is not None:
        nd.set_priority(obj, priority)
    return obj


def add_sphere(name: str, radius: float, material=None, priority=None, location=(0.0, 0.0, 0.0), segments: int = 64):
    """A smooth UV sphere."""

    def build(bm):
        bmesh.ops.create_uvsphere(
            bm, u_segments=segments, v_segments=segments // 2, radius=radius, matrix=Matrix.Translation(location)
        )

    return add_mesh(name, build, material, priority, smooth=True)


def add_box(name: str, low, high, material=None, priority=None):
    """A box between two corners."""
    low, high = Vector(low), Vector(high)
    matrix = Matrix.Translation((low + high) / 2) @ Matrix.Diagonal((*(high - low), 1.0))
    return add_mesh(name, lambda bm: bmesh.ops.create_cube(bm, size=1.0, matrix=matrix), material, priority)


def add_plane(name: str, size: float, location, normal, material=None):
    """A square that faces along its normal."""
    matrix = Matrix.Translation(location) @ Vector(normal).to_track_quat("Z", "Y").to_matrix().to_4x4()
    return add_mesh(
        name, lambda bm: bmesh.ops.create_grid(bm, x_segments=1, y_segments=1, size=size / 2, matrix=matrix), material
    )


def native(name: str, kind: str, **inputs) -> bpy.types.Material:
    """A material of one of Blender's own shader nodes, such as ``native("Red", "ShaderNodeEmission", Strength=2.0)``."""
    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    shader = tree.nodes.new(kind)
    for key, value in inputs.items():
        shader.inputs[key].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def cycles_glass(ior: float, roughness: float = 0.0) -> bpy.types.Material:
    """Cycles' own Glass: the independent reference for interfaces split by hand."""
    return native("Glass", "ShaderNodeBsdfGlass", IOR=ior, Roughness=roughness, Color=(1.0, 1.0, 1.0, 1.0))


def emission(strength: float = 1.0, color=(1.0, 1.0, 1.0)) -> bpy.types.Material:
    """An emitter of that radiance."""
    return native("Emission", "ShaderNodeEmission", Strength=strength, Color=(*color, 1.0))


def diffuse(albedo: float = 1.0) -> bpy.types.Material:
    """A Lambertian surface."""
    return native("Diffuse", "ShaderNodeBsdfDiffuse", Color=(albedo, albedo, albedo, 1.0))


def add_emission_port(material, socket: str, strength: float = 1.0) -> None:
    """Plug an emitter into an emission port of a nested dielectric."""
    tree = material.node_tree
    shader = tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Strength"].default_value = strength
    tree.links.new(shader.outputs[0], tree.nodes["Nested Dielectric"].inputs[socket])


def add_sun(direction, irradiance: float = 1.0) -> bpy.types.Object:
    """Light from infinitely far, without a size, that travels along `direction`."""
    light = bpy.data.lights.new("Sun", "SUN")
    light.energy = irradiance
    light.angle = 0.0
    sun = add("Sun", light)
    sun.rotation_euler = Vector(direction).to_track_quat("-Z", "Y").to_euler()
    return sun


def add_point_light(location, power: float, radius: float = 0.05) -> None:
    """A small round light that may make caustics."""
    light = bpy.data.lights.new("Lamp", "POINT")
    light.energy, light.shadow_soft_size = power, radius
    light.cycles.is_caustics_light = True
    add("Lamp", light, location)


def updated_by(do: Callable[[], object]) -> list[str]:
    """Names of the data-blocks that Blender has to evaluate again after a call."""
    layer = bpy.context.view_layer
    layer.update()
    names = []

    @bpy.app.handlers.persistent
    def note(_, depsgraph: bpy.types.Depsgraph) -> None:
        names.extend(update.id.name for update in depsgraph.updates)

    bpy.app.handlers.depsgraph_update_post.append(note)
    try:
        do()
        layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(note)
    return names


def fresnel(degrees: float, n1: float, n2: float) -> float:
    """Unpolarised reflectance from Snell's law and the mean of Fresnel's s and p amplitudes squared (Born and Wolf,
    1.5.2).
    """
    cos_i = math.cos(math.radians(degrees))
    sin_t = n1 / n2 * math.sin(math.radians(degrees))
    if sin_t >= 1.0:
        return 1.0
    cos_t = math.sqrt(1.0 - sin_t * sin_t)
    s = (n1 * cos_i - n2 * cos_t) / (n1 * cos_i + n2 * cos_t)
    p = (n2 * cos_i - n1 * cos_t) / (n2 * cos_i + n1 * cos_t)
    return 0.5 * (s * s + p * p)
