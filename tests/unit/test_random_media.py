"""Random scenes of the stress suite are the same for the same seed, and hold all that they are to hold."""

import pytest
from random_media import (
    ARRANGEMENTS,
    MESHES,
    OTHERS,
    SCENES,
    SPLIT_SCENES,
    SPLITS_BY_CYCLES,
    SPLITS_BY_TIME,
    random_media_scene,
)

ALL = [random_media_scene(seed) for seed in SCENES]
BODIES = [body for scene in ALL for body in scene.bodies]


def test_a_seed_is_a_scene():
    assert random_media_scene(7) == random_media_scene(7) != random_media_scene(12)


@pytest.mark.parametrize(
    "found, wanted",
    [
        ({body.shape for body in BODIES}, {*MESHES, *OTHERS}),
        ({scene.arrangement for scene in ALL}, {*ARRANGEMENTS}),
        ({scene.splits for scene in ALL}, {"", SPLITS_BY_TIME, SPLITS_BY_CYCLES}),
        ({scene.rough for scene in ALL}, {True, False}),
        ({scene.camera_inside for scene in ALL}, {True, False}),
        ({body.smooth for body in BODIES}, {True, False}),
        ({body.parent is None for body in BODIES}, {True, False}),
        ({min(body.place.scale) < 0.0 for body in BODIES}, {True, False}),
    ],
    ids=["shapes", "arrangements", "splits", "rough", "inside", "smooth", "parents", "mirrored"],
)
def test_random_scenes_hold_all_kinds(found, wanted):
    assert found == wanted


def test_random_media_have_indices_from_a_tenth_to_ten():
    indices = [medium.ior for scene in ALL for medium in scene.media]
    assert min(indices) < 0.15 and max(indices) > 7.0
    assert len(indices) > 680


def test_scenes_that_are_split_by_hand_have_one_mesh_a_medium():
    for scene in map(random_media_scene, SPLIT_SCENES):
        assert sorted(body.medium for body in scene.bodies) == list(range(len(scene.media)))
        assert all(body.shape in MESHES and not body.smooth for body in scene.bodies)
        assert not scene.disperses and not scene.camera_inside
