"""Checks of what scenes of a file share: a material can be told of one scene alone."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..analysis.storage import has_facts_of
from ..analysis.validity import is_analysed
from ..cutting.needs import material_users
from ..nodes.identity import known_number
from ..nodes.render_with import get_backend, is_native
from .finding import Action, Finding, Fix
from .inspection import Inspection
from .kinds import SCENES_ASK, SCENES_DISAGREE


def scene_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield materials that this scene shares with another one for which they are told, or rendered, otherwise."""
    scene = inspection.scene
    others = [each for each in bpy.data.scenes if each != scene and is_analysed(each)]
    if not others:
        return
    mine = material_users(scene)
    for other in others:
        shared = [material for material in mine if material in material_users(other)]
        if not shared:
            continue
        names = tuple(material.name for material in shared)
        if is_native(scene) != is_native(other) or get_backend(scene) != get_backend(other):
            yield Finding(
                SCENES_DISAGREE,
                scene.name,
                f"shares the material {names[0]!r} with scene {other.name!r}, which renders its media otherwise",
                "give both the same Render With, or each scene its own materials (Object > Relations > Make Single User)",
                others=(other.name, *names),
            )
        elif any(has_facts_of(material, known_number(other)) for material in shared):
            yield Finding(
                SCENES_DISAGREE if is_native(scene) else SCENES_ASK,
                scene.name,
                f"shares the material {names[0]!r} with scene {other.name!r}, of which that was told last",
                "press Prepare Scene in the scene that is rendered next",
                others=(other.name, *names),
                fix=Fix(Action.PREPARE, (scene.name,), safe=False),
            )
