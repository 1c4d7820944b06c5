"""Panels of scenes, media and lights; entries in Blender's own menus; notices."""
