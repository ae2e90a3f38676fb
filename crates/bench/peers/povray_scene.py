"""The scene as POV-Ray reads it. Its meshes are part of its scene file."""

import math

import numpy as np

import ply

# POV-Ray dims light by 2 / (1 + (r/d)²) from a distance d on: so small a distance leaves the square of the distance.
FADE = 1e-3


def text(scene):
    plane, half = scene["plane"], scene["plane"]["half"]
    corners = [(x * half, plane["height"], z * half) for x, z in ((-1, 1), (1, 1), (1, -1), (-1, -1))]
    parts = ["#version 3.7;\nglobal_settings{assumed_gamma 1 max_trace_level 2}\n", camera(scene)]
    parts.append(mesh(np.array(corners), np.array([(0, 1, 2), (0, 2, 3)]), plane["reflectance"]))
    if "mesh" in scene:
        parts.append(mesh(*ply.load(scene["mesh"]["file"]), scene["mesh"]["reflectance"]))
    for sphere in scene.get("spheres", []):
        look = texture(sphere["reflectance"])
        parts.append(f"sphere{{{vector(sphere['center'])},{sphere['radius']} {look}}}\n")
    parts.extend(light(**light_) for light_ in scene["lights"])
    return "".join(parts)


def camera(scene):
    """POV-Ray's space is left-handed: the picture's right side is told, so nothing else needs to be turned."""
    eye, target = (np.array(scene["camera"][key], float) for key in ("eye", "target"))
    tan = math.tan(math.radians(scene["camera"]["fov"] / 2))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, (0, 1, 0))
    right /= np.linalg.norm(right)
    up = 2 * tan * np.cross(right, forward)
    right *= 2 * tan * scene["width"] / scene["height"]
    return f"camera{{location {vector(eye)} direction {vector(forward)} right {vector(right)} up {vector(up)}}}\n"


def light(position, intensity):
    """POV-Ray knows no 1/π in diffuse reflection."""
    color = [value / (math.pi * 2 * FADE**2) for value in intensity]
    return f"light_source{{{vector(position)} rgb {vector(color)} fade_distance {FADE} fade_power 2}}\n"


def mesh(vertices, triangles, reflectance):
    points = ",\n".join(map(vector, vertices.tolist()))
    faces = ",\n".join("<%d,%d,%d>" % tuple(face) for face in triangles.tolist())
    return (
        f"mesh2{{vertex_vectors{{{len(vertices)},\n{points}}}\nface_indices{{{len(triangles)},\n{faces}}}\n"
        f"{texture(reflectance)}}}\n"
    )


def texture(reflectance):
    return f"texture{{pigment{{rgb {vector(reflectance)}}} finish{{ambient 0 diffuse 1}}}}"


def vector(values):
    return "<%.7g,%.7g,%.7g>" % tuple(values)
