"""Rendering media as surfaces that are cut where they cross, while the artist's own objects stay as they are.

Beside each medium that may cross others stands an object that shows its surface as far as it exists
(:mod:`nested_dielectric.cutting_nodes`). It reads the artist's object, which is hidden from renders only, and is evaluated
with the scene: what moves, deforms or is exchanged is cut as it is then. All of these objects live in one collection.

Media that cannot be cut, and all that they may meet, are rendered as ever: they ask the scene.
"""

from __future__ import annotations

from hashlib import sha256

import bpy
import numpy as np

from ..analysis import analysis
from ..analysis.changes import plain
from ..nodes.animation import curves
from ..nodes.compatibility import is_native
from ..nodes.cutting_nodes import (
    BODY_INPUT,
    CUT_GROUP,
    CUT_INPUT,
    END_INPUT,
    FRAME_INPUT,
    OWN_INPUT,
    PART,
    SURFACE_INPUTS,
    Plan,
    ensure_kept_tree,
    ensure_part_tree,
    ensure_surface_tree,
    make_cut_tree,
    told_layers,
    value_name,
    values_of,
)
from ..nodes.native_nodes import TELLS_COLOUR, TELLS_DISPERSION
from ..nodes.node_group import CUT, VERSION_PROPERTY
from ..scene import rays
from ..scene.materials import dielectric_node
from ..scene.media import CUT_OF, CUT_SETTING, HIDDEN_BY_CUT
from ..scene.shapes import content_of
from .cutting_plan import Cut, is_in_use, make_plan

COLLECTION = "Nested Dielectric Cut"
SUFFIX = " (cut)"
"""Behind a medium's name: the object that shows its surface."""

HOLDER = "all"
"""In place of a medium: an object that shows none."""

PLAN = "nd_plan"
"""Custom property of the object that cuts: what its nodes were made from."""

KEPT = "nd_kept"
"""Another: what the cut that is kept in the file was made from."""

ALIKE = (
    *rays.SETTINGS,
    "is_holdout",
    "is_shadow_catcher",
    "pass_index",
    "color",
    "lightgroup",
    "shadow_terminator_normal_offset",
    "shadow_terminator_geometry_offset",
    "shadow_terminator_shading_offset",
)
ALIKE_IN_CYCLES = (
    "use_motion_blur",
    "motion_steps",
    "use_camera_cull",
    "use_distance_cull",
    "ao_distance",
    "is_caustics_caster",
    "is_caustics_receiver",
)
"""What a render makes of an object beside its shape."""


def is_set_to_cut(scene: bpy.types.Scene) -> bool:
    """Tell whether the artist wants a scene's surfaces cut where media cross: a setting of the scene."""
    return bool(scene.get(CUT_SETTING))


def is_cut(scene: bpy.types.Scene) -> bool:
    """Tell whether a scene's surfaces are cut where media cross: by its setting, or because Cycles' own nodes render all media,
    which cannot ask.
    """
    return is_set_to_cut(scene) or (is_native(scene) and any(VERSION_PROPERTY in tree for tree in bpy.data.node_groups))


def is_shown(scene: bpy.types.Scene) -> bool:
    """Tell whether renders of a scene show any surfaces in place of media."""
    return _find_collection(scene) is not None


def set_cut(scene: bpy.types.Scene, cut: bool) -> None:
    """Render the media of a scene as surfaces that are cut where they cross, or as they are, as far as they can ask.

    Nothing of the artist's is changed but that media are hidden from renders, which goes back.
    """
    if cut:
        scene[CUT_SETTING] = True
    else:
        scene.pop(CUT_SETTING, None)
        end_cut(scene)


def cut_surfaces(scene: bpy.types.Scene, scripted: bool = False) -> Cut:
    """Make what renders show of a scene that is cut, or bring it up to date; return what was found.

    :param scripted: a script may change any object on any frame.
    """
    plan, found = make_plan(scene, scripted, is_native(scene))
    _show(scene, plan)
    _drop_if_changed(scene, plan)
    show_strays()
    _last[scene.session_uid] = found, _settings(scene)
    return found


def end_cut(scene: bpy.types.Scene) -> None:
    """Let renders show the artist's own objects again if the scene is not cut any more."""
    if is_cut(scene):
        return
    if is_shown(scene):
        _clear(scene)
    _last.pop(scene.session_uid, None)


_last: dict[int, tuple[Cut, tuple]] = {}
"""What was found of each scene in this session, by its number, and with which settings."""


def last_cut(scene: bpy.types.Scene) -> Cut | None:
    """Return what was last found of a scene that is cut; None if it is not, or nobody has looked in this session."""
    return _last[scene.session_uid][0] if is_cut(scene) and scene.session_uid in _last else None


def _settings(scene: bpy.types.Scene) -> tuple:
    """Settings of a scene by which media are cut or not."""
    return scene.render.use_motion_blur, scene.render.motion_blur_shutter > 0.0, is_native(scene)


def show_whole(scene: bpy.types.Scene) -> bool:
    """Take the setting and all that shows surfaces away; return whether there was any."""
    was_cut = is_set_to_cut(scene) or is_shown(scene)
    scene.pop(CUT_SETTING, None)
    _clear(scene)
    _last.pop(scene.session_uid, None)
    return was_cut


def _clear(scene: bpy.types.Scene) -> None:
    if CUT in scene:
        del scene[CUT]
        scene.update_tag()
    collection = _find_collection(scene)
    if collection is not None:
        for obj in list(collection.objects):
            _remove(obj)
        bpy.data.collections.remove(collection)
    for obj in scene.objects:
        _unhide(obj)


def keep_in_file(scene: bpy.types.Scene, scripted: bool = False) -> str:
    """Keep the cut of the present frame in the file, so that whoever renders this frame has nothing to cut; other frames are
    cut as ever. :func:`forget_kept` takes it back. Returns why that cannot be, or nothing.
    """
    shown = surfaces_of(scene)
    plan, _ = make_plan(scene, scripted, is_native(scene))
    if not shown or _holder(scene).get(PLAN) != _described(plan):
        return "nothing is cut, or something has changed since; press Prepare Scene"
    if scene.render.use_simplify:
        return "Simplify may show other shapes in a render"
    different = [obj.name for obj in shown if not all(map(analysis.is_same_in_renders, obj.modifiers))]
    if different:
        return f"{analysis.listed(tuple(different))} has modifiers that do otherwise in renders"
    forget_kept(scene)
    layer = scene.view_layers[0]
    hidden = {surface: surface.hide_viewport for surface in shown.values()}
    for surface in hidden:
        surface.hide_viewport = False
        surface.hide_set(False, view_layer=layer)
    layer.update()
    for surface in hidden:
        evaluated = surface.evaluated_get(layer.depsgraph)
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=layer.depsgraph)
        mesh.use_auto_texspace = False
        mesh.texspace_location, mesh.texspace_size = evaluated.data.texspace_location, evaluated.data.texspace_size
        exchange_mesh(surface, mesh)
        _exchange_tree(surface.modifiers[0], ensure_kept_tree())
        _set_inputs(surface.modifiers[0], {FRAME_INPUT: scene.frame_current})
        surface.hide_viewport = hidden[surface]
    _holder(scene)[KEPT] = _state(scene, plan)
    return ""


def is_kept(scene: bpy.types.Scene) -> bool:
    """Tell whether the cut of one frame is kept in the file."""
    holder = _holder(scene)
    return holder is not None and KEPT in holder


def forget_kept(scene: bpy.types.Scene) -> bool:
    """Cut every frame as it is rendered; return whether one was kept."""
    was_kept = is_kept(scene)
    for obj, surface in surfaces_of(scene).items() if was_kept else ():
        _exchange_tree(surface.modifiers[0], ensure_surface_tree())
        exchange_mesh(surface, bpy.data.meshes.new(surface.name))
        liken(surface, obj)
    if was_kept:
        del _holder(scene)[KEPT]
    return was_kept


def _drop_if_changed(scene: bpy.types.Scene, plan: Plan) -> None:
    """Forget what is kept of a scene once it is not what would be cut."""
    if is_kept(scene) and _holder(scene)[KEPT] != _state(scene, plan):
        forget_kept(scene)


def _state(scene: bpy.types.Scene, plan: Plan) -> str:
    """What a plan's cut depends on on the present frame, as a short text: shapes, places and all that faces carry."""
    state = sha256(_described(plan).encode())
    depsgraph = scene.view_layers[0].depsgraph
    for obj in plan.numbers():
        state.update(np.ascontiguousarray(obj.matrix_world))
        state.update(content_of(obj.evaluated_get(depsgraph).data))
    for place in sorted(told_layers(plan)):
        inputs = dielectric_node(plan.layers[place].material).inputs
        state.update(
            repr([_plain_value(inputs[name].default_value) for name in values_of(plan.layers[place])]).encode()
        )
    return state.hexdigest()


def _plain_value(value):
    return value if isinstance(value, (bool, int, float)) else tuple(value)


def surfaces_of(scene: bpy.types.Scene) -> dict[bpy.types.Object, bpy.types.Object]:
    """The objects that show media in renders, by the media."""
    collection = _find_collection(scene)
    found = collection.objects if collection is not None else ()
    return {obj[CUT_OF]: obj for obj in found if isinstance(obj.get(CUT_OF), bpy.types.Object)}


def _holder(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """The object whose modifier cuts."""
    collection = _find_collection(scene)
    return next((obj for obj in collection.objects if PLAN in obj), None) if collection is not None else None


def exchange_mesh(surface: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    before, surface.data = surface.data, mesh
    bpy.data.meshes.remove(before)


def _exchange_tree(modifier: bpy.types.NodesModifier, tree: bpy.types.NodeTree) -> None:
    values = {name: _input_of(modifier, name).value for name in SURFACE_INPUTS}
    before, modifier.node_group = modifier.node_group, tree
    _set_inputs(modifier, values)
    _remove_tree(before)


def show_strays() -> None:
    """Let renders show media that are hidden in favour of surfaces that are not there."""
    shown = {obj for scene in bpy.data.scenes for obj in surfaces_of(scene)}
    for obj in bpy.data.objects:
        if obj not in shown:
            _unhide(obj)


_CONCERNED = (
    bpy.types.Object,
    bpy.types.Mesh,
    bpy.types.Material,
    bpy.types.ShaderNodeTree,
    bpy.types.Collection,
)


def concerns(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Tell whether an update may change which media of a scene that is cut cross, or how they are shown. To select does not, nor
    do cut surfaces that follow.
    """
    if not is_cut(scene):
        return is_shown(scene)
    known = _last.get(scene.session_uid)
    if known is None or known[1] != _settings(scene):
        return True
    changed = {
        update.id.original
        for update in depsgraph.updates
        if isinstance(update.id, _CONCERNED)
        and (update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading)
    }
    return bool(changed) and not changed <= {
        each for surface in surfaces_of(scene).values() for each in (surface, surface.data)
    }


# Showing ------------------------------------------------------------------------------------------------------------


def _find_collection(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """The collection of the scene's own that holds what renders show in place of media."""
    return next((each for each in scene.collection.children if CUT_OF in each and each.library is None), None)


def _ensure_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    collection = _find_collection(scene)
    if collection is None:
        collection = bpy.data.collections.new(COLLECTION)
        collection[CUT_OF] = True
        collection.hide_select = True
        scene.collection.children.link(collection)
    shown = [
        each for layer in scene.view_layers for each in layer.layer_collection.children if each.collection == collection
    ]
    for owner, names in (
        (collection, ("hide_render",)),
        *((each, ("exclude", "holdout", "indirect_only")) for each in shown),
    ):
        for name in names:
            if getattr(owner, name):
                setattr(owner, name, False)
    return collection


def _show(scene: bpy.types.Scene, plan: Plan) -> None:
    """Let renders show what a plan cuts in place of the artist's objects."""
    if not plan.layers:
        _clear(scene)
        return
    tells = _tells(plan)
    if scene.get(CUT) != tells:
        scene[CUT] = tells
        scene.update_tag()
    numbers = plan.numbers()
    collection = _ensure_collection(scene)
    surfaces = {}
    for obj in list(collection.objects):
        source = obj.get(CUT_OF)
        if source in numbers and source not in surfaces:
            surfaces[source] = obj
        elif source != HOLDER:
            _remove(obj)
    for obj in scene.objects:
        if HIDDEN_BY_CUT in obj and obj not in numbers:
            _unhide(obj)
    holder, *parts = _ensure_holders(collection, len(numbers))
    _ensure_nodes(holder, plan)
    for place, part in enumerate(parts):
        part.modifiers[0].node_group = ensure_part_tree()
        _set_inputs(part.modifiers[0], {CUT_INPUT: holder, BODY_INPUT: place * PART, END_INPUT: (place + 1) * PART})
    tree = ensure_surface_tree()
    for obj, number in numbers.items():
        if obj not in surfaces:
            surfaces[obj] = _new_surface(obj, collection, tree)
        surface = surfaces[obj]
        source = parts[number // PART] if parts else holder
        _set_inputs(surface.modifiers[0], {OWN_INPUT: obj, CUT_INPUT: source, BODY_INPUT: number})
        liken(surface, obj)
        if HIDDEN_BY_CUT not in obj:
            obj[HIDDEN_BY_CUT] = True
        if not obj.hide_render:
            obj.hide_render = True
    _link_lights(surfaces)


def _tells(plan: Plan) -> float:
    """What the faces of a plan's surfaces tell at most of the media outside: their index, colour, or dispersion."""
    nodes = [
        dielectric_node(plan.layers[place].material) for place in told_layers(plan) if plan.layers[place].tells_more
    ]
    if any(is_in_use(node, "Disperse") for node in nodes):
        return TELLS_DISPERSION
    return TELLS_COLOUR if nodes else 1.0


def _ensure_holders(collection: bpy.types.Collection, media: int) -> list[bpy.types.Object]:
    """The object whose modifier cuts, and where there are many media one for each part of them. They are nowhere seen."""
    count = 1 + (-(-media // PART) if media > PART else 0)
    holders = sorted((obj for obj in collection.objects if obj.get(CUT_OF) == HOLDER), key=lambda obj: PLAN not in obj)
    for obj in holders[count:]:
        _remove(obj)
    while len(holders) < count:
        holder = bpy.data.objects.new(COLLECTION, bpy.data.meshes.new(COLLECTION))
        holder[CUT_OF] = HOLDER
        holder.hide_render = holder.hide_viewport = holder.hide_select = True
        holder.modifiers.new(CUT_GROUP, "NODES")
        collection.objects.link(holder)
        holders.append(holder)
    return holders[:count]


def _ensure_nodes(holder: bpy.types.Object, plan: Plan) -> None:
    """Give the object that cuts the nodes of a plan, and drivers that bring what materials say now."""
    described = _described(plan)
    modifier = holder.modifiers[0]
    if holder.get(PLAN) == described and modifier.node_group is not None:
        return
    holder.animation_data_clear()
    before, modifier.node_group = modifier.node_group, None
    _remove_tree(before)
    modifier.node_group = make_cut_tree(plan)
    holder[PLAN] = described
    for place in told_layers(plan):
        for name in values_of(plan.layers[place]):
            _drive(holder, modifier, value_name(name, place), plan.layers[place].material, name)


def _described(plan: Plan) -> str:
    """What a plan's nodes depend on, as a short text."""
    text = repr(
        (
            [
                (
                    layer.priority,
                    layer.material.name_full,
                    [obj.name_full for obj in layer.crossing],
                    [(obj.name_full, around) for obj, around in layer.constant],
                    layer.overlapping,
                    layer.tells_more,
                    layer.keeps_hidden,
                )
                for layer in plan.layers
            ],
            sorted(plan.pairs),
            plan.may_part,
            sorted((obj.name_full, names) for obj, names in plan.attributes.items()),
        )
    )
    return sha256(text.encode()).hexdigest()


def _drive(
    holder: bpy.types.Object, modifier: bpy.types.NodesModifier, name: str, material: bpy.types.Material, socket: str
) -> None:
    """Let an input of a modifier be what a material's socket is, without a script."""
    identifier = modifier.node_group.interface.items_tree[name].identifier
    path = f'modifiers["{modifier.name}"].properties.inputs.{identifier}.value'
    node = dielectric_node(material)
    _drive_by(holder, path, material, f'node_tree.nodes["{node.name}"].inputs["{socket}"].default_value')


def _drive_by(owner: bpy.types.Object, path: str, source: bpy.types.ID, source_path: str) -> None:
    """Let a property be what another data-block's is, part by part."""
    value = source.path_resolve(source_path)
    for part in [-1] if isinstance(value, (bool, int, float)) else range(len(value)):
        driver = owner.driver_add(path, part).driver
        driver.type = "SUM"
        target = driver.variables.new().targets[0]
        target.id_type = source.id_type
        target.id = source
        target.data_path = source_path if part < 0 else f"{source_path}[{part}]"


def _set_inputs(modifier: bpy.types.NodesModifier, values: dict) -> None:
    for name, value in values.items():
        socket = _input_of(modifier, name)
        if socket.value != value:
            socket.value = value
            modifier.id_data.update_tag()


def _input_of(modifier: bpy.types.NodesModifier, name: str) -> bpy.types.bpy_struct:
    tree = modifier.node_group.interface.items_tree
    socket = next(item for item in tree if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name == name)
    return getattr(modifier.properties.inputs, socket.identifier)


def _new_surface(obj: bpy.types.Object, collection: bpy.types.Collection, tree: bpy.types.NodeTree) -> bpy.types.Object:
    """An object that shows a medium's surface, where the medium is."""
    name = obj.name + SUFFIX
    surface = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    surface[CUT_OF] = obj
    surface.parent = obj
    surface.hide_viewport = surface.hide_select = True
    for slot in obj.material_slots:
        surface.data.materials.append(slot.material)
    collection.objects.link(surface)
    surface.modifiers.new(COLLECTION, "NODES").node_group = tree
    return surface


def liken(surface: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Make a render treat the surface as the medium itself."""
    animated = {curve.data_path for curve in curves(obj.animation_data)}
    for owner, source, names in ((surface, obj, ALIKE), (surface.cycles, obj.cycles, ALIKE_IN_CYCLES)):
        for name in names:
            if name not in owner.bl_rna.properties:
                continue
            value = rays.is_seen(obj, name) if name in rays.SETTINGS else getattr(source, name)
            before = getattr(owner, name)
            if value != before and (isinstance(value, (bool, int, float, str)) or tuple(value) != tuple(before)):
                setattr(owner, name, value)
    if not surface.name.startswith(obj.name + SUFFIX):
        surface.name = obj.name + SUFFIX
    while len(surface.data.materials) < len(obj.material_slots):
        surface.data.materials.append(None)
    for own, slot in zip(surface.material_slots, obj.material_slots):
        if own.link != slot.link or own.material != slot.material:
            own.link = slot.link
            own.material = slot.material
    own = {key: plain(obj[key]) for key in obj.keys() if key != HIDDEN_BY_CUT}
    for key in surface.keys() - own.keys() - {CUT_OF}:
        del surface[key]
    for key, value in own.items():
        if key not in surface or plain(surface[key]) != value:
            surface[key] = value
    for path in animated:
        if path in ALIKE or path.startswith('["'):
            _follow(surface, obj, path)
    for linking in ("receiver_collection", "blocker_collection"):
        if getattr(surface.light_linking, linking) != getattr(obj.light_linking, linking):
            setattr(surface.light_linking, linking, getattr(obj.light_linking, linking))


def _follow(surface: bpy.types.Object, obj: bpy.types.Object, path: str) -> None:
    """Let a property of the surface be what the medium's is on each frame."""
    if not any(curve.data_path == path for curve in curves(surface.animation_data)):
        _drive_by(surface, path, obj, path)


def _link_lights(surfaces: dict[bpy.types.Object, bpy.types.Object]) -> None:
    """Put the surfaces of media into the collections by which lights single these out."""
    for collection in _linking_collections():
        members = set(collection.objects)
        for obj in members & surfaces.keys():
            if surfaces[obj] not in members:
                collection.objects.link(surfaces[obj])
            states = dict(zip(collection.objects, collection.collection_objects))
            states[surfaces[obj]].light_linking.link_state = states[obj].light_linking.link_state


def _linking_collections() -> set[bpy.types.Collection]:
    roots = {
        collection
        for each in bpy.data.objects
        for collection in (each.light_linking.receiver_collection, each.light_linking.blocker_collection)
        if collection is not None
    }
    return {each for root in roots for each in (root, *root.children_recursive)}


def _unhide(obj: bpy.types.Object) -> None:
    if HIDDEN_BY_CUT in obj:
        rays.show(obj)
        del obj[HIDDEN_BY_CUT]
        obj.hide_render = False


def _remove(obj: bpy.types.Object) -> None:
    """Take an object of the collection away, with what is its own."""
    data = obj.data
    trees = [modifier.node_group for modifier in obj.modifiers]
    bpy.data.objects.remove(obj)
    if isinstance(data, bpy.types.Mesh) and not data.users:
        bpy.data.meshes.remove(data)
    for tree in trees:
        _remove_tree(tree)


def _remove_tree(tree: bpy.types.NodeTree | None) -> None:
    """Remove a group that nobody uses, and those in it."""
    if tree is None or tree.users or tree.library is not None:
        return
    inner = [node.node_tree for node in tree.nodes if node.type == "GROUP"]
    bpy.data.node_groups.remove(tree)
    for each in dict.fromkeys(inner):
        _remove_tree(each)
