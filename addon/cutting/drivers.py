"""Drivers that copy a property without a script, so that files evaluate them wherever they are rendered."""

from __future__ import annotations

import bpy


def drive_by(owner: bpy.types.Object, path: str, source: bpy.types.ID, source_path: str) -> None:
    """Drive a property of an object by a property of another data-block, component by component.

    :param path: of the driven property, from ``owner``; source_path: of the property that it copies, from ``source``.
    """
    value = source.path_resolve(source_path)
    for part in [-1] if isinstance(value, (bool, int, float)) else range(len(value)):
        driver = owner.driver_add(path, part).driver
        driver.type = "SUM"
        target = driver.variables.new().targets[0]
        target.id_type = source.id_type
        target.id = source
        target.data_path = source_path if part < 0 else f"{source_path}[{part}]"
