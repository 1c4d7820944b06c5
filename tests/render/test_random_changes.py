"""Whatever is done to a scene, no handler raises anything and each picture is that of a scene which was never prepared.

`python tests/helpers/random_changes.py 10000` makes as many changes; here are some of them.
"""

import pytest
from random_changes import SAME, make_changes
from scenes import mostly_again


@pytest.mark.parametrize("seed", mostly_again((0, 1), 1))
def test_random_changes_raise_nothing_and_change_no_picture(seed):
    looked = []
    assert make_changes(seed, 60, 15, lambda *seen: looked.append(seen)) == []
    assert len(looked) == 4
    for what, difference, _ in looked:
        assert difference < SAME, what
