"""Choosing presets: menus, pictures, the asset library."""
