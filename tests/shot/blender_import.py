# Run by Blender: imports what `relamp export` wrote and prints what stands where, as one JSON line that begins with "RELAMP ".
#   blender -b --factory-startup --python blender_import.py -- FILE.gltf|FILE.exr
import json
import sys

import bpy
import numpy

numpy.bool = bool  # Blender 3.4's importers use the old name, newer numpy dropped it
path = sys.argv[sys.argv.index("--") + 1]
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
result = {}
if path.endswith(".exr"):
    bpy.context.scene.use_nodes = True
    node = bpy.context.scene.node_tree.nodes.new("CompositorNodeImage")
    node.image = bpy.data.images.load(path)
    result = {"type": node.image.type, "layers": [o.name for o in node.outputs]}
else:
    bpy.ops.import_scene.gltf(filepath=path)
bpy.context.view_layer.update()
for thing in bpy.data.objects:
    entry = {"type": thing.type, "location": list(thing.matrix_world.translation)}
    if thing.type == "MESH":
        corners = [thing.matrix_world @ v.co for v in thing.data.vertices]
        entry["low"] = [min(c[k] for c in corners) for k in range(3)]
        entry["high"] = [max(c[k] for c in corners) for k in range(3)]
        entry["area"] = sum(p.area for p in thing.data.polygons)
        for slot in thing.material_slots:
            for node in slot.material.node_tree.nodes if slot.material and slot.material.node_tree else []:
                if node.type == "EMISSION":
                    colour, strength = node.inputs["Color"], node.inputs["Strength"]
                elif node.type == "BSDF_PRINCIPLED":
                    colour, strength = node.inputs["Emission"], node.inputs["Emission Strength"]
                else:
                    continue
                entry["radiance"] = [c * strength.default_value for c in list(colour.default_value)[:3]]
    elif thing.type == "CAMERA":
        entry["forward"] = [-x for x in list(thing.matrix_world.col[2])[:3]]
        entry["angle_x"] = thing.data.angle_x
    result[thing.name] = entry
print("RELAMP " + json.dumps(result))
