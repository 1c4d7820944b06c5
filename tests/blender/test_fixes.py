"""What a check finds is mended, one by one or all that is safe; one undo takes it back."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import pytest
from faults import UNIT, fault_of, flip, glass, mend, open_up, state, volume, with_fixes
from scenes import add, add_box, add_plane, mostly_again, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.checking.finding import Action, Finding, Fix
from nested_dielectric.checking.kinds import KINDS
from nested_dielectric.fixing.fix import ACTIONS
from nested_dielectric.fixing.words import in_words
from nested_dielectric.model.parameter import PRIORITY_PROPERTY
from nested_dielectric.preparation.report import keep_findings, last_report
from nested_dielectric.ui.operators import problem_operators


@pytest.fixture(autouse=True)
def scene():
    new_scene(with_group=True)
    return bpy.context.scene


def test_each_action_has_a_function_and_words_and_those_that_need_names_refuse_none(scene):
    assert set(ACTIONS) == set(Action)
    for action in Action:
        text = in_words(scene, Fix(action, ("Glass", "Table"), 0.5, "cycles.max_bounces"))
        assert text[0].isupper() and "{" not in text and not text.endswith(".")
    assert in_words(scene, Fix(Action.SET_PRIORITY, ("Glass",), 1)) == "Give 'Glass' the priority 1"
    with pytest.raises(nd.ParameterError, match="does not say what to change"):
        nd.fix(scene, Finding(KINDS["gap"], "Glass", "", "", fix=Fix(Action.PUSH_INTO_WALL, ("Glass",), 1.0)))
    with pytest.raises(nd.ParameterError, match="'Glass' is open: close it"):
        nd.fix(scene, Finding(KINDS["open-mesh"], "Glass", "is open", "close it"))


def test_a_scene_is_prepared(scene):
    add_box("Box", *UNIT, glass())
    scene.render.engine = "BLENDER_EEVEE"
    assert "Render Engine: EEVEE -> Cycles" in mend(Action.PREPARE, scene.name, kind="settings")
    assert is_analysed(scene)


def test_what_is_linked_is_never_changed(tmp_path, scene):
    box = add_box("Box", *UNIT, glass())
    open_up(box, 1)
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {box})
    new_scene(with_group=True)
    scene = bpy.context.scene
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Box"]
    (box,) = wanted.objects
    scene.collection.objects.link(box)
    local = add("Local", box.data)
    for action, value, path in (
        (Action.RECALCULATE_NORMALS, None, ""),
        (Action.CLOSE_HOLES, None, ""),
        (Action.PUSH_INTO_WALL, 0.1, ""),
        (Action.MOVE_APART, 0.1, ""),
        (Action.SET_PRIORITY, 3, ""),
        (Action.APPLY_TRANSFORM, None, ""),
        (Action.MERGE_COPIES, None, ""),
        (Action.MOVE_SLOT, None, ""),
        (Action.REMOVE_PROPERTY, None, PRIORITY_PROPERTY),
        (Action.MOVE_TO_ORIGIN, None, ""),
    ):
        with pytest.raises(nd.ParameterError, match="comes from"):
            mend(action, "Box", "Local", value=value, path=path)
    for action, value, path in (
        (Action.MEND_NODES, None, ""),
        (Action.SET_VALUE, None, "IOR"),
        (Action.SET_PRIORITY, 3, ""),
    ):
        with pytest.raises(nd.ParameterError, match="'Glass' comes from"):
            mend(action, "Glass", value=value, path=path)
    with pytest.raises(nd.ParameterError, match="'Local' has its shape from"):
        mend(Action.RECALCULATE_NORMALS, local.name)


def test_all_that_is_safe_is_fixed_and_what_is_left_is_said(monkeypatch, scene):
    with_fixes(
        monkeypatch,
        ("open-mesh", (Action.CLOSE_HOLES, True)),
        ("inward-normals", (Action.RECALCULATE_NORMALS, True)),
        ("slot-limit", (Action.MOVE_SLOT, False)),
    )
    open_up(add_box("Open", *UNIT, glass()), 1)
    flip(add_box("Inward", (4, 0, 0), (5, 1, 1), glass()))
    add_plane("Plane", 1.0, (9, 9, 9), (0, 0, 1), glass())
    far = add_box("Far", (6, 0, 0), (7, 1, 1))
    for index in range(9):
        far.data.materials.append(bpy.data.materials.new(f"Paint {index}"))
    far.data.materials.append(glass())
    fixed = nd.fix_all(scene)
    assert sorted(change.split(":")[0] for change in fixed.changes) == ["Inward", "Open"]
    left = {(finding.kind.key, finding.name) for finding in fixed.left}
    assert ("open-mesh", "Plane") in left and ("slot-limit", "Far") in left
    assert not {"Open", "Inward"} & {name for _, name in left}
    assert "changed: Open: 1 hole closed" in str(fixed) and "left: 'Plane'" in str(fixed)
    assert nd.fix_all(scene).changes == ()


@pytest.fixture
def operators(scene):
    """The extension is registered, and what its panel lists is still there."""
    nd.register()
    yield
    nd.unregister()


@pytest.mark.parametrize("action", mostly_again(Action))
def test_a_fix_is_one_step_that_undo_takes_back_and_redo_does_again(action, operators, monkeypatch):
    monkeypatch.setattr(problem_operators, "as_it_is_now", lambda scene, kept: kept)
    finding = fault_of(action)
    keep_findings(bpy.context.scene, 1, [finding])
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="fault")
    before = state()
    assert bpy.ops.nested_dielectric.fix("EXEC_DEFAULT", True, index=0) == {"FINISHED"}
    after = state()
    changed = {name for name in before if before[name] != after.get(name)}
    assert changed - {"scene"} or before["scene"][:-1] != after["scene"][:-1]
    bpy.ops.ed.undo()
    assert state() == before
    bpy.ops.ed.redo()
    assert state() == after


def test_a_button_fixes_one_problem_and_lists_what_is_left(operators, monkeypatch, capfd):
    scene = bpy.context.scene
    with_fixes(monkeypatch, ("open-mesh", (Action.CLOSE_HOLES, True)), ("value-limit", (None, True)))
    open_up(add_box("Open", *UNIT, glass()), 1)
    add_plane("Plane", 1.0, (9, 9, 9), (0, 0, 1), glass())
    before = state()
    assert bpy.ops.nested_dielectric.check() == {"FINISHED"}
    assert {**state(), "scene": None} == {**before, "scene": None} and not is_analysed(scene)
    names = [problem.name for problem in last_report(scene).problems]
    assert names == ["Open", "Plane"]
    description = problem_operators.FixProblem.description.__func__
    index = type("Index", (), {"index": 0})
    assert description(problem_operators.FixProblem, bpy.context, index).startswith(
        "Close Holes: Fill the holes in the mesh"
    )
    assert bpy.ops.nested_dielectric.fix(index=0) == {"FINISHED"}
    assert [problem.name for problem in last_report(scene).problems] == ["Plane"]
    assert "Open: 1 hole closed" in "".join(capfd.readouterr())
    with pytest.raises(RuntimeError, match="'Plane' is flat"):
        bpy.ops.nested_dielectric.fix(index=0)
    with pytest.raises(RuntimeError, match="This problem has no fix"):
        bpy.ops.nested_dielectric.fix(index=7)
    assert bpy.ops.nested_dielectric.fix_all() == {"FINISHED"}
    output = "".join(capfd.readouterr())
    assert "Left: 'Plane' is not closed" in output and "1 problem left" in output
    with_fixes(monkeypatch)
    with pytest.raises(RuntimeError, match="'Plane' is not closed"):
        bpy.ops.nested_dielectric.fix(index=0)
    bpy.data.objects.remove(bpy.data.objects["Plane"])
    assert bpy.ops.nested_dielectric.fix(index=0) == {"FINISHED"}
    assert "'Plane' has this problem no more" in "".join(capfd.readouterr())
    for operator in (bpy.ops.nested_dielectric.fix, bpy.ops.nested_dielectric.fix_all):
        with pytest.raises(RuntimeError, match="No problem is listed"):
            operator()
    bpy.context.view_layer.objects.active = bpy.data.objects["Open"]
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Leave this mode for Object Mode"):
        bpy.ops.nested_dielectric.fix_all()


def test_to_fix_all_is_one_step_too(operators, monkeypatch):
    with_fixes(
        monkeypatch, ("open-mesh", (Action.CLOSE_HOLES, True)), ("inward-normals", (Action.RECALCULATE_NORMALS, True))
    )
    open_up(add_box("Open", *UNIT, glass()), 1)
    flip(add_box("Inward", (4, 0, 0), (5, 1, 1), glass()))
    bpy.ops.nested_dielectric.check()
    bpy.ops.ed.undo_push(message="faults")
    before = state()
    bpy.ops.nested_dielectric.fix_all("EXEC_DEFAULT", True)
    assert all(map(volume, bpy.context.scene.objects))
    bpy.ops.ed.undo()
    assert state() == before


def test_a_problem_shows_its_faces_and_its_point(operators, capfd):
    from dataclasses import replace

    from nested_dielectric.checking.finding import Place

    scene = bpy.context.scene
    box = add_box("Box", *UNIT, glass())
    finding = replace(fault_of(Action.SET_SETTING), name="Box", place=Place((2, 4, 99), (1.0, 2.0, 3.0)))
    keep_findings(scene, 1, [finding, replace(finding, name=scene.name)])
    bpy.context.view_layer.update()
    assert bpy.ops.nested_dielectric.show_problem(index=0) == {"FINISHED"}
    assert bpy.context.object == box and tuple(scene.cursor.location) == (1.0, 2.0, 3.0)
    assert [polygon.index for polygon in box.data.polygons if polygon.select] == [2, 4]
    assert "Tab shows them in Edit Mode" in "".join(capfd.readouterr())
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(box.data)
    assert [face.index for face in bm.faces if face.select] == [2, 4]
    bpy.ops.object.mode_set(mode="OBJECT")
    scene.cursor.location = (0, 0, 0)
    assert bpy.ops.nested_dielectric.show_problem(index=1) == {"FINISHED"}
    assert tuple(scene.cursor.location) == (1.0, 2.0, 3.0)
    box.modifiers.new("Round", "SUBSURF")
    assert bpy.ops.nested_dielectric.show_problem(index=0) == {"FINISHED"}
    assert "Tab shows" not in "".join(capfd.readouterr())
