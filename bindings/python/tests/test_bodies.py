"""Bodies that the caller deforms, marks of strands, and caches."""

import numpy as np
import pytest

import tresses

FRAME = 1 / 24


def ball(radius=0.1, rings=24):
    """Return vertices and triangles of a ball around the origin."""
    polar = np.linspace(0, np.pi, rings + 1)[:, None]
    around = np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False)[None]
    points = np.stack(
        [np.sin(polar) * np.sin(around), np.cos(polar) + 0 * around, np.sin(polar) * np.cos(around)], -1
    )
    columns = 2 * rings
    at = lambda i, j: i * columns + j % columns
    triangles = [
        corners
        for i in range(rings)
        for j in range(columns)
        for corners in ([at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)])
    ]
    return radius * points.reshape(-1, 3), np.array(triangles)


def hair(count=120, vertices=9, length=0.12):
    """Return strands on the upper half of the ball, straight out, [count, vertices, 3]."""
    i = np.arange(count)
    down, turn = 1.2 * np.sqrt((i + 0.5) / count), 2.399963 * i
    out = np.stack([np.sin(down) * np.sin(turn), np.cos(down), np.sin(down) * np.cos(turn)], -1)
    return out[:, None] * (0.1 + np.linspace(0, length, vertices))[None, :, None]


def turned(angle):
    """Return a turn about Z, [3, 3]."""
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]])


def simulated(rig, strands=None):
    points, triangles = ball()
    strands = hair() if strands is None else strands
    groom = tresses.Groom.of(
        tresses.Strands(strands), tresses.Mesh(points, triangles), {"lod.mode": "off", "style.all_guides": True}, rig=rig
    )
    return points, tresses.Simulation(groom)


def test_given_vertices_come_back_in_their_order():
    strands = hair(vertices=13)
    # A strand without length is dropped by the repair, and moves with the head.
    strands[7] = strands[7, :1]
    _, sim = simulated(None, strands)
    assert sim.given().shape == (120 * 13, 3)
    assert np.abs(sim.given() - strands.reshape(-1, 3)).max() < 2e-6
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turned(0.4), [0.2, 0.1, 0]
    sim.reset(body=pose)
    assert np.abs(sim.given() - (strands.reshape(-1, 3) @ turned(0.4).T + pose[:3, 3])).max() < 1e-5
    for _ in range(24):
        sim.step(FRAME)
    now = sim.given().reshape(120, 13, 3)
    lengths = np.linalg.norm(np.diff(now, axis=1), axis=2).sum(1)
    assert np.abs(np.delete(lengths, 7) / 0.12 - 1).max() < 0.01
    assert np.abs(now - strands).max() > 0.02, "it falls"
    with pytest.raises(tresses.TressesError, match="Groom.of"):
        tresses.Simulation(tresses.Groom.built_in("bob", {"style.strands": 50})).given()


def test_hair_follows_vertices_of_the_caller():
    points, sim = simulated(tresses.Rig.single())
    strands = hair()
    sim.reset(skin=points)
    assert np.abs(sim.given() - strands.reshape(-1, 3)).max() < 1e-5
    # A rigid turn of all vertices turns the hair at rest.
    sim.reset(skin=points @ turned(0.7).T)
    assert np.abs(sim.given() - strands.reshape(-1, 3) @ turned(0.7).T).max() < 2e-4
    # The ball swells by a fifth on one side: roots stay on it, and no vertex is inside.
    sim.reset(skin=points)
    for i in range(24):
        share = min(1, i / 12)
        swell = lambda p: p * (1 + 0.2 * share * np.maximum(p[..., :1], 0) / 0.1)
        sim.step(FRAME, skin=swell(points))
    now = sim.given().reshape(strands.shape)
    assert np.abs(now[:, 0] - swell(strands[:, 0])).max() < 1e-3
    direction = now / np.linalg.norm(now, axis=-1, keepdims=True)
    skin = 0.1 * (1 + 0.2 * np.maximum(direction[..., 0], 0))
    # The root itself lies on the skin.
    assert (np.linalg.norm(now, axis=-1) - skin)[:, 1:].min() > -1e-3
    # Two calls with the same vertices give the same hair.
    again = simulated(tresses.Rig.single())[1]
    again.reset(skin=points)
    for i in range(24):
        share = min(1, i / 12)
        again.step(FRAME, skin=points * (1 + 0.2 * share * np.maximum(points[:, :1], 0) / 0.1))
    assert np.array_equal(again.given(), now.reshape(-1, 3))


def test_joints_and_vertices_pose_the_same_body():
    points, _ = ball()
    rest = np.stack([np.eye(4), np.eye(4)])
    rest[1, 1, 3] = 0.02
    upper = np.clip(points[:, 1] / 0.05 + 0.5, 0, 1)
    rig = tresses.Rig(["root", "head"], [-1, 0], rest, [[1, 0]] * len(points), np.stack([upper, 1 - upper], -1))
    assert len(rig) == 2
    joints = rest.copy()
    joints[1, :3, :3] = turned(0.5)
    moved = points @ turned(0.5).T + [0, 0.02, 0] - turned(0.5) @ [0, 0.02, 0]
    skin = moved * upper[:, None] + points * (1 - upper[:, None])
    by_joints, by_both = simulated(rig)[1], simulated(rig)[1]
    by_joints.reset(joints=rest)
    by_both.reset(joints=rest, skin=points)
    for i in range(12):
        by_joints.step(FRAME, joints=joints)
        by_both.step(FRAME, joints=joints, skin=skin)
    assert np.abs(by_joints.given() - by_both.given()).max() < 2e-3
    assert by_joints.head[1] == pytest.approx(by_both.head[1], abs=1e-6)
    assert by_joints.head[1] == pytest.approx([0, 0, np.sin(0.25), np.cos(0.25)], abs=1e-5)


def test_state_continues_in_another_process():
    points, triangles = ball()
    groom = tresses.Groom.of(
        tresses.Strands(hair()), tresses.Mesh(points, triangles), {"lod.mode": "off", "style.all_guides": True},
        rig=tresses.Rig.single(),
    )  # fmt: skip
    skin = lambda i: points @ turned(0.8 * np.sin(0.4 * i)).T
    whole = tresses.Simulation(groom)
    whole.reset(skin=skin(0))
    for i in range(1, 13):
        whole.step(FRAME, skin=skin(i))
        if i == 6:
            state, kept = whole.state(), whole.given()
    rest = tresses.Simulation(groom)
    rest.reset(skin=skin(6), state=state)
    assert np.abs(rest.given() - kept).max() < 1e-6
    assert rest.state() == state
    for i in range(7, 13):
        rest.step(FRAME, skin=skin(i))
    assert np.abs(whole.given() - kept).max() > 0.01
    assert np.abs(rest.given() - whole.given()).max() < 2e-4
    cold = tresses.Simulation(groom)
    cold.reset(skin=skin(6))
    for i in range(7, 13):
        cold.step(FRAME, skin=skin(i))
    assert np.abs(cold.given() - whole.given()).max() > 0.005, "without the state it differs"
    for wrong in (b"", state[:-8], b"x" * 400, bytes(len(state))):
        with pytest.raises(tresses.TressesError, match="of other hair|damaged"):
            rest.reset(skin=skin(6), state=wrong)


def test_invalid_bodies_fail_in_a_sentence():
    points, sim = simulated(None)
    with pytest.raises(tresses.TressesError, match="need a rig"):
        sim.step(FRAME, skin=points)
    points, sim = simulated(tresses.Rig.single())
    with pytest.raises(tresses.TressesError, match="2 vertices, but the mesh has"):
        sim.step(FRAME, skin=points[:2])
    with pytest.raises(tresses.TressesError, match="not finite"):
        sim.step(FRAME, skin=points * np.nan)
    with pytest.raises(tresses.TressesError, match="2 transforms, but the rig has 1"):
        sim.step(FRAME, joints=np.stack([np.eye(4)] * 2))
    good = dict(names=["a"], parents=[-1], rest=[np.eye(4)], joints=[[0]], weights=[[1]])
    for wrong, clause in [
        (dict(parents=[0]), "parent of joint 0"),
        (dict(rest=[np.zeros((4, 4))]), "no inverse"),
        (dict(joints=[[1]]), "follows joint 1"),
        (dict(weights=[[-1]]), "weights of vertex 0"),
        (dict(weights=[[1, 1]]), "shape"),
        (dict(names=[]), "0 joints"),
    ]:
        with pytest.raises(tresses.TressesError, match=clause):
            tresses.Rig(**{**good, **wrong})
    with pytest.raises(tresses.TressesError, match="the rig has 1 vertices"):
        simulated(tresses.Rig(**good))
    with pytest.raises(tresses.TressesError, match="needs the head"):
        tresses.Groom.of(tresses.Strands(hair()), rig=tresses.Rig.single())


@pytest.mark.parametrize("ending", ["abc", "usda", "glb"])
def test_attributes_keep_name_kind_and_values(tmp_path, ending):
    strands = tresses.Strands(hair())
    given = {
        "age": np.arange(120) - 4,
        "curl": np.linspace(0, 1, len(strands.positions)),
        "tint": np.tile(np.float32([0.1, 0.2, 0.3]), (120, 1)),
    }
    strands = tresses.Strands(hair(), attributes=given)
    file = tmp_path / f"groom.{ending}"
    assert strands.write(file) == []
    back = tresses.read(file).strands.attributes
    assert back.keys() == given.keys() and back["age"].dtype == np.int32
    assert all(np.allclose(back[name], values, atol=1e-6) for name, values in given.items())
    assert any("“curl” is not written" in note for note in strands.write(tmp_path / "groom.hair"))
    with pytest.raises(tresses.TressesError, match="has 3 values for 120 strands"):
        tresses.Strands(hair(), attributes={"a": [1, 2, 3]})


@pytest.mark.parametrize("ending", ["abc", "usda"])
def test_marks_and_groups_reach_files_and_come_back(tmp_path, ending):
    guides = np.arange(120) < 30
    groups, ids = np.arange(120) % 3, 1000 + np.arange(120)
    closest = np.stack([1000 + np.arange(120) % 30, 1000 + (np.arange(120) + 1) % 30], -1)
    weights = np.stack([np.full(120, 0.75), np.full(120, 0.25)], -1)
    strands = tresses.Strands(
        hair(), widths=8e-5, root_uvs=np.full((120, 2), 0.25),
        guides=guides, ids=ids, groups=groups, closest=closest, weights=weights,
    )
    file = tmp_path / f"groom.{ending}"
    assert strands.write(file, unit="cm") == []
    back = tresses.read(file).strands
    assert np.array_equal(back.guides, guides) and np.array_equal(back.groups, groups)
    assert np.array_equal(back.ids, ids) and np.array_equal(back.closest[:, :2], closest)
    assert np.allclose(back.weights[:, :2], weights) and np.allclose(back.root_uvs, 0.25)
    assert np.allclose(back.widths, 8e-5)
    # Only guides are simulated, and the others follow those that they name.
    groom = tresses.Groom.of(back)
    assert len(groom.guides) == 30
    assert tresses.Strands(hair()).guides is None
    with pytest.raises(tresses.TressesError, match="weights need"):
        tresses.Strands(hair(), weights=weights)
    with pytest.raises(tresses.TressesError, match=r"groups have the shape"):
        tresses.Strands(hair(), groups=[1, 2])
    with pytest.raises(tresses.TressesError, match="too large"):
        tresses.Strands(hair(), ids=np.full(120, 2**40))


@pytest.mark.parametrize("ending", ["abc", "usda"])
def test_caches_hold_every_frame(tmp_path, ending):
    strands = tresses.Strands(hair(), widths=8e-5)
    file = tmp_path / f"cache.{ending}"
    with tresses.Cache(file, strands, frames=3, fps=25, unit="cm") as cache:
        for i in range(3):
            cache.frame(hair() + [0, 0.1 * i, 0])
    for i in range(3):
        back = tresses.read(file, frame=i, up="y", front="z", mirror=False).strands
        assert np.abs(back.positions - (hair() + [0, 0.1 * i, 0]).reshape(-1, 3)).max() < 1e-5
    cache = tresses.Cache(file, strands, frames=2)
    cache.frame(hair())
    with pytest.raises(tresses.TressesError, match="1 frames of the cache are missing"):
        cache.close()
    with pytest.raises(tresses.TressesError, match="ended"):
        cache.frame(hair())
    with pytest.raises(tresses.TressesError, match="number of positions|positions"):
        with tresses.Cache(file, strands, frames=2) as cache:
            cache.frame(hair()[:3])
    with pytest.raises(tresses.TressesError, match="cache can be written as"):
        tresses.Cache(tmp_path / "a.obj", strands, frames=2)


def test_strands_fit_another_head(tmp_path):
    points, triangles = ball()
    other = tresses.Mesh(*ball(0.11, 31))
    strands = tresses.Strands(hair(), widths=8e-5, groups=np.arange(120) % 2)
    fitted, report = tresses.retarget(strands, tresses.Mesh(points, triangles), other)
    assert not report["same_topology"] and report["inside"] < 0.005 and report["skin_error"] < 1.5e-3
    assert np.allclose(fitted.lengths, strands.lengths, rtol=1e-4) and np.array_equal(fitted.groups, strands.groups)
    roots = fitted.positions[fitted.offsets[:-1]]
    assert np.abs(np.linalg.norm(roots, axis=1) - 0.11).max() < 2e-3
    with pytest.raises(tresses.TressesError, match="1 landmarks of the head, but 2"):
        tresses.retarget(strands, other, other, ([[0, 0, 0]], [[0, 0, 0], [1, 1, 1]]))
    with pytest.raises(tresses.TressesError, match="no strands"):
        tresses.retarget(tresses.Strands.of([]), other, other)


def test_stiff_strands_bend_less():
    def swung(stiffness):
        points, triangles = ball()
        groom = tresses.Groom.of(
            tresses.Strands(hair(length=0.2)), tresses.Mesh(points, triangles),
            {"lod.mode": "off", "style.all_guides": True}, stiffness=stiffness,
        )  # fmt: skip
        sim = tresses.Simulation(groom)
        for _ in range(12):
            sim.step(FRAME, wind=[-6, 0, 0])
        return np.linalg.norm(sim.given().reshape(120, 9, 3) - hair(length=0.2), axis=2)[:, -1]

    plain = swung(None)
    assert swung(60.0).mean() < 0.7 * plain.mean()
    # Neighbors rub on each other, so soft strands move less too, but stiff ones move least.
    mixed = swung(np.where(np.arange(120) % 2, 60.0, 1.0)) / plain
    assert mixed[1::2].mean() < 0.9 * mixed[::2].mean(), f"{mixed[1::2].mean()} and {mixed[::2].mean()}"
    assert np.allclose(swung(1.0), plain)
    with pytest.raises(tresses.TressesError, match="3 stiffness, but must be 120"):
        swung([1, 2, 3])
    with pytest.raises(tresses.TressesError, match="not below 0"):
        swung(-1.0)
