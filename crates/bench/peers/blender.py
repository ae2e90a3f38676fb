"""What scripts for Cycles share: settings without anything adaptive, cameras, meshes, matte materials; y is up."""

import math
import os

import bpy
import mathutils
import numpy as np


def settings(width, height, samples, bounces):
    """No denoising, nothing adaptive, nothing clamped, pixels under a box; returns what is rendered and Cycles' own part."""
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device, cycles.samples = "CYCLES", "CPU", samples
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_auto_tile = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    for kind in ("max", "diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, f"{kind}_bounces", bounces)
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.threads_mode, render.threads = "FIXED", os.cpu_count()
    render.use_compositing = render.use_sequencer = False
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0, 0, 0, 1)
    return render, cycles


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
    bpy.context.scene.camera = placed


def add(name, data):
    placed = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(placed)
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
