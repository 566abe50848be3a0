"""Plans, schedules, shards, and recovery from killed workers."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import tresses
from tresses import farm
from tresses.farm import drive, forecast, schedule, shards, work
from tresses.farm.folder import Folder

SMALL = """
seed = 5
frames = 4
every = 2
shard = 2
size = [64, 40]
outputs = ["color", "depth", "strand", "motion"]
motions = ["shake", "nod"]

[settings]
style.strands = 200
style.guides = 60

[[groom]]
style = "bob"

[sweep]
"shading.color" = ["red", "black"]

[draw]
wind.speed = { from = 0, to = 9 }

[[camera]]
name = "front"

[[camera]]
name = "around"
azimuth = { from = -180, to = 180 }
elevation = 10
"""


@pytest.fixture(scope="session")
def small(tmp_path_factory):
    """Return the plan and the output of a single worker."""
    folder = tmp_path_factory.mktemp("farm")
    file = folder / "small.toml"
    file.write_text(SMALL)
    plan = farm.read(file)
    farm.run(plan, folder / "whole", tell=lambda line: None)
    return plan, folder / "whole"


def command(*words, **more):
    return subprocess.run(
        [sys.executable, "-m", "tresses.farm", *map(str, words)], capture_output=True, text=True, timeout=300, **more
    )


def contents(folder):
    """Return the files of a run that must be bit-identical between runs."""
    files = [folder / "manifest.json", *sorted((folder / "shards").iterdir())]
    return {file.name: file.read_bytes() for file in files}


def arrays(files):
    """Return the arrays of a sample."""
    return {ending[:-4]: np.load(io.BytesIO(data)) for ending, data in files.items() if ending.endswith(".npy")}


def killed_in_the_midst(plan, out, **words):
    """Run two workers and kill the first while it writes shard 0. Return the progress messages."""
    told = []

    def kill(process):
        until = time.monotonic() + 120
        while not list(out.glob("shards/.000000-*.part")) and time.monotonic() < until:
            time.sleep(0.002)
        os.kill(process, signal.SIGKILL)

    def tell(line):
        told.append(line)
        found = re.match(r"worker \d+: process (\d+)", line)
        if found and len(told) == 1:
            threading.Thread(target=kill, args=[int(found[1])], daemon=True).start()

    farm.run(plan, out, workers=2, tell=tell, **words)
    return told


# Plans


def test_plan_expands_into_shots(small):
    plan, _ = small
    assert len(plan.shots) == 4 and len(plan.shards) == 8 and [c.name for c in plan.cameras] == ["front", "around"]
    assert [shot.name for shot in plan.shots][:2] == ["bob shading.color=red shake", "bob shading.color=red nod"]
    speeds = [shot.settings["wind.speed"] for shot in plan.shots]
    assert len(set(speeds)) == 4 and all(0 <= speed <= 9 for speed in speeds)
    assert farm.parse(SMALL) == farm.parse(SMALL)
    assert farm.parse(SMALL).fingerprint != farm.parse(SMALL.replace("seed = 5", "seed = 6")).fingerprint


def test_additions_keep_existing_shots():
    before = {shot.name: (shot.seed, shot.settings) for shot in farm.parse(SMALL).shots}
    more = SMALL.replace('["red"', '["blond", "red"').replace('motions = [', 'motions = ["turn", ')
    after = {shot.name: (shot.seed, shot.settings) for shot in farm.parse(more).shots}
    assert len(after) == 9 and before.items() <= after.items()
    other = {shot.name: (shot.seed, shot.settings) for shot in farm.parse(SMALL.replace("seed = 5", "seed = 6")).shots}
    assert other.keys() == before.keys() and not any(other[name] == before[name] for name in other)


def test_draws_cover_their_ranges():
    plan = farm.parse(
        'frames = 1\ndraws = 400\nsettings.style.strands = 9\n[draw]\nwind.speed = { from = 2, to = 8 }\n'
        'style.seed = { from = 0, to = 3 }\n"shading.color" = ["red", "black"]\n'
        "shading.eumelanin = { from = 0.1, to = 10, log = true }\n"
    )
    drawn = {name: [shot.settings[name] for shot in plan.shots] for name in plan.shots[0].settings}
    assert min(drawn["wind.speed"]) < 2.1 and max(drawn["wind.speed"]) > 7.9
    assert np.mean(drawn["wind.speed"]) == pytest.approx(5, abs=0.3)
    assert np.median(drawn["shading.eumelanin"]) == pytest.approx(1, rel=0.4)
    assert [drawn["style.seed"].count(i) for i in range(4)] == pytest.approx([100] * 4, abs=35)
    assert drawn["shading.color"].count("red") == pytest.approx(200, abs=40)
    assert abs(np.corrcoef(drawn["wind.speed"], drawn["shading.eumelanin"])[0, 1]) < 0.15


@pytest.mark.parametrize(
    "lines, sentence",
    [
        ("frames = ", "is not valid TOML"),
        ("", "frames is missing"),
        ("frames = 0", "frames is 0, but must be from 1"),
        ("frames = true", "frames is True, but must be a whole number"),
        ("frames = 3.5", "frames is 3.5"),
        ("frames = 2\nframe = 3", "frame is unknown; a plan has"),
        ("frames = 2\nsize = [0, 10]", "size"),
        ("frames = 2\nsize = [64, 100000]", "size"),
        ("frames = 2\nrate = inf", "rate is inf"),
        ('frames = 2\noutputs = ["normals"]', "no output normals"),
        ('frames = 2\noutputs = ["color", "color"]', "outputs has 'color' twice"),
        ("frames = 2\noutputs = []", "outputs"),
        ('frames = 2\nmotions = ["moonwalk"]', "motions: .*moonwalk"),
        ("frames = 2\nsettings.wind.speed = -1", "settings: .*wind.speed"),
        ('frames = 2\nsettings.wind.speed = "fast"', "settings: .*wind.speed"),
        ("frames = 2\nsettings.wind.sped = 1", "settings: .*the nearest is wind.speed"),
        ("frames = 2\nsettings.style.strands = 10000000000000", "style.strands"),
        ("frames = 2\nsweep.wind.speed = 3", "sweep: wind.speed is 3, but must be a list"),
        ("frames = 2\nsweep.wind.speed = [3, 3]", "sweep: wind.speed has 3 twice"),
        ("frames = 2\nsweep.wind.speed = [3, 1e9]", "sweep: .*wind.speed"),
        ("frames = 2\nsweep.wind.speed = [3]\ndraw.wind.speed = [4]", "draw: wind.speed is also in .sweep."),
        ("frames = 2\ndraw.wind.speed = { from = 4 }", "draw: wind.speed.to"),
        ("frames = 2\ndraw.wind.speed = { from = 4, to = 2 }", "from 4 down to 2"),
        ("frames = 2\ndraw.wind.speed = { from = 0, to = 2, log = true }", "log"),
        ("frames = 2\ndraw.wind.speed = { from = 0, to = 1e9 }", "draw: wind.speed.to is 1000000000.0, but must be"),
        ("frames = 2\ndraw.shading.color = { from = 0, to = 1 }", "draw: shading.color"),
        ("frames = 2\ndraws = 3", "nothing is random"),
        ("frames = 1000000\ndraws = 1000000\ndraw.wind.speed = [1, 2]", "the limit is"),
        ('frames = 2\n[[groom]]\nstyle = "mohawk"', r"groom\[0\].style is mohawk, but must be one of long"),
        ('frames = 2\n[[groom]]\nfile = "none.tfx"', r"groom\[0\].file: .*none.tfx"),
        ('frames = 2\n[[groom]]\nstyle = "bob"\nhead = "x.obj"', r"groom\[0\].head is unknown"),
        ('frames = 2\n[[groom]]\nstyle = "bob"\nties = "x.json"', r"groom\[0\].ties: .*x.json does not exist"),
        ('frames = 2\n[[groom]]\nstyle = "bob"\n[[groom]]\nstyle = "bob"', "two grooms called bob"),
        ("frames = 2\n[[groom]]", "style, file or preset"),
        ('frames = 2\n[[camera]]\nname = "a.b"', r"camera\[0\].name"),
        ('frames = 2\n[[camera]]\nname = "a"', "one of: angle"),
        ('frames = 2\n[[camera]]\nname = "a"\neye = [0, 1, 2]', "target"),
        ('frames = 2\n[[camera]]\nname = "a"\neye = [0, 1]', r"camera\[0\].eye"),
        ('frames = 2\n[[camera]]\nname = "front"\nelevation = 3', r"camera\[0\].elevation does not apply"),
        ('frames = 2\n[[camera]]\nname = "front"\n[[camera]]\nname = "front"', "two cameras called front"),
        ('frames = 2\n[[look]]\nname = "a"\n[look.settings]\nwind.speed = 1e9', r"look\[0\].settings: "),
        ("frames = 2\ncamera = 3", r"camera is 3, but must be tables"),
    ],
)
def test_invalid_plans_fail_with_one_sentence(lines, sentence):
    with pytest.raises(farm.PlanError, match=sentence) as caught:
        farm.parse(lines)
    assert "\n" not in str(caught.value)


def test_broken_groom_fails_before_writing(tmp_path):
    (tmp_path / "hair.tfx").write_bytes(b"\1\0\0\0" * 40)
    (tmp_path / "plan.toml").write_text('frames = 2\n[[groom]]\nfile = "hair.tfx"\n')
    ended = command(tmp_path / "plan.toml", "--out", tmp_path / "out")
    assert ended.returncode == 2 and not (tmp_path / "out").exists()
    assert re.fullmatch(r"error: .*plan.toml: groom\[0\].file: .*hair.tfx.*\n", ended.stderr), ended.stderr
    (tmp_path / "plan.toml").write_text("frames = 2\n")
    for words, code, clause in [
        (["--dry-run"], 0, "1 shots of 2 frames"),
        (["--simulate", "1,2"], 2, "costs.json"),
        (["--simulate", "1,many"], 2, "many is not a whole number"),
        (["--verify"], 1, "no manifest"),
    ]:
        ended = command(tmp_path / "plan.toml", "--out", tmp_path / "out", *words)
        assert ended.returncode == code and clause in ended.stdout + ended.stderr, ended
    assert not (tmp_path / "out").exists()
    assert command(tmp_path / "none.toml").returncode == 2
    # A folder with other contents is left alone.
    ended = command(tmp_path / "plan.toml", "--out", tmp_path)
    assert ended.returncode == 1 and "contains other files" in ended.stderr


# Schedules


def played(runs, workers, lose=()):
    """Simulate workers that take one second per shard. Return the order of the shards and the total time."""
    places = [(shot, i) for shot, run in enumerate(runs) for i in range(len(run))]
    order, asked = [], schedule.Schedule(runs, places)
    now = {worker: asked.take(worker) for worker in range(workers)}
    for turn in range(1000):
        for worker in list(now):
            if (turn, worker) in lose:
                assert asked.lost(worker) == now[worker]
            elif now[worker] is not None:
                order.append(now[worker])
            now[worker] = asked.take(worker)
        if not asked.left:
            return order, turn + 1
    raise AssertionError("it never ends")


def test_every_shard_is_done_once():
    runs = [list(range(8 * shot, 8 * shot + 8)) for shot in range(5)]
    for workers in (1, 2, 3, 7, 40, 64):
        for lose in ((), {(0, 0)}, {(1, 0), (1, 1), (3, 0)}, {(turn, 0) for turn in range(9)}):
            order, turns = played(runs, workers, lose)
            assert sorted(order) == list(range(40)), (workers, lose)
            if not lose:
                # Workers hardly ever wait while shards are left.
                assert turns <= 40 / workers + 4
    assert played(runs, 1)[0] == list(range(40))
    # The check detects a duplicate shard.
    twice, _ = played([[0, 1], [1, 2]], 2)
    assert sorted(twice) != [0, 1, 2]


def test_taken_shards_account_for_repeated_steps():
    places = [(0, i) for i in range(20)]

    def taken(again, done=1):
        asked = schedule.Schedule([list(range(20))], places, again)
        for _ in range(done):
            asked.take("first")
        return asked.take("second")

    # Take half if steps are free, less if they cost more, and nothing if they are the whole cost.
    assert taken(0.0) == 10 and 10 < taken(0.3) < taken(0.6) < 20 and taken(1.0) is None
    assert taken(0.3, 20) is None
    # A worker that is already in the shot has fewer steps to repeat.
    asked = schedule.Schedule([list(range(10)), list(range(10, 20))], [(i // 10, i % 10) for i in range(20)], 0.3)
    for worker in range(3):
        asked.take(worker)
    third = asked.running[2]
    assert 5 < third < 10
    assert asked.take(1) == 11


# Shards


def test_output_is_identical_after_a_killed_worker(small, tmp_path):
    plan, whole = small
    told = killed_in_the_midst(plan, tmp_path / "killed")
    assert any("was lost with shard 0" in line for line in told), told
    there, again = contents(whole), contents(tmp_path / "killed")
    assert again == there
    assert farm.verify(tmp_path / "killed") == "8 shards with 32 samples match the manifest"
    # Another seed changes the output.
    other = farm.parse(SMALL.replace("seed = 5", "seed = 6").replace('"shake", ', ""))
    farm.run(other, tmp_path / "other", tell=lambda line: None)
    assert not set(contents(tmp_path / "other").values()) & set(there.values())


def test_interrupted_run_resumes(small, tmp_path):
    plan, whole = small
    file, out = tmp_path / "plan.toml", tmp_path / "out"
    file.write_text(SMALL)
    # Shells ignore Ctrl-C in background jobs, and child processes inherit that. Restore the default handler.
    heard = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        driver = subprocess.Popen(
            [sys.executable, "-m", "tresses.farm", file, "--out", out], stderr=subprocess.PIPE, text=True
        )
    finally:
        signal.signal(signal.SIGINT, heard)
    until = time.monotonic() + 120
    while not list(out.glob("records/*.json")) and time.monotonic() < until:
        time.sleep(0.02)
    began = time.monotonic()
    driver.send_signal(signal.SIGINT)
    _, told = driver.communicate(timeout=30)
    assert driver.returncode == 130 and time.monotonic() - began < 5, told
    assert "resume from the shards" in told and "Traceback" not in told, told
    there = len(list(out.glob("records/*.json")))
    assert 0 < there < 8 and not (out / "manifest.json").exists()
    ended = command(file, "--out", out, "--workers", 2)
    assert ended.returncode == 0 and "of 8 shards are done already" in ended.stderr, ended.stderr
    assert contents(out) == contents(whole)
    # A second run renders nothing.
    assert "all 8 shards are done" in command(file, "--out", out).stderr
    # A folder rejects another plan.
    file.write_text(SMALL.replace("seed = 5", "seed = 6"))
    ended = command(file, "--out", out)
    assert ended.returncode == 1 and "contains another plan" in ended.stderr


def test_verify_detects_damage(small, tmp_path):
    import shutil

    _, whole = small
    out = tmp_path / "out"
    shutil.copytree(whole, out)
    shard = out / "shards" / "000003.tar"
    data = bytearray(shard.read_bytes())
    data[5000] ^= 1
    shard.write_bytes(data)
    with pytest.raises(farm.FolderError, match="000003.tar does not match the manifest"):
        farm.verify(out)
    shard.unlink()
    with pytest.raises(farm.FolderError, match="000003.tar"):
        farm.verify(out)


def test_samples_match_a_direct_simulation(small):
    """A worker's samples equal direct renders, and their metadata is correct."""
    plan, whole = small
    shot = plan.shots[1]
    sim = tresses.Simulation(tresses.Groom.built_in("bob", shot.settings))
    nod = tresses.Motion("nod")
    for step in range(6):
        sim.step(1 / 60, **nod.at((step + 1) / 60, sim.pivot))
    samples = dict(shards.read(whole / "shards" / "000003.tar"))
    assert list(samples) == [f"000001-{frame:06}-{name}" for frame in (2, 3) for name in ("front", "around")]
    files = samples["000001-000003-front"]
    assert set(files) == {"color.png", "depth.npy", "strand.npy", "motion.npy", "json"}
    seen = sim.render("front", (64, 40), ["color", "depth", "strand"])
    from PIL import Image

    assert np.array_equal(np.asarray(Image.open(io.BytesIO(files["color.png"]))), seen["color"][..., :3])
    stored = arrays(files)
    assert np.array_equal(stored["depth"], seen["depth"]) and np.array_equal(stored["strand"], seen["strand"])
    assert stored["strand"].max() > 20
    told = json.loads(files["json"])
    assert told["seed"] == shot.seed and told["settings"] == shot.settings and told["time"] == pytest.approx(0.1)
    assert np.array_equal(told["view"], sim.camera("front", (64, 40))["view"])
    # Random cameras differ between shots and see the hair.
    views = {json.loads(files["json"])["seed"]: np.array(json.loads(files["json"])["view"])
             for shard in (1, 3) for key, files in shards.read(whole / "shards" / f"{shard:06}.tar") if "around" in key}
    one, other = views.values()
    assert np.abs(one - other).max() > 0.05
    assert (arrays(samples["000001-000003-around"])["strand"] >= 0).sum() > 60


def test_motion_matches_render_with_one_camera(groom):
    """Compare with `render`, which measures motion from frame to frame of one camera."""
    size = (160, 120)
    text = SMALL.replace("[64, 40]", "[160, 120]").replace("style.strands = 200\nstyle.guides = 60", "style.strands = 400")
    plan = farm.parse(text.replace('"nod"', '"turn"'))
    stage = work.Stage(plan, 0, groom)
    sim = tresses.Simulation(groom, {"wind.speed": plan.shots[0].settings["wind.speed"]})
    shake = tresses.Motion("shake")
    far = []
    for frame in range(4):
        stage.go(frame)
        mine = next(iter(stage.samples(frame))).arrays["motion"] if frame < 3 else None
        if frame == 3:
            mine, around = (sample.arrays["motion"] for sample in stage.samples(frame))
        while round(sim.time * 60) < plan.steps(frame):
            step = round(sim.time * 60) + 1
            sim.step(1 / 60, **shake.at(step / 60, sim.pivot))
        theirs = sim.render("front", size, ["motion", "share", "coverage"])
        # Compare pixels with a single visible strand, because `render` averages over all strands.
        sure = (theirs["coverage"] > 0.02) & (theirs["share"] > 0.9 * theirs["coverage"])
        assert np.isnan(mine).all() == (frame == 0)
        if frame:
            far.append(np.abs(mine - theirs["motion"])[sure])
    far, length = np.concatenate(far), np.abs(theirs["motion"][sure])
    assert sure.sum() > 300 and length.max() > 1 and np.quantile(far, 0.9) < 0.05, np.quantile(far, 0.9)
    # The comparison detects another camera.
    assert np.nanquantile(np.abs(around - theirs["motion"])[sure], 0.9) > 0.2


def test_webdataset_reads_shards(small):
    wds = pytest.importorskip("webdataset", reason="webdataset is not installed")
    plan, whole = small
    urls = f"{whole}/shards/{{000000..000007}}.tar"
    samples = list(wds.WebDataset(urls, shardshuffle=False).decode("rgb8"))
    assert len({sample["__key__"] for sample in samples}) == len(samples) == 32
    for sample in samples:
        assert sample["color.png"].shape == (40, 64, 3) and sample["depth.npy"].dtype == np.float32
        assert sample["json"]["camera"] in ("front", "around")


def test_compressed_shards_have_equal_contents(small, tmp_path):
    plan, whole = small
    text = SMALL.replace("seed = 5", "seed = 5\ncompress = true").replace('["red", "black"]', '["red"]')
    farm.run(farm.parse(text), tmp_path / "out", tell=lambda line: None)
    for i in range(4):
        packed = tmp_path / "out" / "shards" / f"{i:06}.tar.gz"
        assert list(shards.read(packed)) == list(shards.read(whole / "shards" / f"{i:06}.tar"))
    assert packed.stat().st_size < 0.7 * (whole / "shards" / "000003.tar").stat().st_size


def test_failed_shots_are_left_out(tmp_path):
    """The density map turns out to be invalid when the groom is grown."""
    (tmp_path / "thin.png").write_bytes(b"none")
    text = 'frames = 1\nsize = [32, 32]\nsettings.style.strands = 50\n[[groom]]\nstyle = "bob"\n[[groom]]\nstyle = "short"\n'
    told = []
    with pytest.raises(farm.FolderError, match="1 of 2 shots failed"):
        farm.run(farm.parse(text + 'density_map = "thin.png"\n', tmp_path), tmp_path / "out", tell=told.append)
    assert any(re.search(r"shot 1 \(short still\) failed: .*thin.png", line) for line in told), told
    assert len(list((tmp_path / "out" / "shards").iterdir())) == 1 and not (tmp_path / "out" / "manifest.json").exists()


# Many workers


class Played:
    """An engine without workers. `answer` returns the event for each shard."""

    name, seconds = "played", 0.0

    def __init__(self, answer):
        self.answer, self.events, self.stopped = answer, [], False
        self.started, self.late = 0, None

    def start(self, worker):
        self.started += 1
        if self.started > 3 and self.late is not None:
            return
        adapter = {"name": f"card {worker}", "software": False}
        self.events.append(("ready", worker, {"opened": 0.0, "process": 1, "adapter": adapter}))

    def give(self, worker, shard):
        event = self.answer(worker, shard)
        if event[0] == "late":
            self.late = [event[1]]
        else:
            self.events.append(event)

    def wait(self, seconds):
        assert self.events or self.late, "nothing goes on any more"
        if not self.events:
            self.events, self.late = self.late, []
        events, self.events = self.events, []
        return events

    def stop(self):
        self.stopped = True


def driven(plan, out, answer):
    told = []
    folder = Folder(out, plan)
    folder.open()
    driver = drive.Driver(folder, Played(answer), 3, told.append)
    try:
        driver.run()
    finally:
        assert driver.engine.stopped
    driver.close()
    return told


def test_run_fails_if_a_shard_kills_its_workers(small, tmp_path):
    plan, _ = small

    def done(worker, shard):
        cost = {"first": False, "grooms": 0, "shots": 0, "steps": 1, "pictures": 4, "seconds": {"steps": 0.1, "pictures": 0.1}}
        card = {"name": f"card {worker}", "software": False}
        record = {"shard": shard, "file": "none", "sha256": "", "bytes": 0, "samples": 4, "adapter": card, "cost": cost}
        return "done", worker, record

    def deadly(worker, shard):
        return ("lost", worker, "it ended with -9") if shard == 5 else done(worker, shard)

    with pytest.raises(farm.FolderError, match="3 workers were lost with shard 5"):
        driven(plan, tmp_path / "out", deadly)
    with pytest.raises(farm.FolderError, match="worker 0: the disk is full"):
        driven(plan, tmp_path / "full", lambda worker, shard: ("broken", worker, "the disk is full"))
    told = driven(plan, tmp_path / "cards", done)
    # A worker is lost when no other shards are left, and its replacement never starts.
    lost = []

    def late(worker, shard):
        if shard == 0 and not lost:
            lost.append(worker)
            return "late", ("lost", worker, "its machine is off")
        return done(worker, shard)

    assert any("shard 0 (its machine is off)" in line for line in driven(plan, tmp_path / "off", late))
    assert "3 adapters took part, so samples may not be bit-identical: card 0, card 1, card 2" in told


def test_forecast_sums_costs(small):
    plan, whole = small
    each = {"grooms": 3.0, "shots": 0.25, "steps": 0.5, "pictures": 1.0}
    costs = forecast.Costs(each, start=2.0, dispatch=0.01, shots={}, source="")
    # Four shots of six steps and eight images; all use the same groom.
    by_hand = 2 + 8 * 0.01 + 4 * (0.25 + 6 * 0.5 + 8 * 1.0)
    assert forecast.forecast(plan, costs, 1).seconds == pytest.approx(by_hand + 3)
    rows = [forecast.forecast(plan, costs, workers) for workers in (1, 2, 4, 8, 64)]
    assert all(one.seconds >= more.seconds for one, more in zip(rows, rows[1:]))
    assert rows[0].again == 0 and rows[3].again > 0 and rows[4].idle > 0.8
    # Workers beyond the number of shards do not help. The lower bound is a shard at the end of a shot with all steps
    # before it.
    assert rows[4].seconds == pytest.approx(rows[3].seconds)
    assert rows[4].seconds >= 2 + 3 + 6 * 0.5 + 4 * 1.0
    measured = forecast.read(whole / "costs.json")
    assert all(measured.of(shot.name)[kind] > 0 for shot in plan.shots for kind in ("shots", "steps", "pictures"))
    # The first shard includes growing the groom and the one-time compilation.
    assert measured.start > 0.3


def test_missing_ray_error_names_the_package(small, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(farm.FolderError, match="pip install 'tresses.farm.'"):
        farm.run(small[0], tmp_path / "out", ray="local")
    assert not (tmp_path / "out").exists()


def test_unreachable_ray_address_fails_fast(small, tmp_path):
    pytest.importorskip("ray")
    began = time.monotonic()
    for address in ("127.0.0.1:1", "ray://127.0.0.1:1", "somewhere:else"):
        with pytest.raises(farm.FolderError, match=f"Ray at {address}"):
            farm.run(small[0], tmp_path / "out", ray=address)
    assert time.monotonic() - began < 20


def test_ray_output_is_identical_after_a_killed_worker(small, tmp_path):
    pytest.importorskip("ray", reason="Ray is not installed")
    plan, whole = small
    told = killed_in_the_midst(plan, tmp_path / "out", ray="local")
    assert any("was lost with shard 0" in line for line in told), told
    assert contents(tmp_path / "out") == contents(whole)
    costs = json.loads((tmp_path / "out" / "costs.json").read_text())
    assert costs["run"]["engine"].startswith("Ray ") and costs["run"]["dispatch"] < 1


def test_ray_data_reads_shards(small):
    ray = pytest.importorskip("ray", reason="Ray is not installed")
    pytest.importorskip("pyarrow", reason="Ray Data is not installed")
    _, whole = small
    ray.init(address="local", num_cpus=1, include_dashboard=False, log_to_driver=False, logging_level="error")
    try:
        rows = ray.data.read_webdataset(str(whole / "shards")).take_all()
    finally:
        ray.shutdown()
    assert len({row["__key__"] for row in rows}) == len(rows) == 32
    assert all(row["color.png"].shape == (40, 64, 3) and row["strand.npy"].shape == (40, 64) for row in rows)
