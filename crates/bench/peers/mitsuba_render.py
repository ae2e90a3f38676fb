"""Renders a scene with Mitsuba 3: mitsuba_render.py VARIANT SCENE.json PICTURE.png"""

import json
import sys

import mitsuba as mi

from mitsuba_parts import diffuse, mesh, rgb, sensor

variant, scene_file, picture = sys.argv[1:]
mi.set_variant(variant)
scene = json.load(open(scene_file))
Transform = mi.ScalarTransform4f
plane, lights = scene["plane"], scene["lights"]
place = Transform().translate([0, plane["height"], 0]).rotate([1, 0, 0], -90).scale([plane["half"], plane["half"], 1])
described = {
    "type": "scene",
    # One emitter sample per light; nothing else gives light.
    "integrator": {"type": "direct", "emitter_samples": len(lights), "bsdf_samples": 0},
    "sensor": sensor(scene["camera"], scene["width"], scene["height"], scene["samples"]),
    "plane": {"type": "rectangle", "to_world": place, "bsdf": diffuse(plane["reflectance"])},
}
if "mesh" in scene:
    described["mesh"] = mesh(**scene["mesh"])
for i, sphere in enumerate(scene.get("spheres", [])):
    shape = {"type": "sphere", "center": list(sphere["center"]), "radius": sphere["radius"]}
    described[f"sphere{i}"] = shape | {"bsdf": diffuse(sphere["reflectance"])}
for i, light in enumerate(lights):
    # Mitsuba 3.9.1 is as many times too bright as it takes emitter samples of point lights.
    intensity = rgb(value / len(lights) for value in light["intensity"])
    described[f"light{i}"] = {"type": "point", "position": light["position"], "intensity": intensity}
mi.util.write_bitmap(picture, mi.render(mi.load_dict(described), spp=scene["samples"]))
