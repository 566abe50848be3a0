"""Writes and reads grooms with Pixar's USD (Python module `pxr`, package `usd-core`).

`python reference_usd.py write FILE` writes strands (B-splines, widths per curve, two frames) and guides, each under
transforms, with Unreal's attributes; `crates/groom/src/import/usd/reference.usdc` is this file. `python
reference_usd.py read FILE` prints the curves of a file as JSON: their number, the number of points, and the sum of
the points in world space (meters, Y up).

`python reference_usd.py posed FILE CODE` skins a character with UsdSkel at a time code, and prints the number and
the sum of the points by the type of their prim.

`python reference_usd.py skel FILE` writes an animated skeleton of three joints, a skinned body with a blend shape,
and hair that is skinned rigidly as a whole and per point. It prints the points as skinned by UsdSkel, at rest and in
each frame. `crates/groom/src/import/usd/reference_skel.usdc` and `.txt` are the results."""

import json
import sys

from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

FRAMES = (24, 25)


def curve(i, frame, guide):
    return [(i + 0.1 * k * k * (i + 1), 10.0 * k, 0.5 * frame * k) for k in range(2 if guide else 6)]


def begun(path):
    stage = Usd.Stage.CreateNew(path)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.SetTimeCodesPerSecond(24)
    return stage


def write(path):
    stage = begun(path)
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
    meters, up = UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)
    cache = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())
    curves, points, total = 0, 0, Gf.Vec3d(0, 0, 0)
    for prim in stage.Traverse(Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdGeom.BasisCurves):
            shape = UsdGeom.BasisCurves(prim)
            curves += len(shape.GetCurveVertexCountsAttr().Get(Usd.TimeCode.EarliestTime()))
            matrix = cache.GetLocalToWorldTransform(prim)
            for point in shape.GetPointsAttr().Get(Usd.TimeCode.EarliestTime()):
                points += 1
                total += matrix.Transform(Gf.Vec3d(point)) * meters
    x, y, z = total
    print(json.dumps({"curves": curves, "points": points, "sum": [x, z, -y] if up == "Z" else [x, y, z]}))


JOINTS = ["Torso", "Torso/Neck", "Torso/Neck/Head"]


def matrix(move, axis=(0, 1, 0), degrees=0.0, scale=1.0):
    turn = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(*axis), degrees))
    return Gf.Matrix4d().SetScale(scale) * turn * Gf.Matrix4d().SetTranslate(Gf.Vec3d(*move))


def bind(prim, skeleton, joints, weights, width, constant, own=None):
    api = UsdSkel.BindingAPI.Apply(prim)
    api.CreateSkeletonRel().SetTargets([skeleton])
    api.CreateJointIndicesPrimvar(constant, width).Set(joints)
    api.CreateJointWeightsPrimvar(constant, width).Set(weights)
    api.CreateGeomBindTransformAttr().Set(matrix((0.5, 0, 1), (1, 0, 0), 10))
    if own:
        api.CreateJointsAttr().Set(own)
    return api


def skel(path):
    stage = begun(path)
    root = UsdSkel.Root.Define(stage, "/who")
    root.AddTransformOp().Set(matrix((1, 2, 3), (0, 0, 1), 15))
    skeleton = UsdSkel.Skeleton.Define(stage, "/who/bones")
    skeleton.AddTransformOp().Set(matrix((0, 1, 0), (0, 1, 0), 20, 1.5))
    skeleton.CreateJointsAttr(JOINTS)
    places = [matrix((0, 10 * i, i), (1, 0, 0), 5 * i) for i in range(3)]
    skeleton.CreateBindTransformsAttr(places)
    skeleton.CreateRestTransformsAttr([matrix((0, 9 + i, 0), (0, 0, 1), 4 * i) for i in range(3)])
    walk = UsdSkel.Animation.Define(stage, "/who/walk")
    walk.CreateJointsAttr([JOINTS[2], JOINTS[0], JOINTS[1]])
    walk.CreateBlendShapesAttr(["jaw"])
    for frame, time in enumerate(FRAMES):
        turns = [Gf.Rotation(Gf.Vec3d(0, 1, 1), 30 * frame + 10 * i).GetQuat() for i in range(3)]
        walk.CreateTranslationsAttr().Set([Gf.Vec3f(frame, 8 + i, 0.5 * i) for i in range(3)], time)
        walk.CreateRotationsAttr().Set([Gf.Quatf(turn) for turn in turns], time)
        walk.CreateScalesAttr().Set([Gf.Vec3h(1, 1 + 0.25 * frame, 1)] * 3, time)
        walk.CreateBlendShapeWeightsAttr().Set([0.5 * frame], time)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([walk.GetPath()])

    body = UsdGeom.Mesh.Define(stage, "/who/body")
    corners = [Gf.Vec3f(x, 7 * y, z) for y in range(4) for x, z in ((0, 0), (1, 0), (0, 1))]
    faces = [[3 * y + a, 3 * y + b, 3 * y + c] for y in range(3) for a, b, c in ((0, 1, 3), (1, 4, 3), (2, 0, 5))]
    body.CreatePointsAttr(corners)
    body.CreateFaceVertexCountsAttr([3] * len(faces))
    body.CreateFaceVertexIndicesAttr(sum(faces, []))
    shares = [(min(i // 3, 2), min(i // 3 + 1, 2), 0.25 * (i % 4)) for i in range(12)]
    joints, weights = sum(([a, b] for a, b, _ in shares), []), sum(([1 - w, w] for _, _, w in shares), [])
    api = bind(body.GetPrim(), skeleton.GetPath(), joints, weights, 2, False)
    jaw = UsdSkel.BlendShape.Define(stage, "/who/body/jaw")
    jaw.CreateOffsetsAttr([Gf.Vec3f(0, -1, 2), Gf.Vec3f(1, 0, 0)])
    jaw.CreatePointIndicesAttr([11, 9])
    api.CreateBlendShapesAttr(["jaw"])
    api.CreateBlendShapeTargetsRel().SetTargets([jaw.GetPath()])

    for name in ("whole", "parts"):
        hair = UsdGeom.BasisCurves.Define(stage, "/who/" + name)
        hair.CreateTypeAttr("linear")
        hair.CreateCurveVertexCountsAttr([3, 3])
        hair.CreatePointsAttr([Gf.Vec3f(i, 21 + 2 * k, k * k) for i in range(2) for k in range(3)])
        if name == "whole":
            bind(hair.GetPrim(), skeleton.GetPath(), [2, 1], [0.75, 0.25], 2, True)
        else:
            bind(hair.GetPrim(), skeleton.GetPath(), [1, 0] * 6, [0.5, 0.5] * 3 + [0.0, 1.0] * 3, 2, False, JOINTS[1:])
    stage.GetRootLayer().Save()

    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(skeleton)
    for moment in (None,) + FRAMES:
        time = Usd.TimeCode(moment) if moment else Usd.TimeCode.EarliestTime()
        bones = query.ComputeSkinningTransforms(time) if moment else None
        if bones is None:
            # At rest: the inverse bind transforms, followed by the chain of rest transforms.
            now = []
            for i, rest in enumerate(skeleton.GetRestTransformsAttr().Get()):
                now.append(rest * now[i - 1] if i else rest)
            bones = [place.GetInverse() * at for place, at in zip(places, now)]
        world = UsdGeom.XformCache(time).GetLocalToWorldTransform(skeleton.GetPrim())
        for name in ("body", "whole", "parts"):
            prim = stage.GetPrimAtPath("/who/" + name)
            skin = cache.GetSkinningQuery(prim)
            points = list(UsdGeom.PointBased(prim).GetPointsAttr().Get())
            if name == "body" and moment:
                share = walk.GetBlendShapeWeightsAttr().Get(time)[0]
                for index, offset in zip(jaw.GetPointIndicesAttr().Get(), jaw.GetOffsetsAttr().Get()):
                    points[index] += offset * share
            # The query maps the joints to the order of the prim's own list.
            own = Vt.Matrix4dArray(bones)
            if skin.IsRigidlyDeformed():
                moved = skin.ComputeSkinnedTransform(own, time)
                points = [moved.Transform(Gf.Vec3d(p)) for p in points]
            else:
                points = Vt.Vec3fArray(points)
                skin.ComputeSkinnedPoints(own, points, time)
            for point in points:
                print(moment or "rest", name, *(f"{x:.5f}" for x in world.Transform(Gf.Vec3d(point))))


def posed(path, code):
    stage = Usd.Stage.Open(path)
    time = Usd.TimeCode(float(code))
    root = UsdSkel.Root(stage.GetDefaultPrim())
    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.PrimDefaultPredicate)
    skeleton = next(UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    bones = Vt.Matrix4dArray(cache.GetSkelQuery(skeleton).ComputeSkinningTransforms(time))
    world = UsdGeom.XformCache(time).GetLocalToWorldTransform(skeleton.GetPrim())
    found = {}
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.PointBased):
            continue
        skin, points = cache.GetSkinningQuery(prim), Vt.Vec3fArray(UsdGeom.PointBased(prim).GetPointsAttr().Get())
        if skin.IsRigidlyDeformed():
            moved = skin.ComputeSkinnedTransform(bones, time)
            points = [moved.Transform(Gf.Vec3d(p)) for p in points]
        else:
            skin.ComputeSkinnedPoints(bones, points, time)
        total = Gf.Vec3d(0, 0, 0)
        for point in points:
            total += world.Transform(Gf.Vec3d(point)) * UsdGeom.GetStageMetersPerUnit(stage)
        found[str(prim.GetTypeName())] = {"points": len(points), "sum": list(total)}
    print(json.dumps(found))


if __name__ == "__main__":
    {"write": write, "read": read, "skel": skel, "posed": posed}[sys.argv[1]](*sys.argv[2:])
