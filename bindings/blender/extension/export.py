"""Grooms in files: guides, strands, groups and root UVs, as Unreal reads them."""

import numpy as np
import tresses

from . import hair, nodes
from .body import Body, BodyError
from .space import Space


def _strands(evaluated, space):
    """Return points in Tresses' space, offsets, diameters in meters and root UVs of evaluated curves."""
    curves = evaluated.data
    widths = hair.diameters(curves)
    points = space.points(hair.positions(curves), evaluated.matrix_world)
    scale = space.unit * np.mean(evaluated.matrix_world.to_scale())
    return points, hair.offsets(curves), None if widths is None else widths * scale, hair.root_uvs(curves)


class _Parts:
    """Strands of several sources, as one."""

    def __init__(self):
        self.points, self.starts, self.widths, self.uvs = [], [0], [], []
        self.guides, self.groups, self.closest, self.count = [], [], [], 0

    def add(self, of, guide, group, closest):
        points, starts, widths, uvs = of
        count = len(starts) - 1
        self.points.append(points)
        self.starts.extend((starts[1:] + self.starts[-1]).tolist())
        self.widths.append(np.full(len(points), 7e-5, np.float32) if widths is None else widths)
        self.uvs.append(np.full((count, 2), np.nan, np.float32) if uvs is None else uvs)
        self.guides.append(np.full(count, guide))
        self.groups.append(np.full(count, group))
        self.closest.append(np.zeros(count, np.int64) if closest is None else closest)
        self.count += count

    def strands(self):
        uvs = np.concatenate(self.uvs)
        marks = {}
        if any(guides.any() for guides in self.guides):
            marks = dict(closest=np.concatenate(self.closest)[:, None])
        return tresses.Strands(
            np.concatenate(self.points),
            self.starts,
            np.concatenate(self.widths),
            root_uvs=uvs if np.isfinite(uvs).all() else None,
            guides=np.concatenate(self.guides),
            groups=np.concatenate(self.groups),
            **marks,
        )


def groom(context, things, path, unit="cm"):
    """Write the hair at rest. Returns what the file cannot hold, as sentences."""
    return at_rest(context, things).strands().write(path, unit=unit)


def at_rest(context, things):
    """Return the hair at rest. Each object is a group; its own curves are the guides of what its modifiers make."""
    space, parts = Space(context.scene), _Parts()
    bodies = dict.fromkeys(thing.data.surface for thing in things if thing.data.surface)
    moved = [m for m in map(nodes.modifier, things) if m and m.show_viewport]
    try:
        for m in moved:
            m.show_viewport = False
        with Body(list(bodies), space).at_rest(context.view_layer):
            _add(things, space, context.evaluated_depsgraph_get(), parts)
    finally:
        for m in moved:
            m.show_viewport = True
    return parts


def _add(things, space, depsgraph, parts):
    for group, thing in enumerate(things):
        now = thing.evaluated_get(depsgraph)
        of = hair.attribute(now.data, "guide_curve_index", "CURVE", 1, np.int32)
        first = parts.count
        if of is None:
            # No strand says which guide it follows, so none is a guide.
            parts.add(_strands(now, space), False, group, None)
            continue
        own = _guides(thing, space)
        count = len(own[1]) - 1
        if not ((of >= 0) & (of < count)).all():
            raise BodyError(f"strands of {thing.name} follow guides that it does not have")
        parts.add(own, True, group, first + np.arange(count))
        parts.add(_strands(now, space), False, group, first + of)


def _guides(thing, space):
    """Return the curves of an object without its modifiers."""
    curves = thing.data
    widths, matrix = hair.diameters(curves), thing.matrix_world
    scale = space.unit * np.mean(matrix.to_scale())
    points = space.points(hair.positions(curves), matrix)
    return points, hair.offsets(curves), None if widths is None else widths * scale, hair.root_uvs(curves)


def cache(context, things, path, unit="cm"):
    """Write the strands in all frames of the scene. Returns what the file cannot hold, as sentences."""
    scene, space = context.scene, Space(context.scene)
    before, frames = scene.frame_current, scene.frame_end - scene.frame_start + 1
    try:
        writer = None
        for i in range(frames):
            scene.frame_set(scene.frame_start + i)
            depsgraph, parts = context.evaluated_depsgraph_get(), _Parts()
            for group, thing in enumerate(things):
                parts.add(_strands(thing.evaluated_get(depsgraph), space), False, group, None)
            strands = parts.strands()
            if writer is None:
                count = len(strands.positions)
                fps = scene.render.fps / scene.render.fps_base
                writer = tresses.Cache(path, strands, frames, fps, unit=unit)
            if len(strands.positions) != count:
                raise BodyError(f"the number of vertices changes at frame {scene.frame_current}")
            writer.frame(strands.positions)
        writer.close()
    finally:
        scene.frame_set(before)
    return []
