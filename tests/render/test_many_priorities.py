"""A ray may have many media of many priorities open at once."""

import pytest
from fluids import differs
from scenes import add_camera, add_sphere, new_scene, render, set_striped_world

import nested_dielectric as nd


@pytest.mark.parametrize("outermost", [1, 100], ids=["winning outside", "winning inside"])
def test_a_hundred_priorities_one_in_another_raise_no_alarm(outermost):
    """A ray may have all of them open at once."""
    scene = new_scene(16)
    set_striped_world()
    materials = [nd.new_material("Shell", ior=1.0 + 0.01 * index) for index in range(7)]
    for index in range(100):
        priority = abs(outermost - index)
        add_sphere(f"Shell {index}", 1.0 - 0.009 * index, materials[index % 7], priority, segments=16)
    add_camera((0, -5, 0.1), (0, 0, 0))
    asked = render(16)
    assert not nd.prepare(scene).found.doubts
    assert differs(render(16), asked) < 5e-3  # 100 surfaces a path: one that a last bit decides changes all behind it
    told = render(128)
    assert (told[..., 0] < told[..., 1] + 1e-3).all()


def test_many_shells_that_a_ray_enters_before_it_leaves_any_are_told_apart():
    """The 80 shells beside the ball lie between it and nothing else: it is in air."""
    new_scene(16)
    set_striped_world()
    add_sphere("Ball", 0.5, nd.new_material("Glass", ior=1.5), 500)
    clear = nd.new_material("Clear", ior=1.0)
    add_camera((0, -5, 0.1), (0, 0, 0))
    alone = render(16)
    for index in range(80):
        for side in (-1.0, 1.0):
            add_sphere(f"Shell {index} {side}", 0.9 - 0.01 * index, clear, index, (side * 2.0, 0.0, 0.0), segments=16)
    assert differs(render(16), alone) < 2e-2
