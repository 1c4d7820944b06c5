"""Names of what the extension stores in files: node groups, nodes, sockets, properties."""

from __future__ import annotations

from ..model.contract import OUTSIDE_PROPERTY, OUTSIDE_TRANSMITTANCE_PROPERTY

NATIVE_GROUP = "Nested Dielectric Native"

CYCLES_OUTPUT = "Surface"

VOLUME_OUTPUT = "Volume"

PREVIEW_OUTPUT = "Preview"

MASK_OUTPUT = "Volume Mask"

FACTS_PANEL = "Facts"

ANALYSIS_PANEL = "Scene Analysis"

SCENE_SOCKET = "Analysed Scene"

EXTERIOR_SOCKET = "Outside"

SOLE_PRIORITY_SOCKET = "Outside Priority"

OVERLAP_SOCKET = "Overlaps Itself"

FOREIGN_SOCKET = "Foreign Objects"

GIVES_BACK_SOCKET = "Gives Back"

EXTERIOR_MEDIUM_SOCKET = "Surroundings"

EXTERIOR_TRANSMITTANCE_SOCKET = "Surroundings Transmittance"

SLOTS_SOCKET = "Material Slots"

NATIVE_SOCKET = "Native"
"""Input of the group: Cycles' own nodes render the material, not the shader."""

TABLE_SOCKET = "Spectral Table"

MEANS_SOCKET = "Spectral Table Means"

SHADER_NODE = "Nested Dielectric Shader"

TABLES_NODE = "Spectral Tables"

COORDINATE_NODE = "Spectral Coordinate"

ROW_OUTPUT = "Row"

FRAME_NODE = "Frame"

DISPERSER_NODE = "Cycles Dispersion"

VERSION_PROPERTY = "nd_version"

WHOLE = "nd_whole"
"""Custom property of a group: how much it held when it was made."""

SOURCE_HASH = "nd_source"
"""What groups of version 1 carry instead of a number."""

LIGHTS_NAME = "Nested Dielectric Lights"

LIGHTS_VERSION_PROPERTY = "nd_lights_version"

ANALYSED = "nd_analysed"
"""Custom property of a scene whose media are analysed again as it changes: what holds of its analysis, :class:`Validity`."""

FACTS_SCENE = "nd_told"
"""Another: its number, where stored facts hold on every frame as far as is known.

Cycles' own nodes go by it, as they cannot probe the scene where facts do not hold.
"""

LEFT_TO_SHADER = -2.0
"""Its value where Cycles' own nodes are to show the alarm, whatever they are told: only the shader is right."""

CENTRE = "nd_centre"
"""Custom property of a scene: a point amid its media, from which shadow rays measure how far they go through them.

Where there is none, volumes absorb of shadow rays.
"""

DEBUG_VIEW = "nd_debug_view"
"""Custom property of a scene, or of a view layer that shows another view: the code of a debug view that is on.

It is negative where numbers are to show in the place of colours.
"""

DEBUG_THROUGH = "nd_debug_through"
"""Another: how many surfaces a debug view lets through before it shows one."""

DEBUG_GROUP = "Nested Dielectric Debug View"

OBJECT_PROPERTIES = (OUTSIDE_PROPERTY, OUTSIDE_TRANSMITTANCE_PROPERTY)
"""Custom properties in which objects keep a scene's facts, four floats each."""

OFFSET_GROUP = "Nested Dielectric Offset"

OFFSET_ATTRIBUTE = "nd_offset"
"""Attribute of a mesh's points: by how much the modifier with that group moves them, in the object's own space.

Objects that share the mesh and are moved by something else have one of the same name and a number.
"""

ATTRIBUTE_SOCKET = "Attribute"
"""Input of that modifier: the name of the attribute; empty stands for OFFSET_ATTRIBUTE."""
