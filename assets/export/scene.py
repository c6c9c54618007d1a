"""Rebuilds the scene that `relamp export` wrote beside this file, in Blender:

    blender --python scene.py
    blender -b --python scene.py -- --view 0 --samples 256 --render frame.exr

Every light is an object with a light group of its own, the environment is the group "world". Radiance, albedo and
places are those of relamp: view 0 of matte surfaces is the frame that `relamp render` makes of it. Glossy lobes are
Glossy BSDFs of the same roughness. Lens distortion is left out and said so.
"""
import argparse
import array
import json
import math
import os
import sys

import bpy
import mathutils

LEVEL = "relamp level"
# What the IES node makes of a candela: 4 pi / 177.83.
IES_UNIT = 0.0706650768394
WIDEST_GOBO = 80
FOLDER = os.path.dirname(os.path.abspath(__file__))


def read(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return json.load(file)


def note(text):
    print("relamp: " + text)


def mesh_of(name, positions, triangles, base):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([[p[k] - base[k] for k in range(3)] for p in positions], [], [list(t) for t in triangles])
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    return material, nodes, material.node_tree.links, nodes.new("ShaderNodeOutputMaterial")


def maths(nodes, links, operation, a, b=None):
    node = nodes.new("ShaderNodeMath")
    node.operation = operation
    for at, value in enumerate((a, b)):
        if value is None:
            continue
        if isinstance(value, (int, float)):
            node.inputs[at].default_value = value
        else:
            links.new(value, node.inputs[at])
    return node.outputs[0]


def product_of(nodes, links, factors):
    """None where there is nothing to multiply."""
    product = None
    for factor in factors:
        if factor is not None:
            product = factor if product is None else maths(nodes, links, "MULTIPLY", product, factor)
    return product


def vector_maths(nodes, links, operation, a, b):
    node = nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    for at, value in enumerate((a, b)):
        if isinstance(value, (list, tuple)):
            node.inputs[at].default_value = value
        else:
            links.new(value, node.inputs[at])
    return node.outputs["Value" if operation == "DOT_PRODUCT" else "Vector"]


def image_of(nodes, links, file, u, v):
    """The colour of an image at a place, black beside it."""
    place = nodes.new("ShaderNodeCombineXYZ")
    for at, value in enumerate((u, v)):
        links.new(value, place.inputs[at])
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = bpy.data.images.load(os.path.join(FOLDER, file), check_existing=True)
    picture.extension = "CLIP"
    links.new(place.outputs[0], picture.inputs["Vector"])
    return picture.outputs["Color"]


def doors_of(shaping, nodes, links, along, middle):
    """1 where light passes a barn door, for each door that is not wide open; both in the light's own axes."""
    factors = []
    for key, axis, side in (("left", 0, -1), ("right", 0, 1), ("top", 1, 1), ("bottom", 1, -1)):
        degrees = shaping.get(key + "_door_degrees", 90)
        if degrees >= 90:
            continue
        half, turned = shaping["half_size"][axis], math.radians(degrees)
        end = maths(nodes, links, "SUBTRACT", half + 2 * half * math.sin(turned),
                    maths(nodes, links, "MULTIPLY", middle[axis], side))
        reach = maths(nodes, links, "MULTIPLY", along[axis], side * 2 * half * math.cos(turned))
        factors.append(maths(nodes, links, "LESS_THAN", reach, maths(nodes, links, "MULTIPLY", end, along[2])))
    return factors


def shape_of(light, nodes, links, base):
    """What a light's surface and its shape leave of its radiance: a number, and colours to multiply; none: all."""
    geometry = nodes.new("ShaderNodeNewGeometry")
    factors, colours = [], []
    if not light["two_sided"]:
        factors.append(maths(nodes, links, "SUBTRACT", 1, geometry.outputs["Backfacing"]))
    if "levels" in light:
        level = nodes.new("ShaderNodeAttribute")
        level.attribute_name = LEVEL
        factors.append(level.outputs["Fac"])
    shaping = light.get("shaping")
    if not shaping:
        return product_of(nodes, links, factors), colours
    # The direction that light leaves along, in the light's own axes; the last one is where it shines.
    away = geometry.outputs["Incoming"]
    along = [vector_maths(nodes, links, "DOT_PRODUCT", away, shaping[k]) for k in ("x_axis", "y_axis", "axis")]
    cosine = along[2]
    if "cone_degrees" in shaping:
        outer = math.radians(shaping["cone_degrees"])
        inner = outer * (1 - shaping.get("cone_softness", 0))
        fade = nodes.new("ShaderNodeMapRange")
        fade.interpolation_type = "SMOOTHSTEP"
        links.new(maths(nodes, links, "ARCCOSINE", cosine), fade.inputs["Value"])
        fade.inputs["From Min"].default_value = outer
        fade.inputs["From Max"].default_value = min(inner, outer - 1e-6)
        factors.append(fade.outputs["Result"])
    if shaping.get("focus", 0) > 0:
        factors.append(maths(nodes, links, "POWER", maths(nodes, links, "MAXIMUM", cosine, 0), shaping["focus"]))
    if "ies_file" in shaping:
        # The node's angle 0 is at -Y and it turns the other way.
        turned = nodes.new("ShaderNodeCombineXYZ")
        for at, value in enumerate((along[1], along[0], cosine)):
            links.new(maths(nodes, links, "MULTIPLY", value, -1), turned.inputs[at])
        profile = nodes.new("ShaderNodeTexIES")
        profile.mode = "EXTERNAL"
        profile.filepath = os.path.join(FOLDER, shaping["ies_file"])
        profile.inputs["Strength"].default_value = 1 / (IES_UNIT * shaping["ies_candela"])
        links.new(turned.outputs[0], profile.inputs["Vector"])
        factors.append(profile.outputs["Fac"])
    if "gobo_file" in shaping:
        edge = math.tan(math.radians(min(shaping.get("cone_degrees", 180), WIDEST_GOBO)))
        ahead = maths(nodes, links, "MULTIPLY", maths(nodes, links, "MAXIMUM", cosine, 1e-3), 2 * edge)
        places = [maths(nodes, links, "ADD", maths(nodes, links, "DIVIDE", a, ahead), 0.5) for a in along[:2]]
        colours.append(image_of(nodes, links, shaping["gobo_file"], *places))
        factors.append(maths(nodes, links, "GREATER_THAN", cosine, 1e-3))
    if "middle" in shaping:
        here = vector_maths(nodes, links, "SUBTRACT", geometry.outputs["Position"],
                            [shaping["middle"][k] - base[k] for k in range(3)])
        middle = [vector_maths(nodes, links, "DOT_PRODUCT", here, shaping[k]) for k in ("x_axis", "y_axis")]
        factors += doors_of(shaping, nodes, links, along, middle)
        if "surface_file" in shaping:
            places = [maths(nodes, links, "ADD", vector_maths(nodes, links, "DOT_PRODUCT", here, shaping[k]), 0.5)
                      for k in ("image_u", "image_v")]
            colours.append(image_of(nodes, links, shaping["surface_file"], *places))
    return product_of(nodes, links, factors), colours


def add_light(light, base):
    if light["type"] == "sun":
        data = bpy.data.lights.new(light["name"], "SUN")
        strongest = max(max(light["irradiance"]), 1e-30)
        data.energy = strongest
        data.color = [c / strongest for c in light["irradiance"]]
        data.angle = math.radians(light["angle_degrees"])
        data.use_shadow = light["shadows"]
        data.cycles.cast_shadow = light["shadows"]
        thing = bpy.data.objects.new(light["name"], data)
        bpy.context.scene.collection.objects.link(thing)
        thing.rotation_mode = "QUATERNION"
        thing.rotation_quaternion = mathutils.Vector(light["direction"]).to_track_quat("-Z", "Y")
    else:
        thing = mesh_of(light["name"], light["positions"], light["triangles"], base)
        if "levels" in light:
            thing.data.attributes.new(LEVEL, "FLOAT", "POINT").data.foreach_set("value", light["levels"])
        material, nodes, links, output = new_material(light["name"])
        emission = nodes.new("ShaderNodeEmission")
        strongest = max(max(light["radiance"]), 1e-30)
        strength, colours = shape_of(light, nodes, links, base)
        colour = [c / strongest for c in light["radiance"]]
        emission.inputs["Color"].default_value = colour + [1]
        for other in colours:
            colour = vector_maths(nodes, links, "MULTIPLY", other, colour)
        if colours:
            links.new(colour, emission.inputs["Color"])
        if strength is None:
            emission.inputs["Strength"].default_value = strongest
        else:
            links.new(maths(nodes, links, "MULTIPLY", strength, strongest), emission.inputs["Strength"])
        links.new(emission.outputs[0], output.inputs["Surface"])
        thing.data.materials.append(material)
        if not light.get("shadows", True):
            note("%s: shadows cannot be switched off for a mesh" % light["name"])
    thing["relamp_id"] = light["id"]
    group(thing, light["name"])
    keep_from(thing, light.get("not_on", []))


def keep_from(thing, surfaces):
    """Light linking: the light falls on everything but these."""
    if not surfaces:
        return
    if not hasattr(thing, "light_linking"):
        note("%s: falls on all surfaces, light linking needs Blender 4.0" % thing.name)
        return
    receivers = bpy.data.collections.new(thing.name + " falls on")
    for other in bpy.data.objects:
        if other.get("relamp_surface") and other["relamp_surface"] not in surfaces:
            receivers.objects.link(other)
    thing.light_linking.receiver_collection = receivers


def group(thing, name):
    """Blender may change the name (no dots, no two alike); the group that was made is the last one."""
    bpy.ops.scene.view_layer_add_lightgroup(name=name)
    thing.lightgroup = bpy.context.view_layer.lightgroups[-1].name


def values(gltf, buffer, accessor):
    entry = gltf["accessors"][accessor]
    view = gltf["bufferViews"][entry["bufferView"]]
    numbers = array.array({5126: "f", 5125: "I"}[entry["componentType"]])
    begin = view.get("byteOffset", 0)
    numbers.frombytes(buffer[begin:begin + view["byteLength"]])
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers


def add_surface(gltf, buffer, node):
    part = gltf["meshes"][node["mesh"]]["primitives"][0]
    attributes, material = part["attributes"], gltf["materials"][part["material"]]
    flat = values(gltf, buffer, attributes["POSITION"])
    corners = values(gltf, buffer, part["indices"])
    thing = mesh_of(node["name"], zip(flat[0::3], flat[1::3], flat[2::3]),
                    zip(corners[0::3], corners[1::3], corners[2::3]), (0, 0, 0))
    thing["relamp_surface"] = node["name"]
    mesh = thing.data
    normals = values(gltf, buffer, attributes["NORMAL"])
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set_from_vertices(list(zip(normals[0::3], normals[1::3], normals[2::3])))
    made, nodes, links, output = new_material(node["name"])
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    if "TEXCOORD_0" in attributes:
        places = values(gltf, buffer, attributes["TEXCOORD_0"])
        layer = mesh.uv_layers.new(name="relamp")
        for loop in mesh.loops:
            at = 2 * loop.vertex_index
            layer.data[loop.index].uv = (places[at], 1 - places[at + 1])
    if "COLOR_0" not in attributes:
        albedo = nodes.new("ShaderNodeTexImage")
        albedo.image = bpy.data.images.load(os.path.join(FOLDER, "albedo.exr"), check_existing=True)
        albedo.image.colorspace_settings.is_data = True
        albedo.extension = "EXTEND"
    else:
        colours = values(gltf, buffer, attributes["COLOR_0"])
        layer = mesh.color_attributes.new("relamp", "FLOAT_COLOR", "POINT")
        rgba = array.array("f", [1.0]) * (len(colours) // 3 * 4)
        for k in range(3):
            rgba[k::4] = colours[k::3]
        layer.data.foreach_set("color", rgba)
        albedo = nodes.new("ShaderNodeVertexColor")
        albedo.layer_name = "relamp"
    links.new(albedo.outputs["Color"], diffuse.inputs["Color"])
    closure = diffuse.outputs[0]
    for lobe in material.get("extras", {}).get("relamp_lobes", []):
        gloss = nodes.new("ShaderNodeBsdfGlossy")
        gloss.distribution = "GGX"
        gloss.inputs["Roughness"].default_value = math.sqrt(lobe["alpha"])
        gloss.inputs["Color"].default_value = lobe["weight"] + [1]
        shader = gloss.outputs[0]
        if lobe["kind"] == "ggx_dielectric":
            fresnel, mix = nodes.new("ShaderNodeFresnel"), nodes.new("ShaderNodeMixShader")
            fresnel.inputs["IOR"].default_value = 1.5
            black = nodes.new("ShaderNodeBsdfTransparent")
            black.inputs["Color"].default_value = (0, 0, 0, 1)
            links.new(fresnel.outputs[0], mix.inputs[0])
            links.new(black.outputs[0], mix.inputs[1])
            links.new(shader, mix.inputs[2])
            shader = mix.outputs[0]
        elif lobe["kind"] != "ggx":
            note("%s: a lobe %s is shown as GGX" % (node["name"], lobe["kind"]))
        total = nodes.new("ShaderNodeAddShader")
        links.new(closure, total.inputs[0])
        links.new(shader, total.inputs[1])
        closure = total.outputs[0]
    links.new(closure, output.inputs["Surface"])
    mesh.materials.append(made)


def panorama_of(nodes, name):
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(os.path.join(FOLDER, name))
    picture.image.colorspace_settings.is_data = True
    return picture.outputs["Color"]


def add_environment(environment):
    """What lights the scene is environment.exr; what cameras see of it may be a finer panorama."""
    world = bpy.data.worlds.new("relamp environment")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    colour = panorama_of(nodes, environment["file"])
    if "background" in environment:
        seen, ray = nodes.new("ShaderNodeMixRGB"), nodes.new("ShaderNodeLightPath")
        links.new(ray.outputs["Is Camera Ray"], seen.inputs["Fac"])
        links.new(colour, seen.inputs["Color1"])
        links.new(panorama_of(nodes, environment["background"]), seen.inputs["Color2"])
        colour = seen.outputs["Color"]
    links.new(colour, nodes["Background"].inputs["Color"])
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 1024
    bpy.context.scene.world = world
    group(world, "world")


def add_camera(frame, base):
    data = bpy.data.cameras.new(frame["file_path"])
    thing = bpy.data.objects.new(frame["file_path"], data)
    bpy.context.scene.collection.objects.link(thing)
    rows = [list(row) for row in frame["transform_matrix"]]
    for k in range(3):
        rows[k][3] -= base[k]
    thing.matrix_world = mathutils.Matrix(rows[:3] + [[0, 0, 0, 1]])
    width, height = frame["w"], frame["h"]
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = 36
    data.lens = 36 * frame["fl_x"] / width
    data.shift_x = (0.5 * width - frame["cx"]) / width
    data.shift_y = (frame["cy"] - 0.5 * height) / width * frame["fl_x"] / frame["fl_y"]
    data.clip_start, data.clip_end = 0.001, 1e5
    thing["relamp_size"] = [width, height]
    thing["relamp_pixel_aspect"] = frame["fl_x"] / frame["fl_y"]
    if any(frame.get(k, 0) for k in ("k1", "k2", "k3", "k4", "p1", "p2", "omega", "skew")):
        note("%s: its lens distortion is left out" % frame["file_path"])
    return thing


def use(camera):
    """Looks through a camera at its photograph's size."""
    scene = bpy.context.scene
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = [int(x) for x in camera["relamp_size"]]
    scene.render.resolution_percentage = 100
    aspect = camera["relamp_pixel_aspect"]
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = max(1, 1 / aspect), max(1, aspect)


def settings(bounced, samples):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.light_sampling_threshold = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 8 if bounced else 0
    cycles.caustics_reflective = bounced
    cycles.blur_glossy = 0
    scene.view_settings.view_transform = "Standard"
    scene.unit_settings.system = "METRIC"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"


def build(samples=256):
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    lights, gltf, cameras = read("lights.json"), read("lights.gltf"), read("transforms.json")
    with open(os.path.join(FOLDER, gltf["buffers"][0]["uri"]), "rb") as file:
        buffer = file.read()
    base = lights["origin"]
    if any(base):
        note("the scene stands about its own origin, %s" % base)
    settings(lights["interreflection"], samples)
    for node in gltf["nodes"]:
        if "mesh" not in node:
            continue
        material = gltf["meshes"][node["mesh"]]["primitives"][0]["material"]
        if "emissiveFactor" not in gltf["materials"][material]:
            add_surface(gltf, buffer, node)
    for light in lights["lights"]:
        add_light(light, base)
    add_environment(lights["environment"])
    views = [add_camera(frame, base) for frame in cameras["frames"]]
    if views:
        use(views[0])
    return views


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="scene.py", description="Rebuilds a scene that relamp exported.")
    parser.add_argument("--view", type=int, default=0, help="the camera to look through, from 0")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--render", metavar="FILE.exr", help="renders it, linear")
    parser.add_argument("--save", metavar="FILE.blend")
    options = parser.parse_args(arguments)
    views = build(options.samples)
    if not 0 <= options.view < max(1, len(views)):
        sys.exit("scene.py: --view %d: there are %d" % (options.view, len(views)))
    if views:
        use(views[options.view])
    if options.save:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options.save))
    if options.render:
        bpy.context.scene.render.filepath = os.path.abspath(options.render)
        bpy.ops.render.render(write_still=True)


main()
