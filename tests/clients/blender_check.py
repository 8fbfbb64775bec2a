"""Imports files into Blender and says what it made of them.

    python blender_check.py FILE..    with a Python that has bpy; prints one JSON object a file
"""
import json
import sys

import bpy

for path in sys.argv[1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith((".glb", ".gltf")):
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.usd_import(filepath=path)
    meshes = {}
    for item in bpy.data.objects:
        if item.type == "MESH":
            mesh = item.data
            # What is read back is compared elsewhere; here the sum shows that values came through.
            def total(attribute):
                name = {"FLOAT": "value", "FLOAT_VECTOR": "vector"}.get(attribute.data_type)
                if name is None:
                    return None
                width = 3 if name == "vector" else 1
                values = [0.0] * (len(attribute.data) * width)
                attribute.data.foreach_get(name, values)
                return sum(abs(x) for x in values)

            meshes[item.name] = {
                "vertices": len(mesh.vertices), "edges": len(mesh.edges), "polygons": len(mesh.polygons),
                "corners": len(mesh.loops),
                "attributes": {a.name: [a.domain, a.data_type, len(a.data), total(a)] for a in mesh.attributes},
            }
    print(json.dumps({"file": path, "meshes": meshes}), flush=True)
