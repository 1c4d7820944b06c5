"""What the pictures of the open file need and it does not hold: files that are missing or cannot be packed, and simulations."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import bpy

from .whole_file import shader_trees

SEND = "send it along and use --keep-outside"


@dataclass(frozen=True)
class Lack:
    """Something that a file does not hold.

    :param name: of what needs it; text: what it lacks, after the name; remedy: what to do about it.
    :param file: the path as Blender has it; empty where there is none.
    """

    name: str
    text: str
    remedy: str
    file: str = ""

    def __str__(self) -> str:
        return f"{self.name!r} {self.text}; {self.remedy}"


def find_lacks() -> list[Lack]:
    """Return what scenes of the open file need and it does not hold, after all that can be packed is."""
    shown = _shown_data()
    found = [lack for data in shown for lack in _lacks_of(data)]
    found += [lack for owner, tree in shader_trees() if owner in shown for lack in _lacks_of_nodes(owner, tree)]
    return sorted(set(found), key=lambda lack: (lack.name, lack.text, lack.file))


def _shown_data() -> set[bpy.types.ID]:
    """Return all data that the scenes of the open file use, but for pictures that only viewports show."""
    uses = defaultdict(list)
    for data, owners in bpy.data.user_map().items():
        for owner in owners:
            if not isinstance(owner, bpy.types.Camera):
                uses[owner].append(data)
    shown: set[bpy.types.ID] = set()
    ahead: list[bpy.types.ID] = list(bpy.data.scenes)
    while ahead:
        data = ahead.pop()
        if data not in shown:
            shown.add(data)
            ahead += uses[data] if getattr(data, "type", "") != "EMPTY" or data.instance_collection else ()
    return shown


def _lacks_of(data: bpy.types.ID) -> Iterator[Lack]:
    """Yield what some data lack by themselves."""
    if data.is_missing:
        path = data.library.filepath
        yield Lack(
            data.name, f"is linked from {path}, which lacks it", "find that file, or remove what is linked", path
        )
    elif isinstance(data, bpy.types.Object):
        yield from _lacks_of_object(data)
    elif isinstance(data, bpy.types.Scene):
        yield from _lacks_of_scene(data)
    elif isinstance(data, bpy.types.Volume):
        if data.filepath:  # also where Blender has packed the file, which it does not read from there
            yield _lack_of_file(data.name, data.filepath, "a volume, which cannot be packed")
    elif isinstance(data, (bpy.types.Image, bpy.types.MovieClip, bpy.types.CacheFile, bpy.types.VectorFont)):
        for path in bpy.data.file_path_map(subset={data})[data]:
            yield _lack_of_file(
                data.name, path, _KINDS.get(getattr(data, "source", ""), "a file that cannot be packed")
            )


_KINDS = {"SEQUENCE": "pictures one by one, which cannot be packed", "MOVIE": "a movie, which cannot be packed"}
"""What else than a single file images and clips show, by their source."""


def _lack_of_file(name: str, path: str, what: str, remedy: str = SEND) -> Lack:
    """Return what is lacking of a file that is not packed: all of it, or its place in the .blend."""
    if os.path.exists(bpy.path.abspath(path)):
        return Lack(name, f"shows {what}: {path}", remedy, path)
    return Lack(name, f"needs a file that is not there: {path}", "find it, or choose another", path)


def _lacks_of_nodes(owner: bpy.types.ID, tree: bpy.types.NodeTree) -> Iterator[Lack]:
    """Yield the files that shader nodes need."""
    for node in tree.nodes:
        if node.type == "SCRIPT" and node.mode == "EXTERNAL" and node.filepath:
            what = f"what the node {node.name!r} runs"
            yield _lack_of_file(owner.name, node.filepath, what, f"make it internal, or {SEND}")
        elif node.type == "TEX_IES" and node.mode == "EXTERNAL" and node.filepath:
            yield _lack_of_file(owner.name, node.filepath, "a light distribution")


def _lacks_of_scene(scene: bpy.types.Scene) -> Iterator[Lack]:
    """Yield what a scene's strips and its rigid bodies lack."""
    if scene.render.use_sequencer and scene.sequence_editor is not None:
        for strip in scene.sequence_editor.strips_all:
            if strip.type in ("IMAGE", "MOVIE"):
                path = strip.filepath if strip.type == "MOVIE" else strip.directory
                yield _lack_of_file(scene.name, path, f"the strip {strip.name!r}, which cannot be packed")
    world = scene.rigidbody_world
    if world is not None and world.enabled and world.collection is not None and _is_animation(scene):
        yield from _lacks_of_cache(scene.name, "rigid bodies", world.point_cache)


def _is_animation(scene: bpy.types.Scene) -> bool:
    return scene.frame_end > scene.frame_start


BAKE = "bake it into the file (Physics > Cache), or apply it"


def _lacks_of_cache(name: str, what: str, cache: bpy.types.PointCache) -> Iterator[Lack]:
    """Yield what is lacking of a simulation's cache."""
    if cache.use_disk_cache or cache.use_external:
        yield Lack(name, f"has its {what} in files beside the .blend", f"switch Disk Cache off and bake, or {SEND}")
    elif not cache.is_baked:
        yield Lack(name, f"has {what} that are not baked: machines that begin on a later frame show others", BAKE)


def _lacks_of_object(obj: bpy.types.Object) -> Iterator[Lack]:
    """Yield what an object's modifiers, particles and simulations lack."""
    moves = any(map(_is_animation, bpy.data.scenes))
    for modifier in obj.modifiers:
        if modifier.show_render:
            yield from _lacks_of_modifier(obj, modifier, moves)
    for system in obj.particle_systems:
        if moves and system.settings.type == "EMITTER" and system.settings.physics_type != "NO":
            yield from _lacks_of_cache(obj.name, "particles", system.point_cache)


def _lacks_of_modifier(obj: bpy.types.Object, modifier: bpy.types.Modifier, moves: bool) -> Iterator[Lack]:
    """Yield what a modifier lacks.

    :param moves: other frames than one are rendered.
    """
    match modifier.type:
        case "MESH_CACHE":
            yield _lack_of_file(obj.name, modifier.filepath, "a mesh cache, which cannot be packed")
        case "OCEAN" if modifier.is_cached:
            yield _lack_of_file(obj.name, modifier.filepath, "a baked ocean, which cannot be packed")
        case "FLUID" if modifier.fluid_type == "DOMAIN":
            path = modifier.domain_settings.cache_directory
            yield _lack_of_file(
                obj.name, path, "a fluid's cache, which cannot be packed", f"turn it into meshes, or {SEND}"
            )
        case "CLOTH" | "SOFT_BODY" if moves:
            yield from _lacks_of_cache(obj.name, f"shapes of {modifier.name}", modifier.point_cache)
        case "NODES" if modifier.bake_target == "DISK" and modifier.bakes:
            yield Lack(
                obj.name, f"has bakes of {modifier.name} in files beside the .blend", f"bake them as Packed, or {SEND}"
            )
