"""Renders a scene with Cycles, Blender's renderer: cycles_render.py SCENE.json PICTURE.png"""

import json
import math
import os
import sys

import bpy

import ply
from blender import add, camera, mesh, diffuse, settings

scene_file, picture = sys.argv[1:]
recipe = json.load(open(scene_file))
bpy.ops.wm.read_factory_settings(use_empty=True)
render, cycles = settings(recipe["width"], recipe["height"], recipe["samples"], bounces=0)
# The light tree costs a third where lights are few.
cycles.use_light_tree = len(recipe["lights"]) > 8
render.image_settings.file_format, render.filepath = "PNG", os.path.abspath(picture)


def sphere(center, radius, reflectance):
    """Cycles has no spheres: a smooth mesh stands in."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=radius, location=center)
    bpy.context.object.data.materials.append(diffuse(reflectance))
    bpy.ops.object.shade_smooth()


def point_light(position, intensity):
    data = bpy.data.lights.new("light", "POINT")
    strongest = max(intensity)
    data.color, data.energy = [value / strongest for value in intensity], 4 * math.pi * strongest
    data.shadow_soft_size = 0.0
    add("light", data).location = position


camera(**recipe["camera"])
height, half = recipe["plane"]["height"], recipe["plane"]["half"]
square = [(x * half, height, z * half) for x, z in ((-1, 1), (1, 1), (1, -1), (-1, -1))]
mesh(square, [(0, 1, 2), (0, 2, 3)], recipe["plane"]["reflectance"])
if "mesh" in recipe:
    mesh(*ply.load(recipe["mesh"]["file"]), recipe["mesh"]["reflectance"])
for ball in recipe.get("spheres", []):
    sphere(**ball)
for light in recipe["lights"]:
    point_light(**light)
bpy.ops.render.render(write_still=True)
