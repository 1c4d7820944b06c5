"""What is no mesh renders as the same turned into one."""

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from object_types import curve, metaball, text
from scenes import add, add_box, add_camera, mostly_again, new_scene, render, set_striped_world

import nested_dielectric as nd


def turned_into_a_mesh(obj: bpy.types.Object) -> None:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph), depsgraph=depsgraph)
    place = obj.matrix_world.copy()
    for other in [other for other in bpy.context.scene.objects if other.type == obj.type]:
        bpy.data.objects.remove(other)
    add("Mesh", mesh).matrix_world = place


SHAPES = (metaball, text, curve)


@pytest.mark.parametrize("make", mostly_again(SHAPES, 2))
def test_what_is_no_mesh_renders_as_the_same_turned_into_one(make):
    """Rays meet the same triangles, whether what surrounds them is known or asked for."""

    def picture(is_mesh: bool) -> np.ndarray:
        new_scene(16)
        set_striped_world()
        add_camera((0.1, -6, 0.3), (0.03, 0, 0), angle=26)
        tint = {"transmittance": (0.3, 0.7, 0.9), "transmittance_depth": 0.5}
        obj = make(nd.new_material("Water", ior=1.33, priority=2, **tint))
        add_box("Pane", (-1.3, 0.1, -1.3), (1.3, 0.6, 1.3), nd.new_material("Glass", ior=1.5, priority=1))
        bpy.context.view_layer.update()
        if is_mesh:
            turned_into_a_mesh(obj)
        result = nd.prepare(bpy.context.scene)
        assert result.problems == () and not result.found.doubts
        return render(8)

    native_picture, mesh_picture = picture(False), picture(True)
    assert np.mean(np.abs(native_picture - mesh_picture).max(axis=-1) > 1e-3) < 0.02  # rounding may turn single samples
    assert native_picture.mean() == pytest.approx(mesh_picture.mean(), rel=2e-3)
