"""Labels of pictures as papers on hair reconstruction use them, and Gaussians on strands."""

import numpy

from ._tresses import TressesError

# Factor of the first spherical harmonic.
_SH = 0.28209479177387814


def camera_of(K, RT, size):
    """Return the camera of a calibrated picture, for `Simulation.render`.

    Parameters
    ----------
    K : array [3, 3]
        Intrinsics: focal lengths and principal point, pixels.
    RT : array [3, 4] or [4, 4]
        From world to camera: x right, y down, z forward, meters.
    size : (int, int)
        Width and height of the picture, pixels.

    Returns
    -------
    (array [4, 4], array [4, 4])
        View and projection.
    """
    K, RT = numpy.asarray(K, numpy.float64), numpy.asarray(RT, numpy.float64)
    if K.shape != (3, 3) or RT.shape not in ((3, 4), (4, 4)):
        raise TressesError(f"K and RT have the shapes {K.shape} and {RT.shape}, but must have [3, 3] and [3, 4]")
    width, height = size
    view = numpy.eye(4)
    view[:3] = numpy.diag([1.0, -1.0, -1.0]) @ RT[:3]
    projection = numpy.zeros((4, 4))
    projection[0, :3] = 2 * K[0, 0] / width, -2 * K[0, 1] / width, 1 - 2 * K[0, 2] / width
    projection[1, 1:3] = 2 * K[1, 1] / height, 2 * K[1, 2] / height - 1
    projection[2, 3], projection[3, 2] = 0.01, -1
    return view.astype(numpy.float32), projection.astype(numpy.float32)


def calibration(view, projection, size):
    """Return K [3, 3] and RT [3, 4] of a perspective camera: the inverse of `camera_of`."""
    view, projection = numpy.asarray(view, numpy.float64), numpy.asarray(projection, numpy.float64)
    width, height = size
    if abs(projection[3, 2] + 1) > 1e-6:
        raise TressesError("an orthographic camera has no K: use view and projection")
    K = numpy.eye(3)
    K[0, 0], K[0, 1], K[0, 2] = projection[0, 0] * width / 2, -projection[0, 1] * width / 2, (1 - projection[0, 2]) * width / 2
    K[1, 1], K[1, 2] = projection[1, 1] * height / 2, (1 + projection[1, 2]) * height / 2
    return K, (numpy.diag([1.0, -1.0, -1.0]) @ view[:3])


def orthographic(eye, target, height, size, near=0.01, far=10.0):
    """Return an upright orthographic camera: view and projection. `height` is what the picture shows, meters."""
    eye, target = numpy.asarray(eye, numpy.float64), numpy.asarray(target, numpy.float64)
    back = eye - target
    back = back / numpy.linalg.norm(back)
    right = numpy.cross([0.0, 1.0, 0.0], back)
    right = right / numpy.linalg.norm(right)
    view = numpy.eye(4)
    view[:3, :3] = right, numpy.cross(back, right), back
    view[:3, 3] = -view[:3, :3] @ eye
    projection = numpy.diag([2 * size[1] / (height * size[0]), 2 / height, 1 / (far - near), 1.0])
    projection[2, 3] = far / (far - near)
    return view.astype(numpy.float32), projection.astype(numpy.float32)


def labels(simulation, camera=None, size=(1280, 720), **view):
    """Render a picture of the current state with the labels of papers.

    Parameters
    ----------
    simulation : Simulation
        Hair, in tiles without supersampling, as `Simulation.render` asks.
    camera, size, **view
        As for `Simulation.render`.

    Returns
    -------
    dict
        Arrays, rows from the top: ``color`` uint8 [h, w, 4]; ``mask``, opacity of the hair, and ``body``, share of the
        pixel that shows the body, [h, w]; ``body_depth`` [h, w], meters, inf without body, and ``body_normal`` [h, w, 3],
        world space, 0 without body, both also behind the hair; ``depth`` of the hair, meters, inf without; ``direction`` [h, w, 2], the
        projected direction from root to tip, pixels to the right and down, length 1, 0 without hair; ``orientation``
        [h, w], degrees from 0 to 180, 0 vertical and 90 horizontal, as the filters of NeuralHaircut and GaussianHaircut
        answer, nan without hair; ``strand_map`` uint8 [h, w, 3], the picture of HairStep: hair and half the body in red,
        the direction in green and blue; ``strand``, ``groom`` and ``share`` as for `Simulation.render`; ``view`` and ``projection``;
        ``K`` [3, 3] and ``RT`` [3, 4], for perspective cameras.
    """
    matrices = simulation.camera(camera, size, **view)
    given = (matrices["view"], matrices["projection"])
    outputs = ["color", "body_depth", "body_normal", "coverage", "depth", "tangent", "strand", "groom", "share"]
    out = simulation.render(given, size, outputs, background="transparent")
    direction = _projected(out["tangent"], out["depth"], *given)
    has_direction = numpy.abs(direction).sum(-1) > 0
    angle = numpy.degrees(numpy.arctan2(direction[..., 0], direction[..., 1])) % 180
    alpha = out["color"][..., 3].astype(numpy.float32) / 255
    mask, body = out["coverage"], numpy.clip(alpha - out["coverage"], 0, 1)
    strand_map = numpy.zeros((*mask.shape, 3))
    strand_map[..., 0] = numpy.clip(mask + 0.5 * body, 0, 1)
    strand_map[..., 1:] = numpy.where(has_direction[..., None], 0.5 + 0.5 * direction, 0)
    found = {
        "color": out["color"],
        "mask": mask,
        "body": body,
        "body_depth": out["body_depth"],
        "body_normal": out["body_normal"],
        "depth": out["depth"],
        "direction": direction,
        "orientation": numpy.where(has_direction, angle, numpy.nan).astype(numpy.float32),
        "strand_map": numpy.round(255 * strand_map).astype(numpy.uint8),
        "strand": out["strand"],
        "groom": out["groom"],
        "share": out["share"],
        "view": given[0],
        "projection": given[1],
    }
    if abs(given[1][3, 2] + 1) < 1e-6:
        found["K"], found["RT"] = calibration(*given, size)
    return found


def _projected(tangent, depth, view, projection):
    """Return unit directions in the picture, right and down, of tangents in world space at view-space depths."""
    height, width = depth.shape
    view, projection = view.astype(numpy.float64), projection.astype(numpy.float64)
    far = numpy.where(numpy.isfinite(depth), depth, 1.0)
    x = (numpy.arange(width) + 0.5)[None] * 2 / width - 1
    y = 1 - (numpy.arange(height) + 0.5)[:, None] * 2 / height
    # Normalized coordinates of a point at this depth; its clip coordinate w follows from the depth alone.
    w = projection[3, 2] * -far + projection[3, 3]
    view_tangent = tangent.astype(numpy.float64) @ view[:3, :3].T
    clip = view_tangent @ projection[:, :3].T
    across = numpy.stack([clip[..., 0] - x * clip[..., 3], clip[..., 1] - y * clip[..., 3]], -1) / w[..., None]
    across *= [width, -height]
    length = numpy.linalg.norm(across, axis=-1, keepdims=True)
    return (across / numpy.where(length > 0, length, 1)).astype(numpy.float32)


def gaussians(strands, color=(0.1, 0.06, 0.04)):
    """Return a Gaussian for each segment, to begin an optimization with.

    Parameters
    ----------
    strands : Strands
        Strands; their widths and colors are used if they have them.
    color : array [3]
        Linear color without colors.

    Returns
    -------
    dict
        ``mean`` [s, 3], meters; ``rotation`` [s, 4], unit quaternions (w, x, y, z) that turn X along the segment;
        ``scale`` [s, 3], half the length and twice the radius, meters; ``sh`` [s, 3], the constant spherical harmonic of
        the color in sRGB; ``strand`` int [s].
    """
    starts, points = strands.offsets, strands.positions.astype(numpy.float64)
    strand = numpy.repeat(numpy.arange(len(strands)), numpy.maximum(numpy.diff(starts) - 1, 0))
    # Vertices that begin a segment: all but the last of each strand.
    first = numpy.delete(numpy.arange(len(points)), starts[1:] - 1)
    a, b = points[first], points[first + 1]
    along = b - a
    length = numpy.linalg.norm(along, axis=1)
    unit = along / numpy.maximum(length, 1e-12)[:, None]
    # Half-way quaternion from X; opposite directions turn about Y.
    rotation = numpy.stack([1 + unit[:, 0], 0 * length, -unit[:, 2], unit[:, 1]], 1)
    rotation[unit[:, 0] < -1 + 1e-9] = [0, 0, 1, 0]
    rotation /= numpy.linalg.norm(rotation, axis=1, keepdims=True)
    widths = numpy.full(len(points), 7e-5) if strands.widths is None else strands.widths
    radius = 0.25 * (widths[first] + widths[first + 1])
    linear = numpy.asarray(color)[None] if strands.colors is None else 0.5 * (strands.colors[first] + strands.colors[first + 1])
    linear = numpy.broadcast_to(numpy.clip(linear, 0, 1), (len(first), 3))
    srgb = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    single = lambda values: numpy.asarray(values, numpy.float32)
    return {
        "mean": single(0.5 * (a + b)),
        "rotation": single(rotation),
        "scale": single(numpy.stack([0.5 * length, 2 * radius, 2 * radius], 1)),
        "sh": single((srgb - 0.5) / _SH),
        "strand": strand,
    }
