"""Writes and reads grooms with the reference implementation of Alembic (Python module `alembic3d`).

`python reference.py write FILE` writes strands (B-splines, widths per curve, two frames) and guides, each under
transforms, with Unreal's attributes; `crates/groom/src/import/abc/reference.abc` is this file. `python reference.py
read FILE` prints the curves of a file as JSON: their number, points, attributes and times."""

import json
import sys

import imath
from alembic3d.Abc import *
from alembic3d.AbcCoreAbstract import *
from alembic3d.AbcGeom import *


def filled(array, values):
    for i, value in enumerate(values):
        array[i] = value
    return array


def ints(values):
    return filled(imath.IntArray(len(values)), values)


def floats(values):
    return filled(imath.FloatArray(len(values)), values)


def vecs(values):
    return filled(imath.V3fArray(len(values)), [imath.V3f(*value) for value in values])


def curve(i, frame, guide):
    return [(i + 0.1 * k * k * (i + 1), 10.0 * k, 0.5 * frame * k) for k in range(2 if guide else 6)]


def attribute(compound, name, values, scope):
    OInt32GeomParam(compound, name, False, scope, 1).set(OInt32GeomParamSample(ints(values), scope))


def write(path):
    archive = OArchive(path)
    times = archive.addTimeSampling(TimeSampling(1 / 24.0, 1.0))
    top = OXform(archive.getTop(), "hair")
    stack = XformSample()
    stack.addOp(XformOp(XformOperationType.kTranslateOperation, 0), imath.V3d(1, 2, 3))
    stack.addOp(XformOp(XformOperationType.kRotateYOperation, 0), 90.0)
    stack.addOp(XformOp(XformOperationType.kScaleOperation, 0), imath.V3d(2, 2, 2))
    top.getSchema().set(stack)
    for name, count, guide in (("strands", 5, False), ("guides", 2, True)):
        above = OXform(top, name + "_x")
        matrix = imath.M44d(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5 if guide else 0, 1)
        stack = XformSample()
        stack.addOp(XformOp(XformOperationType.kMatrixOperation, 0), matrix)
        above.getSchema().set(stack)
        schema = OCurves(above, name, times).getSchema()
        for frame in range(2):
            points = [p for i in range(count) for p in curve(i, frame, guide)]
            widths = OFloatGeomParamSample(
                floats([0.01 * (i + 1) for i in range(count)]), GeometryScope.kUniformScope
            )
            kind, basis = (
                (CurveType.kLinear, BasisType.kNoBasis) if guide else (CurveType.kCubic, BasisType.kBsplineBasis)
            )
            none = (OV2fGeomParamSample(), ON3fGeomParamSample())
            counts = ints([2 if guide else 6] * count)
            schema.set(
                OCurvesSchemaSample(
                    vecs(points), counts, kind, CurvePeriodicity.kNonPeriodic, widths, *none, basis
                )
            )
        beside = schema.getArbGeomParams()
        attribute(beside, "groom_id", [100 * guide + i for i in range(count)], GeometryScope.kUniformScope)
        attribute(beside, "groom_guide", [int(guide)], GeometryScope.kConstantScope)
        attribute(beside, "groom_group_id", [i % 2 for i in range(count)], GeometryScope.kUniformScope)


def read(path):
    def walk(item):
        if ICurves.matches(item.getHeader()):
            yield ICurves(item.getParent(), item.getName()).getSchema()
        for i in range(item.getNumChildren()):
            yield from walk(item.getChild(i))

    archive = IArchive(path)
    found = {"curves": 0, "points": 0, "attributes": {}, "times": []}
    for schema in walk(archive.getTop()):
        sample = schema.getValue()
        found["curves"] += len(sample.getCurvesNumVertices())
        found["points"] += len(sample.getPositions())
        points = schema.getPositionsProperty()
        found["times"] = [points.getTimeSampling().getSampleTime(i) for i in range(points.getNumSamples())]
        beside = schema.getArbGeomParams()
        for i in range(beside.getNumProperties()):
            name = beside.getPropertyHeader(i).getName()
            values = IArrayProperty(beside, name).getValue(0)
            kept = [values[k] for k in range(len(values))]
            found["attributes"][name] = [v if isinstance(v, (int, float, str)) else list(v) for v in kept]
    print(json.dumps(found))


if __name__ == "__main__":
    {"write": write, "read": read}[sys.argv[1]](sys.argv[2])
