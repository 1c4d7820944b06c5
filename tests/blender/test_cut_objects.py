"""What is cut leaves the artist's objects alone."""

import bpy  # before bmesh, which lives inside it
import numpy as np
import pytest
from cut import add_labels, add_rod, drink, now, two_bodies
from scenes import add_box

import nested_dielectric as nd

BLOCKS = ("objects", "collections", "materials", "node_groups", "meshes", "scenes", "cameras", "actions")
DEPTH = 3


def dump() -> dict[str, str]:
    """All that can be read of all data-blocks."""
    found = {}
    for kind in BLOCKS:
        for block in getattr(bpy.data, kind):
            found[f"{kind} {block.name}"] = "\n".join(_lines(block, DEPTH))
    return found


def _lines(owner, depth: int):
    if hasattr(owner, "keys") and isinstance(owner, (bpy.types.ID, bpy.types.PoseBone)):
        yield from (f"[{name!r}] {_plain(owner[name])}" for name in sorted(owner.keys()))
    for prop in owner.bl_rna.properties:
        name = prop.identifier
        if prop.is_deprecated or name in (
            "rna_type",
            "depsgraph",
            "storage_type",
            "is_visible",
            "original",
            "session_uid",
            "is_evaluated",
            "id_data",
            "bound_box",
            "tag",
            "users",
            "library_weak_reference",
        ):
            continue
        try:
            value = getattr(owner, name)
        except Exception:
            continue
        if prop.type == "COLLECTION":
            inner = list(value)
            yield f"{name} {len(inner)} {[getattr(each, 'name', '') for each in inner[:50]]}"
            if depth and len(inner) < 50:
                for each in inner:
                    if isinstance(each, bpy.types.bpy_struct) and not isinstance(each, bpy.types.ID):
                        yield from (f"{name}.{line}" for line in _lines(each, depth - 1))
        elif prop.type == "POINTER":
            yield f"{name} {getattr(value, 'name', None)}"
            if (
                depth
                and value is not None
                and not isinstance(value, bpy.types.ID)
                and name not in ("id", "node", "owner")
            ):
                yield from (f"{name}.{line}" for line in _lines(value, min(depth - 1, 1)))
        else:
            yield f"{name} {_plain(value)}"


def _plain(value) -> str:
    if hasattr(value, "to_list"):
        value = value.to_list()
    if not isinstance(value, (str, int, float, bool)) and hasattr(value, "__len__"):
        value = [_plain(each) for each in value]
    return repr(getattr(value, "name", value))


def assert_dumps_match(before: dict[str, str], after: dict[str, str]) -> None:
    assert before.keys() == after.keys()
    for name, text in before.items():
        lost = set(text.splitlines()) ^ set(after[name].splitlines())
        assert not lost, f"{name}: {sorted(lost)[:6]}"


@pytest.mark.parametrize("reopens", [False, True], ids=["in a session", "saved and opened again"])
def test_switched_off_everything_is_as_it_was(reopens, tmp_path):
    glass, water, ice = drink()
    add_rod()
    add_labels(glass)
    ice.keyframe_insert("location", frame=1)
    water.visible_shadow, water.pass_index, water["mine"] = False, 3, 7
    water.modifiers.new("Weld", "WELD")
    hidden = add_box("Hidden", (0, 0, 0), (0.3, 0.3, 0.3), bpy.data.materials["Ice"])
    hidden.hide_render = True
    shelf = bpy.data.collections.new("Shelf")
    now().collection.children.link(shelf)
    shelf.objects.link(ice)
    ice.select_set(True)
    bpy.context.view_layer.objects.active = ice
    nd.prepare(now(), cut=False)
    bpy.data.orphans_purge(do_recursive=True)
    before = dump()
    file = str(tmp_path / "scene.blend")
    assert set(nd.prepare(now(), cut=True).cut.media) == {"Glass", "Water", "Ice"}
    if reopens:
        bpy.ops.wm.save_as_mainfile(filepath=file)
        bpy.ops.wm.open_mainfile(filepath=file)
    assert dump().keys() != before.keys()
    nd.prepare(now(), cut=False)
    assert_dumps_match(before, dump())


def test_a_second_preparation_makes_nothing_anew():
    drink()
    nd.prepare(now(), cut=True)
    before = dump()
    nd.prepare(now())
    assert_dumps_match(before, dump())


def surface_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """The object that shows another in renders."""
    return next((each for each in bpy.data.objects if each.get("nd_cut_of") == obj), None)


def test_objects_that_come_go_and_are_renamed_are_followed_by_the_next_preparation():
    ball, block = two_bodies()
    nd.prepare(now(), cut=True)
    copy = ball.copy()
    now().collection.objects.link(copy)
    copy.location.x += 0.5
    assert set(nd.prepare(now()).cut.media) == {"Ball", "Ball.001", "Block"}
    assert surface_of(copy) not in (None, surface_of(ball)) and copy.hide_render
    copy.name = "Twin"
    nd.prepare(now())
    assert surface_of(copy).name == "Twin (cut)"
    bpy.data.objects.remove(ball)
    assert set(nd.prepare(now()).cut.media) == {"Twin", "Block"}
    assert {each.name for each in bpy.data.objects if each.name.endswith("(cut)")} == {"Twin (cut)", "Block (cut)"}
    nd.prepare(now(), cut=False)
    assert not copy.hide_render and not block.hide_render
    assert not [each for each in (*bpy.data.objects, *bpy.data.collections, *bpy.data.scenes) if "nd_cut" in each]
    assert not [tree for tree in bpy.data.node_groups if "Cut" in tree.name]


def faces_of(obj: bpy.types.Object) -> dict[float, int]:
    """How many faces of a medium's surface carry what."""
    surface = surface_of(obj)
    surface.hide_viewport = False
    bpy.context.view_layer.update()
    mesh = surface.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    values = np.zeros(len(mesh.polygons), dtype=np.float32)
    mesh.attributes["nd_cut"].data.foreach_get("value", values)
    surface.hide_viewport = True
    return dict(zip(*(each.tolist() for each in np.unique(values, return_counts=True))))


def test_a_blender_without_the_manifold_library_cuts_too():
    """There that solver returns its first mesh as it is, as a node that is muted does."""
    ball, block = two_bodies()
    nd.prepare(now(), cut=True)
    expected = [faces_of(body) for body in (ball, block)]
    assert len(expected[0]) == 2
    for tree in bpy.data.node_groups:
        for node in tree.nodes:
            if node.bl_idname == "GeometryNodeMeshBoolean" and node.solver == "MANIFOLD":
                node.mute = True
    for body, before in zip((ball, block), expected):
        assert faces_of(body) == before
