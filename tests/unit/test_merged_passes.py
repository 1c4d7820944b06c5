"""Passes of merged pictures are those of the picture in one go."""

import numpy as np

from nested_dielectric.farm.merged_passes import mend, plan

SHARES = [0.25, 0.75]


def mended(names: list[str], *parts: list[list[float]]) -> np.ndarray:
    """Merge two pixels of parts as Cycles does, and mend them; (pixels, channels)."""
    arrays = [np.array([part], dtype=np.float32) for part in parts]
    merged = sum(share * part for share, part in zip(SHARES, arrays)).astype(np.float32)
    mend(plan(names), merged, arrays, SHARES)
    return merged[0]


def test_what_the_first_sample_writes_is_that_of_the_first_part():
    names = ["A.Position.X", "A.Object Index.X", "Material Index.X", "A.Depth.Z", "A.Combined.R"]
    result = mended(names, [[3.0, 2.0, 5.0, 7.0, 1.0]], [[0.0, 0.0, 0.0, 1e10, 0.2]])
    np.testing.assert_allclose(result[0], [3.0, 2.0, 5.0, 7.0, 0.4])


def test_light_is_weighed_by_the_colour_that_divides_it():
    names = ["A.Diffuse Direct.R", "A.Diffuse Indirect.R", "A.Diffuse Color.R"]
    # Light itself is light times colour: 0.5 and 0, which is 0.125 in the mean; the colour's mean is 0.125.
    result = mended(names, [[1.0, 0.0, 0.5], [2.0, 3.0, 0.0]], [[0.0, 0.0, 0.0], [2.0, 3.0, 0.0]])
    np.testing.assert_allclose(result, [[1.0, 0.0, 0.125], [2.0, 3.0, 0.0]])


def test_mattes_are_summed_by_number_and_the_largest_come_first():
    names = [f"A.CryptoObject00.{channel}" for channel in "rgba"]
    nan, other, third = np.array([0x7FC00001, 0x3F800001, 5], dtype=np.uint32).view(np.float32)
    result = mended(names, [[nan, 0.6, other, 0.4]], [[other, 0.9, third, 0.1]])
    assert result.view(np.uint32)[0, ::2].tolist() == [0x3F800001, 0x7FC00001]
    np.testing.assert_allclose(result[0, 1::2], [0.775, 0.15], rtol=1e-6)


def test_mattes_of_one_number_leave_the_rest_empty():
    names = [f"CryptoAsset00.{channel}" for channel in "rgba"]
    result = mended(names, [[2.0, 1.0, 0.0, 0.0]], [[2.0, 1.0, 0.0, 0.0]])
    assert result[0].tolist() == [2.0, 1.0, 0.0, 0.0]


def test_pictures_colours_and_normals_need_no_mending():
    assert not plan(
        ["A.Combined.R", "A.Diffuse Color.R", "A.Normal.X", "A.Denoising Depth.Z", "A.Volume Direct.R", "A.UV.U"]
    )
