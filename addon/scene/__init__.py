"""Blender's data: media, priorities, materials, lights, passes, rendering."""
