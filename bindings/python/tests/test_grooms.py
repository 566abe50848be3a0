"""Strands, meshes, grooms and files."""

import numpy as np
import pytest

import tresses


def lines(count=6, vertices=5):
    """Return strands of different vertex counts, 10 cm high, with roots on a plane."""
    out = []
    for i in range(count):
        n = vertices + i % 3
        line = np.zeros((n, 3), np.float32)
        line[:, 0] = 0.01 * i
        line[:, 1] = np.linspace(1.5, 1.6, n)
        line[:, 2] = 0.02 * np.linspace(0, 1, n) ** 2
        out.append(line)
    return out


def test_arrays_round_trip():
    given = lines()
    count = sum(map(len, given))
    widths = np.linspace(5e-5, 9e-5, count, dtype=np.float32)
    strands = tresses.Strands(
        np.concatenate(given), np.cumsum([0] + [len(line) for line in given]), widths, colors=[0.1, 0.2, 0.3]
    )
    assert len(strands) == 6 and strands.offsets.dtype == np.int64
    assert np.array_equal(strands.widths, widths) and strands.colors.shape == (count, 3)
    for i, line in enumerate(given):
        assert np.array_equal(strands[i], line) and np.array_equal(strands.lines()[i], line)
    assert np.array_equal(strands[-1], given[-1])
    assert np.array_equal(tresses.Strands.of(given).positions, strands.positions)
    assert strands.lengths == pytest.approx([np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in given])
    with pytest.raises(tresses.TressesError, match="differ"):
        strands.grid()
    grid = np.random.default_rng(1).random((4, 7, 3))
    assert np.array_equal(tresses.Strands(grid).grid(), grid.astype(np.float32))


@pytest.mark.parametrize(
    "values, clause",
    [
        (dict(positions=np.zeros((4, 2))), "3 numbers"),
        (dict(positions=np.zeros((4, 3))), "offsets"),
        (dict(positions=np.zeros((4, 3)), offsets=[0, 5]), "end with 4"),
        (dict(positions=np.zeros((4, 3)), offsets=[0, 3, 2, 4]), "never decrease"),
        (dict(positions=np.zeros((4, 3)), offsets=[0, -1, 4]), "never decrease"),
        (dict(positions=np.zeros((2, 2, 3)), widths=[1.0, 2.0]), "widths"),
        (dict(positions="hair"), "not an array of numbers"),
    ],
)
def test_invalid_arrays_fail(values, clause):
    with pytest.raises(tresses.TressesError, match=clause):
        tresses.Strands(**values)


@pytest.mark.parametrize("ending", ["hair", "obj", "data", "ply", "abc", "npz"])
def test_files_round_trip(tmp_path, ending):
    assert ending == "npz" or ending in tresses.formats()["written"]
    given = tresses.Strands.of(lines())
    given = tresses.Strands(given.positions, given.offsets, widths=7e-5)
    file = tmp_path / f"a.{ending}"
    if ending == "npz":
        tresses.save_npz(file, given)
        back = tresses.load_npz(file)
    else:
        notes = given.write(file)
        assert ("widths" in " ".join(notes)) == (ending in ("obj", "data"))
        # A .data file does not store its unit and axes.
        known = dict(unit="m", up="y", front="z", mirror=False) if ending == "data" else {}
        back = tresses.read(file, **known).strands
    assert np.array_equal(back.positions, given.positions) and np.array_equal(back.offsets, given.offsets)
    if ending in ("hair", "ply", "abc", "npz"):
        assert np.array_equal(back.widths, given.widths)


def test_data_files_follow_the_hair_salon_format(tmp_path):
    file = tmp_path / "strands00001.data"
    with open(file, "wb") as target:
        np.array([3], "<i4").tofile(target)
        for count in (100, 1, 4):
            np.array([count], "<i4").tofile(target)
            points = np.zeros((count, 3), "<f4")
            points[:, 1] = np.linspace(1.7, 1.4, count)
            points.tofile(target)
    raw = tresses.read(file, unit="m", up="y", front="z", repair=False)
    assert list(np.diff(raw.strands.offsets)) == [100, 1, 4]
    assert [f.kind for f in raw.findings if f.count] and raw.strands.lint()
    repaired, done = raw.strands.repaired()
    assert done["dropped_strands"] == 1 and len(repaired) == 2 == len(tresses.read(file).strands)


def test_broken_files_fail_with_one_sentence(tmp_path):
    for name, content in [
        ("a.data", b"\x09\0\0\0\x01\0\0\0"),
        ("a.ply", b"ply\nformat ascii 1.0\nend_header\n"),
        ("a.hair", b"HAIL" * 40),
        ("a.npz", b"PK nothing"),
        ("a.xyz", b"1 2 3"),
    ]:
        file = tmp_path / name
        file.write_bytes(content)
        read = tresses.load_npz if name.endswith(".npz") else tresses.read
        with pytest.raises(tresses.TressesError) as error:
            read(file)
        assert name in str(error.value) and "\n" not in str(error.value)
    for missing in (FileNotFoundError, tresses.TressesError):
        with pytest.raises(missing, match="nowhere.hair") as error:
            tresses.read(tmp_path / "nowhere.hair")
        assert str(error.value).count("No such file") == 1
    with pytest.raises(FileNotFoundError):
        tresses.Settings.open(tmp_path / "nowhere.toml")
    assert tresses.__version__.count(".") == 2
    with pytest.raises(tresses.TressesError, match="written as"):
        tresses.Strands.of(lines()).write(tmp_path / "a.xyz")


def test_lint_reports_problems():
    given = lines()
    given[2][3] = np.nan
    given[4][:] = given[4][0]
    strands = tresses.Strands.of(given)
    found = {finding.kind: finding for finding in strands.lint()}
    assert found["numbers that are not finite"].severity == "error"
    assert found["numbers that are not finite"].first_strand == 2
    assert found["zero-length strands"].count == 1
    assert not any(f.severity == "error" for f in strands.repaired()[0].lint())


def test_meshes_validate_and_round_trip(tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    mesh = tresses.Mesh(corners, [[0, 1, 2]])
    assert np.allclose(mesh.normals, [0, 0, 1]) and mesh.colors is None and mesh.triangles.tolist() == [[0, 1, 2]]
    with pytest.raises(tresses.TressesError):
        tresses.Mesh(corners, [[0, 1, 3]])
    with pytest.raises(tresses.TressesError):
        tresses.Mesh(corners, [[0, 1, -1]])
    mesh.write(tmp_path / "a.glb")
    back = tresses.Mesh.read(tmp_path / "a.glb", unit="m", up="y", front="z", mirror=False)
    assert np.allclose(back.positions, mesh.positions)


def test_built_in_groom_exposes_its_data(groom):
    strands, guides, binding = groom.strands(), groom.guides, groom.binding
    assert len(groom) == len(strands) == 400 and strands.grid().shape[0] == 400
    assert guides.ndim == 3 and guides.shape[2] == 3 and np.isfinite(guides).all()
    assert binding["guides"].shape == (400, 3) and binding["guides"].max() < len(guides)
    assert np.allclose(binding["weights"].sum(axis=1), 1, atol=1e-5)
    assert np.all(np.diff(binding["weights"], axis=1) <= 1e-6)
    assert sorted(groom.order) == list(range(400))
    assert groom.head.positions.shape[1] == 3 and groom.settings["style.strands"] == 400
    # Realistic hair width and bust height.
    assert 2e-5 < strands.widths.mean() < 2e-3 and 0.3 < np.ptp(groom.head.positions[:, 1]) < 0.8


def test_equal_seeds_grow_equal_hair():
    def grown(seed):
        return tresses.Groom.built_in("short", {"style.strands": 200, "style.seed": seed}).strands().positions

    assert np.array_equal(grown(3), grown(3))
    assert not np.array_equal(grown(3), grown(4))


def test_groom_of_arrays_keeps_its_strands():
    root = np.stack([0.05 * np.cos(np.arange(40)), 1.6 + 0 * np.arange(40), 0.05 * np.sin(np.arange(40))], axis=1)
    down = np.linspace(0, 0.2, 17)
    lines = root[:, None] + np.stack([0.3 * down, -down, 0 * down], axis=1)[None]
    groom = tresses.Groom.of(tresses.Strands(lines, widths=8e-5), settings={"style.all_guides": True})
    ours = groom.strands().grid()
    # Rest vertices are quantized to 16 bits in each strand's bounding box.
    assert np.abs(ours[:, [0, -1]] - lines[groom.order][:, [0, -1]]).max() < 5e-6
    assert len(groom.guides) == 40 and groom.head is None
    with pytest.raises(tresses.TressesError, match="no strand is usable"):
        tresses.Groom.of(tresses.Strands(np.zeros((3, 4, 3))))


def test_arrays_match_the_command_export(tmp_path, command, groom):
    file = tmp_path / "a.hair"
    command("export", "--style", "bob", "--strands", "400", "--out", file)
    theirs = tresses.read(file)
    ours = tresses.Simulation(groom).strands()
    assert np.array_equal(ours.positions, theirs.strands.positions)
    assert np.array_equal(ours.widths, theirs.strands.widths)
    assert np.array_equal(ours.offsets, theirs.strands.offsets)


def test_cards_are_baked_and_saved(tmp_path):
    groom = tresses.Groom.built_in("short", {"style.strands": 300})
    seen = []
    cards = groom.cards([12, 4], texture=256, progress=lambda task, done: seen.append((task, done)))
    assert [level.cards for level in cards.levels] == [12, 4] and seen
    level = cards.levels[0]
    count = len(level.positions)
    assert level.normals.shape == level.tangents.shape == (count, 3) and level.uvs.shape == (count, 2)
    assert level.light.shape == (count,) and level.triangles.max() == count - 1
    assert len(level.starts) == 12 and sum(map(len, level.locks)) == 300
    color = cards.textures["color"]
    assert color.shape == (256, 256, 4) and color.dtype == np.uint8 and color[..., 3].max() == 255
    report = cards.report
    assert report["strands"] == 300 and report["levels"][1]["cards"] == 4
    assert 0.95 < report["levels"][0]["coverage"] < 1.05
    assert [path.name for path in cards.save(tmp_path / "hair.glb", split=True)] == ["hair_LOD0.glb", "hair_LOD1.glb"]
    assert len(cards.save(tmp_path / "hair.obj")) == 7 and (tmp_path / "hair_color.png").exists()
    with pytest.raises(tresses.TressesError, match=".glb or .obj"):
        cards.save(tmp_path / "hair.fbx")
    dense = tresses.Groom.built_in("bob", {"style.strands": 4000})
    last = dense.cards([12, "helmet"], texture=256).levels[-1]
    assert last.helmet and last.cards == 0 and last.roots.shape == last.positions.shape
    for wrong in [["helmet", 12], ["cap"], [4, 12]]:
        with pytest.raises(tresses.TressesError, match="level"):
            groom.cards(wrong)
    with pytest.raises(tresses.TressesError, match="core, mask or blend"):
        cards.save(tmp_path / "hair.glb", alpha="hash")


def test_cards_move_with_the_guides():
    groom = tresses.Groom.built_in("bob", {"style.strands": 3000})
    cards = groom.cards([60, "helmet"], texture=512, bones=4)
    worn = groom.with_cards(cards)
    assert 120 <= len(worn) <= 180 and np.array_equal(worn.guides, groom.guides)
    pictures = [tresses.Simulation(hair).render(size=(96, 96))["color"] for hair in (groom, worn)]
    differ = np.abs(pictures[0].astype(int) - pictures[1]).mean()
    bare = tresses.Simulation(groom).render(size=(96, 96), background=(0, 0, 0))["color"]
    assert differ < 0.5 * np.abs(pictures[0].astype(int) - bare).mean()
    sim = tresses.Simulation(worn)
    rest = sim.strands().positions
    assert np.allclose(rest, worn.strands().positions, atol=0.003)
    for degrees in range(0, 60, 10):
        half = np.radians(degrees) / 2
        sim.step(1 / 30, head=((0, 0, 0), (0, np.sin(half), 0, np.cos(half))))
    assert np.abs(sim.strands().positions - rest).max() > 0.02
    with pytest.raises(tresses.TressesError, match="not for cards"):
        sim.render(size=(96, 96), outputs=["coverage"])
    other = tresses.Groom.built_in("bob", {"style.strands": 100})
    for wrong, why in [((cards, 1), "helmet"), ((cards, 2), "level")]:
        with pytest.raises(tresses.TressesError, match=why):
            groom.with_cards(*wrong)
    with pytest.raises(tresses.TressesError, match="another groom"):
        other.with_cards(cards)


def test_brushes_comb_and_cut_grooms():
    groom = tresses.Groom.built_in("bob", {"style.strands": 800})
    path = [[0.1, 0.16, 0.06], [0.1, 0.14, 0.0], [0.09, 0.12, -0.08]]
    combed = groom.stroked("comb", path, radius=0.04, strength=1.0)
    assert len(combed) == 800 and combed.guides.shape == groom.guides.shape
    moved = np.linalg.norm(combed.guides - groom.guides, axis=2)
    assert moved.max() > 0.01 and moved[:, 0].max() == 0
    lengths = [np.linalg.norm(np.diff(guides, axis=1), axis=2).sum(1) for guides in (groom.guides, combed.guides)]
    assert lengths[0] == pytest.approx(lengths[1], rel=5e-3)
    # The same stroke as a recording.
    line = '{"tool":"comb","set":{"radius":0.04,"strength":1.0},"path":%s}' % path
    again = groom.groomed('{"version":1}\n' + line + "\n")
    assert np.array_equal(again.guides, combed.guides)
    # A cut below the middle of the head.
    cut = groom.stroked("line", [[-0.3, 0.06, 0], [0.3, 0.06, 0]], reach="through", mirror=False)
    assert cut.strands().lengths.max() < groom.strands().lengths.max() - 0.01
    assert np.array_equal(np.sort(cut.order), np.sort(groom.order))
    simulation = tresses.Simulation(combed)
    simulation.step(1 / 60)
    assert simulation.strands().positions.shape == combed.strands().positions.shape
    for tool, brush, error in [("rake", {}, "rake"), ("comb", {"radius": 2.0}, "radius"), ("comb", {"rad": 1}, "rad")]:
        with pytest.raises(tresses.TressesError, match=error):
            groom.stroked(tool, path, **brush)
    with pytest.raises(tresses.TressesError, match="line 1"):
        groom.groomed("nonsense")


def test_grooms_of_the_command_are_read(command, tmp_path):
    file = tmp_path / "bob.groom"
    command("groom", "--style", "bob", "--strands", 900, "--out", file)
    groom = tresses.Groom.read(file)
    assert len(groom) == 900 and groom.head is not None
    with pytest.raises(tresses.TressesError, match="complete|includes"):
        tresses.Groom.read([file, file])


def test_planted_and_removed_strands_keep_their_order():
    """Strands that stay keep their indices; new ones have others."""
    groom = tresses.Groom.built_in("bob", {"style.strands": 400})
    beard = dict(radius=0.02, length=0.02, spacing=0.004, density=60.0)
    planted = groom.stroked("plant", [[0, 0.01, 0.085], [0, 0.02, 0.09]], **beard)
    order = planted.order
    assert len(order) > 450 and len(set(order)) == len(order)
    assert set(groom.order) < set(order)
    bald = planted.stroked("remove", [[0, 0.2236, -0.01]], radius=0.05)
    assert set(bald.order) < set(order)
    with pytest.raises(tresses.TressesError, match="brush.spacing"):
        groom.stroked("plant", [[0, 0.2, 0]], spacing=9)
