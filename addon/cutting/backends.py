"""Which body of each material renders a scene: the shader in Open Shading Language, or Cycles' own nodes.

Own nodes trace no rays and know of what lies outside a surface only what they are told, by the analysis or by faces that
are cut; and there are things that only the shader does (:class:`~nested_dielectric.model.parameter.Limit`). So each material
has a socket that chooses, written here for the scene that is prepared or rendered.

Where a scene has both, media that may meet are of one kind: what a ray of the shader's finds out of a medium is exported by
materials of the shader's alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import bpy

from ..analysis import findings, stability, surroundings
from ..model.dispersion import abbe_deviation
from ..model.parameters import BY_KEYWORD
from ..nodes.compatibility import NATIVE_DISPERSION_VERSION
from ..nodes.identity import forget_gone_scenes
from ..nodes.lookups import caching_nodes
from ..nodes.names import NATIVE_SOCKET
from ..nodes.places import is_plugged
from ..nodes.render_with import OSL, get_backend, is_native
from ..scene.materials import get_parameter, may_disperse, rendered_node
from ..scene.media import dispersing_materials
from .cut_plan import CutReport
from .cut_scene import last_cut
from .needs import MaterialUsers, Need, asking_media, changing_media, find_needs, material_users
from .neighbours import connected_groups, touching_media


@dataclass(frozen=True)
class BackendChoice:
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
        """Say in one line how many materials are rendered in which way."""
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
        lines = [f"by Cycles' own nodes: {findings.listed(self.native)}"] if self.native else []
        named: dict[str, list[str]] = {}
        for name, reason in self.osl:
            named.setdefault(reason, []).append(name)
        lines += [f"by OSL: {findings.listed(tuple(names))}: {reason}" for reason, names in named.items()]
        return "\n".join((*lines, *self.notes))


_last: dict[int, BackendChoice] = {}
"""What was chosen for each scene in this session, by its number."""


def last_choice(scene: bpy.types.Scene) -> BackendChoice | None:
    """Return what was last chosen for a scene; None if nobody has in this session."""
    return _last.get(scene.session_uid)


@caching_nodes()
def choose(scene: bpy.types.Scene, scripted: bool = False) -> BackendChoice:
    """Write into the materials of a scene's media which body renders them; return what was chosen.

    All are rendered by Cycles' own nodes where the scene has no choice. Where it has, those media are left to the shader that
    need anything more, with all that they may meet or share a material with; and all media where one of them splits light.

    :param scripted: a script may change any object on any frame, and while the shutter is open.
    """
    users = material_users(scene)
    reasons: dict[bpy.types.Material, str] = {}
    asking: tuple[tuple[str, str], ...] = ()
    cut = last_cut(scene) or CutReport()
    if is_native(scene):
        asking = tuple((need.name, need.reason) for need in asking_media(users, cut, surroundings.last_found(scene)))
    elif get_backend(scene) == OSL:
        reasons = dict.fromkeys(users, "as Render With says")
    elif scripted:
        reasons = dict.fromkeys(users, "may be changed by a script on any frame")
    elif users:
        found = surroundings.last_found(scene)
        reasons = _reasons(scene, users, [*find_needs(scene, cut, found), *changing_media(users, cut, found)])
    for material in users:
        _tell(material, material not in reasons)
    native = tuple(material.name for material in users if material not in reasons)
    notes = tuple(_dispersion_notes(scene)) if is_native(scene) else ()
    chosen = BackendChoice(
        native, tuple((material.name, reason) for material, reason in reasons.items()), notes, asking
    )
    _last[scene.session_uid] = chosen
    forget_gone_scenes(_last)
    return chosen


def fall_back_to_osl(scene: bpy.types.Scene) -> None:
    """Leave all media of a scene to the shader until they are told again what surrounds them, if renders run it."""
    if not is_native(scene):
        _leave_to_shader(scene)


def choose_for_file(scene: bpy.types.Scene) -> None:
    """Leave all media of a scene that is saved to whichever body its renderer can run, unless that would be the wrong one.

    So whoever appends or links them, or renders them elsewhere, finds media that can ask.
    """
    if not (is_native(scene) and scene.cycles.shading_system):
        _leave_to_shader(scene)


def _leave_to_shader(scene: bpy.types.Scene) -> None:
    """Let the shader render all media of a scene where it runs."""
    for material in material_users(scene):
        _tell(material, False)


def _reasons(scene: bpy.types.Scene, users: MaterialUsers, needs: Sequence[Need]) -> dict[bpy.types.Material, str]:
    """Return why materials are left to the shader; what is not named is not."""
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
    for group in _materials_that_may_meet(scene, users):
        cause = next((each for each in group if each.name in own), None)
        if cause is not None:
            reasons |= {each: own.get(each.name, f"may meet {cause.name!r}, which is") for each in group}
    return {material: reasons[material] for material in users if material in reasons}


def _materials_that_may_meet(scene: bpy.types.Scene, users: MaterialUsers) -> Iterator[list[bpy.types.Material]]:
    """Yield sets of materials whose objects may meet."""
    objects = list(dict.fromkeys(obj for each in users.values() for obj in each))
    own = set(scene.objects)
    instances = scene.view_layers[0].depsgraph.object_instances
    anywhere = {instance.object.original for instance in instances if instance.is_instance}
    anywhere |= {obj for obj in objects if obj not in own or stability.may_change(obj)}
    touching = touching_media(objects, anywhere)
    for members in users.values():
        for one, other in pairwise(members):
            touching[one].append(other)
            touching[other].append(one)
    for group in connected_groups(objects, touching):
        members = set(group)
        yield [material for material, found in users.items() if not members.isdisjoint(found)]


def _tell(material: bpy.types.Material, native: bool) -> None:
    """Write into a local material whether Cycles' own nodes render it."""
    node = rendered_node(material)
    socket = node.inputs.get(NATIVE_SOCKET)
    if material.library is None and node.id_data == material.node_tree and socket is not None and is_plugged(node):
        if socket.default_value != native:
            socket.default_value = native


def _dispersion_notes(scene: bpy.types.Scene) -> Iterator[str]:
    """Yield how far the indices of media in which Cycles itself splits light are off their own, in sentences."""
    for material in dispersing_materials(scene) if bpy.app.version >= NATIVE_DISPERSION_VERSION else ():
        node = rendered_node(material)
        curve = {name: get_parameter(node, BY_KEYWORD[name]) for name in _CURVE}
        yield (
            f"{material.name!r} splits light by Cycles' own dispersion, whose index is up to {abbe_deviation(curve):.2g} off "
            "the medium's own between 380 and 780 nm"
        )


_CURVE = ("ior", "dispersion_model", "abbe", "sellmeier_b", "sellmeier_c", "dispersion")
"""Keywords of the parameters that make a medium's index a function of the wavelength."""
