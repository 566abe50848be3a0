"""Step-by-step simulation."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import tresses


def moved(sim, steps=20):
    motion = tresses.Motion("shake")
    for i in range(steps):
        sim.step(1 / 60, wind=[-6, 0, 1], **motion.at((i + 1) / 60, sim.pivot))
    return sim


def test_hair_at_rest_matches_the_groom(groom, sim):
    assert np.abs(sim.strands().positions - groom.strands().positions).max() < 1e-3
    assert np.abs(sim.guides() - groom.guides).max() < 1e-3
    assert sim.time == 0 and len(sim.face()) > 0


def test_simulation_is_deterministic(groom, sim):
    rest = sim.strands().positions
    once = moved(sim).strands().positions
    again = moved(tresses.Simulation(groom)).strands().positions
    assert np.array_equal(once, again)
    assert np.abs(once - rest).max() > 5e-3 and np.isfinite(once).all()
    sim.reset()
    assert np.array_equal(sim.strands().positions, rest) is False, "the head is where it was said to be"
    sim.reset(head=np.eye(4), body=np.eye(4), shapes={})
    assert np.array_equal(sim.strands().positions, rest)
    # Another wind gives another motion.
    other = tresses.Simulation(groom, {"wind.speed": 6})
    for _ in range(10):
        other.step(1 / 60)
    assert not np.array_equal(other.guides(), moved(sim, 10).guides())


def test_roots_follow_the_head(groom):
    sim = tresses.Simulation(groom)
    rest = sim.strands().grid()
    angle = 0.3
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    pose = np.eye(4)
    pose[:3, :3] = turn
    pose[:3, 3] = [0.1, 0.02, -0.3]
    for given in (pose, (pose[:3, 3], [0, np.sin(angle / 2), 0, np.cos(angle / 2)])):
        sim.reset(body=np.eye(4))
        # Walk for half a second, without teleporting.
        for i in range(30):
            sim.step(1 / 60, body=([0.1 * (i + 1) / 30, 0, 0], [0, 0, 0, 1]))
        sim.reset(body=given)
        roots = sim.strands().grid()[:, 0]
        assert np.abs(roots - (rest[:, 0] @ turn.T + pose[:3, 3])).max() < 1e-4
    translation, quaternion = sim.head
    assert np.allclose(translation, pose[:3, 3], atol=1e-5) and np.isclose(np.linalg.norm(quaternion), 1)


def test_long_steps_are_split(groom):
    one, many = tresses.Simulation(groom, {"wind.speed": 5}), tresses.Simulation(groom, {"wind.speed": 5})
    rest = one.strands().lengths
    many.reset()
    one.step(0.5)
    for _ in range(5):
        many.step(0.1)
    assert one.time == pytest.approx(0.5) and many.time == pytest.approx(0.5)
    assert np.abs(one.guides() - many.guides()).max() < 1e-4
    assert np.abs(one.strands().lengths / rest - 1).max() < 0.02


def test_invalid_arguments_fail(groom, sim):
    nonsense = [
        dict(dt=-1),
        dict(dt=float("nan")),
        dict(dt=0.1, head=np.eye(3)),
        dict(dt=0.1, head=2 * np.eye(4)),
        dict(dt=0.1, head=np.diag([1, 1, -1, 1])),
        dict(dt=0.1, head=np.full((4, 4), np.nan)),
        dict(dt=0.1, head=([0, 0, 0], [0, 0, 0, 2])),
        dict(dt=0.1, wind=[1, 2]),
        dict(dt=0.1, wind=[1, 2, np.inf]),
        dict(dt=0.1, shapes={"nose": 1}),
    ]
    before = sim.guides()
    for words in nonsense:
        with pytest.raises(tresses.TressesError):
            sim.step(**words)
    assert np.array_equal(sim.guides(), before) and sim.time == 0
    with pytest.raises(tresses.TressesError, match="another Groom"):
        sim.apply({"style.strands": 100})
    with pytest.raises(tresses.TressesError, match="give them to the Groom"):
        tresses.Simulation(groom, {"style.strands": 100})
    with pytest.raises(tresses.TressesError, match="no companion file"):
        tresses.Groom.built_in("bob", densitymap="x.png")
    with pytest.raises(tresses.TressesError, match="long, bob"):
        tresses.Groom.built_in("mohawk")
    with pytest.raises(tresses.TressesError, match="motion"):
        tresses.Motion("moonwalk")


def test_settings_change_between_steps(sim):
    sim.apply({"wind.speed": 3, "shading.color": "red"})
    assert sim.settings["wind.speed"] == 3 and sim.settings["shading.color"] == "red"
    sim.step(0.1)


def test_progress_callback_exceptions_propagate():
    told = []
    groom = tresses.Groom.built_in("bob", {"style.strands": 300}, progress=lambda *words: told.append(words))
    assert told and all(isinstance(task, str) and 0 <= share <= 1 for task, share in told)
    tresses.Simulation(groom, progress=lambda task, share: None)

    class Enough(Exception):
        pass

    def stop(task, share):
        raise Enough(task)

    with pytest.raises(Enough):
        tresses.Groom.built_in("bob", {"style.strands": 300}, progress=stop)


def test_ctrl_c_interrupts_a_long_call(sim):
    sim.step(0.1)
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        sim.step(3000.0)
    assert time.monotonic() - begun < 60 and 0 < sim.time < 3000
    timer.join()
    sim.step(0.1)


def test_long_calls_release_the_gil(sim):
    counted = [0]
    done = threading.Event()

    def count():
        while not done.wait(0.001):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    sim.step(2.0)
    done.set()
    thread.join()
    assert counted[0] - before > 5
