"""One run of Mitsuba 3 in the race: race_mitsuba.py SCENE.json WIDTH HEIGHT SAMPLES SEED OUT SAMPLER"""

import json
import sys
import time

import mitsuba as mi
import numpy as np

from mitsuba_parts import diffuse, mesh, rgb, sensor

scene_file, width, height, samples, seed, out, sampler = sys.argv[1:]
mi.set_variant("llvm_ad_rgb")
recipe = json.load(open(scene_file))
Transform = mi.ScalarTransform4f
described = {
    "type": "scene",
    "integrator": {"type": "path", "max_depth": recipe["bounces"] + 1},
    "sensor": sensor(recipe["camera"], int(width), int(height), int(samples), sampler),
}
described |= {name: mesh(**part) for name, part in recipe["parts"].items()}
if "lamp" in recipe:
    lamp = recipe["lamp"]
    corner, u, v = (np.array(lamp[key], float) for key in ("corner", "edge_u", "edge_v"))
    columns = [u / 2, v / 2, np.cross(u, v), corner + u / 2 + v / 2]
    place = np.vstack([np.stack(columns, 1), [0, 0, 0, 1]])
    emitter = {"type": "area", "radiance": rgb(lamp["radiance"])}
    described["lamp"] = {"type": "rectangle", "to_world": Transform(place), "emitter": emitter, "bsdf": diffuse([0, 0, 0])}
if "gold" in recipe:
    gold = recipe["gold"]
    metal = {"type": "roughconductor", "distribution": "ggx", "alpha": gold["alpha"], "material": "Au"}
    described["gold"] = {"type": "sphere", "center": gold["center"], "radius": gold["radius"], "bsdf": metal}
if "sky" in recipe:
    turned = Transform().rotate([0, 1, 0], 180)
    described["sky"] = {"type": "envmap", "filename": recipe["sky"], "to_world": turned}
scene = mi.load_dict(described)
start = time.perf_counter()
picture = np.array(mi.render(scene, spp=int(samples), seed=int(seed)))
print(json.dumps({"seconds": time.perf_counter() - start}))
np.save(out + ".npy", picture)
