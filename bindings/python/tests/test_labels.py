"""Labels of papers, calibrated cameras and Gaussians."""

import numpy as np
import pytest

import tresses

SIZE = (192, 160)


def filtered(gray, count=36, wavelength=3.0, sigma=1.5):
    """Return the orientation of the strongest of `count` Gabor filters at each pixel, degrees, and its contrast.

    A filter at 0 answers vertical stripes, at 90 horizontal ones, as in the papers.
    """
    y, x = np.mgrid[-7:8, -7:8]
    answers = []
    shape = tuple(n + 14 for n in gray.shape)
    spectrum = np.fft.rfft2(gray, shape)
    for angle in np.pi * np.arange(count) / count:
        # Along the stripe, downward at 0; across it, to the right.
        across = x * np.cos(angle) - y * np.sin(angle)
        along = x * np.sin(angle) + y * np.cos(angle)
        kernel = np.exp(-(across**2 + 0.25 * along**2) / (2 * sigma**2)) * np.cos(2 * np.pi * across / wavelength)
        kernel -= kernel.mean()
        answer = np.fft.irfft2(spectrum * np.fft.rfft2(kernel, shape), shape)
        answers.append(np.abs(answer[7:-7, 7:-7]))
    answers = np.stack(answers)
    return 180 * answers.argmax(0) / count, answers.max(0) - np.median(answers, 0)


def apart(a, b):
    """Return the angle between undirected orientations, degrees."""
    return np.abs((a - b + 90) % 180 - 90)


@pytest.mark.parametrize("degrees", [0, 30, 60, 90, 120, 150])
def test_filter_has_the_convention_of_the_papers(degrees):
    y, x = np.mgrid[:64, :64]
    angle = np.radians(degrees)
    stripes = np.cos(2 * np.pi * (x * np.cos(angle) - y * np.sin(angle)) / 3)
    found, _ = filtered(stripes)
    assert apart(found[20:44, 20:44], degrees).max() <= 5


def test_orientation_is_what_filters_find_in_the_picture():
    # Coarse strands, so that single ones are visible.
    groom = tresses.Groom.built_in("long", {"style.strands": 3000, "style.width": "300 um", "lod.mode": "off"})
    sim = tresses.Simulation(groom)
    size = (512, 448)
    found = tresses.labels(sim, "back", size, zoom=2.5)
    gray = found["color"][..., :3].mean(-1) / 255
    angle, sure = filtered(gray)
    known = np.isfinite(found["orientation"]) & (found["mask"] > 0.9)
    # The fifth of the pixels in which the filters are surest. Elsewhere, strands cross within a filter.
    strong = known & (sure > np.quantile(sure[known], 0.8))
    assert strong.sum() > 10_000
    error = np.median(apart(angle, found["orientation"])[strong])
    mirrored = np.median(apart(180 - angle, found["orientation"])[strong])
    assert error < 5 and mirrored > 3 * error, f"{error} and {mirrored} degrees"


def test_labels_fit_together(groom):
    sim = tresses.Simulation(groom)
    found = tresses.labels(sim, "front", SIZE)
    mask, body = found["mask"], found["body"]
    assert mask.max() > 0.5 and body.max() > 0.99 and (mask + body).max() < 1.01
    # The body behind the hair, and its outline.
    inside = np.isfinite(found["body_depth"])
    assert inside[body > 0.99].mean() > 0.999 and not inside[(mask + body) < 0.01].any()
    normals = found["body_normal"]
    assert np.allclose(np.linalg.norm(normals[inside], axis=-1), 1, atol=1e-4) and (normals[~inside] == 0).all()
    # Visible surfaces face the camera, and depths lead to points on the head.
    eye = np.linalg.inv(found["view"])[:3, 3]
    y, x = np.nonzero(inside)
    far = found["body_depth"][inside]
    K, RT = found["K"], found["RT"]
    seen = np.stack([(x + 0.5 - K[0, 2]) / K[0, 0] * far, (y + 0.5 - K[1, 2]) / K[1, 1] * far, far], -1)
    points = (seen - RT[:, 3]) @ RT[:, :3]
    toward = eye - points
    assert ((normals[inside] * toward).sum(-1) > 0).mean() > 0.97
    sample = np.random.default_rng(1).choice(len(points), 300, replace=False)
    vertices = groom.head.positions
    gap = np.linalg.norm(points[sample, None] - vertices[None], axis=-1).min(1)
    assert np.quantile(gap, 0.95) < 0.006
    hair = np.isfinite(found["orientation"])
    assert np.array_equal(hair, found["strand"] >= 0) or (hair != (found["strand"] >= 0)).mean() < 1e-3
    assert np.allclose(np.linalg.norm(found["direction"][hair], axis=-1), 1, atol=1e-5)
    red = found["strand_map"][..., 0] / 255
    assert np.abs(red - np.clip(mask + 0.5 * body, 0, 1)).max() < 0.005
    assert (found["strand_map"][~hair][:, 1:] == 0).all()
    # K and RT put roots where the labels are.
    K, RT = found["K"], found["RT"]
    view, projection = tresses.camera_of(K, RT, SIZE)
    assert np.allclose(view, found["view"], atol=1e-6) and np.allclose(projection, found["projection"], atol=1e-5)
    again = sim.render((view, projection), SIZE)["color"]
    assert np.abs(again.astype(int) - sim.render("front", SIZE)["color"]).max() <= 2
    strands = sim.strands().grid()
    points = np.concatenate([strands[:, 16], np.ones((len(strands), 1))], 1) @ RT.T
    pixels = points @ K.T
    x, y = np.floor(pixels[:, :2] / pixels[:, 2:]).astype(int).T
    inside = (x >= 0) & (y >= 0) & (x < SIZE[0]) & (y < SIZE[1])
    # Strands behind the head are hidden by it.
    assert inside.mean() > 0.9 and ((mask + body)[y[inside], x[inside]] > 0.2).mean() > 0.98


def test_orthographic_cameras(groom):
    sim = tresses.Simulation(groom)
    camera = tresses.orthographic([0, 0.05, 2], [0, 0.05, 0], 0.5, SIZE)
    found = tresses.labels(sim, camera, SIZE)
    assert "K" not in found and 0.02 < (found["mask"] > 0.5).mean() < 0.9
    # From any distance, the picture is the same.
    nearer = tresses.orthographic([0, 0.05, 1], [0, 0.05, 0], 0.5, SIZE)
    assert np.abs(found["mask"] - tresses.labels(sim, nearer, SIZE)["mask"]).mean() < 5e-3
    with pytest.raises(tresses.TressesError, match="orthographic"):
        tresses.calibration(*camera, SIZE)
    with pytest.raises(tresses.TressesError, match="shapes"):
        tresses.camera_of(np.eye(4), np.eye(4), SIZE)


def test_gaussians_lie_along_segments():
    lines = [np.array([[0, 0, 0], [0.01, 0, 0], [0.01, 0.02, 0]]), np.array([[0, 0, 0], [-0.03, 0, 0]])]
    found = tresses.gaussians(tresses.Strands.of(lines))
    assert found["strand"].tolist() == [0, 0, 1]
    assert np.allclose(found["mean"], [[0.005, 0, 0], [0.01, 0.01, 0], [-0.015, 0, 0]])
    assert np.allclose(found["scale"][:, 0], [0.005, 0.01, 0.015]) and np.allclose(found["scale"][:, 1:], 7e-5)
    w, x, y, z = found["rotation"].T
    turned = np.stack([1 - 2 * (y**2 + z**2), 2 * (x * y + w * z), 2 * (x * z - w * y)], 1)
    assert np.allclose(turned, [[1, 0, 0], [0, 1, 0], [-1, 0, 0]], atol=1e-6)
    colored = tresses.Strands(np.zeros((1, 2, 3)) + [[0, 0, 0], [0, 1, 0]], colors=[1, 0, 1])
    assert np.allclose(tresses.gaussians(colored)["sh"] * 0.2820948 + 0.5, [[1, 0, 1]], atol=1e-4)
