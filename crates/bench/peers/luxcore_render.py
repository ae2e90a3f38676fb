"""Renders a scene with LuxCore: luxcore_render.py SCENE.json PICTURE.png"""

import json
import math
import os
import sys
import time

import numpy as np
import pyluxcore
from PIL import Image

scene_file, picture = sys.argv[1:]
recipe = json.load(open(scene_file))
pyluxcore.Init()


def properties(values):
    made = pyluxcore.Properties()
    for key, value in values.items():
        made.Set(pyluxcore.Property(key, value if isinstance(value, list) else [value]))
    return made


def described(scene):
    """The scene but for shapes made of points, which are defined in `scene` at once."""
    camera, plane, half = recipe["camera"], recipe["plane"], recipe["plane"]["half"]
    aspect = recipe["width"] / recipe["height"]
    values = {
        "scene.camera.type": "perspective",
        "scene.camera.lookat.orig": floats(camera["eye"]),
        "scene.camera.lookat.target": floats(camera["target"]),
        "scene.camera.up": [0.0, 1.0, 0.0],
        "scene.camera.cliphither": 1e-3,
        "scene.camera.clipyon": 1e5,
        # Of the longer side.
        "scene.camera.fieldofview": math.degrees(2 * math.atan(math.tan(math.radians(camera["fov"]) / 2) * aspect)),
    }
    square = [(x * half, plane["height"], z * half) for x, z in ((-1, 1), (1, 1), (1, -1), (-1, -1))]
    define(scene, "plane", square, [(0, 1, 2), (0, 2, 3)])
    values |= matte("plane", "plane", plane["reflectance"])
    if "mesh" in recipe:
        values |= {"scene.shapes.mesh.type": "mesh", "scene.shapes.mesh.ply": recipe["mesh"]["file"]}
        values |= matte("mesh", "mesh", recipe["mesh"]["reflectance"])
    for i, ball in enumerate(recipe.get("spheres", [])):
        define(scene, f"sphere{i}", *sphere(ball["center"], ball["radius"]))
        values |= matte(f"sphere{i}", f"sphere{i}", ball["reflectance"])
    for i, light in enumerate(recipe["lights"]):
        values |= point_light(f"scene.lights.light{i}", **light)
    return properties(values)


def floats(values):
    return [float(value) for value in values]


def define(scene, name, vertices, triangles):
    points = [tuple(floats(vertex)) for vertex in vertices]
    scene.DefineMesh(name, points, triangles, None, None, None, None)


def matte(name, shape, reflectance):
    return {
        f"scene.materials.{name}.type": "matte",
        f"scene.materials.{name}.kd": floats(reflectance),
        f"scene.objects.{name}.shape": shape,
        f"scene.objects.{name}.material": name,
    }


def point_light(key, position, intensity):
    """LuxCore's gain is the power of a light of radiant intensity `color`."""
    return {
        f"{key}.type": "point",
        f"{key}.position": floats(position),
        f"{key}.color": floats(intensity),
        f"{key}.gain": [4 * math.pi] * 3,
        f"{key}.normalizebycolor": 0,
    }


def sphere(center, radius, columns=64, rows=32):
    """LuxCore has no spheres: a mesh stands in."""
    theta, phi = np.pi * np.arange(rows + 1) / rows, 2 * np.pi * np.arange(columns) / columns
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    out = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    triangles = []
    for row in range(rows):
        for column in range(columns):
            a, b = row * columns + column, row * columns + (column + 1) % columns
            triangles += [(a, b, b + columns), (a, b + columns, a + columns)]
    return np.array(center) + radius * out, triangles


def configuration():
    return properties({
        "renderengine.type": "PATHCPU",
        "sampler.type": "SOBOL",
        "sampler.sobol.adaptive.strength": 0.0,
        "path.pathdepth.total": 1, "path.pathdepth.diffuse": 1, "path.pathdepth.glossy": 1, "path.pathdepth.specular": 1,
        "path.clamping.variance.maxvalue": 0.0,
        "film.width": recipe["width"],
        "film.height": recipe["height"],
        "film.filter.type": "NONE",
        "batch.haltspp": recipe["samples"],
        "native.threads.count": os.cpu_count(),
    })


def encoded(linear):
    """Linear light as 8-bit sRGB."""
    linear = np.clip(linear, 0, 1)
    bent = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(255 * bent).astype(np.uint8)


scene = pyluxcore.Scene()
scene.Parse(described(scene))
session = pyluxcore.RenderSession(pyluxcore.RenderConfig(configuration(), scene))
session.Start()
while not session.HasDone():
    time.sleep(0.005)
    session.UpdateStats()
pixels = np.zeros(recipe["width"] * recipe["height"] * 3, np.float32)
session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
Image.fromarray(encoded(pixels.reshape(recipe["height"], recipe["width"], 3)[::-1])).save(picture)
session.Stop()
