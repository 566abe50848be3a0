"""Simulation and bake of hair, through the operators."""

import bpy
import numpy as np
import pytest
import scenes

FRAMES = 24


def arrays(thing):
    """Return evaluated points, [n, 3], in the space of the object."""
    data = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    out = np.empty(3 * len(data.points), np.float32)
    data.position_data.foreach_get("vector", out)
    return out.reshape(-1, 3)


def groom(thing):
    out = np.empty(3 * len(thing.data.points), np.float32)
    thing.data.position_data.foreach_get("vector", out)
    return out.reshape(-1, 3)


def center(body):
    """Return the middle and the mean radius of an evaluated ball."""
    data = body.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    out = np.empty(3 * len(data.vertices), np.float32)
    data.attributes["position"].data.foreach_get("vector", out)
    points = out.reshape(-1, 3)
    middle = 0.5 * (points.min(0) + points.max(0))
    return middle, np.linalg.norm(points - middle, axis=1).mean()


def select(*things):
    for thing in bpy.context.selected_objects:
        thing.select_set(False)
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[0]


def lengths(points, count):
    return np.linalg.norm(np.diff(points.reshape(count, -1, 3), axis=1), axis=2).sum(1)


def test_guides_move_keep_their_lengths_and_stay_outside(saved):
    scene = scenes.empty(last=FRAMES)
    body, _ = scenes.ball()
    thing = scenes.hair(body)
    file, before = saved(), groom(thing)
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    assert np.array_equal(groom(thing), before), "the groom is untouched"
    assert not any(o.name.startswith("Tresses") for o in bpy.data.objects), "nothing is left behind"
    assert [m.name for m in thing.modifiers][0] == "Tresses" and all(m.show_viewport for m in thing.modifiers)
    assert thing.data.attributes.get("tresses_position") is None
    seen, deep, changes = [], np.zeros(100), []
    for frame in range(1, FRAMES + 1):
        scene.frame_set(frame)
        now = arrays(thing)
        seen.append(now)
        middle, radius = center(body)
        inside = (np.linalg.norm(now.reshape(100, 16, 3)[:, 1:] - middle, axis=2) < radius - 1e-3).any(1)
        deep = np.where(inside, deep + 1, 0)
        assert deep.max() < 3, f"hair is more than 1 mm inside for three frames, until frame {frame}"
        changes.append(np.abs(lengths(now, 100) / lengths(before, 100) - 1))
    assert np.mean(changes) < 0.005, f"lengths change by {np.mean(changes)}"
    assert np.abs(seen[-1] - before).max() > 0.05, "it falls and swings"
    # The file plays without the extension.
    bpy.ops.wm.save_mainfile()
    bpy.ops.preferences.addon_disable(module="bl_ext.user_default.tresses")
    try:
        bpy.ops.wm.open_mainfile(filepath=file)
        thing = next(o for o in bpy.data.objects if o.type == "CURVES")
        for frame in (1, 7, FRAMES, 12):
            bpy.context.scene.frame_set(frame)
            assert np.abs(arrays(thing) - seen[frame - 1]).max() < 1e-5
    finally:
        bpy.ops.preferences.addon_enable(module="bl_ext.user_default.tresses")


def test_result_is_the_simulation(package, saved):
    run, hair = package.run, package.hair
    scene = scenes.empty(last=8)
    body, _ = scenes.ball(shape_key=True)
    thing = scenes.hair(body, 60)
    saved()
    one = run.Run(bpy.context, [thing], [body], run.Options(1, 8, settle=4))
    wanted = []
    for _ in one.frames():
        wanted.append(one.space.back(one.simulation.given(), thing.matrix_world))
    one.end()
    run.bake(bpy.context, thing)
    for frame in range(1, 9):
        scene.frame_set(frame)
        # Less than a hundredth of a millimeter, beside what attaches roots to the swelling skin.
        assert np.abs(arrays(thing) - wanted[3 + frame]).max() < 2e-4
    # The roots lie on the skin, where it swells too.
    middle, radius = center(body)
    first = arrays(thing).reshape(60, 16, 3)[:, 0]
    assert np.abs(np.linalg.norm(first - middle, axis=1) - radius).max() < 2e-3 and radius > 0.11


def test_strands_of_modifiers_become_an_object(saved):
    scene = scenes.empty(last=6)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 30)
    saved()
    select(thing)
    thing.tresses.mode = "STRANDS"
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    result = thing.tresses.result
    assert result.tresses.source == thing and thing.hide_get() and len(result.data.curves) == 30
    scene.frame_set(1)
    first = arrays(result)
    scene.frame_set(6)
    assert np.abs(arrays(result) - first).max() > 0.01
    radius = result.data.attributes["radius"].data
    assert radius[0].value == pytest.approx(4e-5)
    select(result)
    assert bpy.ops.tresses.clear() == {"FINISHED"}
    assert not thing.hide_get() and len([o for o in bpy.data.objects if o.type == "CURVES"]) == 1


def test_particle_hair_becomes_curves(saved):
    scene = scenes.empty(last=4)
    body, _ = scenes.ball()
    select(body)
    body.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = body.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 40, 0.1
    saved()
    assert bpy.ops.tresses.from_particles() == {"FINISHED"}
    thing = bpy.context.view_layer.objects.active
    assert thing.type == "CURVES" and len(thing.data.curves) == 40 and thing.data.surface == body
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    scene.frame_set(1)
    first = arrays(thing)
    scene.frame_set(4)
    assert np.abs(arrays(thing) - first).max() > 1e-3


def test_several_objects_meet_on_one_body(saved):
    scenes.empty(last=3)
    body, _ = scenes.ball()
    things = [scenes.hair(body, 20), scenes.hair(body, 30)]
    saved()
    select(*things)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    bpy.context.scene.frame_set(3)
    for thing, count in zip(things, (20, 30)):
        assert len(arrays(thing)) == 16 * count and np.abs(arrays(thing) - groom(thing)).max() > 1e-3


def test_hair_without_a_body_swings_about_its_roots(saved):
    scene = scenes.empty(last=12)
    curves = bpy.data.hair_curves.new("Free")
    curves.add_curves([8] * 10)
    points = np.zeros((10, 8, 3), np.float32)
    points[..., 0] = np.linspace(0, 0.2, 8)
    points[..., 1] = 0.02 * np.arange(10)[:, None]
    curves.position_data.foreach_set("vector", points.ravel())
    thing = bpy.data.objects.new("Free", curves)
    scene.collection.objects.link(thing)
    for frame, y in ((1, 0.0), (6, 0.4)):
        thing.location.y = y
        thing.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    saved()
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    scene.frame_set(5)
    now = arrays(thing).reshape(10, 8, 3)
    # Tips stay behind, in the space of the object.
    assert np.abs(now[:, 0] - points[:, 0]).max() < 1e-5 and (now - points)[:, -1, 1].max() < -0.03


def test_a_body_that_multiplies_its_vertices(saved):
    scene = scenes.empty(last=4)
    body, _ = scenes.ball()
    body.modifiers.new("Smooth", "SUBSURF").levels = 1
    thing = scenes.hair(body, 30)
    saved()
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    scene.frame_set(4)
    assert np.isfinite(arrays(thing)).all() and np.abs(arrays(thing) - groom(thing)).max() > 1e-3


def test_an_edited_groom_asks_for_another_simulation(saved):
    scene = scenes.empty(last=3)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 20)
    saved()
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    thing.data.add_curves([4])
    scene.frame_set(3)
    assert np.isfinite(arrays(thing)).all()
    with pytest.raises(RuntimeError, match="edited"):
        bpy.ops.tresses.bake()


def test_an_interrupted_simulation_keeps_its_frames(package, saved):
    scene = scenes.empty(last=8)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 20)
    saved()
    one = package.run.Run(bpy.context, [thing], [body], package.run.Options(1, 8, settle=0))
    frames = one.frames()
    for _ in range(3):
        next(frames)
    # The process ends here: nothing is closed. Another one finds three frames.
    kept = package.cache.Cache(package.cache.folder(thing))
    assert (kept.done, kept.last) == (3, 3)
    one.end()
    select(thing)
    assert bpy.ops.tresses.bake() == {"FINISHED"}
    scene.frame_set(3)
    third = arrays(thing)
    scene.frame_set(8)
    assert np.abs(arrays(thing) - third).max() < 0.4 and package.nodes.modifier(thing)


def test_an_interrupted_simulation_goes_on(package, saved, monkeypatch):
    monkeypatch.setattr(package.run, "KEEP", 0.0)
    scene = scenes.empty(last=10)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 20)
    saved()
    select(thing)
    assert bpy.ops.tresses.simulate() == {"FINISHED"}
    whole = package.cache.Cache(package.cache.folder(thing)).values.copy()
    assert package.cache.next_frame(thing) is None
    with pytest.raises(RuntimeError, match="changed since"):
        bpy.ops.tresses.simulate(resume=True)
    things, meshes, options = package.operators.prepared(bpy.context, [thing])
    one = package.run.Run(bpy.context, things, meshes, options)
    frames = one.frames()
    for _ in range(options.settle + 6):
        next(frames)
    # The process ends here: nothing is closed.
    one.end()
    left = package.cache.Cache(package.cache.folder(thing))
    assert (left.done, left.state_at, package.cache.next_frame(thing)) == (6, 6, 7)
    from test_panel import drawn

    assert "Go On from Frame 7" in drawn(package)
    left.values[6:] = 0
    thing.tresses.values.simulation__drag = 7
    with pytest.raises(RuntimeError, match="changed since"):
        bpy.ops.tresses.simulate(resume=True)
    thing.tresses.values.property_unset("simulation__drag")
    assert bpy.ops.tresses.simulate(resume=True) == {"FINISHED"}
    kept = package.cache.Cache(package.cache.folder(thing))
    assert kept.done == 10 and np.abs(kept.values - whole).max() < 1e-4
    scene.frame_set(10)
    assert np.abs(arrays(thing) - groom(thing)).max() > 1e-3


def test_live_hair_follows_the_timeline(saved):
    scene = scenes.empty(last=10)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 20)
    saved()
    select(thing)
    assert bpy.ops.tresses.live() == {"FINISHED"}
    first = arrays(thing)
    for frame in range(2, 9):
        scene.frame_set(frame)
    moved = arrays(thing)
    assert np.abs(moved - first).max() > 0.01
    assert bpy.ops.tresses.live() == {"FINISHED"}
    assert thing.data.attributes.get("tresses_position") is None
    assert not any(o.name.startswith("Tresses") for o in bpy.data.objects)


def test_mistakes_are_told_in_a_sentence(saved):
    scene = scenes.empty(last=3)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 5)
    saved()
    for selected in bpy.context.selected_objects:
        selected.select_set(False)
    bpy.context.view_layer.objects.active = None
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.tresses.simulate()
    bare = bpy.data.objects.new("Bare", bpy.data.hair_curves.new("Bare"))
    scene.collection.objects.link(bare)
    select(bare)
    with pytest.raises(RuntimeError, match="Bare has no curves"):
        bpy.ops.tresses.simulate()
    plane = bpy.data.objects.new("Wire", bpy.data.meshes.new("Wire"))
    plane.data.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    scene.collection.objects.link(plane)
    select(thing)
    thing.tresses.body = plane
    with pytest.raises(RuntimeError, match="Wire has no faces"):
        bpy.ops.tresses.simulate()
    thing.tresses.body = None
    with pytest.raises(RuntimeError, match="no simulated frames"):
        bpy.ops.tresses.bake()
    uvs = thing.data.attributes["surface_uv_coordinate"]
    thing.data.attributes.remove(uvs)
    with pytest.raises(RuntimeError, match="not attached"):
        bpy.ops.tresses.simulate()
    assert all(m.show_viewport for m in thing.modifiers)


def test_parameters_of_the_table_are_properties(package, saved):
    scenes.empty(last=2)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 5)
    values = thing.tresses.values
    assert package.parameters.changed(values) == {}
    values.simulation__drag = 7
    values.simulation__hair_hair = "fixed"
    assert package.parameters.changed(values) == {"simulation.drag": 7, "simulation.hair_hair": "fixed"}
    bpy.context.scene.gravity.z = -3
    assert thing.tresses.settings(bpy.context.scene)["simulation.gravity"] == pytest.approx(3)


def test_what_is_wrong_is_selected(package, saved):
    scenes.empty(last=2)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 5)
    points = groom(thing)
    points[32:48] = points[32]
    thing.data.position_data.foreach_set("vector", points.ravel())
    select(thing)
    assert bpy.ops.tresses.check() == {"FINISHED"}
    chosen = np.zeros(5, bool)
    thing.data.attributes[".selection"].data.foreach_get("value", chosen)
    assert chosen.tolist() == [False, False, True, False, False]


def test_wind_of_the_scene_blows(package, saved):
    last = 10
    scene = scenes.empty(last=60)
    body, _ = scenes.ball(degrees=0)
    thing = scenes.hair(body, 30)

    def tips(hidden_after=None):
        one = package.run.Run(bpy.context, [thing], [body], package.run.Options(1, last, settle=0))
        for i, _ in enumerate(one.frames()):
            if i == hidden_after:
                bpy.context.object.hide_set(True)
        out = one.space.back(one.simulation.given(), thing.matrix_world).reshape(30, 16, 3)[:, -1].mean(0)
        one.end()
        return out

    saved()
    calm = tips()
    bpy.ops.object.effector_add(type="WIND", rotation=(0, np.pi / 2, 0))
    bpy.context.object.field.strength = 8
    bpy.context.view_layer.update()
    blown = (tips() - calm)[0]
    assert blown > 0.02, "the arrow points along X"
    last = 60
    stays = (tips() - calm)[0]
    falls = (tips(hidden_after=10) - calm)[0]
    assert stays > 0.02 and falls < 0.25 * stays, f"a hidden field blows no more: {falls} of {stays}"


def test_an_attribute_stiffens(package, saved):
    scenes.empty(last=12)
    body, _ = scenes.ball(degrees=60)
    thing = scenes.hair(body, 30)
    saved()

    def bent():
        one = package.run.Run(bpy.context, [thing], [body], package.run.Options(1, 12, settle=0))
        for _ in one.frames():
            pass
        now = np.concatenate([points for _, points in one.positions()]).reshape(30, 16, 3)
        one.end()
        return np.linalg.norm(now - groom(thing).reshape(30, 16, 3), axis=2)[:, -1].mean()

    plain = bent()
    thing.data.attributes.new("stiff", "FLOAT", "CURVE").data.foreach_set("value", np.full(30, 40, np.float32))
    thing.tresses.stiffness = "stiff"
    assert bent() < 0.6 * plain
    thing.tresses.stiffness = "missing"
    with pytest.raises(Exception, match="has no attribute missing"):
        bent()
