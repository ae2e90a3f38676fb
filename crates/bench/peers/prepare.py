"""Writes a scene's files for the renderers: prepare.py NAME FOLDER [--model FILE] [--povray]

A program of its own, as is compare.py: what the one that measures has in memory would be counted as its children's.
"""

import argparse
import json
from pathlib import Path

import cases
import firstlight_scene
import povray_scene

parser = argparse.ArgumentParser()
parser.add_argument("name")
parser.add_argument("folder", type=Path)
parser.add_argument("--model", type=Path)
parser.add_argument("--povray", action="store_true")
asked = parser.parse_args()
scene = cases.scene(asked.name, asked.folder, asked.model)
(asked.folder / "scene.json").write_text(json.dumps(scene))
(asked.folder / "scene.toml").write_text(firstlight_scene.text(scene))
if asked.povray:
    (asked.folder / "scene.pov").write_text(povray_scene.text(scene))
