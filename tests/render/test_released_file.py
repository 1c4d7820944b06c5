"""A file of the first release looks the same after its update."""

import numpy as np
from released_files import FIRST, FRONT_IOR, open_file
from scenes import render

import nested_dielectric as nd


def test_the_first_release_looks_the_same_after_its_update():
    """Blender 5.2 renders the file as it was saved."""
    open_file(FIRST)
    before = render(16)
    nd.update_materials()
    assert (np.array_equal(render(16), before)) != FRONT_IOR
