"""Nested dielectrics for Blender: glass, liquids and ice that touch.

::

    import nested_dielectric as nd

    nd.register()
    water = nd.new_material("Water", preset="water", roughness=0.0)
    nd.assign(obj, water, priority=2)
    print(nd.prepare(bpy.context.scene))
"""

import sys

from .files import ending_at_once

if "bpy" not in sys.modules:
    with ending_at_once():  # which Blender's start would swallow
        import bpy  # noqa: F401

from .analysis import clear_analysis
from .caustics import set_shadow_caustics
from .compatibility import UnsupportedError
from .lights import light_carriers
from .live import analyse
from .materials import new_material
from .media import assign, get_priority, set_priority
from .parameters import ParameterError
from .passes import add_passes
from .preparation import Preparation, prepare
from .preset_library import preset_names
from .registration import register, unregister
from .versions import update_materials

__all__ = [
    "ParameterError",
    "Preparation",
    "UnsupportedError",
    "add_passes",
    "analyse",
    "assign",
    "clear_analysis",
    "get_priority",
    "light_carriers",
    "new_material",
    "prepare",
    "preset_names",
    "register",
    "set_priority",
    "set_shadow_caustics",
    "unregister",
    "update_materials",
]
