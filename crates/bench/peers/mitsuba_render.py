"""Renders a scene with Mitsuba 3: mitsuba_render.py VARIANT SCENE.json PICTURE.png"""

import json
import sys

import mitsuba as mi

variant, scene_file, picture = sys.argv[1:]
mi.set_variant(variant)
scene = json.load(open(scene_file))
Transform = mi.ScalarTransform4f


def rgb(value):
    return {"type": "rgb", "value": list(value)}


def diffuse(reflectance):
    return {"type": "diffuse", "reflectance": rgb(reflectance)}


camera, plane, lights = scene["camera"], scene["plane"], scene["lights"]
place = Transform().translate([0, plane["height"], 0]).rotate([1, 0, 0], -90).scale([plane["half"], plane["half"], 1])
described = {
    "type": "scene",
    # One emitter sample per light; nothing else gives light.
    "integrator": {"type": "direct", "emitter_samples": len(lights), "bsdf_samples": 0},
    "sensor": {
        "type": "perspective",
        "fov": camera["fov"],
        "fov_axis": "y",
        "to_world": Transform().look_at(origin=camera["eye"], target=camera["target"], up=[0, 1, 0]),
        "film": {
            "type": "hdrfilm", "width": scene["width"], "height": scene["height"], "rfilter": {"type": "box"},
            "pixel_format": "rgb", "component_format": "float32",
        },
        "sampler": {"type": "independent", "sample_count": scene["samples"]},
    },
    "plane": {"type": "rectangle", "to_world": place, "bsdf": diffuse(plane["reflectance"])},
}
if "mesh" in scene:
    mesh = scene["mesh"]
    look = diffuse(mesh["reflectance"])
    described["mesh"] = {"type": "ply", "filename": mesh["file"], "face_normals": True, "bsdf": look}
for i, sphere in enumerate(scene.get("spheres", [])):
    shape = {"type": "sphere", "center": list(sphere["center"]), "radius": sphere["radius"]}
    described[f"sphere{i}"] = shape | {"bsdf": diffuse(sphere["reflectance"])}
for i, light in enumerate(lights):
    # Mitsuba 3.9.1 is as many times too bright as it takes emitter samples of point lights.
    intensity = rgb(value / len(lights) for value in light["intensity"])
    described[f"light{i}"] = {"type": "point", "position": light["position"], "intensity": intensity}
mi.util.write_bitmap(picture, mi.render(mi.load_dict(described), spp=scene["samples"]))
