"""Names of what cuts that stand in files: groups, their inputs, attributes of faces."""

from __future__ import annotations

CUT_GROUP = "Nested Dielectric Cut"

SURFACE_GROUP = "Nested Dielectric Cut Surface"

KEPT_GROUP = "Nested Dielectric Cut Kept"

PART_GROUP = "Nested Dielectric Cut Part"

BODY_GROUP = "Nested Dielectric Cut Body"

BOOLEAN_GROUP = "Nested Dielectric Cut Boolean"

OWN_INPUT, CUT_INPUT, BODY_INPUT, END_INPUT = "Medium", "Cut", "Body", "End"

FRAME_INPUT = "Frame"
"""Input: the frame on which the object's own mesh is its surface."""

BODY = "nd_body"
"""Attribute of faces, and of instances: the number of their medium."""

NORMAL = "nd_normal"
"""Attribute of corners: the normal before the mesh was cut."""

ATTRIBUTES = "nd_attributes"
"""Custom property of a group that reads a medium: the names of the attributes that it moves to corners."""
