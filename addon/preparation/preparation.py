"""Making a scene ready to render nested dielectrics, and taking that back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..analysis.analysis import Found, clear_analysis, is_analysed, last_found
from ..cutting import backends
from ..cutting.backends import Chosen
from ..cutting.cutting import Cut, is_set_to_cut, set_cut, show_whole
from ..cutting.cutting_plan import make_plan
from ..model.parameters import ParameterError
from ..nodes.compatibility import (
    NATIVE,
    OSL,
    achromatic_reason,
    get_backend,
    has_osl,
    is_native,
    require_blender,
    set_backend,
)
from ..nodes.trees import complete_nodes, dielectric_places, mend_nodes
from ..scene import settings
from ..scene.lights import update_lights
from ..scene.materials import refresh_spectrum
from ..scene.media import all_objects, dispersing_materials, media
from ..scene.settings import (
    DEVICE,
    MOTION_BLUR,
    OSL_SWITCH,
    RANDOM_TIME,
    ROLLING_SHUTTER,
    SHUTTER,
    SHUTTER_CURVE,
    Changed,
)
from .checks import Problem, find_problems
from .live import analyse, choose_bodies, frame_scripts, update_cut
from .parting import join_parted, part_coincident
from .report import Report, forget_report, keep_report, last_report
from .versions import mend_materials, version_problems

NO_MEDIA = "No media: assign a preset first"


@dataclass(frozen=True)
class Preparation:
    """What :func:`prepare` changed, in sentences, the problems it found and left, what the media of the scene now know of
    each other, how many media there are, which of them are rendered cut, and which body of their materials renders them.
    """

    changes: tuple[str, ...]
    problems: tuple[Problem, ...]
    found: Found = Found()
    media: int = 0
    cut: Cut = Cut()
    chosen: Chosen = Chosen()

    @property
    def headline(self) -> str:
        """In one line whether the scene is ready."""
        return headline(self.media, len(self.problems))

    def __str__(self) -> str:
        lines = [self.headline]
        lines += [f"changed: {change}" for change in self.changes] or ["nothing to change"]
        lines += [f"rendered: {line}" for line in str(self.chosen).splitlines()]
        lines += [f"cut: {line}" for line in str(self.cut).splitlines()]
        lines += [f"analysis: {line}" for line in str(self.found).splitlines()]
        return "\n".join(lines + [f"warning: {problem}" for problem in self.problems])


def headline(media: int, problems: int) -> str:
    """Return in one line whether a scene with some media and problems is ready to render."""
    if problems:
        return f"{problems} problem{'s' * (problems != 1)} to look at before rendering"
    return "Ready to render" if media else NO_MEDIA


def prepare(scene: bpy.types.Scene, cut: bool | None = None, backend: str | None = None) -> Preparation:
    """Set what a scene needs to render nested dielectrics, and look for problems with its media.

    Cycles, and enough bounces; Open Shading Language on the CPU where media need it; where a medium disperses by it, the motion
    blur that carries the wavelengths, with a shutter of 0 unless it is in use, and spectral tables in the file's working space;
    where none does any more, what all that was before; the lamps that direct refraction and reflection carry; and what
    surrounds each medium, so that it need not ask the scene.
    Larger limits stay. A second call changes nothing. Without media nothing is changed, but what an earlier call has set
    goes back. :func:`put_back` takes it back.

    :param cut: render surfaces cut where media cross, which is fastest and costs the time of cutting them on each frame, or
        render the objects as they are; None leaves the scene's own setting. Cycles' own nodes alone always need it.
    :param backend: ``"AUTO"`` renders with Cycles' own nodes on the GPU and without Open Shading Language, else with both in one
        picture; ``"OSL"`` with the shader alone, on the CPU; ``"NATIVE"`` with Cycles' own nodes alone; None leaves the
        scene's own setting.
    :raises UnsupportedError: if this Blender cannot.
    :raises ParameterError: for another backend.
    """
    require_blender()
    if backend is not None:
        set_backend(scene, backend)
    if cut is not None and cut != is_set_to_cut(scene):
        set_cut(scene, cut)
    report = last_report(scene)
    changed = dict(report.settings) if report is not None else {}
    stays = _mend() if _holds_media(scene) else []
    if media(scene):
        preparation = _prepare(scene, changed, stays)
    else:
        back = settings.go_back(scene, changed)
        preparation = Preparation(
            tuple(stays + back), tuple(version_problems() + find_problems(scene)), cut=update_cut(scene)
        )
    keep_report(scene, preparation.media, preparation.problems, stays, changed)
    return preparation


def _holds_media(scene: bpy.types.Scene) -> bool:
    """Whether there are media, or may be once materials are mended."""
    materials = {
        slot.material for obj in all_objects(scene) for slot in obj.material_slots if slot.material is not None
    }
    return any(material.node_tree is not None and dielectric_places(material) for material in materials)


def _mend() -> list[str]:
    changes = list(mend_materials())
    for material in bpy.data.materials:
        changes += mend_nodes(material) + complete_nodes(material)
    return changes


def _prepare(scene: bpy.types.Scene, changed: Changed, stays: list[str]) -> Preparation:
    """Prepare a scene that has media.

    :param changed: settings that have been changed before; stays: changes that :func:`put_back` leaves; both are brought up
        to date.
    """
    set_to = [(settings.ENGINE, "CYCLES")]
    set_to += [(path, max(least, settings.read(scene, path))) for path, least in settings.AT_LEAST.items()]
    changes = [each for path, value in set_to for each in settings.change(scene, changed, path, value)]
    if update_lights(scene):
        stays.append("Lamps of direct refraction and reflection: listed again")
    problems = version_problems()
    dispersing = dispersing_materials(scene)
    for material in dispersing:
        try:
            if refresh_spectrum(material):
                stays.append(f"Spectral Table of {material.name}: baked again")
        except ParameterError as error:
            problems.append(Problem(material.name, f"keeps its old spectral table, because {error}", "choose another"))
    found = analyse(scene)
    parted, coincident = part_coincident(scene)
    if parted:
        found = last_found(scene)
    changes += _ensure_osl(scene, changed)
    by_osl = dispersing and not is_native(scene)
    changes += _ensure_random_time(scene, changed) if by_osl else _end_random_time(scene, changed)
    problems += coincident + find_problems(scene)
    cut = update_cut(scene)
    chosen = choose_bodies(scene)
    problems += [Problem(need.name, need.reason, remedy) for need, remedy in backends.shortcomings(scene, cut, found)]
    return Preparation(
        tuple(stays + changes + parted), tuple(problems), found.without(cut.media), len(media(scene)), cut, chosen
    )


def _ensure_osl(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Let renders run Open Shading Language where media need it, and be as the artist has them where none does any more."""
    held = settings.held(scene, changed, (DEVICE, OSL_SWITCH))
    wanted = {path: held[path][0] if path in held else settings.read(scene, path) for path in (DEVICE, OSL_SWITCH)}
    why = _why_osl(scene, on_cpu=wanted[DEVICE] == "CPU", switched_on=wanted[OSL_SWITCH])
    if why is not None:
        wanted = {DEVICE: "CPU", OSL_SWITCH: True}
    changes = [each for path, value in wanted.items() for each in settings.change(scene, changed, path, value)]
    return [f"{each}, because {why}" if why else each for each in changes]


def _why_osl(scene: bpy.types.Scene, on_cpu: bool, switched_on: bool) -> str | None:
    """Why media of a scene need Open Shading Language on the CPU, empty where the artist says so; None if they do not, or have
    it with these settings.
    """
    backend = get_backend(scene)
    if not has_osl() or backend == NATIVE:
        return None
    if backend == OSL:
        return ""
    if on_cpu and switched_on:
        return None
    _, cut = make_plan(scene, any(frame_scripts()), native=True)
    needs = backends.find_needs(scene, cut, last_found(scene))
    return next((str(need) for need in needs if on_cpu or need.is_hard), None)


def _ensure_random_time(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Make Cycles draw a time for every path, evenly. Motion blur that is in use stays as it is."""
    changes = []
    if not scene.render.use_motion_blur:
        changes += settings.change(scene, changed, SHUTTER, 0.0)
        changes += settings.change(scene, changed, MOTION_BLUR, True)
    if achromatic_reason(scene):
        changes += settings.change(scene, changed, ROLLING_SHUTTER, "NONE")
        points = len(settings.read(scene, SHUTTER_CURVE))
        changes += settings.change(scene, changed, SHUTTER_CURVE, [1.0] * points)
    return changes


def _end_random_time(scene: bpy.types.Scene, changed: Changed) -> list[str]:
    """Let motion blur be what it was; switch off what blurs nothing, which only an older version's preparation leaves on."""
    changes = settings.go_back(scene, changed, RANDOM_TIME)
    if scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.0:
        default = scene.render.bl_rna.properties["motion_blur_shutter"].default
        changes += settings.change(scene, changed, MOTION_BLUR, False)
        changes += settings.change(scene, changed, SHUTTER, default)
    return changes


def taken_back(scene: bpy.types.Scene, report: Report) -> list[str]:
    """Return what :func:`put_back` would change of the settings, in sentences of what was and is; it takes no time."""
    return settings.sentences(scene, settings.held(scene, report.settings))


def put_back(scene: bpy.types.Scene) -> Sequence[str]:
    """Take back what :func:`prepare` has changed in a scene, as far as it still is as it was set; return what was changed, in
    sentences.

    Render settings go back, faces that were parted lie where they lay, and media ask the scene again. What was mended in
    materials stays, and so does what the media are to be rendered with.
    """
    report = last_report(scene)
    changes = settings.go_back(scene, dict(report.settings)) if report is not None else []
    changes += join_parted(scene)
    if is_analysed(scene):
        clear_analysis(scene)
        changes.append("Media: ask the scene what surrounds them")
    if show_whole(scene):
        changes.append("Media: rendered as they are, not cut")
    forget_report(scene)
    return changes
