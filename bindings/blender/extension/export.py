"""Grooms in files: guides, strands, groups and root UVs, as Unreal reads them."""

from dataclasses import dataclass
from typing import Optional

import numpy as np
import tresses

from . import hair, nodes
from .body import Body, BodyError
from .space import Space

# Diameter of curves that have none, meters.
WIDTH = 7e-5


def strands(hair_object, space):
    """Return points in Tresses' space, offsets and diameters in meters of an object's curves."""
    curves, matrix = hair_object.data, hair_object.matrix_world
    widths = hair.diameters(curves)
    points = _points(hair_object, space)
    scale = space.unit * np.mean(matrix.to_scale())
    widths = np.full(len(points), WIDTH, np.float32) if widths is None else widths * scale
    return points, hair.offsets(curves), widths


def _points(hair_object, space):
    return space.points(hair.positions(hair_object.data), hair_object.matrix_world)


@dataclass
class Source:
    """Curves of one object with their attributes."""

    # Points, offsets and diameters of `strands`.
    strands: tuple
    root_uvs: Optional[np.ndarray]
    colors: Optional[np.ndarray]
    # Custom attributes, as `hair.custom` returns them.
    attributes: dict

    @classmethod
    def of(cls, hair_object, space):
        curves = hair_object.data
        uvs = hair.root_uvs(curves)
        uvs = _own(curves, "groom_root_uv", 2) if uvs is None else uvs
        return cls(strands(hair_object, space), uvs, hair.colors(curves), hair.custom(curves))

    def __len__(self):
        return len(self.strands[1]) - 1


def _own(curves, name, width=1, dtype=np.float32):
    """Return an attribute of the curves in Unreal's naming, which USD files have, or None."""
    return hair.attribute(curves, name, "CURVE", width, dtype)


def _marks(curves, group, first):
    """Return guides, ids, groups, closest guides and weights of curves that have them from a file, or None.

    `first` is the number of strands before, which keeps ids of several objects apart.
    """
    guides, ids = _own(curves, "groom_guide", 1, np.int32), _own(curves, "groom_id", 1, np.int32)
    groups, closest = _own(curves, "groom_group_id", 1, np.int32), _own(curves, "groom_closest_guides", 3)
    if all(values is None for values in (guides, ids, groups)):
        return None
    count = len(curves.curves)
    ids = np.arange(count) if ids is None else ids.astype(np.int64)
    weights = _own(curves, "groom_guide_weights", 3)
    known = closest is not None
    return dict(
        guide=np.zeros(count, bool) if guides is None else guides != 0,
        ids=first + ids,
        group=group + (0 if groups is None else groups.astype(np.int64)),
        closest=first + closest.astype(np.int64) if known else np.full((count, 3), first),
        weights=np.zeros((count, 3)) if not known else np.tile([1.0, 0, 0], (count, 1)) if weights is None else weights,
    )


def joined(sources):
    """Return points, offsets and diameters of several results of `strands`, as one."""
    points, starts, widths = [], [0], []
    for own, offsets, diameters in sources:
        points.append(own)
        starts.extend((offsets[1:] + starts[-1]).tolist())
        widths.append(diameters)
    return np.concatenate(points), starts, np.concatenate(widths)


class _Parts:
    """Strands of several sources, as one."""

    def __init__(self):
        self.sources = []
        self.marks = {name: [] for name in ("guide", "ids", "group", "closest", "weights")}

    def next_id(self):
        """Return a number above all ids."""
        return max((int(ids.max()) + 1 for ids in self.marks["ids"] if len(ids)), default=0)

    def add(self, of, marks):
        """Add strands with the marks of `_marks`."""
        self.sources.append(of)
        for name, values in marks.items():
            self.marks[name].append(values)

    def add_plain(self, of, guide, group, closest=None):
        """Add strands that all are guides or none, of one group. Each follows one guide, by its id, or none."""
        count, first = len(of), self.next_id()
        known = closest is not None
        self.add(
            of,
            dict(
                guide=np.full(count, guide),
                ids=first + np.arange(count),
                group=np.full(count, group),
                closest=np.repeat((closest if known else np.full(count, first))[:, None], 3, 1),
                weights=np.tile([1.0 if known else 0.0, 0, 0], (count, 1)),
            ),
        )

    def strands(self):
        marks = {name: np.concatenate(all) for name, all in self.marks.items()}
        return tresses.Strands(
            *joined(of.strands for of in self.sources),
            root_uvs=_concatenated([of.root_uvs for of in self.sources]),
            colors=_concatenated([of.colors for of in self.sources]),
            guides=marks["guide"],
            ids=marks["ids"],
            groups=marks["group"],
            closest=marks["closest"],
            weights=marks["weights"],
            attributes=self._attributes(),
        )

    def _attributes(self):
        """Return the custom attributes that all sources have."""
        first, *others = (of.attributes for of in self.sources)
        kind = lambda one: one and (one[1], one[0].shape[1:])
        return {
            name: np.concatenate([one[0], *(other[name][0] for other in others)])
            for name, one in first.items()
            if all(kind(other.get(name)) == kind(one) for other in others)
        }


def _concatenated(arrays):
    """Return arrays as one, or None if one is missing or not finite."""
    known = all(one is not None and np.isfinite(one).all() for one in arrays)
    return np.concatenate(arrays) if known else None


def groom(context, hair_objects, path, unit="cm"):
    """Write the hair at rest. Returns what the file cannot hold, as sentences."""
    return at_rest(context, hair_objects).strands().write(path, unit=unit)


def at_rest(context, hair_objects):
    """Return the hair at rest. Each object is a group; its own curves are the guides of what its modifiers make."""
    space, parts = Space(context.scene), _Parts()
    bodies = dict.fromkeys(hair_object.data.surface for hair_object in hair_objects if hair_object.data.surface)
    modifiers = [m for m in map(nodes.modifier, hair_objects) if m and m.show_viewport]
    try:
        for m in modifiers:
            m.show_viewport = False
        with Body(list(bodies), space).at_rest(context.view_layer):
            _add(hair_objects, space, context.evaluated_depsgraph_get(), parts)
    finally:
        for m in modifiers:
            m.show_viewport = True
    return parts


def _add(hair_objects, space, depsgraph, parts):
    group = 0
    for hair_object in hair_objects:
        now, first = hair_object.evaluated_get(depsgraph), parts.next_id()
        of = hair.attribute(now.data, "guide_curve_index", "CURVE", 1, np.int32)
        marks = _marks(now.data, group, first)
        if of is not None:
            count = len(hair_object.data.curves)
            if not ((of >= 0) & (of < count)).all():
                raise BodyError(f"strands of {hair_object.name} follow guides that it does not have")
            parts.add_plain(Source.of(hair_object, space), True, group, first + np.arange(count))
            parts.add_plain(Source.of(now, space), False, group, first + of)
        elif marks is not None:
            parts.add(Source.of(now, space), marks)
        else:
            # No strand says which guide it follows, so none is a guide.
            parts.add_plain(Source.of(now, space), False, group)
        group = int(parts.marks["group"][-1].max()) + 1


def cache(context, hair_objects, path, unit="cm"):
    """Write the strands in all frames of the scene. Returns what the file cannot hold, as sentences."""
    scene, space = context.scene, Space(context.scene)
    before, frames = scene.frame_current, scene.frame_end - scene.frame_start + 1
    try:
        writer = None
        for i in range(frames):
            scene.frame_set(scene.frame_start + i)
            depsgraph = context.evaluated_depsgraph_get()
            now = [hair_object.evaluated_get(depsgraph) for hair_object in hair_objects]
            points = np.concatenate([_points(one, space) for one in now])
            if writer is None:
                parts = _Parts()
                for group, one in enumerate(now):
                    parts.add_plain(Source.of(one, space), False, group)
                count = len(points)
                fps = scene.render.fps / scene.render.fps_base
                writer = tresses.Cache(path, parts.strands(), frames, fps, unit=unit)
            if len(points) != count:
                raise BodyError(f"the number of vertices changes at frame {scene.frame_current}")
            writer.frame(points)
        writer.close()
    finally:
        scene.frame_set(before)
    return []
