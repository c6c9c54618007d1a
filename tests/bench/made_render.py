"""Cycles for made_scenes.py: objects in, radiance and masks out. Runs inside Blender."""
import math
import os

import bpy
import numpy as np
from mathutils import Matrix, Vector

WIDTH, HEIGHT = 480, 336


def camera_at(eye, target):
    """Camera to world, 4 x 4: x right, y up, looking along -z."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = right, np.cross(right, forward), -forward, eye
    return m


def write_ply(path, columns, triangles):
    """`columns`: (name, values, little-endian type)."""
    words = {"<f4": "float", "<i4": "int"}
    vertices = np.zeros(len(columns[0][1]), [(name, kind) for name, _, kind in columns])
    for name, values, _ in columns:
        vertices[name] = values
    faces = np.zeros(len(triangles), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    properties = "".join(f"property {words[kind]} {name}\n" for name, _, kind in columns)
    with open(path, "wb") as f:
        f.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
                f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        f.write(vertices.tobytes() + faces.tobytes())


def read_pixels(path):
    """Rows from the bottom."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    w, h = image.size
    pixels = np.array(image.pixels[:], np.float32).reshape(h, w, image.channels)[..., :3]
    bpy.data.images.remove(image)
    return pixels


def write_pixels(pixels, path, kind="OPEN_EXR"):
    h, w, _ = pixels.shape
    image = bpy.data.images.new("made", w, h, float_buffer=kind == "OPEN_EXR")
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.concatenate([pixels, np.ones((h, w, 1))], 2).astype(np.float32).ravel())
    image.filepath_raw, image.file_format = path, kind
    image.save()
    bpy.data.images.remove(image)
    return path


class Renderer:
    def __init__(self, objects, bounces, fov):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene, self.objects = bpy.context.scene, {o["name"]: dict(o) for o in objects}
        self.lights = [o["name"] for o in objects if o["radiance"]]
        self.focal = WIDTH / 2 / math.tan(math.radians(fov) / 2)
        self._settings(bounces)
        for o in self.objects.values():
            self._object(o)
        self._world()
        camera = bpy.data.cameras.new("camera")
        camera.sensor_fit, camera.angle, camera.clip_start = "HORIZONTAL", math.radians(fov), 0.01
        self.camera = bpy.data.objects.new("camera", camera)
        self.scene.collection.objects.link(self.camera)
        self.scene.camera = self.camera

    def _settings(self, bounces):
        cycles, render = self.scene.cycles, self.scene.render
        render.engine, cycles.device = "CYCLES", "CPU"
        cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
        cycles.use_denoising, cycles.pixel_filter_type = False, "BOX"
        cycles.use_adaptive_sampling, cycles.adaptive_threshold = True, 0.004
        render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        self.scene.view_settings.view_transform = "Raw"

    def _object(self, o):
        mesh = bpy.data.meshes.new(o["name"])
        mesh.from_pydata(o["vertices"].tolist(), [], o["triangles"].tolist())
        albedo = np.concatenate([o["albedo"], np.ones((len(o["albedo"]), 1))], 1).astype(np.float32)
        mesh.attributes.new("albedo", "FLOAT_COLOR", "POINT").data.foreach_set("color", albedo.ravel())
        mesh.polygons.foreach_set("use_smooth", np.ones(len(o["triangles"]), bool))
        mesh.update()
        o["material"] = material = bpy.data.materials.new(o["name"])
        mesh.materials.append(material)
        o["object"] = bpy.data.objects.new(o["name"], mesh)
        self.scene.collection.objects.link(o["object"])
        material.use_nodes = True
        nodes, links = material.node_tree.nodes, material.node_tree.links
        nodes.clear()
        surface = nodes.new("ShaderNodeOutputMaterial").inputs[0]
        if o["radiance"]:
            o["emission"] = nodes.new("ShaderNodeEmission")
            o["now"] = o["radiance"]
            links.new(o["emission"].outputs[0], surface)
            return
        attribute, diffuse = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeBsdfDiffuse")
        attribute.attribute_name = "albedo"
        links.new(attribute.outputs[0], diffuse.inputs[0])
        if o["roughness"] == 1:
            links.new(diffuse.outputs[0], surface)
            return
        glossy, fresnel = nodes.new("ShaderNodeBsdfGlossy"), nodes.new("ShaderNodeFresnel")
        glossy.distribution, glossy.inputs[0].default_value = "GGX", (1, 1, 1, 1)
        glossy.inputs["Roughness"].default_value, fresnel.inputs[0].default_value = o["roughness"], 1.5
        mix = nodes.new("ShaderNodeMixShader")
        for k, node in enumerate((fresnel, diffuse, glossy)):
            links.new(node.outputs[0], mix.inputs[k])
        links.new(mix.outputs[0], surface)

    def _world(self):
        self.world = bpy.data.worlds.new("world")
        self.world.use_nodes = True
        self.world.cycles.sampling_method, self.world.cycles.sample_map_resolution = "MANUAL", 1024
        nodes = self.world.node_tree.nodes
        self.panorama_node = nodes.new("ShaderNodeTexEnvironment")
        self.world.node_tree.links.new(self.panorama_node.outputs[0], nodes["Background"].inputs[0])

    def normals(self):
        """Of all vertices, in the objects' order."""
        found = []
        for o in self.objects.values():
            n = np.zeros(3 * len(o["vertices"]))
            o["object"].data.vertices.foreach_get("normal", n)
            found.append(n.reshape(-1, 3))
        return np.concatenate(found)

    def intrinsics(self):
        return {"camera_model": "OPENCV", "w": WIDTH, "h": HEIGHT, "fl_x": self.focal, "fl_y": self.focal,
                "cx": WIDTH / 2, "cy": HEIGHT / 2, "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0}

    def panorama(self, source, mean, path):
        """About 512 texels wide, its sharpest lamps cut, of this mean luminance."""
        p = read_pixels(source)
        k = max(1, p.shape[1] // 512)
        h, w = p.shape[0] // k, p.shape[1] // k
        p = p[:h * k, :w * k].reshape(h, k, w, k, 3).mean((1, 3))
        luma = np.array((0.2126, 0.7152, 0.0722))
        p = np.minimum(p, np.percentile(p @ luma, 99.98))
        return write_pixels(p * mean / (p @ luma).mean(), path)

    def even(self, radiance, path):
        return write_pixels(np.full((64, 128, 3), radiance, np.float32), path)

    def light_from(self, path):
        self.panorama_node.image = bpy.data.images.load(path)
        self.panorama_node.image.colorspace_settings.name = "Non-Color"

    def change(self, light, move=None, power=(1, 1, 1)):
        o = self.objects[light]
        o["now"] = tuple(np.array(o["radiance"]) * np.array(power))
        o["object"].matrix_world = Matrix.Translation(move or (0, 0, 0))

    def render(self, matrix, path, samples, seed):
        self.camera.matrix_world = Matrix(matrix.tolist())
        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed
        self.scene.render.filepath = path + ".part.exr"
        total = 0
        for alone in [None] + [name for name in self.lights if max(self.objects[name]["now"]) > 0]:
            self.scene.world = self.world if alone is None else None
            for name in self.lights:
                o = self.objects[name]
                o["emission"].inputs[0].default_value = (*(o["now"] if name == alone else (0, 0, 0)), 1)
                o["material"].cycles.sample_as_light = name == alone
            bpy.ops.render.render(write_still=True)
            total = total + read_pixels(path + ".part.exr").astype(np.float64)
        os.remove(path + ".part.exr")
        write_pixels(total.astype(np.float32), path)
        print(os.path.basename(path), flush=True)

    def mask(self, matrix, path):
        """White where a pixel and its eight neighbours see the mesh and no light."""
        bpy.context.view_layer.update()
        graph, eye = bpy.context.evaluated_depsgraph_get(), Vector(matrix[:3, 3])
        seen = np.zeros((HEIGHT, WIDTH), bool)
        for y in range(HEIGHT):
            for x in range(WIDTH):
                ray = ((x + 0.5 - WIDTH / 2) / self.focal, -(y + 0.5 - HEIGHT / 2) / self.focal, -1.0)
                hit = self.scene.ray_cast(graph, eye, Vector(matrix[:3, :3] @ np.array(ray)))
                seen[y, x] = hit[0] and hit[4].name not in self.lights
        inside = np.logical_and.reduce([np.roll(seen, (dy, dx), (0, 1)) for dy in (-1, 0, 1) for dx in (-1, 0, 1)])
        write_pixels(np.repeat(inside[::-1, :, None], 3, 2), path, "PNG")
