"""The scenes of the race to equal error, written for all that take part: meshes as PLY files, the rest as plain numbers, y up."""

import json
import math
import shutil

import numpy as np

import ply

# Surfaces that light may be scattered at on its way.
BOUNCES = 7


def quad(a, edge_u, edge_v):
    a, u, v = (np.array(x, float) for x in (a, edge_u, edge_v))
    return np.array([a, a + u, a + u + v, a + v]), np.array([(0, 1, 2), (0, 2, 3)])


def block(center, half, degrees):
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    sin, cos = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    turned = corners @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T + center
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return turned, np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def cornell(_folder, _model):
    """A box lit from its ceiling; all walls face inwards."""
    white, green, red = [0.886, 0.699, 0.666], [0.105, 0.378, 0.076], [0.570, 0.043, 0.044]
    parts = {
        "floor": (quad((-1, -1, 1), (2, 0, 0), (0, 0, -2)), white),
        "ceiling": (quad((-1, 1, -1), (2, 0, 0), (0, 0, 2)), white),
        "back": (quad((-1, -1, -1), (2, 0, 0), (0, 2, 0)), white),
        "right": (quad((1, -1, -1), (0, 0, 2), (0, 2, 0)), green),
        "left": (quad((-1, -1, 1), (0, 0, -2), (0, 2, 0)), red),
        "small": (block((0.335, -0.7, 0.38), (0.3, 0.3, 0.3), -17), white),
        "large": (block((-0.33, -0.4, -0.28), (0.3, 0.61, 0.3), 18.25), white),
    }
    return {
        "small": [128, 128], "full": [512, 512],
        "camera": {"eye": [0, 0, 3.9], "target": [0, 0, 0], "fov": 39.3077},
        "parts": parts,
        "lamp": {"corner": [-0.23, 0.99, -0.18], "edge_u": [0.46, 0, 0], "edge_v": [0, 0, 0.38], "radiance": [18.4, 14, 6.75]},
    }


def sky(folder, model):
    """A model and a sphere of rough gold on a plane under sun and sky; all places are relative to the model's size."""
    if model:
        shutil.copyfile(model, folder / "model.ply")
        mesh = ply.load(folder / "model.ply")
    else:
        mesh = ply.bumpy_ball(870_000)
    lower, upper = mesh[0].min(0).astype(float), mesh[0].max(0).astype(float)
    size, middle = math.dist(lower, upper), (lower + upper) / 2
    at = lambda x, y, z: (middle + [x * size, y * size, z * size]).tolist()
    ground, half = float(lower[1]), 7.5 * size
    plane = quad((middle[0] - half, ground, middle[2] + half), (2 * half, 0, 0), (0, 0, -2 * half))
    write_hdr(folder / "sky.hdr", sun_and_sky(1024, 512))
    radius = 0.17 * size
    return {
        "small": [160, 90], "full": [640, 360],
        "camera": {"eye": at(0.1, 0.17, 1.58), "target": at(0.1, -0.08, 0), "fov": 30},
        "parts": {"model": (mesh, [0.6, 0.5, 0.4]), "plane": (plane, [0.5, 0.5, 0.5])},
        "gold": {"center": [at(0.55, 0, 0)[0], ground + radius, at(0, 0, 0.23)[2]], "radius": radius, "alpha": 0.3},
        "sky": str(folder / "sky.hdr"),
    }


def sun_and_sky(width, height):
    """Lat-long radiance: the first row up, its middle −z, to the right of that +x."""
    polar = (np.arange(height) + 0.5)[:, None] / height * math.pi
    around = (np.arange(width) + 0.5)[None, :] / width * 2 * math.pi - math.pi
    up = np.cos(polar) + 0 * around
    directions = np.stack([np.sin(polar) * np.sin(around), up, -np.sin(polar) * np.cos(around)], -1)
    haze = (1 - np.clip(up, 0, 1))[..., None]
    above = np.array([0.25, 0.45, 0.9]) * (0.4 + 0.6 * haze**2) + 0.3 * haze**8
    radiance = np.where(up[..., None] > 0, above, np.array([0.1, 0.09, 0.08]))
    sun = np.array([0.5, 0.6, 0.62])
    seen = directions @ (sun / np.linalg.norm(sun)) > math.cos(math.radians(1.5))
    return radiance + seen[..., None] * np.array([1600, 1400, 1100])


def write_hdr(path, radiance):
    """Radiance's format, not compressed."""
    exponent = np.ceil(np.log2(radiance.max(-1)))
    mantissa = np.clip(radiance / 2.0 ** exponent[..., None] * 256, 0, 255).astype(np.uint8)
    pixels = np.concatenate([mantissa, (exponent + 128).astype(np.uint8)[..., None]], -1)
    height, width = pixels.shape[:2]
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    path.write_bytes(head.encode() + pixels.tobytes())


def write(name, folder, model):
    """Writes a scene's files into `folder` and returns its numbers."""
    recipe = {"cornell": cornell, "sky": sky}[name](folder, model)
    for part, (mesh, reflectance) in recipe["parts"].items():
        ply.save(folder / f"{part}.ply", *mesh)
        recipe["parts"][part] = {"file": str(folder / f"{part}.ply"), "reflectance": reflectance}
    (folder / "scene.json").write_text(json.dumps(recipe | {"bounces": BOUNCES}))
    (folder / "scene.toml").write_text(toml(recipe))
    return recipe


def toml(recipe):
    """The scene as firstlight reads it."""
    camera = recipe["camera"]
    lines = [
        'up = "y"',
        f"integrator = {{ path = {{ bounces = {BOUNCES} }} }}",
        "film.filter = { box = { radius = 0.5 } }",
        f"camera.perspective = {{ position = {camera['eye']}, target = {camera['target']}, fov = {camera['fov']} }}",
    ]
    for name, part in recipe["parts"].items():
        lines.append(f"materials.{name}.lambert.reflectance = {part['reflectance']}")
        lines.append(f'models.{name} = {{ file = "{name}.ply", material = "{name}" }}')
    if "lamp" in recipe:
        lamp = recipe["lamp"]
        shape = f"{{ corner = {lamp['corner']}, edge_u = {lamp['edge_u']}, edge_v = {lamp['edge_v']} }}"
        lines.append(f"surfaces.lamp = {{ quad = {shape}, light = {{ radiance = {lamp['radiance']} }} }}")
    if "gold" in recipe:
        gold = recipe["gold"]
        lines.append(f'materials.gold.conductor = {{ metal = "gold", roughness = {math.sqrt(gold["alpha"])} }}')
        shape = f"{{ center = {gold['center']}, radius = {gold['radius']} }}"
        lines.append(f'surfaces.gold = {{ material = "gold", sphere = {shape} }}')
    if "sky" in recipe:
        lines.append('environment.image = { file = "sky.hdr" }')
    return "\n".join(lines) + "\n"
