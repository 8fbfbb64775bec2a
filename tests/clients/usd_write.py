"""Writes a stage with Pixar's library, from a description in JSON.

    python usd_write.py STAGE.json OUT.usda|usdc|usdz
"""
import json
import os
import sys
import tempfile

from pxr import Gf, Sdf, Usd, UsdGeom, UsdUtils

CASE = {"none": "none", "edge-only": "edgeOnly", "edge-and-corner": "edgeAndCorner"}


def write(description, path):
    stage = Usd.Stage.CreateNew(path)
    UsdGeom.SetStageUpAxis(stage, description.get("up", "Y"))
    UsdGeom.SetStageMetersPerUnit(stage, description.get("unit", 0.01))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    for mesh in description["meshes"]:
        add(stage, mesh)
    stage.GetRootLayer().Save()


def add(stage, m):
    mesh = UsdGeom.Mesh.Define(stage, m["path"])
    for op, value in m.get("xform", []):
        kind = getattr(UsdGeom.XformOp, "Type" + op[0].upper() + op[1:])
        precision = UsdGeom.XformOp.PrecisionDouble
        if kind == UsdGeom.XformOp.TypeTransform:
            value = Gf.Matrix4d(*value)
        elif kind == UsdGeom.XformOp.TypeOrient:
            value = Gf.Quatd(*value)
        elif isinstance(value, list):
            value = Gf.Vec3d(*value)
        mesh.AddXformOp(kind, precision).Set(value)
    points = [[tuple(p) for p in frame] for frame in m["frames"]]
    if len(points) == 1:
        mesh.CreatePointsAttr(points[0])
    else:
        for time, frame in enumerate(points):
            mesh.CreatePointsAttr().Set(frame, time + 1)
    mesh.CreateFaceVertexCountsAttr(m["face_sizes"])
    mesh.CreateFaceVertexIndicesAttr(m["face_vertices"])
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(points[0]))
    mesh.CreateSubdivisionSchemeAttr(m.get("scheme", "catmullClark"))
    mesh.CreateInterpolateBoundaryAttr(CASE[m["boundary"]])
    mesh.CreateTriangleSubdivisionRuleAttr({"catmark": "catmullClark", "smooth": "smooth"}[m["triangles"]])
    mesh.CreateOrientationAttr("leftHanded" if m["left_handed"] else "rightHanded")
    if m["creases"]:
        # One chain of two vertices each, and where a crease goes on, one longer chain.
        chains = []
        for a, b, sharpness in m["creases"]:
            if chains and chains[-1][0][-1] == a:
                chains[-1][0].append(b)
                chains[-1][1].append(sharpness)
            else:
                chains.append(([a, b], [sharpness]))
        mesh.CreateCreaseIndicesAttr([v for chain, _ in chains for v in chain])
        mesh.CreateCreaseLengthsAttr([len(chain) for chain, _ in chains])
        mesh.CreateCreaseSharpnessesAttr([s for _, sharp in chains for s in sharp])
    if m["corners"]:
        mesh.CreateCornerIndicesAttr([v for v, _ in m["corners"]])
        mesh.CreateCornerSharpnessesAttr([s for _, s in m["corners"]])
    if m["holes"]:
        mesh.CreateHoleIndicesAttr(m["holes"])
    primvars = UsdGeom.PrimvarsAPI(mesh)
    for name, interpolation in (("form0", "vertex"), ("form1", "faceVarying"), ("form2", "uniform")):
        if m.get(name):
            primvars.CreatePrimvar(name, Sdf.ValueTypeNames.FloatArray, interpolation).Set(m[name])


with open(sys.argv[1]) as file:
    description = json.load(file)
out = sys.argv[2]
if out.endswith(".usdz"):
    with tempfile.TemporaryDirectory() as folder:
        inner = os.path.join(folder, "stage.usdc")
        write(description, inner)
        assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(inner), out)
else:
    write(description, out)
