"""Plans, their shards, and workers that are killed."""

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
    """The plan, and what one worker made of it."""
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
    """All that a run leaves and that is the same each time."""
    files = [folder / "manifest.json", *sorted((folder / "shards").iterdir())]
    return {file.name: file.read_bytes() for file in files}


def arrays(files):
    """The arrays of a sample."""
    return {ending[:-4]: np.load(io.BytesIO(data)) for ending, data in files.items() if ending.endswith(".npy")}


def killed_in_the_midst(plan, out, **words):
    """Runs two workers, of which the first is killed while it writes shard 0; what was told."""
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


def test_a_plan_is_spread_out(small):
    plan, _ = small
    assert len(plan.shots) == 4 and len(plan.shards) == 8 and [c.name for c in plan.cameras] == ["front", "around"]
    assert [shot.name for shot in plan.shots][:2] == ["bob shading.color=red shake", "bob shading.color=red nod"]
    speeds = [shot.settings["wind.speed"] for shot in plan.shots]
    assert len(set(speeds)) == 4 and all(0 <= speed <= 9 for speed in speeds)
    assert farm.parse(SMALL) == farm.parse(SMALL)
    assert farm.parse(SMALL).fingerprint != farm.parse(SMALL.replace("seed = 5", "seed = 6")).fingerprint


def test_what_is_added_leaves_shots_as_they_were():
    before = {shot.name: (shot.seed, shot.settings) for shot in farm.parse(SMALL).shots}
    more = SMALL.replace('["red"', '["blond", "red"').replace('motions = [', 'motions = ["turn", ')
    after = {shot.name: (shot.seed, shot.settings) for shot in farm.parse(more).shots}
    assert len(after) == 9 and before.items() <= after.items()
    other = {shot.name: (shot.seed, shot.settings) for shot in farm.parse(SMALL.replace("seed = 5", "seed = 6")).shots}
    assert other.keys() == before.keys() and not any(other[name] == before[name] for name in other)


def test_draws_are_spread_over_their_ranges():
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
        ("frames = ", "is no TOML"),
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
        ("frames = 2\nsweep.wind.speed = [3]\ndraw.wind.speed = [4]", "draw: wind.speed is in .sweep. too"),
        ("frames = 2\ndraw.wind.speed = { from = 4 }", "draw: wind.speed.to"),
        ("frames = 2\ndraw.wind.speed = { from = 4, to = 2 }", "from 4 down to 2"),
        ("frames = 2\ndraw.wind.speed = { from = 0, to = 2, log = true }", "log"),
        ("frames = 2\ndraw.wind.speed = { from = 0, to = 1e9 }", "draw: wind.speed.to is 1000000000.0, but must be"),
        ("frames = 2\ndraw.shading.color = { from = 0, to = 1 }", "draw: shading.color"),
        ("frames = 2\ndraws = 3", "nothing is drawn"),
        ("frames = 1000000\ndraws = 1000000\ndraw.wind.speed = [1, 2]", "may have"),
        ('frames = 2\n[[groom]]\nstyle = "mohawk"', r"groom\[0\].style is mohawk; there are long"),
        ('frames = 2\n[[groom]]\nfile = "none.tfx"', r"groom\[0\].file: .*none.tfx"),
        ('frames = 2\n[[groom]]\nstyle = "bob"\nhead = "x.obj"', r"groom\[0\].head is unknown"),
        ('frames = 2\n[[groom]]\nstyle = "bob"\nties = "x.json"', r"groom\[0\].ties: there is no .*x.json"),
        ('frames = 2\n[[groom]]\nstyle = "bob"\n[[groom]]\nstyle = "bob"', "two grooms called bob"),
        ("frames = 2\n[[groom]]", "style, file or preset"),
        ('frames = 2\n[[camera]]\nname = "a.b"', r"camera\[0\].name"),
        ('frames = 2\n[[camera]]\nname = "a"', "one of angle"),
        ('frames = 2\n[[camera]]\nname = "a"\neye = [0, 1, 2]', "target"),
        ('frames = 2\n[[camera]]\nname = "a"\neye = [0, 1]', r"camera\[0\].eye"),
        ('frames = 2\n[[camera]]\nname = "front"\nelevation = 3', r"camera\[0\].elevation says nothing"),
        ('frames = 2\n[[camera]]\nname = "front"\n[[camera]]\nname = "front"', "two cameras called front"),
        ('frames = 2\n[[look]]\nname = "a"\n[look.settings]\nwind.speed = 1e9', r"look\[0\].settings: "),
        ("frames = 2\ncamera = 3", r"camera is 3, but must be tables"),
    ],
)
def test_a_plan_that_makes_no_sense_is_refused_in_one_sentence(lines, sentence):
    with pytest.raises(farm.PlanError, match=sentence) as caught:
        farm.parse(lines)
    assert "\n" not in str(caught.value)


def test_a_broken_groom_ends_it_before_anything_is_written(tmp_path):
    (tmp_path / "hair.tfx").write_bytes(b"\1\0\0\0" * 40)
    (tmp_path / "plan.toml").write_text('frames = 2\n[[groom]]\nfile = "hair.tfx"\n')
    ended = command(tmp_path / "plan.toml", "--out", tmp_path / "out")
    assert ended.returncode == 2 and not (tmp_path / "out").exists()
    assert re.fullmatch(r"error: .*plan.toml: groom\[0\].file: .*hair.tfx.*\n", ended.stderr), ended.stderr
    (tmp_path / "plan.toml").write_text("frames = 2\n")
    for words, code, clause in [
        (["--dry-run"], 0, "1 shots of 2 frames"),
        (["--simulate", "1,2"], 2, "costs.json"),
        (["--simulate", "1,many"], 2, "many is no whole number"),
        (["--verify"], 1, "no manifest"),
    ]:
        ended = command(tmp_path / "plan.toml", "--out", tmp_path / "out", *words)
        assert ended.returncode == code and clause in ended.stdout + ended.stderr, ended
    assert not (tmp_path / "out").exists()
    assert command(tmp_path / "none.toml").returncode == 2
    # A folder that holds something else stays as it is.
    ended = command(tmp_path / "plan.toml", "--out", tmp_path)
    assert ended.returncode == 1 and "holds something else" in ended.stderr


# Schedules


def played(runs, workers, lose=()):
    """The order in which shards are done by workers who all take one second."""
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


def test_no_shard_is_lost_or_doubled():
    runs = [list(range(8 * shot, 8 * shot + 8)) for shot in range(5)]
    for workers in (1, 2, 3, 7, 40, 64):
        for lose in ((), {(0, 0)}, {(1, 0), (1, 1), (3, 0)}, {(turn, 0) for turn in range(9)}):
            order, turns = played(runs, workers, lose)
            assert sorted(order) == list(range(40)), (workers, lose)
            if not lose:
                # Hardly anybody waits while there is something to be taken.
                assert turns <= 40 / workers + 4
    assert played(runs, 1)[0] == list(range(40))
    # A shard that is doubled is seen.
    twice, _ = played([[0, 1], [1, 2]], 2)
    assert sorted(twice) != [0, 1, 2]


def test_what_is_taken_from_another_is_worth_its_steps():
    places = [(0, i) for i in range(20)]

    def taken(again, done=1):
        asked = schedule.Schedule([list(range(20))], places, again)
        for _ in range(done):
            asked.take("first")
        return asked.take("second")

    # Half where steps cost nothing, less where they cost more, nothing where they cost what all costs.
    assert taken(0.0) == 10 and 10 < taken(0.3) < taken(0.6) < 20 and taken(1.0) is None
    assert taken(0.3, 20) is None
    # Who stands in the shot already has less to simulate.
    asked = schedule.Schedule([list(range(10)), list(range(10, 20))], [(i // 10, i % 10) for i in range(20)], 0.3)
    for worker in range(3):
        asked.take(worker)
    third = asked.busy[2]
    assert 5 < third < 10
    assert asked.take(1) == 11


# Shards


def test_the_same_plan_gives_the_same_bytes_after_a_killed_worker(small, tmp_path):
    plan, whole = small
    told = killed_in_the_midst(plan, tmp_path / "killed")
    assert any("is lost with shard 0" in line for line in told), told
    there, again = contents(whole), contents(tmp_path / "killed")
    assert again == there
    assert farm.verify(tmp_path / "killed") == "8 shards with 32 samples are what the manifest says"
    # Another seed gives other bytes.
    other = farm.parse(SMALL.replace("seed = 5", "seed = 6").replace('"shake", ', ""))
    farm.run(other, tmp_path / "other", tell=lambda line: None)
    assert not set(contents(tmp_path / "other").values()) & set(there.values())


def test_a_run_goes_on_where_it_ended(small, tmp_path):
    plan, whole = small
    file, out = tmp_path / "plan.toml", tmp_path / "out"
    file.write_text(SMALL)
    # In the background of a shell nobody hears of Ctrl-C, nor does what is started there.
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
    assert "goes on from the shards" in told and "Traceback" not in told, told
    there = len(list(out.glob("records/*.json")))
    assert 0 < there < 8 and not (out / "manifest.json").exists()
    ended = command(file, "--out", out, "--workers", 2)
    assert ended.returncode == 0 and "of 8 shards are there already" in ended.stderr, ended.stderr
    assert contents(out) == contents(whole)
    # Once more: nothing is drawn.
    assert "all 8 shards are there" in command(file, "--out", out).stderr
    # Another plan is not mixed into it.
    file.write_text(SMALL.replace("seed = 5", "seed = 6"))
    ended = command(file, "--out", out)
    assert ended.returncode == 1 and "holds another plan" in ended.stderr


def test_damage_is_found(small, tmp_path):
    import shutil

    _, whole = small
    out = tmp_path / "out"
    shutil.copytree(whole, out)
    shard = out / "shards" / "000003.tar"
    data = bytearray(shard.read_bytes())
    data[5000] ^= 1
    shard.write_bytes(data)
    with pytest.raises(farm.FolderError, match="000003.tar is not what the manifest says"):
        farm.verify(out)
    shard.unlink()
    with pytest.raises(farm.FolderError, match="000003.tar"):
        farm.verify(out)


def test_pictures_are_those_of_a_simulation(small):
    """What a worker draws is what the package draws, and says of it."""
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
    # The camera that was drawn is another one for another shot, and hair is in its picture.
    views = {json.loads(files["json"])["seed"]: np.array(json.loads(files["json"])["view"])
             for shard in (1, 3) for key, files in shards.read(whole / "shards" / f"{shard:06}.tar") if "around" in key}
    one, other = views.values()
    assert np.abs(one - other).max() > 0.05
    assert (arrays(samples["000001-000003-around"])["strand"] >= 0).sum() > 60


def test_motion_is_that_of_one_camera(groom):
    """Against `render`, which knows it of one camera from picture to picture."""
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
        # Where hardly another strand is seen; `render` has the mean of all.
        sure = (theirs["coverage"] > 0.02) & (theirs["share"] > 0.9 * theirs["coverage"])
        assert np.isnan(mine).all() == (frame == 0)
        if frame:
            far.append(np.abs(mine - theirs["motion"])[sure])
    far, length = np.concatenate(far), np.abs(theirs["motion"][sure])
    assert sure.sum() > 300 and length.max() > 1 and np.quantile(far, 0.9) < 0.05, np.quantile(far, 0.9)
    # The comparer sees another camera.
    assert np.nanquantile(np.abs(around - theirs["motion"])[sure], 0.9) > 0.2


def test_readers_of_data_sets_read_it(small):
    wds = pytest.importorskip("webdataset", reason="webdataset is not installed")
    plan, whole = small
    urls = f"{whole}/shards/{{000000..000007}}.tar"
    samples = list(wds.WebDataset(urls, shardshuffle=False).decode("rgb8"))
    assert len({sample["__key__"] for sample in samples}) == len(samples) == 32
    for sample in samples:
        assert sample["color.png"].shape == (40, 64, 3) and sample["depth.npy"].dtype == np.float32
        assert sample["json"]["camera"] in ("front", "around")


def test_compressed_shards_hold_the_same(small, tmp_path):
    plan, whole = small
    text = SMALL.replace("seed = 5", "seed = 5\ncompress = true").replace('["red", "black"]', '["red"]')
    farm.run(farm.parse(text), tmp_path / "out", tell=lambda line: None)
    for i in range(4):
        packed = tmp_path / "out" / "shards" / f"{i:06}.tar.gz"
        assert list(shards.read(packed)) == list(shards.read(whole / "shards" / f"{i:06}.tar"))
    assert packed.stat().st_size < 0.7 * (whole / "shards" / "000003.tar").stat().st_size


def test_shots_that_are_refused_are_left_out(tmp_path):
    """A groom whose maps turn out to be none when hair is grown."""
    (tmp_path / "thin.png").write_bytes(b"none")
    text = 'frames = 1\nsize = [32, 32]\nsettings.style.strands = 50\n[[groom]]\nstyle = "bob"\n[[groom]]\nstyle = "short"\n'
    told = []
    with pytest.raises(farm.FolderError, match="1 of 2 shots were left out"):
        farm.run(farm.parse(text + 'density_map = "thin.png"\n', tmp_path), tmp_path / "out", tell=told.append)
    assert any(re.search(r"shot 1 \(short still\) is left out: .*thin.png", line) for line in told), told
    assert len(list((tmp_path / "out" / "shards").iterdir())) == 1 and not (tmp_path / "out" / "manifest.json").exists()


# Many workers


class Played:
    """An engine without workers: what comes of a shard is said by `answer`."""

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


def test_a_shard_that_kills_its_workers_ends_the_run(small, tmp_path):
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
    # A worker is lost when nothing is left for the others, and no other one can be started.
    lost = []

    def late(worker, shard):
        if shard == 0 and not lost:
            lost.append(worker)
            return "late", ("lost", worker, "its machine is off")
        return done(worker, shard)

    assert any("shard 0 (its machine is off)" in line for line in driven(plan, tmp_path / "off", late))
    assert "3 adapters took part, whose bits may differ: card 0, card 1, card 2" in told


def test_a_forecast_is_the_sum_of_its_costs(small):
    plan, whole = small
    each = {"grooms": 3.0, "shots": 0.25, "steps": 0.5, "pictures": 1.0}
    costs = forecast.Costs(each, start=2.0, dispatch=0.01, shots={}, told="")
    # Four shots of six steps and eight pictures; all have the same strands.
    by_hand = 2 + 8 * 0.01 + 4 * (0.25 + 6 * 0.5 + 8 * 1.0)
    assert forecast.forecast(plan, costs, 1).seconds == pytest.approx(by_hand + 3)
    rows = [forecast.forecast(plan, costs, workers) for workers in (1, 2, 4, 8, 64)]
    assert all(one.seconds >= more.seconds for one, more in zip(rows, rows[1:]))
    assert rows[0].again == 0 and rows[3].again > 0 and rows[4].idle > 0.8
    # No more than there are shards, and no faster than a shard at a shot's end with all steps before it.
    assert rows[4].seconds == pytest.approx(rows[3].seconds)
    assert rows[4].seconds >= 2 + 3 + 6 * 0.5 + 4 * 1.0
    measured = forecast.read(whole / "costs.json")
    assert all(measured.of(shot.name)[kind] > 0 for shot in plan.shots for kind in ("shots", "steps", "pictures"))
    # The first shard made the one groom, and compiled what all need.
    assert measured.start > 0.3


def test_without_ray_a_sentence_says_how_to_get_it(small, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(farm.FolderError, match="pip install 'tresses.farm.'"):
        farm.run(small[0], tmp_path / "out", ray="local")
    assert not (tmp_path / "out").exists()


def test_nobody_at_an_address_is_said_at_once(small, tmp_path):
    pytest.importorskip("ray")
    began = time.monotonic()
    for address in ("127.0.0.1:1", "ray://127.0.0.1:1", "somewhere:else"):
        with pytest.raises(farm.FolderError, match=f"no Ray at {address}"):
            farm.run(small[0], tmp_path / "out", ray=address)
    assert time.monotonic() - began < 20


def test_ray_gives_the_same_bytes_after_a_killed_worker(small, tmp_path):
    pytest.importorskip("ray", reason="Ray is not installed")
    plan, whole = small
    told = killed_in_the_midst(plan, tmp_path / "out", ray="local")
    assert any("is lost with shard 0" in line for line in told), told
    assert contents(tmp_path / "out") == contents(whole)
    costs = json.loads((tmp_path / "out" / "costs.json").read_text())
    assert costs["run"]["engine"].startswith("Ray ") and costs["run"]["dispatch"] < 1


def test_ray_data_reads_it(small):
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
