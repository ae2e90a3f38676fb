"""The scenes that renderers are compared on: plain numbers, y up.

A scene is a dictionary: width, height (pixels), samples (per pixel); camera with eye, target and vertical field of view
(degrees); at most one mesh (file, reflectance); spheres (center, radius, reflectance); a square plane (height, half its
side, reflectance); point lights (position, radiant intensity in red, green and blue).
"""

import math
import shutil

import ply


def dragon(folder, model):
    """A mesh of some 900,000 triangles on a plane under two lights; all places are relative to its size."""
    file = folder / "model.ply"
    if model:
        shutil.copyfile(model, file)
    else:
        ply.save(file, *ply.bumpy_ball(870_000))
    vertices, _ = ply.load(file)
    lower, upper = vertices.min(0).astype(float), vertices.max(0).astype(float)
    size, middle = math.dist(lower, upper), (lower + upper) / 2
    at = lambda x, y, z: (middle + [x * size, y * size, z * size]).tolist()
    intensity = lambda *rgb: [value * size * size for value in rgb]
    return {
        "width": 1920, "height": 1080, "samples": 16,
        "camera": {"eye": at(0, 0.2, 1.36), "target": at(0, -0.03, 0), "fov": 30},
        "mesh": {"file": str(file), "reflectance": [0.7, 0.7, 0.7]},
        "plane": {"height": float(lower[1]), "half": 7.5 * size, "reflectance": [0.5, 0.5, 0.5]},
        "lights": [
            {"position": at(1.15, 1.4, 1.5), "intensity": intensity(4.9, 4.6, 4.3)},
            {"position": at(-1.5, 1.0, 0.8), "intensity": intensity(1.4, 1.7, 2.4)},
        ],
    }


def spheres(_folder, _model):
    """Five spheres on a plane under two lights, small and one sample: what starting up costs."""
    places = [(-2, 0.7, 0), (-0.7, 0.5, 1), (0.6, 0.6, 0.6), (1.9, 0.9, -0.3), (0, 1.1, -1.6)]
    colors = [(0.8, 0.2, 0.2), (0.2, 0.8, 0.2), (0.2, 0.2, 0.8), (0.8, 0.8, 0.2), (0.7, 0.7, 0.7)]
    return {
        "width": 640, "height": 480, "samples": 1,
        "camera": {"eye": [0, 2, 6], "target": [0, 0.8, 0], "fov": 45},
        "spheres": [{"center": p, "radius": p[1], "reflectance": c} for p, c in zip(places, colors)],
        "plane": {"height": 0, "half": 50, "reflectance": [0.5, 0.5, 0.5]},
        "lights": [
            {"position": [4, 6, 4], "intensity": [40, 40, 40]},
            {"position": [-5, 4, 3], "intensity": [15, 15, 20]},
        ],
    }


def ball(folder, triangles, lights):
    """A bumpy ball on a plane under a ring of lights."""
    file = folder / "ball.ply"
    ply.save(file, *ply.bumpy_ball(triangles))
    turn = lambda i: 2 * math.pi * (i + 0.17) / lights
    return {
        "camera": {"eye": [0, 1.2, 4], "target": [0, -0.1, 0], "fov": 38},
        "mesh": {"file": str(file), "reflectance": [0.7, 0.7, 0.7]},
        "plane": {"height": -1.02, "half": 20, "reflectance": [0.5, 0.5, 0.5]},
        "lights": [
            {"position": [3 * math.sin(turn(i)), 3, 3 * math.cos(turn(i))], "intensity": [30 / lights] * 3}
            for i in range(lights)
        ],
    }


def growth(folder, _model, triangles):
    return ball(folder, triangles, 1) | {"width": 960, "height": 540, "samples": 4}


def many_lights(folder, _model, lights):
    return ball(folder, 100_000, lights) | {"width": 480, "height": 270, "samples": 1}


def scene(name, folder, model):
    """The scene of a name such as `growth 10000`. Its mesh is written into `folder`; `model` may name a file for it."""
    kind, *numbers = name.split()
    make = {"dragon": dragon, "spheres": spheres, "growth": growth, "lights": many_lights}[kind]
    return make(folder, model, *map(int, numbers))
