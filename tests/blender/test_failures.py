"""Pictures that differ are saved, with a map of where."""

from pathlib import Path

import numpy as np
import pytest
import scenes
from scenes import read_picture
from significance import assert_same_picture


def test_a_failure_saves_both_pictures_and_a_map_of_deviations(tmp_path, monkeypatch):
    monkeypatch.setattr(scenes, "failure_folder", lambda: tmp_path)
    chance = np.random.default_rng(0)
    ours, reference = chance.normal(1.0, 0.1, (2, 8, 32, 48, 3))
    ours[:, :16, 16:32, 2] += 0.2
    with pytest.raises(AssertionError, match=f"Pictures: {tmp_path}"):
        assert_same_picture(ours, reference)
    saved = {path.stem: read_picture(path) for path in tmp_path.iterdir()}
    assert saved.keys() == {"ours", "reference", "deviations"}
    assert all(picture.shape == (32, 48, 3) for picture in saved.values())
    assert np.allclose(saved["ours"], ours.mean(axis=0), atol=1e-6)
    assert saved["deviations"][:16, 16:32, 2].min() > 10.0 > np.abs(saved["deviations"][16:]).max()


def test_a_folder_of_pictures_is_named_after_its_test(monkeypatch):
    monkeypatch.setenv("PYTEST_CURRENT_TEST", "tests/render/test_x.py::test_y[a b/é-1.0] (call)")
    folder = scenes.failure_folder()
    assert folder == Path(__file__).parents[2] / "out" / "tests" / "test_y_a_b_é-1.0"
    folder.rmdir()
