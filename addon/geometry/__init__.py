"""Closed meshes and how they touch, without Blender's data."""
