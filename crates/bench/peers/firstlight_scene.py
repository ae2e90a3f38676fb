"""The scene as firstlight reads it."""

import json
from pathlib import Path


def text(scene):
    camera, plane = scene["camera"], scene["plane"]
    lines = [
        'up = "y"',
        f"film = {{ resolution = [{scene['width']}, {scene['height']}], samples = {scene['samples']}, "
        "filter = { box = { radius = 0.5 } } }",
        f"camera.perspective = {{ position = {camera['eye']}, target = {camera['target']}, fov = {camera['fov']} }}",
        lambert("ground", plane["reflectance"]),
        'surfaces.ground = { material = "ground", quad = '
        f"{{ corner = {[-plane['half'], plane['height'], plane['half']]}, edge_u = {[2 * plane['half'], 0, 0]}, "
        f"edge_v = {[0, 0, -2 * plane['half']]} }} }}",
    ]
    if "mesh" in scene:
        lines.append(lambert("mesh", scene["mesh"]["reflectance"]))
        lines.append(f'models.mesh = {{ file = {json.dumps(Path(scene["mesh"]["file"]).name)}, material = "mesh" }}')
    for i, sphere in enumerate(scene.get("spheres", [])):
        lines.append(lambert(f"s{i}", sphere["reflectance"]))
        shape = f"{{ center = {list(sphere['center'])}, radius = {sphere['radius']} }}"
        lines.append(f'surfaces.s{i} = {{ material = "s{i}", sphere = {shape} }}')
    for i, light in enumerate(scene["lights"]):
        lines.append(f"lights.l{i}.point = {{ position = {light['position']}, intensity = {light['intensity']} }}")
    return "\n".join(lines) + "\n"


def lambert(name, reflectance):
    return f"materials.{name}.lambert.reflectance = {list(reflectance)}"

