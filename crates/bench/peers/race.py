"""Races renderers that follow paths to the same error.

Two scenes: a Cornell box, and a model with a sphere of rough gold under sun and sky. Each renderer's error is its relative mean squared
error, the mean of (x − r)² / (r² + 0.01), against its own picture r of many samples, small; its speed is measured at full size, of
rendering alone, without start-up and loading. From both follows how long it takes to an error. Mitsuba runs with several of its
samplers, since they differ; Cycles with its own. All pictures are compared with ours first, so that all solve the same problem.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import race_scenes
from run import HERE, check_names, find_llvm, has_package

PEERS = ["mitsuba", "cycles"]
TARGETS = {"cornell": [0.01, 0.003, 0.001], "sky": [0.03, 0.01, 0.003]}


class Runner:
    """A renderer: `command` of the folder, the size, samples and seed, and the file for pixels as an array."""

    def __init__(self, name, command, read=np.load):
        self.name, self.command, self.read = name, command, read

    def render(self, folder, size, samples, seed):
        """Linear pixels, and the seconds that rendering took."""
        file = folder / "out"
        words = [str(word) for word in self.command(folder, size, samples, seed, file)]
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"error: {self.name}: {(done.stderr or done.stdout).strip()[-400:]}")
        seconds = json.loads(done.stdout[done.stdout.index("{") :])["seconds"]
        return self.read(file), seconds["render"] if isinstance(seconds, dict) else seconds

    def mean(self, folder, size, samples, seed, at_once):
        """Many samples, as the mean of pictures of fewer."""
        pictures = [self.render(folder, size, at_once, seed + i)[0] for i in range(max(1, samples // at_once))]
        return np.mean(pictures, axis=0, dtype=np.float64)


def read_pfm(file):
    with open(file.with_suffix(".pfm"), "rb") as lines:
        lines.readline()
        width, height = map(int, lines.readline().split())
        lines.readline()
        return np.frombuffer(lines.read(), "<f4").reshape(height, width, 3)[::-1]


def runners(firstlight, wanted):
    def ours(folder, size, samples, seed, file):
        options = ["--resolution", "x".join(map(str, size)), "--spp", samples, "--seed", seed, "--json", "--quiet"]
        return [firstlight, "render", folder / "scene.toml", *options, "-o", file.with_suffix(".pfm")]

    def script(name, *words):
        return lambda folder, size, samples, seed, file: [
            sys.executable, HERE / name, folder / "scene.json", *size, samples, seed, file, *words
        ]

    found = [Runner("firstlight", ours, read_pfm)]
    array = lambda file: np.load(file.with_suffix(".npy"))
    if has_package("mitsuba") and "mitsuba" in wanted:
        for sampler in ["independent", "multijitter", "orthogonal"]:
            found.append(Runner(f"Mitsuba {sampler}", script("race_mitsuba.py", sampler), array))
    if has_package("bpy") and "cycles" in wanted:
        found.append(Runner("Cycles", script("race_cycles.py"), array))
    return found


def error(picture, reference):
    return float(np.mean((picture - reference) ** 2 / (reference**2 + 0.01)))


def blocks(picture):
    rows, columns = (size // 8 for size in picture.shape[:2])
    return picture[: rows * 8, : columns * 8].reshape(rows, 8, columns, 8, 3).mean((1, 3))


def time_to(target, measured, per_sample):
    """Seconds to an error: straight lines through what was measured, log against log, and beyond it."""
    samples, errors = map(np.log, zip(*measured))
    piece = int(np.clip(np.sum(errors > np.log(target)) - 1, 0, len(errors) - 2))
    slope = (samples[piece + 1] - samples[piece]) / (errors[piece + 1] - errors[piece])
    return float(np.exp(samples[piece] + (np.log(target) - errors[piece]) * slope)) * per_sample


def race(scene, options, folder):
    recipe = race_scenes.write(scene, folder, options.model)
    small, full, ours = recipe["small"], recipe["full"], None
    for runner in runners(options.firstlight.resolve(), options.peer):
        reference = runner.mean(folder, small, options.reference, 1000, 512)
        ours = reference if ours is None else ours
        difference = np.abs(blocks(reference) - blocks(ours)).mean() / ours.mean()
        measured = []
        for samples in [16, 64, 256]:
            errors = [error(runner.render(folder, small, samples, seed)[0], reference) for seed in (1, 2)]
            # The reference has noise of its own.
            measured.append((samples, np.mean(errors) / (1 + samples / options.reference)))
        seconds = sorted(runner.render(folder, full, 64, seed)[1] for seed in range(options.runs))
        per_sample = seconds[len(seconds) // 2] / 64
        times = " | ".join(f"{time_to(target, measured, per_sample):.2f}" for target in TARGETS[scene])
        errors = " | ".join(f"{value:.5f}" for _, value in measured)
        rate = full[0] * full[1] / per_sample * 1e-6
        print(f"| {scene} | {runner.name} | {rate:.2f} | {errors} | {times} | {difference:.1%} |", flush=True)


def arguments():
    parser = argparse.ArgumentParser(prog="cargo xtask bench --race", description=__doc__.splitlines()[0])
    names = lambda text: text.lower().split(",")
    parser.add_argument("--firstlight", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--case", type=names, default=list(TARGETS), help="of " + ", ".join(TARGETS))
    parser.add_argument("--peer", type=names, default=PEERS, help="of " + ", ".join(PEERS))
    parser.add_argument("--model", type=Path, help="PLY file of triangles for the case sky, y up (default: a bumpy ball)")
    parser.add_argument("--runs", type=int, default=3, help="runs that medians are taken of (default: 3)")
    parser.add_argument("--reference", type=int, default=2048, help="samples of the references (default: 2048)")
    options = parser.parse_args()
    check_names(parser, "case", options.case, TARGETS)
    check_names(parser, "peer", options.peer, PEERS)
    return options


def main():
    options = arguments()
    find_llvm()
    for scene in options.case:
        goals = " | ".join(f"s to {target}" for target in TARGETS[scene])
        print(f"\n| scene | renderer | Msamples/s | error at 16 | 64 | 256 | {goals} | difference |")
        print("|---|---|---|---|---|---|---|---|---|---|", flush=True)
        with tempfile.TemporaryDirectory(prefix="firstlight-race-") as folder:
            race(scene, options, Path(folder))


if __name__ == "__main__":
    os.environ.setdefault("PYTHONWARNINGS", "ignore")
    main()
