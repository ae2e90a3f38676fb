"""Renders a scene with Cycles, Blender's renderer: cycles_render.py SCENE.json PICTURE.png"""

import json
import math
import os
import sys

import bpy
import mathutils
import numpy as np

import ply

scene_file, picture = sys.argv[1:]
recipe = json.load(open(scene_file))
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene


def settings():
    """Direct light only, no denoising, nothing adaptive. The light tree is off: with few lights it costs a third."""
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device, cycles.samples = "CYCLES", "CPU", recipe["samples"]
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_auto_tile = False
    cycles.use_light_tree = len(recipe["lights"]) > 8
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    for kind in ("max", "diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, f"{kind}_bounces", 0)
    render.resolution_x, render.resolution_y, render.resolution_percentage = recipe["width"], recipe["height"], 100
    render.threads_mode, render.threads = "FIXED", os.cpu_count()
    render.use_compositing = render.use_sequencer = False
    scene.view_settings.view_transform = "Standard"
    render.image_settings.file_format, render.filepath = "PNG", os.path.abspath(picture)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0, 0, 0, 1)


def camera(eye, target, fov):
    """Blender's cameras look along their −z."""
    eye, target = mathutils.Vector(eye), mathutils.Vector(target)
    back = (eye - target).normalized()
    right = mathutils.Vector((0, 1, 0)).cross(back).normalized()
    up = back.cross(right)
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle_y = "VERTICAL", math.radians(fov)
    data.clip_start, data.clip_end = 1e-3, 1e5
    placed = add("camera", data)
    placed.matrix_world = mathutils.Matrix.LocRotScale(eye, mathutils.Matrix((right, up, back)).transposed(), None)
    scene.camera = placed


def add(name, data):
    placed = bpy.data.objects.new(name, data)
    scene.collection.objects.link(placed)
    return placed


def diffuse(reflectance):
    material = bpy.data.materials.new("diffuse")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    bsdf, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    bsdf.inputs["Color"].default_value = (*reflectance, 1)
    material.node_tree.links.new(bsdf.outputs[0], output.inputs[0])
    return material


def mesh(vertices, triangles, reflectance):
    data = bpy.data.meshes.new("mesh")
    data.vertices.add(len(vertices))
    data.vertices.foreach_set("co", np.asarray(vertices, np.float32).ravel())
    data.loops.add(3 * len(triangles))
    data.loops.foreach_set("vertex_index", np.asarray(triangles, np.int32).ravel())
    data.polygons.add(len(triangles))
    data.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    data.update(calc_edges=False)
    data.shade_flat()
    data.materials.append(diffuse(reflectance))
    add("mesh", data)


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


settings()
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
