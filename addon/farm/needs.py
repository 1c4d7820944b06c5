"""What a machine must have to render the open file as it is meant: Blender, Open Shading Language, device, scripts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import bpy

from ..analysis.surroundings import last_found
from ..cutting.cut_plan import CutReport
from ..cutting.cut_scene import last_cut
from ..cutting.needs import Need, find_needs, material_users, unchanging_values
from ..model.effects import limits_at_work
from ..nodes.animation import curves
from ..nodes.compatibility import MINIMUM_VERSION, NATIVE_DISPERSION_VERSION
from ..nodes.render_settings import engine_name
from ..nodes.render_with import is_native
from ..scene.debug_views import debug_notice
from ..scene.materials import may_disperse, medium_material, rendered_node
from ..scene.media import dispersing_materials, is_rendered, media
from ..scene.scripts import frame_scripts

VERSIONS = ("5.2", "5.3")
"""Blenders that render media, by the first two numbers of their versions (tests hold it to `compatibility`)."""


@dataclass(frozen=True)
class SceneNeeds:
    """What a machine must have for one scene.

    :param versions: of Blender, the first two numbers of each; engine: its name.
    :param osl: sentences of why media need Open Shading Language on the CPU; empty where they do not.
    :param frames: the first, the last and the step; output: where pictures go; format: which kind.
    :param notes: what else there is to know, in sentences.
    """

    scene: str
    engine: str
    versions: tuple[str, ...]
    osl: tuple[str, ...]
    frames: tuple[int, int, int]
    output: str
    format: str
    notes: tuple[str, ...] = ()

    @property
    def devices(self) -> tuple[str, ...]:
        """Devices that show what is meant."""
        return ("CPU",) if self.osl else ("CPU", "GPU")

    def as_json(self) -> dict[str, Any]:
        """Return it in JSON's types."""
        return asdict(self) | {"devices": self.devices}

    def __str__(self) -> str:
        first, last, step = self.frames
        by = f" by {step}" if step > 1 else ""
        lines = [f"Blender {' or '.join(self.versions)}, {self.engine}"]
        if self.osl:
            lines += [
                "Open Shading Language on the CPU; elsewhere media show magenta",
                *(f"because {each}" for each in self.osl),
            ]
        else:
            lines.append("CPU or GPU")
        lines.append(f"frames {first} to {last}{by}, {self.format}, to {self.output}")
        return "\n".join(f"{self.scene}: {line}" for line in [*lines, *self.notes])


def needs_of(scene: bpy.types.Scene) -> SceneNeeds:
    """Return what a machine must have to render a scene that is prepared."""
    render = scene.render
    return SceneNeeds(
        scene.name,
        engine_name(render.engine),
        _versions(scene),
        tuple(map(str, shader_needs(scene))),
        (scene.frame_start, scene.frame_end, scene.frame_step),
        render.filepath,
        render.image_settings.file_format,
        tuple(_notes(scene)),
    )


def shader_needs(scene: bpy.types.Scene) -> list[Need]:
    """Return why only the shader renders media of a scene as it is prepared; nothing where Cycles' own nodes are to."""
    if is_native(scene) or scene.render.engine != "CYCLES":
        return []
    return [*find_needs(scene, last_cut(scene) or CutReport(), last_found(scene)), *_appearing_media(scene)]


def _appearing_media(scene: bpy.types.Scene) -> Iterator[Need]:
    """Yield media that renders do not show on the present frame, and may on others."""
    for obj in media(scene):
        if not is_rendered(obj) and any(curve.data_path == "hide_render" for curve in curves(obj.animation_data)):
            yield Need(obj.name, medium_material(obj).name, "may appear on another frame, and then must ask", True)


def _versions(scene: bpy.types.Scene) -> tuple[str, ...]:
    """Return the Blenders that render a scene as this one does: this alone where the newer one's own nodes do more."""
    if is_native(scene) and any(map(_differs, material_users(scene))):
        return (".".join(map(str, bpy.app.version[:2])),)
    return VERSIONS


def _differs(material: bpy.types.Material) -> bool:
    """Return whether Cycles' own nodes render a material otherwise in the newer of both Blenders."""
    values = unchanging_values(rendered_node(material))
    older, newer = (limits_at_work(values, version) for version in (MINIMUM_VERSION, NATIVE_DISPERSION_VERSION))
    return older != newer or may_disperse(material)


def _notes(scene: bpy.types.Scene) -> Iterator[str]:
    """Yield what else there is to know of a scene on another machine."""
    if not is_native(scene) and dispersing_materials(scene):
        yield "motion blur as the file has it: its random time carries wavelengths"
    notice = debug_notice(scene)
    if notice:
        yield notice
    names = sorted({getattr(handler, "__module__", "a script") for handler in frame_scripts()})
    if names:
        yield f"scripts change it on every frame, which must run there, too: {', '.join(names)}"


def file_notes() -> list[str]:
    """Return what of the open file runs Python, in sentences: machines leave it out unless they run a file's scripts."""
    named = [f"the text {text.name!r}, which registers itself" for text in bpy.data.texts if text.use_module]
    named += [f"the driver of {path} of {data.name!r}" for data, path in _python_drivers()]
    return [f"{each}, needs Auto Run Python Scripts there (blender -y)" for each in named]


def _python_drivers() -> Iterator[tuple[bpy.types.ID, str]]:
    """Yield the drivers of the open file that need Python: data, and the paths of what is driven."""
    for data in bpy.data.user_map():
        for owner in filter(None, (data, getattr(data, "node_tree", None))):
            animation = getattr(owner, "animation_data", None)
            for curve in animation.drivers if animation is not None else ():
                if curve.driver.type == "SCRIPTED" and not curve.driver.is_simple_expression:
                    yield data, curve.data_path
