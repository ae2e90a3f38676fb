"""What scripts for Mitsuba share; y is up."""

import mitsuba as mi


def rgb(value):
    return {"type": "rgb", "value": list(value)}


def diffuse(reflectance):
    return {"type": "diffuse", "reflectance": rgb(reflectance)}


def mesh(file, reflectance):
    return {"type": "ply", "filename": file, "face_normals": True, "bsdf": diffuse(reflectance)}


def sensor(camera, width, height, samples, sampler="independent"):
    """A camera whose pixels are under a box."""
    return {
        "type": "perspective",
        "fov": camera["fov"],
        "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(origin=camera["eye"], target=camera["target"], up=[0, 1, 0]),
        "film": {
            "type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb",
            "component_format": "float32",
        },
        "sampler": {"type": sampler, "sample_count": samples},
    }
