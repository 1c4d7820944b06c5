"""Surfaces that are cut where media cross, and which body of the group renders which material."""
