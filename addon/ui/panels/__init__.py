"""Panels of scenes, media and lights."""
