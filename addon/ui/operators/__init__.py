"""Operators: what buttons and menus do, by feature."""
