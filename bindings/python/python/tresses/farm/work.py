"""A worker: simulates a shot and renders the frames of a shard with all cameras."""

from __future__ import annotations

import time
from typing import Any, Iterator

import tresses

from . import flow, shards, sweep
from .plan import OUTPUTS, Plan, Shard


class Clock:
    """Time per category of work, seconds."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, kind: str | None) -> None:
        """Add the time since the last lap to `kind`, or discard it if `kind` is None."""
        now = time.perf_counter()
        if kind is not None:
            self.seconds[kind] = self.seconds.get(kind, 0.0) + now - self._last
        self._last = now


class Stage:
    """Simulation of a shot.

    Only its steps change its state, so every frame is bit-identical, whichever frames were rendered before.
    """

    def __init__(self, plan: Plan, index: int, groom: tresses.Groom) -> None:
        self.plan, self.shot = plan, plan.shots[index]
        self.sim = tresses.Simulation(groom, sweep.parted(self.shot.settings)[1])
        self.motion = tresses.Motion(self.shot.motion)
        rest = groom.guides
        self.views = [(view.name, view.placed(self.shot.seed, rest, plan.size)) for view in plan.cameras]
        self.steps = 0
        # Frame number and strands of the last frame with motion output.
        self.before: tuple[int, flow.Moment] | None = None

    def go(self, frame: int) -> int:
        """Step to a frame and return the number of steps."""
        steps = self.plan.steps(frame) - self.steps
        for _ in range(steps):
            self.steps += 1
            self.sim.step(1 / self.plan.rate, **self.motion.at(self.steps / self.plan.rate, self.sim.pivot))
        return steps

    def remember(self, frame: int) -> flow.Moment:
        cameras = {}
        for name, where in self.views:
            matrices = self.sim.camera(size=self.plan.size, **where)
            cameras[name] = matrices["projection"].astype(float) @ matrices["view"].astype(float)
        moment = flow.Moment([self.sim.strands(), *self.sim.face()], cameras)
        self.before = (frame, moment)
        return moment

    def remembered(self, frame: int) -> flow.Moment | None:
        return self.before[1] if self.before and self.before[0] == frame else None

    def samples(self, frame: int) -> Iterator[shards.Sample]:
        """Yield the samples of the current frame, one per camera."""
        plan = self.plan
        before = self.remembered(frame - 1)
        now = self.remember(frame) if "motion" in plan.outputs else None
        outputs = [name for name in plan.outputs if name in OUTPUTS and name != "motion"]
        labels = [name for name in flow.LABELS if now is not None and name not in outputs]
        shapes = {}
        if "guides" in plan.outputs:
            shapes["guides"] = self.sim.guides()
        if "strands" in plan.outputs:
            shapes["strands"] = self.sim.strands().grid()
        for name, where in self.views:
            # `render` needs at least one output; color adds no cost.
            rendered = self.sim.render(
                size=plan.size, outputs=[*outputs, *labels] or ["color"], background=plan.background, **where
            )
            arrays = {output: rendered[output] for output in outputs}
            if now is not None:
                arrays["motion"] = flow.motion(rendered, now, before, name)
            if "color" in arrays and plan.background != "transparent":
                arrays["color"] = arrays["color"][..., :3]
            yield shards.Sample(
                f"{self.shot.index:06}-{frame:06}-{name}", {**arrays, **shapes}, self.metadata(frame, name, where)
            )

    def metadata(self, frame: int, name: str, where: dict[str, Any]) -> dict[str, Any]:
        matrices = self.sim.camera(size=self.plan.size, **where)
        translation, rotation = self.sim.head
        return {
            "shot": self.shot.index,
            "name": self.shot.name,
            "seed": self.shot.seed,
            "groom": self.plan.grooms[self.shot.groom].name,
            "settings": self.shot.settings,
            "frame": frame,
            "time": self.steps / self.plan.rate,
            "camera": name,
            "view": matrices["view"].tolist(),
            "projection": matrices["projection"].tolist(),
            "head": [list(translation), list(rotation)],
        }


class Worker:
    """Opens the GPU and keeps the current shot, so that its next shard continues where the last one ended."""

    def __init__(self, plan: Plan) -> None:
        began = time.perf_counter()
        self.plan = plan
        self.adapter = tresses.adapter()
        self.opened = time.perf_counter() - began
        self.done = 0
        self.stage: Stage | None = None
        self.groom: tuple[Any, tresses.Groom] | None = None

    def do(self, index: int, folder: str) -> dict[str, Any]:
        """Render and write a shard. Return its record."""
        try:
            return self._done(index, folder)
        except BaseException:
            # The simulation's state is unknown after an error.
            self.stage = None
            raise

    def _done(self, index: int, folder: str) -> dict[str, Any]:
        self.done += 1
        plan, shard, clock = self.plan, self.plan.shards[index], Clock()
        stage, created = self._stand(shard, clock)
        steps = 0
        with shards.Writer(folder, index, plan.compress) as writer:
            # Motion also needs the frame before the first one.
            before = "motion" in plan.outputs and shard.first > 0 and stage.remembered(shard.first - 1) is None
            for frame in range(shard.first - 1 if before else shard.first, shard.end):
                steps += stage.go(frame)
                clock.lap("steps")
                if frame < shard.first:
                    stage.remember(frame)
                    clock.lap("pictures")
                    continue
                for sample in stage.samples(frame):
                    clock.lap("pictures")
                    writer.add(sample)
                    clock.lap("writing")
                clock.lap("pictures")
            written = writer.close()
            clock.lap("writing")
        return {
            "shard": index,
            **written,
            "samples": plan.pictures(shard),
            "adapter": self.adapter,
            "cost": {
                # A worker's first shard includes the driver's one-time compilation.
                "first": self.done == 1,
                **created,
                "steps": steps,
                "pictures": plan.pictures(shard),
                "seconds": clock.seconds,
            },
        }

    def _stand(self, shard: Shard, clock: Clock) -> tuple[Stage, dict[str, int]]:
        """Return a stage that has not passed the shard's start, and the numbers of grooms and shots that it created."""
        stage, created = self.stage, {"grooms": 0, "shots": 0}
        if stage and stage.shot.index == shard.shot and stage.steps <= self.plan.steps(shard.first - 1 if shard.first else 0):
            return stage, created
        shot = self.plan.shots[shard.shot]
        groom_settings, _ = sweep.parted(shot.settings)
        key = (shot.groom, groom_settings)
        self.stage = None
        if self.groom is None or self.groom[0] != key:
            self.groom = None
            self.groom = (key, self.plan.grooms[shot.groom].build(groom_settings))
            created["grooms"] = 1
            clock.lap("groom")
        stage = self.stage = Stage(self.plan, shard.shot, self.groom[1])
        created["shots"] = 1
        clock.lap("shot")
        return stage, created
