"""Lights that the lobes of direct refraction and direct reflection carry.

Cycles' rays carry a light unless its Ray Visibility leaves them out: Transmission for refraction, Glossy for reflection.
What rays leave out the lobes carry, so no light is ever counted twice.

The group `Nested Dielectric Lights` holds one Script node a light, whose inputs are driven by the light itself. So an
animated light, or one that a parent moves, is right on every frame, also where the extension is not installed. A file has one
group for all of its prepared scenes; each light counts in its own scene alone, and in none that its material is taken to.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..model.shader_source import inlined_source
from ..nodes.identity import NO_SCENE, SCENE_PROPERTY, known_number, scene_number
from ..nodes.lights_group import EMITTER_OUTPUT, LIGHT_COUNT_OUTPUT, LIGHT_OUTPUTS, ensure_lights, find_lights
from ..nodes.material_version import MATERIAL_VERSION
from ..nodes.names import LIGHTS_VERSION_PROPERTY
from ..nodes.osl import LIGHT_FILE, add_script, make_script
from ..nodes.shader_nodes import math_node, view_layer_attribute
from ..nodes.wholeness import is_whole, mark_whole

RAYS, LOBE, NOTHING = "RAYS", "LOBE", "NOTHING"

WEAK = 1e-6
"""As in osl/nested_dielectric.osl: so little that Cycles does not take media for lights, and draws no light samples of
them.
"""

_TYPES = ("POINT", "SUN", "SPOT", "AREA", "ELLIPSE")
"""As numbered in osl/light.h."""

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
    | {f"Previous{name}": kind for name, kind in LIGHT_OUTPUTS.items()}
)


@dataclass(frozen=True)
class LightTransport:
    """What carries a light through media and off them.

    :param light: the light's name.
    :param refraction: what carries it through media: ``RAYS``, ``LOBE`` or ``NOTHING``.
    :param reflection: what carries it off them, likewise.
    :param reason: why nothing does.
    """

    light: str
    refraction: str
    reflection: str
    reason: str = ""

    @property
    def lamp(self) -> str:
        """Return the light's name, for scripts that use the word of versions up to 0.2."""
        return self.light


def light_carriers(scene: bpy.types.Scene) -> tuple[LightTransport, ...]:
    """Tell for each light of a scene whether rays or the lobes carry it."""
    transports = []
    for light in scene_lights(scene):
        reason = why_not_lobe(light)
        left_out = NOTHING if reason else LOBE
        ways = [RAYS if seen else left_out for seen in (light.visible_transmission, light.visible_glossy)]
        transports.append(LightTransport(light.name, *ways, reason if NOTHING in ways else ""))
    return tuple(transports)


def scene_lights(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the lights of a scene by name."""
    return sorted((obj for obj in scene.objects if obj.type == "LIGHT"), key=lambda obj: obj.name)


def why_not_lobe(light: bpy.types.Object) -> str:
    """Say why the lobes cannot carry a light, or nothing."""
    tree = light.data.node_tree
    if not light.data.normalize:
        return "its strength is not normalized"
    if tree is not None and any(
        node.bl_idname not in ("ShaderNodeEmission", "ShaderNodeOutputLight") for node in tree.nodes
    ):
        return "its colour or strength comes from nodes"
    return ""


def lobe_lights(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the lights that the lobes carry, now or on some frame."""
    return [
        light
        for light in scene_lights(scene)
        if not why_not_lobe(light)
        and (not light.visible_transmission or not light.visible_glossy or _visibility_moves(light))
    ]


def listed_lights(scene: bpy.types.Scene) -> list[bpy.types.Object | None]:
    """Return the lights that the file's group holds for a scene, in order; None for one that is no longer in the file."""
    return [light for number, light in _listed() if number == known_number(scene)]


def update_lights(scene: bpy.types.Scene) -> bool:
    """Make the group hold the lights that the lobes carry in a scene, and tell whether it changed.

    The lights of scenes that were prepared before stay in it.
    """
    scene_number(scene)
    return _list_lights()


def refresh_lights() -> bool:
    """Make the group hold the lights that it is to hold in the way of this version; tell whether it changed."""
    tree = find_lights()
    if tree is None:
        return False
    listed = {_driving_light(tree, node) for node in tree.nodes if node.type == "SCRIPT" and "Energy" in node.inputs}
    for scene in bpy.data.scenes:
        if not listed.isdisjoint(scene_lights(scene)):  # a list of before scenes had numbers
            scene_number(scene)
    return _list_lights()


def _listed() -> list[tuple[int, bpy.types.Object | None]]:
    """Return the lights that the file's group holds, each with the number of its scene, in order."""
    tree = find_lights()
    return [] if tree is None else [(_number(node), _driving_light(tree, node)) for node in _script_nodes(tree)]


def _list_lights() -> bool:
    """Make the group hold the lights that the lobes carry in all prepared scenes, and tell whether it changed."""
    wanted = [
        (known_number(scene), light)
        for scene in bpy.data.scenes
        if known_number(scene) != NO_SCENE
        for light in lobe_lights(scene)
    ]
    tree = ensure_lights()
    if _holds(tree, wanted):
        return False
    tree[LIGHTS_VERSION_PROPERTY] = MATERIAL_VERSION
    tree.animation_data_clear()
    tree.nodes.clear()
    outputs = tree.nodes.new("NodeGroupOutput")
    if wanted:
        _add_scripts(tree, wanted, outputs)
        emission = tree.nodes.new("ShaderNodeEmission")
        emission.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        emission.inputs["Strength"].default_value = WEAK
        tree.links.new(emission.outputs[0], outputs.inputs[EMITTER_OUTPUT])
        emission.location = (260.0 * (len(wanted) - 1), 300.0)
        outputs.location = (260.0 * len(wanted), 0.0)
    mark_whole(tree)
    return True


def _holds(tree: bpy.types.NodeTree, wanted: list[tuple[int, bpy.types.Object]]) -> bool:
    """Return whether the group holds lights in the way of this version, each with the number of its scene."""
    drivers = tree.animation_data.drivers if tree.animation_data else ()
    return (
        tree.get(LIGHTS_VERSION_PROPERTY) == MATERIAL_VERSION
        and is_whole(tree)
        and _listed() == wanted
        and len(drivers) == sum(_driver_count(light) for _, light in wanted)
        and all(
            node.inputs["Type"].default_value == _type(light.data)
            for (_, light), node in zip(wanted, _script_nodes(tree))
        )
    )


def _add_scripts(
    tree: bpy.types.NodeTree, wanted: list[tuple[int, bpy.types.Object]], outputs: bpy.types.NodeGroupOutput
) -> None:
    """Add a Script node for each light, which passes on what the nodes before it have drawn, and plug the last one in."""
    script = make_script(LIGHT_FILE, inlined_source(LIGHT_FILE))
    rendered = view_layer_attribute(tree, f'["{SCENE_PROPERTY}"]').outputs["Fac"]
    previous, count = None, None
    for index, (number, light) in enumerate(wanted):
        node = add_script(tree, light.name, script, _SOCKETS, LIGHT_OUTPUTS)
        node.location = (260.0 * index, 0.0)
        _set_light(node, index, light)
        here = math_node(tree, "COMPARE", rendered, float(number), 0.5)
        tree.links.new(here, node.inputs["Here"])
        count = here if count is None else math_node(tree, "ADD", count, here)
        if previous is not None:
            for name in LIGHT_OUTPUTS:
                tree.links.new(previous.outputs[name], node.inputs[f"Previous{name}"])
        previous = node
    tree.links.new(count, outputs.inputs[LIGHT_COUNT_OUTPUT])
    for name in LIGHT_OUTPUTS:
        tree.links.new(previous.outputs[name], outputs.inputs[name])


def _number(node: bpy.types.ShaderNodeScript) -> int:
    """Return the number of the scene in which the light of a node counts."""
    links = node.inputs["Here"].links if "Here" in node.inputs else ()
    return int(links[0].from_node.inputs[1].default_value) if links else NO_SCENE


def _script_nodes(tree: bpy.types.NodeTree) -> list[bpy.types.ShaderNodeScript]:
    nodes = (node for node in tree.nodes if node.type == "SCRIPT" and all(name in node.inputs for name in _SOCKETS))
    return sorted(nodes, key=lambda node: node.inputs["Index"].default_value)


def _type(data: bpy.types.Light) -> int:
    return _TYPES.index("ELLIPSE" if data.type == "AREA" and data.shape in ("DISK", "ELLIPSE") else data.type)


def _visibility_moves(light: bpy.types.Object) -> bool:
    animation = light.animation_data
    if animation is None:
        return False
    return animation.action is not None or any(curve.data_path.startswith("visible_") for curve in animation.drivers)


def _driving_light(tree: bpy.types.NodeTree, node: bpy.types.ShaderNodeScript) -> bpy.types.Object | None:
    path = node.inputs["Energy"].path_from_id("default_value")
    curve = tree.animation_data.drivers.find(path) if tree.animation_data else None
    targets = [target for variable in (curve.driver.variables if curve else ()) for target in variable.targets]
    return targets[0].id if targets else None


def _driver_count(light: bpy.types.Object) -> int:
    """Return how many drivers keep a light's node up to date."""
    return len(_values(light.data)) + 3 * (len(_COLORS) + len(_TRANSFORMS))


def _values(data: bpy.types.Light) -> dict[str, str]:
    """Return the sockets of a light's node that hold one number, and the paths from the light that they follow."""
    sizes = dict(_SIZES[data.type])
    if data.type == "AREA" and data.shape in ("SQUARE", "DISK"):
        sizes["SizeY"] = sizes["Size"]
    return _VALUES | sizes


def _set_light(node: bpy.types.ShaderNodeScript, index: int, light: bpy.types.Object) -> None:
    node.inputs["Index"].default_value = index
    node.inputs["Type"].default_value = _type(light.data)
    for name, path in _values(light.data).items():
        _drive(node.inputs[name], -1, light, path)
    for name, path in _COLORS.items():
        for channel in range(3):
            _drive(node.inputs[name], channel, light, f"{path}[{channel}]")
    for name, channel in _TRANSFORMS.items():
        for place, axis in enumerate("XYZ"):
            target = _drive(node.inputs[name], place, light, None)
            target.transform_type = channel.format(axis)
            target.transform_space = "WORLD_SPACE"
            target.rotation_mode = "XYZ"


def _drive(
    socket: bpy.types.NodeSocket, component: int, light: bpy.types.Object, path: str | None
) -> bpy.types.DriverTarget:
    """Let a socket follow a property of a light, or with no path its place in the world, without Python."""
    driver = socket.driver_add("default_value", component).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.type = "SINGLE_PROP" if path else "TRANSFORMS"
    target = variable.targets[0]
    target.id = light
    if path:
        target.data_path = path
    return target
