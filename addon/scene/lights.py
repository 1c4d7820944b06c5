"""Lamps that the lobes of direct refraction and direct reflection carry.

Cycles' rays carry a lamp unless its Ray Visibility leaves them out: Transmission for refraction, Glossy for reflection.
What rays leave out the lobes carry, so no lamp is ever counted twice.

The group `Nested Dielectric Lights` holds one Script node a lamp, whose inputs are driven by the lamp itself. So an
animated lamp, or one that a parent moves, is right on every frame, also where the extension is not installed. A file has one
group for all of its prepared scenes; each lamp counts in its own scene alone, and in none that its material is taken to.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..model.shader_source import inlined_source
from ..nodes.identity import NO_SCENE, SCENE_PROPERTY, known_number, scene_number
from ..nodes.node_group import (
    EMITTER_OUTPUT,
    LAMP_OUTPUTS,
    LAMPS_OUTPUT,
    LIGHT_FILE,
    LIGHTS_VERSION_PROPERTY,
    MATERIAL_VERSION,
    add_script,
    ensure_lights,
    find_lights,
    make_script,
)
from ..nodes.shader_nodes import math_node, view_layer_attribute

RAYS, LOBE, NOTHING = "RAYS", "LOBE", "NOTHING"

WEAK = 1e-6
"""As in osl/nested_dielectric.osl: so little that Cycles does not take media for lamps, and draws no light samples of
them.
"""

_TYPES = ("POINT", "SUN", "SPOT", "AREA", "ELLIPSE")
"""As numbered in osl/lamp.h."""

_SIZES = {
    "POINT": {"Size": "data.shadow_soft_size"},
    "SUN": {"Size": "data.angle"},
    "SPOT": {"Size": "data.shadow_soft_size", "SpotSize": "data.spot_size", "SpotBlend": "data.spot_blend"},
    "AREA": {"Size": "data.size", "SizeY": "data.size_y", "Spread": "data.spread"},
}

_VALUES = {
    "UseTemperature": "data.use_temperature",
    "Energy": "data.energy",
    "Exposure": "data.exposure",
    "Hidden": "hide_render",
    "SeenByRefraction": "visible_transmission",
    "SeenByReflection": "visible_glossy",
}

_COLORS = {"Color": "data.color", "TemperatureColor": "data.temperature_color"}

_TRANSFORMS = {"Position": "LOC_{}", "Rotation": "ROT_{}", "Scale": "SCALE_{}"}

_SOCKETS = (
    dict.fromkeys(("Index", "Here", "Type"), "INT")
    | dict.fromkeys((*_TRANSFORMS, *_COLORS), "VECTOR")
    | dict.fromkeys((*_VALUES, "Size", "SizeY", "SpotSize", "SpotBlend", "Spread"), "FLOAT")
    | {f"Other{name}": kind for name, kind in LAMP_OUTPUTS.items()}
)


@dataclass(frozen=True)
class Carrier:
    """What brings the light of a lamp through media (``refraction``) and off them (``reflection``): ``RAYS``, the
    ``LOBE``, or ``NOTHING``, with the reason.
    """

    lamp: str
    refraction: str
    reflection: str
    reason: str = ""


def light_carriers(scene: bpy.types.Scene) -> tuple[Carrier, ...]:
    """Tell for each lamp of a scene whether rays or the lobes carry its light."""
    carriers = []
    for lamp in lamps(scene):
        reason = unsuitable(lamp)
        left_out = NOTHING if reason else LOBE
        ways = [RAYS if seen else left_out for seen in (lamp.visible_transmission, lamp.visible_glossy)]
        carriers.append(Carrier(lamp.name, *ways, reason if NOTHING in ways else ""))
    return tuple(carriers)


def lamps(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the lamps of a scene by name."""
    return sorted((obj for obj in scene.objects if obj.type == "LIGHT"), key=lambda obj: obj.name)


def unsuitable(lamp: bpy.types.Object) -> str:
    """Say why the lobes cannot carry a lamp, or nothing."""
    light = lamp.data
    if not light.normalize:
        return "its strength is not normalized"
    if light.node_tree is not None and any(
        node.bl_idname not in ("ShaderNodeEmission", "ShaderNodeOutputLight") for node in light.node_tree.nodes
    ):
        return "its colour or strength comes from nodes"
    return ""


def carried_lamps(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the lamps that the lobes carry, now or on some frame."""
    return [
        lamp
        for lamp in lamps(scene)
        if not unsuitable(lamp)
        and (not lamp.visible_transmission or not lamp.visible_glossy or _visibility_moves(lamp))
    ]


def listed_lamps(scene: bpy.types.Scene) -> list[bpy.types.Object | None]:
    """Return the lamps that the file's group holds for a scene, in order; None for one that is no longer in the file."""
    return [lamp for number, lamp in _listed() if number == known_number(scene)]


def update_lights(scene: bpy.types.Scene) -> bool:
    """Make the group hold the lamps that the lobes carry in a scene, and in those that were prepared before; tell whether it
    changed.
    """
    scene_number(scene)
    return _list_lamps()


def refresh_lights() -> bool:
    """Make the group hold the lamps that it is to hold in the way of this version; tell whether it changed."""
    tree = find_lights()
    if tree is None:
        return False
    listed = {_driving_lamp(tree, node) for node in tree.nodes if node.type == "SCRIPT" and "Energy" in node.inputs}
    for scene in bpy.data.scenes:
        if not listed.isdisjoint(lamps(scene)):  # a list of before scenes had numbers
            scene_number(scene)
    return _list_lamps()


def _listed() -> list[tuple[int, bpy.types.Object | None]]:
    """Numbers of scenes and their lamps that the file's group holds, in order."""
    tree = find_lights()
    return [] if tree is None else [(_number(node), _driving_lamp(tree, node)) for node in _script_nodes(tree)]


def _list_lamps() -> bool:
    wanted = [
        (known_number(scene), lamp)
        for scene in bpy.data.scenes
        if known_number(scene) != NO_SCENE
        for lamp in carried_lamps(scene)
    ]
    tree = ensure_lights()
    if (
        tree.get(LIGHTS_VERSION_PROPERTY) == MATERIAL_VERSION
        and _listed() == wanted
        and len(tree.animation_data.drivers if tree.animation_data else ())
        == sum(_driver_count(lamp) for _, lamp in wanted)
        and all(
            node.inputs["Type"].default_value == _type(lamp.data)
            for (_, lamp), node in zip(wanted, _script_nodes(tree))
        )
    ):
        return False
    tree[LIGHTS_VERSION_PROPERTY] = MATERIAL_VERSION
    tree.animation_data_clear()
    tree.nodes.clear()
    outputs = tree.nodes.new("NodeGroupOutput")
    if not wanted:
        return True
    script = make_script(LIGHT_FILE, inlined_source(LIGHT_FILE))
    rendered = view_layer_attribute(tree, f'["{SCENE_PROPERTY}"]').outputs["Fac"]
    previous, count = None, None
    for index, (number, lamp) in enumerate(wanted):
        node = add_script(tree, lamp.name, script, _SOCKETS, LAMP_OUTPUTS)
        node.location = (260.0 * index, 0.0)
        _set_lamp(node, index, lamp)
        here = math_node(tree, "COMPARE", rendered, float(number), 0.5)
        tree.links.new(here, node.inputs["Here"])
        count = here if count is None else math_node(tree, "ADD", count, here)
        if previous is not None:
            for name in LAMP_OUTPUTS:
                tree.links.new(previous.outputs[name], node.inputs[f"Other{name}"])
        previous = node
    tree.links.new(count, outputs.inputs[LAMPS_OUTPUT])
    for name in LAMP_OUTPUTS:
        tree.links.new(previous.outputs[name], outputs.inputs[name])
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    emission.inputs["Strength"].default_value = WEAK
    tree.links.new(emission.outputs[0], outputs.inputs[EMITTER_OUTPUT])
    emission.location = (260.0 * (len(wanted) - 1), 300.0)
    outputs.location = (260.0 * len(wanted), 0.0)
    return True


def _number(node: bpy.types.ShaderNodeScript) -> int:
    """Of the scene in which a lamp counts."""
    links = node.inputs["Here"].links if "Here" in node.inputs else ()
    return int(links[0].from_node.inputs[1].default_value) if links else NO_SCENE


def _script_nodes(tree: bpy.types.NodeTree) -> list[bpy.types.ShaderNodeScript]:
    nodes = (node for node in tree.nodes if node.type == "SCRIPT" and all(name in node.inputs for name in _SOCKETS))
    return sorted(nodes, key=lambda node: node.inputs["Index"].default_value)


def _type(light: bpy.types.Light) -> int:
    return _TYPES.index("ELLIPSE" if light.type == "AREA" and light.shape in ("DISK", "ELLIPSE") else light.type)


def _visibility_moves(lamp: bpy.types.Object) -> bool:
    animation = lamp.animation_data
    if animation is None:
        return False
    return animation.action is not None or any(curve.data_path.startswith("visible_") for curve in animation.drivers)


def _driving_lamp(tree: bpy.types.NodeTree, node: bpy.types.ShaderNodeScript) -> bpy.types.Object | None:
    path = node.inputs["Energy"].path_from_id("default_value")
    curve = tree.animation_data.drivers.find(path) if tree.animation_data else None
    targets = [target for variable in (curve.driver.variables if curve else ()) for target in variable.targets]
    return targets[0].id if targets else None


def _driver_count(lamp: bpy.types.Object) -> int:
    """How many drivers keep a lamp's node up to date."""
    return len(_values(lamp.data)) + 3 * (len(_COLORS) + len(_TRANSFORMS))


def _values(light: bpy.types.Light) -> dict[str, str]:
    """Sockets of a lamp's node that hold one number, and the paths from the lamp that they follow."""
    sizes = dict(_SIZES[light.type])
    if light.type == "AREA" and light.shape in ("SQUARE", "DISK"):
        sizes["SizeY"] = sizes["Size"]
    return _VALUES | sizes


def _set_lamp(node: bpy.types.ShaderNodeScript, index: int, lamp: bpy.types.Object) -> None:
    light = lamp.data
    node.inputs["Index"].default_value = index
    node.inputs["Type"].default_value = _type(light)
    for name, path in _values(light).items():
        _drive(node.inputs[name], -1, lamp, path)
    for name, path in _COLORS.items():
        for channel in range(3):
            _drive(node.inputs[name], channel, lamp, f"{path}[{channel}]")
    for name, channel in _TRANSFORMS.items():
        for place, axis in enumerate("XYZ"):
            target = _drive(node.inputs[name], place, lamp, None)
            target.transform_type = channel.format(axis)
            target.transform_space = "WORLD_SPACE"
            target.rotation_mode = "XYZ"


def _drive(
    socket: bpy.types.NodeSocket, component: int, lamp: bpy.types.Object, path: str | None
) -> bpy.types.DriverTarget:
    """Let a socket follow a property of a lamp, or with no path its place in the world, without Python."""
    driver = socket.driver_add("default_value", component).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.type = "SINGLE_PROP" if path else "TRANSFORMS"
    target = variable.targets[0]
    target.id = lamp
    if path:
        target.data_path = path
    return target
