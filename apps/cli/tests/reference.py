"""A groom as the reference implementation of Alembic writes it: `python reference.py FILE` (module `alembic3d`).

Two objects under transforms: strands (B-splines, widths per curve, Unreal's attributes, two frames) and guides."""
import sys
import imath
from alembic3d.Abc import *
from alembic3d.AbcCoreAbstract import *
from alembic3d.AbcGeom import *
archive = OArchive(sys.argv[1])
times = archive.addTimeSampling(TimeSampling(1/24., 1.0))
def ints(v):
    a=imath.IntArray(len(v))
    for i,x in enumerate(v): a[i]=x
    return a
def floats(v):
    a=imath.FloatArray(len(v))
    for i,x in enumerate(v): a[i]=x
    return a
def vecs(v):
    a=imath.V3fArray(len(v))
    for i,x in enumerate(v): a[i]=imath.V3f(*x)
    return a
def curve(i,frame,guide):
    return [(i*1.0+0.1*k*k*(i+1), 10.0*k, 0.5*frame*k) for k in range(2 if guide else 6)]
top = OXform(archive.getTop(),"hair")
s = XformSample()
s.addOp(XformOp(XformOperationType.kTranslateOperation,0), imath.V3d(1,2,3))
s.addOp(XformOp(XformOperationType.kRotateYOperation,0), 90.0)
s.addOp(XformOp(XformOperationType.kScaleOperation,0), imath.V3d(2,2,2))
top.getSchema().set(s)
for name,n,guide in (("strands",5,False),("guides",2,True)):
    x = OXform(top,name+"_x")
    xs = XformSample(); xs.addOp(XformOp(XformOperationType.kMatrixOperation,0), imath.M44d(1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5 if guide else 0,1)); x.getSchema().set(xs)
    o = OCurves(x,name,times); sch=o.getSchema()
    for frame in range(2):
        pts=[p for i in range(n) for p in curve(i,frame,guide)]
        kw=(vecs(pts), ints([2 if guide else 6]*n), CurveType.kLinear if guide else CurveType.kCubic, CurvePeriodicity.kNonPeriodic)
        w = OFloatGeomParamSample(floats([0.01*(i+1) for i in range(n)]), GeometryScope.kUniformScope)
        samp = OCurvesSchemaSample(vecs(pts), ints([2 if guide else 6]*n), CurveType.kLinear if guide else CurveType.kCubic, CurvePeriodicity.kNonPeriodic, w, OV2fGeomParamSample(), ON3fGeomParamSample(), BasisType.kNoBasis if guide else BasisType.kBsplineBasis)
        sch.set(samp)
    arb = sch.getArbGeomParams()
    p=OInt32GeomParam(arb,"groom_id",False,GeometryScope.kUniformScope,1); p.set(OInt32GeomParamSample(ints([100*guide+i for i in range(n)]),GeometryScope.kUniformScope))
    p=OInt32GeomParam(arb,"groom_guide",False,GeometryScope.kConstantScope,1); p.set(OInt32GeomParamSample(ints([int(guide)]),GeometryScope.kConstantScope))
    p=OInt32GeomParam(arb,"groom_group_id",False,GeometryScope.kUniformScope,1); p.set(OInt32GeomParamSample(ints([i%2 for i in range(n)]),GeometryScope.kUniformScope))
