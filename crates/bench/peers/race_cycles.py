"""One run of Cycles in the race: race_cycles.py SCENE.json WIDTH HEIGHT SAMPLES SEED OUT"""

import json
import os
import sys
import time

import bpy
import mathutils
import numpy as np

import ply
from blender import add, camera, diffuse, mesh, reset

scene_file, width, height, samples, seed, out = sys.argv[1:]
recipe = json.load(open(scene_file))
