"""Why media of a scene need the shader: what Cycles' own nodes do not render as it does."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import bpy

from ..analysis import storage
from ..analysis.findings import Found
from ..model.contract import BY_VOLUME_SOCKET, Exterior
from ..model.effects import limits_at_work
from ..model.parameter import LIGHTS_BY_LOBE, TINTED_MEDIA
from ..model.parameters import SOCKETS
from ..nodes.animation import curves
from ..nodes.compatibility import NATIVE_DISPERSION_VERSION, has_osl
from ..nodes.identity import known_number
from ..nodes.lookups import caching_nodes
from ..nodes.names import EXTERIOR_SOCKET, FOREIGN_SOCKET, GIVES_BACK_SOCKET, MASK_OUTPUT, NATIVE_SOCKET
from ..nodes.render_with import NATIVE, get_backend, is_native
from ..scene.lights import lobe_lights
from ..scene.materials import dielectrics, get_parameter, rendered_node
from ..scene.media import is_rendered, media
from .cut_plan import CutReport
from .medium_contents import may_absorb


@dataclass(frozen=True)
class Need:
    """Why a medium needs the shader.

    :param name: of an object that must ask, or of a material.
    :param material: the material's name.
    :param reason: after the name.
    :param is_hard: Cycles' own nodes show the alarm instead; else they come near, or leave something out.
    :param keyword: of the parameter that it comes from, if it does.
    """

    name: str
    material: str
    reason: str
    is_hard: bool = False
    keyword: str = ""

    def __str__(self) -> str:
        return f"{self.name!r} {self.reason}"


@caching_nodes()
def find_needs(scene: bpy.types.Scene, cut: CutReport, found: Found | None) -> list[Need]:
    """Tell why media of a scene need the shader: those that must ask first.

    :param cut: which media are cut; found: what the analysis found, None without one.
    """
    users = material_users(scene)
    circumstances = {LIGHTS_BY_LOBE: bool(lobe_lights(scene)), TINTED_MEDIA: any(map(may_absorb, users))}
    limits = (need for material in users for need in _limits(scene, material, users[material], circumstances))
    return [*asking_media(users, cut, found), *limits]


MaterialUsers = dict[bpy.types.Material, list[bpy.types.Object]]
"""Materials of media, each with the objects that have it."""


def material_users(scene: bpy.types.Scene) -> MaterialUsers:
    """Return the materials of a scene's media and the objects in renders that have them, in the order of names."""
    users: MaterialUsers = {}
    for obj in media(scene):
        for _, material in dielectrics(obj) if is_rendered(obj) else ():
            users.setdefault(material, []).append(obj)
    return dict(sorted(users.items(), key=lambda item: item[0].name_full))


def asking_media(users: MaterialUsers, cut: CutReport, found: Found | None) -> Iterator[Need]:
    """Yield media that neither the analysis nor their faces tell what lies outside."""
    known = {*cut.media, *(found.known if found is not None else ())}
    uncut = dict(cut.asking)
    doubts = dict(found.doubts) if found is not None else {}
    for material, objects in users.items():
        for obj in objects:
            if obj.name in known:
                continue
            reason = "must ask what lies outside it"
            if obj.name in uncut:
                reason += f": it {uncut[obj.name]}"
            elif obj.name in doubts:
                reason += f": it {doubts[obj.name]}"
            yield Need(obj.name, material.name, reason, True)


def changing_media(users: MaterialUsers, cut: CutReport, found: Found | None) -> Iterator[Need]:
    """Yield media that may change: on some frame their meshes may not be closed, and nothing can be cut."""
    changes = found is None or found.doubts or any(any(curves(material.node_tree.animation_data)) for material in users)
    uncertain = set(cut.media) if changes else ()
    for material, objects in users.items():
        for obj in objects:
            if obj.name in uncertain:
                yield Need(material.name, material.name, "may change or open up on some frame, and then must ask")
                break


def _limits(
    scene: bpy.types.Scene,
    material: bpy.types.Material,
    objects: Sequence[bpy.types.Object],
    circumstances: dict[str, bool],
) -> Iterator[Need]:
    """Yield what Cycles' own nodes do otherwise in a material, or not at all."""
    node = rendered_node(material)

    def need(reason: str, keyword: str = "") -> Need:
        return Need(material.name, material.name, reason, keyword=keyword)

    if NATIVE_SOCKET not in node.inputs:
        yield need("is of an older version of the extension, or a copy; update it")
        return
    for limit, parameter in limits_at_work(unchanging_values(node) | circumstances, bpy.app.version).items():
        yield need(f"has {parameter.name}: Cycles' own nodes {limit.text}", parameter.keyword)
    if any(output.is_linked for output in node.outputs if output.name == MASK_OUTPUT):
        yield need(f"has its {MASK_OUTPUT} plugged in, which only the shader knows")
    if node.inputs[GIVES_BACK_SOCKET].default_value:
        yield need("wins over media that their volumes tint, and only the shader gives back what these take in it")
    if may_absorb(material) and not _is_left_to_volume(scene, node) and _may_hold_others(node, objects):
        yield need("may hold things that are no media, and only the shader tints all rays to them")


def unchanging_values(node: bpy.types.ShaderNodeGroup) -> dict[str, Any]:
    """Return the values of a medium that are the same on every frame, by keyword; what a Shader socket is linked to is None."""
    paths = {curve.data_path for curve in curves(node.id_data.animation_data)}
    values = {}
    for parameter in SOCKETS:
        socket = node.inputs.get(parameter.name)
        if socket is None or socket.is_linked or f"{socket.path_from_id()}.default_value" in paths:
            continue
        values[parameter.keyword] = None if parameter.kind == "SHADER" else get_parameter(node, parameter)
    return values


def _is_left_to_volume(scene: bpy.types.Scene, node: bpy.types.ShaderNodeGroup) -> bool:
    """Return whether Cycles' volume absorbs in a medium for all rays, as an analysis of the scene has told its material."""
    return 0 < node.inputs[BY_VOLUME_SOCKET].default_value == known_number(scene)


def _may_hold_others(node: bpy.types.ShaderNodeGroup, objects: Iterable[bpy.types.Object]) -> bool:
    """Return whether, as far as the analysis knows, objects that are no media may stand in a material's media."""
    if node.inputs[EXTERIOR_SOCKET].default_value != Exterior.BY_OBJECT:
        return node.inputs[FOREIGN_SOCKET].default_value
    return any(storage.may_hold_objects(obj) for obj in objects)


def shortcomings(scene: bpy.types.Scene, cut: CutReport, found: Found | None) -> Iterator[tuple[Need, str]]:
    """Yield what Cycles' own nodes, where they render all of a scene, do not render as the shader would, with remedies."""
    shader = (
        "set Render With to OSL, which renders on the CPU"
        if has_osl()
        else "use a Blender with Open Shading Language, such as that of blender.org"
    )
    for need in find_needs(scene, cut, found) if is_native(scene) else ():
        if need.is_hard:
            choice = "set Render With to Automatic" if get_backend(scene) == NATIVE and has_osl() else shader
            yield need, f"mend that, so that its surface can be cut, or {choice}"
        elif need.keyword != "disperse" or bpy.app.version < NATIVE_DISPERSION_VERSION:
            yield need, f"do without it, or {shader}"
