"""A simulation: frames of the scene become positions of hair, then a bake.

1. Each frame: body and roots as Blender poses them, a step of Tresses, positions into a cache.
2. The cache goes through Blender's own bake, so that the file plays without this extension.
"""

import os
from dataclasses import dataclass, field

import bpy
import numpy as np
import tresses

from . import cache, hair, nodes, versions
from .body import Body, BodyError
from .space import Space
from .tripods import Tripods, deforms, is_attached

# Largest distance between a root in Blender and in the simulation that is no mistake, meters.
ROOT_REACH = 5e-3


@dataclass
class Options:
    """What a simulation needs besides the objects."""

    first: int
    last: int
    # Frames that hair takes to come to rest in the pose of the first frame.
    settle: int = 24
    # Values of Tresses' parameters by name.
    settings: dict = field(default_factory=dict)


class Hair:
    """One hair object in a simulation."""

    def __init__(self, thing, scene):
        self.object = thing
        self.starts, self.rest = hair.offsets(thing.data), hair.positions(thing.data)
        if len(self.starts) < 2:
            raise BodyError(f"{thing.name} has no curves")
        self.tripods = None
        self.attached = is_attached(thing)
        if self.attached:
            if thing.data.surface is None or hair.root_uvs(thing.data) is None:
                raise BodyError(f"{thing.name} is not attached: use Curves > Snap to Nearest Surface")
            self.tripods = Tripods(thing, scene)

    def strands(self, space):
        """Return the curves as `tresses.Strands`, in the pose of the objects now."""
        widths = hair.diameters(self.object.data)
        points = space.points(self.rest, self.object.matrix_world)
        return points, None if widths is None else widths * space.unit

    def stored(self, points, depsgraph):
        """Return what the modifier must give for vertices at `points` (of the object) to end there."""
        if not self.attached:
            return points
        places, turns = self.tripods.frames(depsgraph)
        of = np.repeat(np.arange(len(places)), np.diff(self.starts))
        # The root lies where Blender attaches it.
        first = points[self.starts[:-1]]
        points = points + (places - first)[of]
        return np.einsum("nij,nj->ni", turns[of], points - places[of]) + self.tripods.roots[of]

    def end(self):
        if self.tripods:
            self.tripods.remove()


class Run:
    """A simulation of hair objects on one body. Hair of several objects meets.

    Parameters
    ----------
    things : list of bpy.types.Object
        Hair.
    meshes : list of bpy.types.Object
        The body, its surface first; empty for hair without a body.
    options : Options
    """

    def __init__(self, context, things, meshes, options):
        self.scene, self.view_layer, self.options = context.scene, context.view_layer, options
        self.space = Space(self.scene)
        self.hair, self.caches, self.muted = [], [], []
        self.before = self.scene.frame_current
        self.scene.frame_set(options.first)
        try:
            self.hair = [Hair(thing, self.scene) for thing in things]
            self._build(meshes)
        except BaseException:
            self.end()
            raise

    def _build(self, meshes):
        depsgraph = bpy.context.evaluated_depsgraph_get
        self.body = Body(meshes, self.space) if meshes else None
        mesh = rig = None
        if self.body:
            with self.body.at_rest(self.view_layer):
                triangles = self.body.triangles(depsgraph())
                mesh = tresses.Mesh(self.body.vertices(depsgraph()), triangles)
                rig = tresses.Rig(*self.body.rig(depsgraph()))
        points, widths, starts = [], [], [0]
        for one in self.hair:
            own, width = one.strands(self.space)
            points.append(own)
            widths.append(np.full(len(own), 7e-5, np.float32) if width is None else width)
            starts.extend((one.starts[1:] + starts[-1]).tolist())
        strands = tresses.Strands(np.concatenate(points), starts, np.concatenate(widths))
        settings = {"lod.mode": "off", "style.all_guides": len(strands) <= 20_000, **self.options.settings}
        groom = tresses.Groom.of(strands, mesh, settings, rig=rig)
        self.notes = list(groom.notes)
        self.simulation = tresses.Simulation(groom)

    def _pose(self):
        if not self.body:
            return {}
        return dict(skin=self.body.vertices(bpy.context.evaluated_depsgraph_get()), joints=self.body.joints())

    def _mute(self):
        """Switch off the modifiers that only shape the result: they take time in each frame."""
        for one in self.hair:
            for m in one.object.modifiers:
                if m.show_viewport:
                    m.show_viewport = False
                    self.muted.append(m)

    def frames(self):
        """Simulate all frames. Yields the share that is done after each."""
        options = self.options
        count = options.last - options.first + 1
        self._mute()
        self.scene.frame_set(options.first)
        self.caches = [
            cache.Cache.create(cache.folder(one.object), options.first, count, len(one.rest)) for one in self.hair
        ]
        seconds = self.scene.render.fps_base / self.scene.render.fps
        pose = self._pose()
        self.simulation.reset(**pose)
        for i in range(options.settle):
            self.simulation.step(seconds, **pose)
            yield i / (options.settle + count)
        for i in range(count):
            if i > 0:
                self.scene.frame_set(options.first + i)
                self.simulation.step(seconds, **self._pose())
            self._store()
            yield (options.settle + i + 1) / (options.settle + count)

    def _store(self):
        given, first = self.simulation.given(), 0
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for one, kept in zip(self.hair, self.caches):
            points = self.space.back(given[first : first + len(one.rest)], one.object.matrix_world)
            kept.append(one.stored(points, depsgraph))
            first += len(one.rest)

    def end(self):
        """Restore the scene. What is in the caches stays."""
        for m in self.muted:
            m.show_viewport = True
        self.muted = []
        for one in self.hair:
            one.end()
        self.hair = []
        self.scene.frame_set(self.before)


def bake(context, thing):
    """Let Blender bake the cache of a hair object into its modifier."""
    frames = cache.Cache(cache.folder(thing))
    if frames.vertices != len(thing.data.points) or frames.done == 0:
        raise BodyError(f"{thing.name} has been edited since: simulate it again")
    m = nodes.add_modifier(thing)

    def write(scene, *_):
        hair.write_vectors(thing.data, nodes.ATTRIBUTE, frames.frame(scene.frame_current))

    current = context.scene.frame_current
    bpy.app.handlers.frame_change_pre.append(write)
    try:
        context.view_layer.update()
        baked = m.bakes[0]
        versions.set_bake(baked, os.path.join(frames.path, "bake"), frames.first, frames.last)
        bpy.ops.object.geometry_node_bake_single(
            session_uid=thing.session_uid, modifier_name=m.name, bake_id=baked.bake_id
        )
    finally:
        bpy.app.handlers.frame_change_pre.remove(write)
        found = thing.data.attributes.get(nodes.ATTRIBUTE)
        if found is not None:
            thing.data.attributes.remove(found)
        context.scene.frame_set(current)


def clear(thing):
    """Remove the result of a simulation from a hair object."""
    m = nodes.modifier(thing)
    if m is not None:
        thing.modifiers.remove(m)
    found = thing.data.attributes.get(nodes.ATTRIBUTE)
    if found is not None:
        thing.data.attributes.remove(found)
