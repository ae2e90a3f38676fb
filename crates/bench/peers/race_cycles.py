"""One run of Cycles in the race: race_cycles.py SCENE.json WIDTH HEIGHT SAMPLES SEED OUT"""

import json
import math
import sys
import time

import bpy
import mathutils
import numpy as np

import ply
from blender import add, camera, mesh, settings

scene_file, width, height, samples, seed, out = sys.argv[1:]
recipe = json.load(open(scene_file))
bpy.ops.wm.read_factory_settings(use_empty=True)


def lamp(corner, edge_u, edge_v, radiance):
    """Blender's area lights shine along their −z, and emit π times their radiance a square metre."""
    u, v = mathutils.Vector(edge_u), mathutils.Vector(edge_v)
    data = bpy.data.lights.new("lamp", "AREA")
    data.shape, data.size, data.size_y = "RECTANGLE", u.length, v.length
    strongest = max(radiance)
    data.color = [value / strongest for value in radiance]
    data.energy = math.pi * u.length * v.length * strongest
    right, back = u.normalized(), -u.cross(v).normalized()
    turned = mathutils.Matrix((right, back.cross(right), back)).transposed()
    middle = mathutils.Vector(corner) + u / 2 + v / 2
    placed = add("lamp", data)
    placed.matrix_world, placed.visible_camera = mathutils.Matrix.LocRotScale(middle, turned, None), True


def gold(center, radius, alpha):
    """Cycles has no spheres: a fine smooth mesh stands in, of gold's colour at normal incidence and at the rim."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=radius, location=center)
    bpy.ops.object.shade_smooth()
    material = bpy.data.materials.new("gold")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    bsdf, output = nodes.new("ShaderNodeBsdfMetallic"), nodes.new("ShaderNodeOutputMaterial")
    bsdf.distribution = "GGX"
    bsdf.inputs["Base Color"].default_value = (1.0, 0.78, 0.34, 1)
    bsdf.inputs["Roughness"].default_value = math.sqrt(alpha)
    material.node_tree.links.new(bsdf.outputs[0], output.inputs[0])
    bpy.context.object.data.materials.append(material)


def sky(file):
    """A lat-long picture whose middle is −z and whose first row is +y; Blender's middle is +x and its first row +z."""
    tree = bpy.context.scene.world.node_tree
    texture, place = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    texture.image = bpy.data.images.load(file)
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    turned = mathutils.Matrix(((0, 0, -1), (-1, 0, 0), (0, 1, 0))).to_euler()
    place.inputs["Rotation"].default_value = turned
    tree.links.new(coordinates.outputs["Generated"], place.inputs["Vector"])
    tree.links.new(place.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


render, cycles = settings(int(width), int(height), int(samples), recipe["bounces"])
cycles.seed, cycles.use_light_tree = int(seed), False
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.filepath = out + ".exr"
camera(**recipe["camera"])
for part in recipe["parts"].values():
    mesh(*ply.load(part["file"]), part["reflectance"])
if "lamp" in recipe:
    lamp(**recipe["lamp"])
if "gold" in recipe:
    gold(**recipe["gold"])
if "sky" in recipe:
    sky(recipe["sky"])
start = time.perf_counter()
bpy.ops.render.render(write_still=True)
print(json.dumps({"seconds": time.perf_counter() - start}))
picture = bpy.data.images.load(out + ".exr")
pixels = np.empty(4 * int(width) * int(height), np.float32)
picture.pixels.foreach_get(pixels)
np.save(out + ".npy", pixels.reshape(int(height), int(width), 4)[::-1, :, :3])
