"""The picture in the viewport: matrices, depth, and drawing where Blender has a GPU without a window."""

import bpy
import gpu
import numpy as np
import pytest
import scenes

SIZE = (160, 120)


def camera():
    """Return view and projection of a camera in front of the ball, as a region of Blender has them."""
    from mathutils import Matrix

    view = (Matrix.Translation((0, -1.2, 0.1)) @ Matrix.Rotation(np.pi / 2, 4, "X")).inverted()
    near, far, x = 0.1, 100.0, 1.8
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = x, x * SIZE[0] / SIZE[1]
    projection[2, 2], projection[2, 3] = -(far + near) / (far - near), -2 * far * near / (far - near)
    projection[3, 2] = -1
    return np.array(view), projection


def window_depth(projection, meters):
    """Return the window depth at a distance in front of the camera."""
    clip, w = -projection[2, 2] * meters + projection[2, 3], meters
    return 0.5 + 0.5 * clip / w


@pytest.fixture()
def simulated(package):
    scenes.empty(last=2)
    body, _ = scenes.ball()
    thing = scenes.hair(body, 400)
    # Thick, so that a pixel is opaque.
    thing.data.attributes["radius"].data.foreach_set("value", np.full(400 * 16, 1e-3, np.float32))
    one = package.run.Run(bpy.context, [thing], [body], package.run.Options(1, 2))
    one.reset(0)
    yield one, thing
    one.end()


def test_hair_is_where_blender_sees_it(package, simulated):
    one, thing = simulated
    view, projection = camera()
    color, depth = package.picture.render(one.simulation, view, projection, SIZE)
    points = np.concatenate([p for _, p in one.positions()]).astype(np.float64)
    clip = np.concatenate([points, np.ones((len(points), 1))], 1) @ (projection @ view).T
    places = (0.5 + 0.5 * clip[:, :2] / clip[:, 3:]) * SIZE
    x, y = np.floor(places).astype(int).T
    hit = color[y.clip(0, SIZE[1] - 1), x.clip(0, SIZE[0] - 1), 3]
    assert (hit > 0).mean() > 0.97, "the pixels of the vertices are covered"
    assert 0.05 < (color[..., 3] > 0.1).mean() < 0.6
    # No hair is nearer than the nearest vertex, or behind the farthest.
    near, far = window_depth(projection, np.array([clip[:, 3].min(), clip[:, 3].max()]))
    seen = depth[color[..., 3] > 0]
    assert near - 1e-3 < seen.min() and seen.max() < far + 1e-3


def test_units_of_the_scene_do_not_move_the_picture(package, simulated):
    one, _ = simulated
    view, projection = camera()
    color, depth = package.picture.render(one.simulation, view, projection, SIZE)
    # The same scene in centimeters: places are 100 times as large.
    larger, scaled = view.copy(), projection.copy()
    larger[:3, 3] *= 100
    scaled[2, 3] *= 100
    same, deep = package.picture.render(one.simulation, larger, scaled, SIZE, unit=0.01)
    assert np.abs(color - same).max() < 0.02 and np.abs(depth - deep).max() < 1e-3


def test_objects_hide_hair_behind_them(package, simulated):
    if not hasattr(gpu, "init"):
        pytest.skip("this version of Blender has no GPU without a window")
    gpu.init()
    one, _ = simulated
    view, projection = camera()
    color, depth = package.picture.render(one.simulation, view, projection, SIZE)
    target = gpu.types.GPUOffScreen(*SIZE, format="RGBA16F")

    def drawn(at):
        with target.bind():
            framebuffer = gpu.state.active_framebuffer_get()
            framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=at)
            package.picture.draw(color, depth)
            pixels = framebuffer.read_color(0, 0, *SIZE, 4, 0, "FLOAT")
        pixels.dimensions = SIZE[0] * SIZE[1] * 4
        return np.array(pixels, np.float32).reshape(SIZE[1], SIZE[0], 4)

    alone = drawn(1.0)
    assert np.abs(alone[..., 3] - color[..., 3]).max() < 0.01
    middle = float(np.median(depth[color[..., 3] > 0]))
    before = drawn(middle)
    hidden = (color[..., 3] > 0.05) & (depth > middle + 1e-5)
    shown = (color[..., 3] > 0.05) & (depth < middle - 1e-5)
    assert hidden.sum() > 50 and shown.sum() > 50
    assert before[hidden][:, 3].max() == 0 and np.abs(before[shown] - alone[shown]).max() < 0.01
