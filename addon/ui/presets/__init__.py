"""Choosing presets: operators, menus, pictures; media that are dragged from the asset library."""
