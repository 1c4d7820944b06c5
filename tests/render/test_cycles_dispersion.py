"""Without time Cycles' own closures split light."""

import bpy
import numpy as np
import pytest
from dispersing import CLOSURES_DISPERSE, SF11, material, set_band_world
from scenes import add_camera, add_sphere, batches, native, new_scene, render
from significance import assert_same_picture

import nested_dielectric as nd
from nested_dielectric.model import dispersion


def without_time(**keywords):
    new_scene()
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    add_sphere("Sphere", 1.0, material(SF11, **keywords))
    return render(samples=16)


JF_CURVE = {
    "dispersion_model": "JF",
    "ior": SF11["ior"] - dispersion.jf_ior(0.0, 0.2, dispersion.LINE_D),
    "dispersion": 0.2,
}


@pytest.mark.skipif(CLOSURES_DISPERSE, reason="Cycles' closures disperse")
def test_without_time_the_picture_is_that_of_the_d_line():
    split = without_time()
    assert np.array_equal(split, without_time(disperse=False))
    assert np.allclose(split, without_time(**JF_CURVE), atol=1e-3)


@pytest.mark.skipif(not CLOSURES_DISPERSE, reason="Cycles' closures do not disperse")
def test_without_time_light_is_split_by_cycles_and_only_where_it_is_asked_for():
    without = without_time(disperse=False)
    assert np.ptp(without, axis=2).max() < 1e-6
    assert np.ptp(without_time(), axis=2).mean() > 0.05 * without.mean()
    # JF's quadratic curve is not Cauchy's, so only the mean is near: the index at the d line and the spread agree.
    assert without_time(**JF_CURVE).mean() == pytest.approx(without.mean(), rel=0.02)


def cycles_dispersing_glass(ior, abbe):
    """Cycles' own dispersion: Principled, all transmission."""
    return native(
        "Principled",
        "ShaderNodeBsdfPrincipled",
        **{"Base Color": (1.0, 1.0, 1.0, 1.0), "Roughness": 0.0, "IOR": ior, "Transmission Weight": 1.0},
        **{"Transmission Dispersion Scale": 1.0, "Transmission Dispersion Abbe Number": abbe},
    )


@pytest.mark.skipif(not CLOSURES_DISPERSE, reason="Cycles' closures do not disperse")
@pytest.mark.parametrize("ior, abbe", [(1.5, 20.0), (0.75, 20.0)])
def test_without_time_an_object_disperses_as_cycles_own_glass(ior, abbe):
    pictures = []
    for make in (
        lambda: nd.new_material("Glass", ior=ior, abbe=abbe, disperse=True, shadow_mode="BLACK"),
        lambda: cycles_dispersing_glass(ior, abbe),
    ):
        new_scene()
        set_band_world()
        add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
        add_sphere("Sphere", 1.0, make())
        pictures.append(render(samples=64))
    # The same closures and random numbers: only where rounding turns a path may a pixel differ.
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 1e-3).mean() < 0.01
    assert np.ptp(pictures[0], axis=2).mean() > 0.05 * pictures[0].mean()


NESTED_CURVES = {
    "both disperse": ({"ior": 1.5, "abbe": 20.0}, {"ior": 1.33, "abbe": 30.0}),
    "the outer one disperses": ({"ior": 1.5, "abbe": 20.0}, {"ior": 1.33, "abbe": 0.0, "disperse": False}),
    "the outer one spreads wider": ({"ior": 1.5, "abbe": 20.0}, {"ior": 1.8, "abbe": 200.0}),
    "equal at the d line": ({"ior": 1.5, "abbe": 15.0}, {"ior": 1.5, "abbe": 150.0}),
}


@pytest.mark.skipif(not CLOSURES_DISPERSE, reason="Cycles' closures do not disperse")
@pytest.mark.parametrize("name", NESTED_CURVES)
def test_without_time_nested_media_show_the_colours_of_daylight_tables(name):
    """Cycles' closures split D65 unclamped, and its Cauchy curve of a ratio of indices is near that ratio's own."""
    pictures = []
    for blurred in (False, True):
        new_scene(48).render.use_motion_blur = blurred
        bpy.context.scene.render.motion_blur_shutter = 0.0
        set_band_world()
        add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
        for radius, priority, keywords in zip((1.0, 0.7), (2, 1), NESTED_CURVES[name]):
            light = {"disperse": True, "spectral_distribution": "D65", "clamp_negative": False, "shadow_mode": "BLACK"}
            add_sphere(f"Ball {priority}", radius, nd.new_material("M", **(light | keywords)), priority)
        pictures.append(batches(256, 8))
    # Curves of these Abbe numbers, half of the strongest glass's, leave the ratio's own by 1e-3 at the ends of the spectrum.
    assert_same_picture(*pictures, bias=1e-3)
    assert np.ptp(pictures[0].mean(axis=0), axis=2).max() > 0.05
