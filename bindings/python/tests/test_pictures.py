"""Rendered images and labels."""

import numpy as np
import pytest
from PIL import Image

import tresses

SIZE = (160, 120)
LABELS = ["color", "linear", "coverage", "depth", "motion", "strand", "groom", "share", "along", "tangent"]


def encoded(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def test_render_matches_the_command(tmp_path, command, sim):
    file = tmp_path / "a.png"
    words = ["--style", "bob", "--strands", "400", "--lod", "off", "--camera", "front", "--size", "160x120"]
    command("render", *words, "--out", file)
    ours = sim.render("front", SIZE)["color"]
    assert ours.shape == (120, 160, 4) and ours.dtype == np.uint8
    assert np.array_equal(ours[..., :3], np.asarray(Image.open(file).convert("RGB")))
    assert not np.array_equal(sim.render("side", SIZE)["color"], ours)


def test_color_is_tone_mapped_linear_radiance(sim):
    # Dark enough to stay in the linear part of the tone curve.
    sim.apply({"lights.exposure": 0.1})
    out = sim.render("front", SIZE, ["color", "linear"], background="transparent")
    assert out["linear"].dtype == np.float32 and np.isfinite(out["linear"]).all()
    assert out["linear"][..., :3].max() > 0.2
    expected = 255 * encoded(0.1 * out["linear"][..., :3])
    assert np.abs(expected - out["color"][..., :3]).max() < 1.01
    assert np.abs(255 * out["linear"][..., 3] - out["color"][..., 3]).max() < 1.01
    # The comparison detects a wrong factor.
    assert np.abs(255 * encoded(0.2 * out["linear"][..., :3]) - out["color"][..., :3]).max() > 3


def test_labels_match_visible_strands(sim):
    out = sim.render("front", SIZE, LABELS)
    again = sim.render("front", SIZE, LABELS)
    hair = out["strand"] >= 0
    assert 500 < hair.sum() < hair.size
    for name in LABELS:
        assert out[name].shape[:2] == (120, 160)
        if name != "motion":
            assert np.array_equal(out[name], again[name], equal_nan=True), name
    assert np.array_equal(hair, out["groom"] >= 0) and np.array_equal(hair, out["share"] > 0)
    assert np.all(out["share"] <= out["coverage"] + 1e-3)
    assert np.array_equal(np.isfinite(out["depth"]), out["coverage"] > 0)
    assert np.allclose(np.linalg.norm(out["tangent"][hair], axis=1), 1, atol=1e-3)
    assert np.all(out["tangent"][~hair] == 0)

    # The labeled strand point projects into its pixel, and its depth matches.
    camera = sim.camera("front", SIZE)
    grooms = [sim.strands(), *sim.face()]
    rows, columns = np.nonzero(hair & (out["share"] > 0.3))
    assert len(rows) > 200
    beside, far = [], []
    for row, column in zip(rows, columns):
        line = grooms[out["groom"][row, column]][out["strand"][row, column]]
        at = out["along"][row, column] * (len(line) - 1)
        vertex = min(int(at), len(line) - 2)
        point = line[vertex] + (at - vertex) * (line[vertex + 1] - line[vertex])
        view = camera["view"] @ [*point, 1]
        clip = camera["projection"] @ view
        place = (clip[:2] / clip[3] * [0.5, -0.5] + 0.5) * SIZE
        beside.append(np.abs(place - [column + 0.5, row + 0.5]).max())
        far.append(abs(-view[2] - out["depth"][row, column]))
    assert np.quantile(beside, 0.95) < 1.5, np.quantile(beside, 0.95)
    assert np.quantile(far, 0.9) < 0.02, np.quantile(far, 0.9)
    # Labels of other strands fail this check.
    wrong = grooms[0].grid()[(out["strand"][rows, columns] + 7) % 400].mean(axis=1)
    clip = np.c_[wrong, np.ones(len(wrong))] @ (camera["projection"] @ camera["view"]).T
    place = (clip[:, :2] / clip[:, 3:] * [0.5, -0.5] + 0.5) * SIZE
    assert np.quantile(np.abs(place - np.c_[columns, rows]).max(axis=1), 0.5) > 3


def test_motion_is_known_from_the_second_frame(sim):
    first = sim.render("front", SIZE, ["motion", "depth"])
    assert np.isnan(first["motion"]).all()
    still = sim.render("front", SIZE, ["motion"])["motion"]
    assert np.abs(still).max() < 1e-3
    by = 0.004
    sim.reset(body=([by, 0, 0], [0, 0, 0, 1]))
    out = sim.render("front", SIZE, ["motion", "depth", "coverage"])
    hair = out["coverage"] > 0.3
    pixels = by * SIZE[1] / (2 * out["depth"][hair] * np.tan(np.radians(15)))
    assert np.abs(out["motion"][hair][:, 0] - pixels).max() < 0.05
    assert np.abs(out["motion"][hair][:, 1]).max() < 0.05


def test_hair_without_head_is_not_occluded(sim):
    behind = sim.render("front", SIZE, ["coverage"])["coverage"]
    alone = sim.render("front", SIZE, ["coverage"], head=False)["coverage"]
    assert alone.sum() > 1.1 * behind.sum()
    assert np.array_equal(sim.render("front", SIZE, ["coverage"])["coverage"], behind)


def test_a_holdout_hides_hair_and_is_transparent(groom):
    sim = tresses.Simulation(groom)
    names = ["color", "coverage"]
    drawn = sim.render("three-quarter", SIZE, names, background="transparent")
    held = sim.render("three-quarter", SIZE, names, background="transparent", head="holdout")
    free = sim.render("three-quarter", SIZE, names, background="transparent", head=False)
    assert np.array_equal(held["coverage"], drawn["coverage"])
    assert (free["coverage"] - held["coverage"]).max() > 0.5, "the head hides hair"
    alpha = held["color"][..., 3] / 255
    assert np.abs(alpha - held["coverage"]).max() < 0.02
    # Where hair is dense, the pictures agree; where there is none, only the head is missing.
    dense = held["coverage"] > 0.995
    difference = np.abs(held["color"].astype(int) - drawn["color"])
    assert dense.sum() > 50 and difference[dense].max() <= 4
    assert (held["color"][held["coverage"] == 0] == 0).all()
    again = sim.render("three-quarter", SIZE, names, background="transparent")
    assert np.array_equal(again["color"], drawn["color"])
    with pytest.raises(tresses.TressesError, match="head is gone"):
        sim.render("front", SIZE, head="gone")


def test_cameras_and_backgrounds(sim):
    named = sim.render("front", SIZE)["color"]
    view = sim.camera("front", SIZE)["view"]
    eye = -view[:3, :3].T @ view[:3, 3]
    given = sim.render((eye, eye - view[2, :3]), SIZE)["color"]
    assert np.abs(named.astype(int) - given).mean() < 1
    clear = sim.render("front", SIZE, background="transparent")["color"]
    assert clear[0, 0].tolist() == [0, 0, 0, 0] and named[0, 0, 3] == 255
    red = sim.render("front", SIZE, background=[1, 0, 0])["color"]
    assert red[0, 0, 0] > 150 and red[0, 0, 1] < 80
    far = sim.render("front", SIZE, ["depth"], distance=3.0)["depth"]
    assert 2.7 < far[np.isfinite(far)].mean() < 3.1


def test_invalid_render_arguments_fail(sim):
    for words, clause in [
        (dict(outputs=["normals"]), "no output normals"),
        (dict(camera="above"), "no camera above"),
        (dict(camera=([0, 0, 0], [0, 0, 0])), "same point"),
        (dict(size=(0, 10)), "above 0"),
        (dict(size=(100000, 10)), "size"),
        (dict(zoom=-1.0), "zoom"),
        (dict(distance=float("nan")), "distance"),
    ]:
        with pytest.raises(tresses.TressesError, match=clause):
            sim.render(**{"size": SIZE, **words})
    sim.apply({"renderer.kind": "masks"})
    assert sim.render("front", SIZE)["color"].any()
    with pytest.raises(tresses.TressesError, match="tiles"):
        sim.render("front", SIZE, ["depth"])
    sim.apply({"renderer.kind": "tiles"})
    assert np.isfinite(sim.render("front", SIZE, ["depth"])["depth"]).any()


def test_matrices_of_a_camera_give_its_picture(sim):
    size = (96, 80)
    of_name = sim.render("side", size)["color"]
    matrices = sim.camera("side", size)
    of_matrices = sim.render((matrices["view"], matrices["projection"]), size)["color"]
    assert np.array_equal(of_name, of_matrices)
    # Shifted by a quarter of the width, as no position and target can.
    shifted = matrices["projection"].copy()
    shifted[0] += 0.5 * shifted[3]
    moved = sim.render((matrices["view"], shifted), size, ["coverage"])["coverage"]
    still = sim.render("side", size, ["coverage"])["coverage"]
    assert np.abs(moved[:, 24:] - still[:, :-24]).mean() < 5e-3 and still.max() > 0.9
    with pytest.raises(tresses.TressesError, match="need an inverse"):
        sim.render((np.zeros((4, 4)), shifted), size)
    with pytest.raises(tresses.TressesError, match="projection must be a matrix"):
        sim.render((matrices["view"], [0, 0, 0]), size)
