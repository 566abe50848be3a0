"""Grooms as Pixar's USD writes and reads them (Python module `pxr`, package `usd-core`).

`python reference_usd.py write FILE`: strands (B-splines, widths per curve, two frames) and guides, each under transforms,
with Unreal's attributes; `crates/groom/src/import/usd/reference.usdc` is this file. `python reference_usd.py read FILE`:
prints, as JSON, what curves a file has: how many, how many points, and the sum of these in the world, in metres, Y up."""

import json
import sys

from pxr import Gf, Sdf, Usd, UsdGeom

FRAMES = (24, 25)


def curve(i, frame, guide):
    return [(i + 0.1 * k * k * (i + 1), 10.0 * k, 0.5 * frame * k) for k in range(2 if guide else 6)]


def write(path):
    stage = Usd.Stage.CreateNew(path)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.SetTimeCodesPerSecond(24)
    top = UsdGeom.Xform.Define(stage, "/hair")
    stage.SetDefaultPrim(top.GetPrim())
    top.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    top.AddRotateYOp().Set(90.0)
    top.AddScaleOp().Set(Gf.Vec3f(2, 2, 2))
    for name, count, guide in (("strands", 5, False), ("guides", 2, True)):
        above = UsdGeom.Xform.Define(stage, "/hair/" + name + "_x")
        above.AddTransformOp().Set(Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, 5 if guide else 0)))
        curves = UsdGeom.BasisCurves.Define(stage, f"/hair/{name}_x/{name}")
        curves.CreateTypeAttr("linear" if guide else "cubic")
        curves.CreateBasisAttr("bspline")
        curves.CreateCurveVertexCountsAttr([2 if guide else 6] * count)
        for frame, time in enumerate(FRAMES):
            points = [Gf.Vec3f(*p) for i in range(count) for p in curve(i, frame, guide)]
            curves.CreatePointsAttr().Set(points, time)
        curves.CreateWidthsAttr([0.01 * (i + 1) for i in range(count)])
        curves.SetWidthsInterpolation("uniform")
        values = UsdGeom.PrimvarsAPI(curves)

        def attribute(name, numbers):
            values.CreatePrimvar(name, Sdf.ValueTypeNames.IntArray, "uniform").Set(numbers)

        attribute("groom_guide", [int(guide)] * count)
        attribute("groom_id", [(100 if guide else 0) + i for i in range(count)])
        attribute("groom_group_id", [i % 2 for i in range(count)])
    stage.GetRootLayer().Save()


def read(path):
    stage = Usd.Stage.Open(path)
    metres, up = UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)
    cache = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())
    curves, points, total = 0, 0, Gf.Vec3d(0, 0, 0)
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdGeom.BasisCurves):
            shape = UsdGeom.BasisCurves(prim)
            curves += len(shape.GetCurveVertexCountsAttr().Get(Usd.TimeCode.EarliestTime()))
            matrix = cache.GetLocalToWorldTransform(prim)
            for point in shape.GetPointsAttr().Get(Usd.TimeCode.EarliestTime()):
                points += 1
                total += matrix.Transform(Gf.Vec3d(point)) * metres
    x, y, z = total
    print(json.dumps({"curves": curves, "points": points, "sum": [x, z, -y] if up == "Z" else [x, y, z]}))


if __name__ == "__main__":
    {"write": write, "read": read}[sys.argv[1]](sys.argv[2])
