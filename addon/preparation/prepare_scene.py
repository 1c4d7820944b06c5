"""Making a scene ready to render nested dielectrics, and taking that back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import bpy

from ..analysis.findings import Found
from ..analysis.surroundings import clear_analysis, last_found
from ..analysis.validity import is_analysed
from ..checking.check import check, find
from ..checking.finding import Finding, severe
from ..checking.inspection import inspect
from ..checking.kinds import SPECTRAL_TABLE, Severity
from ..cutting.backends import BackendChoice
from ..cutting.cut_plan import CutReport
from ..cutting.cut_scene import is_set_to_cut, remove_cut, set_cut
from ..model.parameter import ParameterError
from ..nodes.compatibility import require_blender
from ..nodes.mending import complete_nodes, repair_nodes
from ..nodes.places import dielectric_places
from ..nodes.render_with import is_native, set_backend
from ..scene import settings
from ..scene.lights import update_lights
from ..scene.material_spectra import refresh_spectrum
from ..scene.media import all_objects, dispersing_materials, media
from ..scene.settings import Changed
from .guard import forget_faults
from .live import analyse, update_cut
from .report import Report, forget_report, keep_report, last_report
from .required_settings import end_random_time, ensure_osl, ensure_random_time
from .separate_faces import rejoin_separated_faces, separate_coincident_faces
from .upkeep import choose_bodies
from .versions import mend_materials

NO_MEDIA = "No media: assign a preset first"


@dataclass(frozen=True)
class Preparation:
    """What :func:`prepare` found and changed.

    :param changes: in sentences; problems: those that it left; notes: what else an artist may want to know.
    :param found: what the media of the scene now know of each other; media: how many there are.
    :param cut: which of them are rendered cut; chosen: which body of their materials renders them.
    """

    changes: tuple[str, ...]
    problems: tuple[Finding, ...]
    found: Found = field(default_factory=Found)
    media: int = 0
    cut: CutReport = field(default_factory=CutReport)
    chosen: BackendChoice = field(default_factory=BackendChoice)
    notes: tuple[Finding, ...] = ()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All that was found, the worst first: problems and notes."""
        return self.problems + self.notes

    @property
    def headline(self) -> str:
        """Say in one line whether the scene is ready."""
        return headline(self.media, len(self.problems))

    def __str__(self) -> str:
        lines = [self.headline]
        lines += [f"changed: {change}" for change in self.changes] or ["nothing to change"]
        lines += [f"rendered: {line}" for line in str(self.chosen).splitlines()]
        lines += [f"cut: {line}" for line in str(self.cut).splitlines()]
        lines += [f"analysis: {line}" for line in str(self.found).splitlines()]
        lines += [f"warning: {problem}" for problem in self.problems]
        return "\n".join(lines + [f"note: {note}" for note in self.notes])


def headline(media: int, problems: int) -> str:
    """Return in one line whether a scene with some media and problems is ready to render."""
    if problems:
        return f"{problems} problem{'s' * (problems != 1)} to look at before rendering"
    return "Ready to render" if media else NO_MEDIA


def prepare(scene: bpy.types.Scene, cut: bool | None = None, backend: str | None = None) -> Preparation:
    """Set what a scene needs to render nested dielectrics, and look for problems with its media.

    Cycles, and enough bounces; Open Shading Language on the CPU where media need it; where a medium disperses by it, the motion
    blur that carries the wavelengths, with a shutter of 0 unless it is in use, and spectral tables in the file's working space;
    where none does any more, what all that was before; the lights that direct refraction and reflection carry; and what
    surrounds each medium, so that it need not ask the scene.
    Larger limits stay. A second call changes nothing. Without media nothing is changed, but what an earlier call has set
    goes back. :func:`put_back` takes it back.

    :param cut: render surfaces cut where media cross, which is fastest and costs the time of cutting them on each frame, or
        render the objects as they are; None leaves the scene's own setting. Cycles' own nodes alone always need it.
    :param backend: ``"AUTO"`` renders with Cycles' own nodes on the GPU and without Open Shading Language, else with both in
        one picture; ``"OSL"`` with the shader alone, on the CPU; ``"NATIVE"`` with Cycles' own nodes alone; None leaves the
        scene's own setting.
    :raises UnsupportedError: if this Blender cannot.
    :raises ParameterError: for another backend.
    """
    require_blender()
    forget_faults()
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
        problems, notes = _sorted(check(scene))
        preparation = Preparation(tuple(stays + back), problems, cut=update_cut(scene), notes=notes)
    keep_report(scene, preparation.media, preparation.findings, stays, changed)
    return preparation


def _holds_media(scene: bpy.types.Scene) -> bool:
    """Return whether a scene has media, or may have once materials are mended."""
    materials = {
        slot.material for obj in all_objects(scene) for slot in obj.material_slots if slot.material is not None
    }
    return any(material.node_tree is not None and dielectric_places(material) for material in materials)


def _mend() -> list[str]:
    """Mend the nodes of all materials; return what was changed, in sentences."""
    changes = list(mend_materials())
    for material in bpy.data.materials:
        changes += repair_nodes(material) + complete_nodes(material)
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
        stays.append("Lights of direct refraction and reflection: listed again")
    findings: list[Finding] = []
    dispersing = dispersing_materials(scene)
    for material in dispersing:
        try:
            if refresh_spectrum(material):
                stays.append(f"Spectral Table of {material.name}: baked again")
        except ParameterError as error:
            text = f"keeps its old spectral table, because {error}"
            findings.append(Finding(SPECTRAL_TABLE, material.name, text, "choose another"))
    found = analyse(scene)
    separated = separate_coincident_faces(scene)
    if separated:
        found = last_found(scene)
    changes += ensure_osl(scene, changed)
    by_osl = dispersing and not is_native(scene)
    changes += ensure_random_time(scene, changed) if by_osl else end_random_time(scene, changed)
    cut = update_cut(scene)
    chosen = choose_bodies(scene)
    findings += find(inspect(scene, just_analysed=True))
    problems, notes = _sorted(severe(findings))
    return Preparation(
        tuple(stays + changes + separated),
        problems,
        found.without(cut.media),
        len(media(scene)),
        cut,
        chosen,
        notes,
    )


def _sorted(findings: Sequence[Finding]) -> tuple[tuple[Finding, ...], tuple[Finding, ...]]:
    """Return what is a problem, and what is a note."""
    problems = tuple(finding for finding in findings if finding.severity != Severity.NOTE)
    return problems, tuple(finding for finding in findings if finding.severity == Severity.NOTE)


def taken_back(scene: bpy.types.Scene, report: Report) -> list[str]:
    """Return what :func:`put_back` would change of the settings, in sentences of what was and is; it takes no time."""
    return settings.sentences(scene, settings.held(scene, report.settings))


def put_back(scene: bpy.types.Scene) -> Sequence[str]:
    """Take back what :func:`prepare` has changed in a scene, as far as it still is as it was set.

    Render settings go back, faces that were separated lie where they lay, and media ask the scene again. What was mended in
    materials stays, and so does what the media are to be rendered with.

    :returns: what was changed, in sentences.
    """
    report = last_report(scene)
    changes = settings.go_back(scene, dict(report.settings)) if report is not None else []
    changes += rejoin_separated_faces(scene)
    if is_analysed(scene):
        clear_analysis(scene)
        changes.append("Media: ask the scene what surrounds them")
    if remove_cut(scene):
        changes.append("Media: rendered as they are, not cut")
    forget_report(scene)
    return changes
