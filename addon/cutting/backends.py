"""Which body of each material renders a scene: the shader in Open Shading Language, or Cycles' own nodes.

Own nodes trace no rays and know of what lies outside a surface only what they are told, by the analysis or by faces that are cut;
and there are things that only the shader does (:class:`~nested_dielectric.parameters.Limit`). So each material has a socket that
chooses, written here for the scene that is prepared or rendered.

Where a scene has both, media that may meet are of one kind: what a ray of the shader's finds out of a medium is exported by
materials of the shader's alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import bpy

from ..analysis import analysis
from ..analysis.analysis import Found
from ..model.dispersion import abbe_deviation
from ..model.parameters import BY_KEYWORD, LAMPS_BY_LOBE, SOCKETS, TINTED_MEDIA, limits_at_work
from ..nodes.animation import curves
from ..nodes.compatibility import NATIVE, NATIVE_DISPERSION_VERSION, OSL, get_backend, has_osl, is_native
from ..nodes.identity import known_number
from ..nodes.lookups import unchanged_nodes
from ..nodes.node_group import (
    BY_OBJECT,
    BY_VOLUME_SOCKET,
    FOREIGN_SOCKET,
    GIVES_BACK_SOCKET,
    MASK_OUTPUT,
    NATIVE_SOCKET,
    OUTSIDE_SOCKET,
)
from ..nodes.trees import is_plugged
from ..scene.lights import carried_lamps
from ..scene.materials import dielectrics, get_parameter, may_disperse, rendered_node
from ..scene.media import dispersing_materials, is_rendered, media
from .cutting import last_cut
from .cutting_plan import Cut, components, may_absorb, touching_media


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


@dataclass(frozen=True)
class Chosen:
    """Which materials of a scene Cycles' own nodes render, by name, and which the shader and why.

    :param notes: what there is to know of own nodes' pictures, in sentences.
    :param asking: media that must ask though nothing can, by name, and why.
    """

    native: tuple[str, ...] = ()
    osl: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    asking: tuple[tuple[str, str], ...] = ()

    @property
    def headline(self) -> str:
        """How many materials are rendered in which way, in one line."""
        count = len(self.native) + len(self.osl)
        if not count:
            return ""
        noun = f"{count} material{'s' * (count != 1)}"
        if not self.osl:
            return f"{noun}: Cycles' own nodes"
        return (
            f"{noun}: {len(self.native)} by Cycles' own nodes, {len(self.osl)} by OSL"
            if self.native
            else f"{noun}: OSL"
        )

    def __str__(self) -> str:
        lines = [f"by Cycles' own nodes: {analysis.listed(self.native)}"] if self.native else []
        named: dict[str, list[str]] = {}
        for name, reason in self.osl:
            named.setdefault(reason, []).append(name)
        lines += [f"by OSL: {analysis.listed(tuple(names))}: {reason}" for reason, names in named.items()]
        return "\n".join((*lines, *self.notes))


_last: dict[int, Chosen] = {}
"""What was chosen for each scene in this session, by its number."""


def last_chosen(scene: bpy.types.Scene) -> Chosen | None:
    """Return what was last chosen for a scene; None if nobody has in this session."""
    return _last.get(scene.session_uid)


# What needs the shader ------------------------------------------------------------------------------------------------


@unchanged_nodes()
def find_needs(scene: bpy.types.Scene, cut: Cut, found: Found | None) -> list[Need]:
    """Tell why media of a scene need the shader: those that must ask first.

    :param cut: which media are cut; found: what the analysis found, None without one.
    """
    users = _users(scene)
    circumstances = {LAMPS_BY_LOBE: bool(carried_lamps(scene)), TINTED_MEDIA: any(map(may_absorb, users))}
    limits = (need for material in users for need in _limits(scene, material, users[material], circumstances))
    return [*_asking(users, cut, found), *limits]


Users = dict[bpy.types.Material, list[bpy.types.Object]]


def _users(scene: bpy.types.Scene) -> Users:
    """Materials of media and the objects in renders that have them, by name."""
    users: Users = {}
    for obj in media(scene):
        for _, material in dielectrics(obj) if is_rendered(obj) else ():
            users.setdefault(material, []).append(obj)
    return dict(sorted(users.items(), key=lambda item: item[0].name_full))


def _asking(users: Users, cut: Cut, found: Found | None) -> Iterator[Need]:
    """Media that neither the analysis nor their faces tell what lies outside."""
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


def _changing(users: Users, cut: Cut, found: Found | None) -> Iterator[Need]:
    """Media that are cut on each frame as they are then: on some their meshes may not be closed, and nothing can be cut."""
    changes = found is None or found.doubts or any(any(curves(material.node_tree.animation_data)) for material in users)
    media = set(cut.media) if changes else ()
    for material, objects in users.items():
        for obj in objects:
            if obj.name in media:
                yield Need(material.name, material.name, "may change or open up on some frame, and then must ask")
                break


def _limits(
    scene: bpy.types.Scene,
    material: bpy.types.Material,
    objects: Sequence[bpy.types.Object],
    circumstances: dict[str, bool],
) -> Iterator[Need]:
    """What Cycles' own nodes do otherwise in a material, or not at all."""
    node = rendered_node(material)

    def need(reason: str, keyword: str = "") -> Need:
        return Need(material.name, material.name, reason, keyword=keyword)

    if NATIVE_SOCKET not in node.inputs:
        yield need("is of an older version of the extension, or a copy; update it")
        return
    for limit, parameter in limits_at_work(_values(node) | circumstances, bpy.app.version).items():
        yield need(f"has {parameter.name}: Cycles' own nodes {limit.text}", parameter.keyword)
    if any(output.is_linked for output in node.outputs if output.name == MASK_OUTPUT):
        yield need(f"has its {MASK_OUTPUT} plugged in, which only the shader knows")
    if node.inputs[GIVES_BACK_SOCKET].default_value:
        yield need("wins over media that their volumes tint, and only the shader gives back what these take in it")
    if may_absorb(material) and not _is_left_to_volume(scene, node) and _may_hold_others(node, objects):
        yield need("may hold things that are no media, and only the shader tints all rays to them")


def _values(node: bpy.types.ShaderNodeGroup) -> dict[str, Any]:
    """The values of a medium that are the same on every frame, by keyword; what is plugged into a Shader socket is none."""
    paths = {curve.data_path for curve in curves(node.id_data.animation_data)}
    values = {}
    for parameter in SOCKETS:
        socket = node.inputs.get(parameter.name)
        if socket is None or socket.is_linked or f"{socket.path_from_id()}.default_value" in paths:
            continue
        values[parameter.keyword] = None if parameter.kind == "SHADER" else get_parameter(node, parameter)
    return values


def _is_left_to_volume(scene: bpy.types.Scene, node: bpy.types.ShaderNodeGroup) -> bool:
    return 0 < node.inputs[BY_VOLUME_SOCKET].default_value == known_number(scene)


def _may_hold_others(node: bpy.types.ShaderNodeGroup, objects: Iterable[bpy.types.Object]) -> bool:
    """Whether the analysis leaves it open that objects that are no media stand in a material's media."""
    if node.inputs[OUTSIDE_SOCKET].default_value != BY_OBJECT:
        return node.inputs[FOREIGN_SOCKET].default_value
    return any(analysis.told_foreign(obj) for obj in objects)


# Choosing -------------------------------------------------------------------------------------------------------------


@unchanged_nodes()
def choose(scene: bpy.types.Scene, scripted: bool = False) -> Chosen:
    """Write into the materials of a scene's media which body renders them; return what was chosen.

    All are rendered by Cycles' own nodes where the scene has no choice. Where it has, those media are left to the shader that
    need anything more, with all that they may meet or share a material with; and all media where one of them splits light.

    :param scripted: a script may change any object on any frame, and while the shutter is open.
    """
    users = _users(scene)
    reasons: dict[bpy.types.Material, str] = {}
    asking: tuple[tuple[str, str], ...] = ()
    cut = last_cut(scene) or Cut()
    if is_native(scene):
        asking = tuple((need.name, need.reason) for need in _asking(users, cut, analysis.last_found(scene)))
    elif get_backend(scene) == OSL:
        reasons = dict.fromkeys(users, "as Render With says")
    elif scripted:
        reasons = dict.fromkeys(users, "may be changed by a script on any frame")
    elif users:
        found = analysis.last_found(scene)
        reasons = _reasons(scene, users, [*find_needs(scene, cut, found), *_changing(users, cut, found)])
    for material in users:
        _tell(material, material not in reasons)
    native = tuple(material.name for material in users if material not in reasons)
    notes = tuple(_dispersion_notes(scene)) if is_native(scene) else ()
    chosen = Chosen(native, tuple((material.name, reason) for material, reason in reasons.items()), notes, asking)
    _last[scene.session_uid] = chosen
    return chosen


def let_ask(scene: bpy.types.Scene) -> None:
    """Leave all media of a scene to the shader until they are told again what surrounds them, if renders run it."""
    if not is_native(scene):
        _leave_to_shader(scene)


def let_choose(scene: bpy.types.Scene) -> None:
    """Leave all media of a scene to whichever body its renderer can run, unless that would be the wrong one: so whoever appends or
    links them, or renders them elsewhere, finds media that can ask.
    """
    if not (is_native(scene) and scene.cycles.shading_system):
        _leave_to_shader(scene)


def _leave_to_shader(scene: bpy.types.Scene) -> None:
    for material in _users(scene):
        _tell(material, False)


def _reasons(scene: bpy.types.Scene, users: Users, needs: Sequence[Need]) -> dict[bpy.types.Material, str]:
    """Why materials are left to the shader; what is not named is not."""
    own: dict[str, str] = {}
    for need in needs:
        own.setdefault(need.material, str(need) if need.is_hard else need.reason)
    if not own:
        return {}
    dispersing = next(filter(may_disperse, users), None)
    if dispersing is not None:
        return {
            each: own.get(each.name, f"{dispersing.name!r} splits light, which all media then bend") for each in users
        }
    reasons = {}
    for group in _hanging_together(scene, users):
        cause = next((each for each in group if each.name in own), None)
        if cause is not None:
            reasons |= {each: own.get(each.name, f"may meet {cause.name!r}, which is") for each in group}
    return {material: reasons[material] for material in users if material in reasons}


def _hanging_together(scene: bpy.types.Scene, users: Users) -> Iterator[list[bpy.types.Material]]:
    """Yield sets of materials whose objects may meet."""
    objects = list(dict.fromkeys(obj for each in users.values() for obj in each))
    own = set(scene.objects)
    instances = scene.view_layers[0].depsgraph.object_instances
    anywhere = {instance.object.original for instance in instances if instance.is_instance}
    anywhere |= {obj for obj in objects if obj not in own or analysis.may_change(obj)}
    touching = touching_media(objects, anywhere)
    for members in users.values():
        for one, other in zip(members, members[1:]):
            touching[one].append(other)
            touching[other].append(one)
    for group in components(objects, touching):
        members = set(group)
        yield [material for material, found in users.items() if not members.isdisjoint(found)]


def _tell(material: bpy.types.Material, native: bool) -> None:
    node = rendered_node(material)
    socket = node.inputs.get(NATIVE_SOCKET)
    if material.library is None and node.id_data == material.node_tree and socket is not None and is_plugged(node):
        if socket.default_value != native:
            socket.default_value = native


def _dispersion_notes(scene: bpy.types.Scene) -> Iterator[str]:
    """How far the indices of media that Cycles itself splits light in are off their own."""
    for material in dispersing_materials(scene) if bpy.app.version >= NATIVE_DISPERSION_VERSION else ():
        node = rendered_node(material)
        curve = {name: get_parameter(node, BY_KEYWORD[name]) for name in _CURVE}
        yield (
            f"{material.name!r} splits light by Cycles' own dispersion, whose index is up to {abbe_deviation(curve):.2g} off "
            "the medium's own between 380 and 780 nm"
        )


_CURVE = ("ior", "dispersion_model", "abbe", "sellmeier_b", "sellmeier_c", "dispersion")


def shortcomings(scene: bpy.types.Scene, cut: Cut, found: Found | None) -> Iterator[tuple[Need, str]]:
    """Yield what Cycles' own nodes do not render as the shader would where they render all media of a scene, and remedies."""
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
