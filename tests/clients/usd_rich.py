"""A stage with a little of everything, and a comparison of two stages.

    python usd_rich.py OUT.usda|usdc         writes the stage
    python usd_rich.py A B /World/Mesh       exit code 1 if the layers differ outside that mesh's attributes
"""
import sys

from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, Vt


def write(path):
    stage = Usd.Stage.CreateNew(path)
    layer = stage.GetRootLayer()
    layer.comment = 'a comment, with "quotes"'
    layer.documentation = "several\nlines"
    layer.customLayerData = {"tool": "test", "nested": {"n": 3, "x": 0.1, "list": Vt.IntArray([1, 2])}}
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(24)
    stage.SetTimeCodesPerSecond(24)
    stage.SetMetadata("renderSettingsPrimPath", "/Render")
    UsdGeom.SetStageUpAxis(stage, "Z")
    UsdGeom.SetStageMetersPerUnit(stage, 0.5)
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    Usd.ModelAPI(world).SetKind("component")
    Usd.ModelAPI(world).SetAssetInfo({"name": "rich", "version": "2"})
    world.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3), 1)
    world.AddTranslateOp(opSuffix="pivot").Set(Gf.Vec3d(0.1, 0, -0.0))
    world.AddOrientOp().Set(Gf.Quatf(0.5, 0.5, -0.5, 0.5))
    world.GetPrim().SetCustomDataByKey("a:b", "c")
    mesh = UsdGeom.Mesh.Define(stage, "/World/Mesh")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    mesh.CreateExtentAttr([(0, 0, 0), (1, 1, 0)])
    mesh.CreateSubdivisionSchemeAttr("catmullClark")
    mesh.GetPrim().SetDocumentation("the mesh")
    mesh.CreateDisplayColorPrimvar("constant").Set([(0.2, 0.4, 0.6)])
    material = UsdShade.Material.Define(stage, "/World/Looks/Paint")
    shader = UsdShade.Shader.Define(stage, "/World/Looks/Paint/Shader")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.1, 0.2, 0.3))
    texture = UsdShade.Shader.Define(stage, "/World/Looks/Paint/Texture")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set("./tex ture.png")
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).ConnectToSource(
        texture.CreateOutput("r", Sdf.ValueTypeNames.Float))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    light = UsdLux.SphereLight.Define(stage, "/World/Light")
    light.CreateIntensityAttr(3).Set(5, 12)
    light.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    camera = UsdGeom.Camera.Define(stage, "/World/Camera")
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 1e6))
    curves = UsdGeom.BasisCurves.Define(stage, "/World/Curves")
    curves.CreateCurveVertexCountsAttr([4])
    curves.CreatePointsAttr([(0, 0, 0), (1e-7, 1, 0), (2, 1.5e8, 0), (3, 0, 0)])
    curves.SetWidthsInterpolation("constant")
    curves.CreateWidthsAttr([0.1])
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/Trees")
    instancer.CreatePositionsAttr([(0, 0, 0), (5, 0, 0)])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreateOrientationsAttr([Gf.Quath(1, 0, 0, 0), Gf.Quath(0.5, 0.5, 0.5, 0.5)])
    UsdGeom.Sphere.Define(stage, "/World/Trees/Ball")
    instancer.CreatePrototypesRel().SetTargets(["/World/Trees/Ball"])
    skeleton = UsdSkel.Skeleton.Define(stage, "/World/Skeleton")
    skeleton.CreateJointsAttr(["a", "a/b"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1), Gf.Matrix4d(2)])
    prim = stage.DefinePrim("/World/Values")
    values = {
        "Bool": True, "UChar": 7, "Int": -5, "UInt": 4000000000, "Int64": -2**40, "UInt64": 2**63, "Half": 0.5,
        "Float": 0.1, "Double": 0.1, "String": 'say "hi"\n\\', "Token": "t", "Asset": "a.usd",
        "Float2": Gf.Vec2f(1, 2), "Double3": Gf.Vec3d(0.1, 0.2, 0.3), "Half3": Gf.Vec3h(1, 2, 3), "Int3": Gf.Vec3i(1, 2, 3),
        "Quatd": Gf.Quatd(1, 2, 3, 4), "Matrix3d": Gf.Matrix3d(2), "Matrix4d": Gf.Matrix4d(3), "TimeCode": 2.5,
        "StringArray": ["a", "b"], "TokenArray": ["x"], "BoolArray": [True, False], "Int64Array": [1, -2],
        "Double2Array": [(1, 2), (0.1, 3)], "FloatArray": [], "Color4f": Gf.Vec4f(1, 0, 0, 1),
    }
    for name, value in values.items():
        prim.CreateAttribute("v:" + name, getattr(Sdf.ValueTypeNames, name)).Set(value)
    blocked = prim.CreateAttribute("v:blocked", Sdf.ValueTypeNames.Float)
    blocked.Set(Sdf.ValueBlock())
    blocked.Set(1.5, 2)
    blocked.Set(Sdf.ValueBlock(), 3)
    prim.CreateAttribute("v:declared", Sdf.ValueTypeNames.Double, custom=True, variability=Sdf.VariabilityUniform)
    prim.CreateRelationship("r:none")
    prim.CreateRelationship("r:two").SetTargets(["/World/Light", "/World/Values.v:Int"])
    prim.SetMetadata("hidden", True)
    clips = prim.GetAttribute("v:Token")
    clips.SetMetadata("allowedTokens", ["t", "u"])
    clips.SetDisplayName("A token")
    off = stage.DefinePrim("/World/Off")
    off.SetActive(False)
    stage.OverridePrim("/World/Over").CreateAttribute("x", Sdf.ValueTypeNames.Int).Set(1)
    stage.CreateClassPrim("/_class").CreateAttribute("x", Sdf.ValueTypeNames.Int).Set(2)
    heir = stage.DefinePrim("/World/Heir")
    heir.GetInherits().AddInherit("/_class")
    heir.GetReferences().AddReference("./other.usda", "/A", Sdf.LayerOffset(2, 0.5))
    heir.GetReferences().AddInternalReference("/World/Values", position=Usd.ListPositionBackOfAppendList)
    heir.GetPayloads().AddPayload("./heavy.usd")
    variants = heir.GetVariantSets().AddVariantSet("look")
    for name in ("red", "blue"):
        variants.AddVariant(name)
        variants.SetVariantSelection(name)
        with variants.GetVariantEditContext():
            heir.CreateAttribute("colour", Sdf.ValueTypeNames.Token).Set(name)
            stage.DefinePrim("/World/Heir/" + name, "Scope")
    Usd.CollectionAPI.Apply(world.GetPrim(), "lights").IncludePath("/World/Light")
    layer.Save()


def same(a, b, mesh):
    a, b = (Sdf.Layer.FindOrOpen(path) for path in (a, b))
    differences = []

    def content(layer):
        found = {}

        def visit(path):
            spec = layer.GetObjectAtPath(path)
            if spec is None or (path.HasPrefix(mesh) and path != mesh):
                return
            for key in spec.ListInfoKeys():
                value = spec.GetInfo(key)
                if key == "propertyChildren" and path == mesh:
                    continue
                found[(str(path), key)] = value
            found[(str(path), "type")] = type(spec).__name__
            if isinstance(spec, Sdf.AttributeSpec):
                found[(str(path), "typeName")] = str(spec.typeName)
                found[(str(path), "samples")] = {
                    t: layer.QueryTimeSample(path, t) for t in layer.ListTimeSamplesForPath(path)}

        layer.Traverse(Sdf.Path.absoluteRootPath, visit)
        return found

    a, b = content(a), content(b)
    for key in sorted(set(a) | set(b), key=str):
        if a.get(key) != b.get(key):
            differences.append(f"{key}: {a.get(key)!r} became {b.get(key)!r}")
    print(f"{len(a)} fields")
    print("\n".join(differences))
    return bool(differences)


if len(sys.argv) == 2:
    write(sys.argv[1])
else:
    sys.exit(same(sys.argv[1], sys.argv[2], Sdf.Path(sys.argv[3])))
