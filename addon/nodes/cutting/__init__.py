"""Geometry Nodes that cut the surfaces of media where they cross."""
