"""Nested dielectrics for Blender: glass, liquids and ice that touch.

::

    import nested_dielectric as nd

    nd.register()
    water = nd.new_material("Water", preset="water", roughness=0.0)
    nd.assign(obj, water, priority=2)
    print(nd.prepare(bpy.context.scene))
"""

import sys
from contextlib import nullcontext

from .model.files import ending_at_once
from .model.streams import log_to_stderr

if "bpy" not in sys.modules:
    # What Blender's start would swallow, and what it prints where others are to read JSON.
    with ending_at_once(), log_to_stderr() if "--json" in sys.argv else nullcontext():
        import bpy  # noqa: F401

from .analysis.surroundings import clear_analysis
from .checking.check import check
from .checking.finding import Finding
from .checking.priority_suggestions import accept_priorities, suggest_priorities
from .fixing.fix import Fixed, fix, fix_all
from .model.parameter import ParameterError
from .nodes.compatibility import UnsupportedError
from .preparation.live import analyse
from .preparation.prepare_scene import Preparation, prepare
from .preparation.versions import update_materials
from .registration import register, unregister
from .scene.caustics import set_shadow_caustics
from .scene.lights import light_carriers
from .scene.media import assign, get_priority, set_priority
from .scene.new_materials import new_material
from .scene.passes import add_passes
from .scene.preset_library import preset_names

__all__ = [
    "Finding",
    "Fixed",
    "ParameterError",
    "Preparation",
    "UnsupportedError",
    "accept_priorities",
    "add_passes",
    "analyse",
    "assign",
    "check",
    "clear_analysis",
    "fix",
    "fix_all",
    "get_priority",
    "light_carriers",
    "new_material",
    "prepare",
    "preset_names",
    "register",
    "set_priority",
    "set_shadow_caustics",
    "suggest_priorities",
    "unregister",
    "update_materials",
]
