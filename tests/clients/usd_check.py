"""Opens USD files with Pixar's library and holds them against what it and its validators demand.

    python usd_check.py FILE..    prints one JSON object a file; exit code 1 if there is an error
"""
import json
import sys

import numpy
from pxr import Usd, UsdGeom, UsdValidation

PER = {"vertex": "points", "varying": "points", "faceVarying": "corners", "uniform": "faces", "constant": "one"}


def check(path):
    errors = []
    stage = Usd.Stage.Open(path)
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    for error in context.Validate(stage):
        if error.GetType() == UsdValidation.ValidationErrorType.Error:
            errors.append(f"{error.GetIdentifier()}: {error.GetMessage()}")
    for key in ("upAxis", "metersPerUnit", "defaultPrim"):
        if not stage.HasAuthoredMetadata(key):
            errors.append(f"no {key}")
    meshes = {}
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh = UsdGeom.Mesh(prim)
        here = str(prim.GetPath())
        times = mesh.GetPointsAttr().GetTimeSamples() or [Usd.TimeCode.Default()]
        sizes = numpy.array(mesh.GetFaceVertexCountsAttr().Get() or [])
        corners = numpy.array(mesh.GetFaceVertexIndicesAttr().Get() or [])
        scheme = mesh.GetSubdivisionSchemeAttr().Get()
        for time in times:
            points = numpy.array(mesh.GetPointsAttr().Get(time) or []).reshape(-1, 3)
            count = {"points": len(points), "corners": len(corners), "faces": len(sizes), "one": 1}
            if sizes.sum() != len(corners):
                errors.append(f"{here}: counts and indices disagree")
            if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
                errors.append(f"{here}: an index is out of range")
            valid, reason = UsdGeom.Mesh.ValidateTopology(
                mesh.GetFaceVertexIndicesAttr().Get(), mesh.GetFaceVertexCountsAttr().Get(), len(points))
            if not valid:
                errors.append(f"{here}: {reason}")
            extent = mesh.GetExtentAttr().Get(time)
            if extent is None or len(extent) != 2 or not numpy.allclose(extent, [points.min(0), points.max(0)], atol=1e-6):
                errors.append(f"{here}: extent {extent} at {time}")
            normals = mesh.GetNormalsAttr().Get(time)
            if (scheme == "none") != (normals is not None):
                errors.append(f"{here}: scheme {scheme}, normals {normals is not None}")
            if normals is not None:
                if len(normals) != count[PER[mesh.GetNormalsInterpolation()]]:
                    errors.append(f"{here}: {len(normals)} normals")
                if abs(numpy.linalg.norm(numpy.array(normals), axis=1) - 1).max() > 1e-5:
                    errors.append(f"{here}: normals are not of length 1")
            for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvars():
                values = primvar.ComputeFlattened(time)
                wanted = count[PER[primvar.GetInterpolation()]] * primvar.GetElementSize()
                if values is not None and hasattr(values, "__len__") and not isinstance(values, str):
                    if len(values) != wanted and primvar.GetInterpolation() != "constant":
                        errors.append(f"{here}: {primvar.GetName()} has {len(values)}, not {wanted}")
        indices, lengths, sharp = (
            list(attribute.Get() or []) for attribute in
            (mesh.GetCreaseIndicesAttr(), mesh.GetCreaseLengthsAttr(), mesh.GetCreaseSharpnessesAttr()))
        if sum(lengths) != len(indices) or len(sharp) not in (len(lengths), len(indices) - len(lengths)):
            errors.append(f"{here}: crease arrays disagree")
        if len(mesh.GetCornerIndicesAttr().Get() or []) != len(mesh.GetCornerSharpnessesAttr().Get() or []):
            errors.append(f"{here}: corner arrays disagree")
        for subset in UsdGeom.Subset.GetAllGeomSubsets(mesh):
            chosen = list(subset.GetIndicesAttr().Get() or [])
            if chosen and max(chosen) >= len(sizes):
                errors.append(f"{here}: a subset is out of range")
        meshes[here] = {
            "points": len(points), "faces": len(sizes), "corners": len(corners), "scheme": scheme,
            "samples": len(mesh.GetPointsAttr().GetTimeSamples()),
            "primvars": {p.GetPrimvarName(): [str(p.GetTypeName()), p.GetInterpolation()]
                         for p in UsdGeom.PrimvarsAPI(prim).GetPrimvars()},
        }
    return {"file": path, "errors": errors, "meshes": meshes}


results = [check(path) for path in sys.argv[1:]]
for result in results:
    print(json.dumps(result))
sys.exit(any(result["errors"] for result in results))
