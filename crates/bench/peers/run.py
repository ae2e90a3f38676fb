"""Times whole renders of firstlight and of the renderers people use: start of the process to the written picture.

What is installed takes part: Mitsuba 3, Cycles and LuxCore from PyPI (`pip install numpy pillow mitsuba bpy pyluxcore`;
Mitsuba's fast variant needs LLVM, Debian's libllvm15 or later), POV-Ray from the system. All make the same picture with the
same samples per pixel; how far the pictures agree with ours is told. Cycles and LuxCore ask one light a sample, picked at
random, the others all. Writing scene files is not timed, except where a renderer is fed by a script.
"""

import argparse
import importlib.util
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from glob import glob
from pathlib import Path

HERE = Path(__file__).parent
# For each case its scenes, from small to large.
CASES = {
    "dragon": ["dragon"],
    "spheres": ["spheres"],
    "growth": [f"growth {triangles}" for triangles in (10_000, 100_000, 1_000_000, 10_000_000)],
    "lights": [f"lights {lights}" for lights in (1, 10, 100, 1000)],
}
PEERS = ["mitsuba", "cycles", "luxcore", "povray"]


class Renderer:
    """A program that makes a picture of the scene in a folder: `command` of the folder and the picture's name."""

    def __init__(self, name, command):
        self.name, self.command = name, command
        self.begin()

    def begin(self):
        """Forgets the last scene."""
        self.seconds, self.megabytes, self.trouble = [], 0, ""

    def picture(self, folder):
        return folder / f"{self.name.replace(' ', '-')}.png"

    def run(self, folder, limit):
        """One run of at most `limit` seconds: notes its time and memory, or what went wrong."""
        words = [str(word) for word in self.command(folder, self.picture(folder))]
        with open(folder / "log.txt", "w+") as log:
            start = time.perf_counter()
            process = subprocess.Popen(words, cwd=folder, stdout=log, stderr=log, stdin=subprocess.DEVNULL)
            alarm = threading.Timer(limit, process.kill)
            alarm.start()
            _, status, usage = os.wait4(process.pid, 0)
            self.seconds.append(time.perf_counter() - start)
            alarm.cancel()
            self.megabytes = max(self.megabytes, usage.ru_maxrss // 1024)
            log.seek(0)
            if status != 0:
                slow = self.seconds[-1] >= limit
                self.trouble = f"over {limit:g} s" if slow else "failed: " + log.read().strip()[-300:].replace("\n", " ")

    def median(self):
        return statistics.median(self.seconds)


def renderers(firstlight, wanted):
    """Firstlight and those peers that are installed and wanted."""
    peers = [
        (has_package("mitsuba"), "Mitsuba llvm", script("mitsuba_render.py", "llvm_ad_rgb")),
        (has_package("mitsuba"), "Mitsuba scalar", script("mitsuba_render.py", "scalar_rgb")),
        (has_package("bpy"), "Cycles", script("cycles_render.py")),
        (has_package("pyluxcore"), "LuxCore", script("luxcore_render.py")),
        (shutil.which("povray"), "POV-Ray", povray),
    ]
    ours = lambda folder, picture: [firstlight, "render", folder / "scene.toml", "-o", picture]
    contenders = [Renderer("firstlight", ours)]
    for installed, name, command in peers:
        if not wanted or any(name.lower().replace("-", "").startswith(word) for word in wanted):
            if installed:
                contenders.append(Renderer(name, command))
            else:
                print(f"{name} is not installed and takes no part.\n")
    return contenders


def script(name, *words):
    return lambda folder, picture: [sys.executable, HERE / name, *words, folder / "scene.json", picture]


def povray(folder, picture):
    scene = json.loads((folder / "scene.json").read_text())
    size = [f"+W{scene['width']}", f"+H{scene['height']}"]
    grid = ["+A0.0", "+AM1", f"+R{round(scene['samples'] ** 0.5)}", "-J"] if scene["samples"] > 1 else ["-A"]
    return ["povray", f"+I{folder / 'scene.pov'}", f"+O{picture}", *size, *grid, "-D", "-V", f"+WT{os.cpu_count()}"]


def find_llvm():
    """Mitsuba looks for LLVM under names that Debian does not use."""
    libraries = sorted(glob("/usr/lib/*/libLLVM*.so*"))
    if libraries:
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", libraries[-1])


def measure(name, contenders, folder, options):
    """Times all contenders in turns, so that whatever else the machine does hits all alike."""
    model = ["--model", options.model.resolve()] if options.model else []
    pov = ["--povray"] if any(contender.name == "POV-Ray" for contender in contenders) else []
    subprocess.run([sys.executable, HERE / "prepare.py", name, folder, *model, *pov], check=True)
    for contender in contenders:
        contender.begin()
    for _ in range(options.runs):
        for contender in contenders:
            if not contender.trouble and sum(contender.seconds) < options.limit:
                contender.run(folder, options.limit)


def report(name, contenders, folder):
    done = [contender for contender in contenders if not contender.trouble]
    pictures = [contender.picture(folder) for contender in done]
    compared = subprocess.run(
        [sys.executable, HERE / "compare.py", pictures[0], *pictures], check=True, capture_output=True, text=True
    )
    for contender, difference in zip(done, compared.stdout.split()):
        seconds, ratio = contender.median(), contender.median() / done[0].median()
        print(f"| {name} | {contender.name} | {seconds:.3f} | {ratio:.2f} | {contender.megabytes} | {difference} |")
    for contender in contenders:
        if contender.trouble:
            print(f"| {name} | {contender.name} | {contender.trouble} | | | |")
    sys.stdout.flush()


def keep(name, contenders, folder, to):
    """Copies the pictures to where they can be looked at."""
    to.mkdir(parents=True, exist_ok=True)
    for contender in contenders:
        if not contender.trouble:
            shutil.copyfile(contender.picture(folder), to / f"{name} {contender.name}.png".replace(" ", "-"))


def run_case(case, options, contenders):
    """All scenes of a case; who runs into trouble takes no part in larger ones."""
    for name in CASES[case]:
        with tempfile.TemporaryDirectory(prefix="firstlight-peers-") as folder:
            folder = Path(folder)
            measure(name, contenders, folder, options)
            if contenders[0].trouble:
                sys.exit(f"error: {name}: firstlight {contenders[0].trouble}")
            report(name, contenders, folder)
            if options.pictures:
                keep(name, contenders, folder, options.pictures)
        contenders = [contender for contender in contenders if not contender.trouble]


def arguments():
    parser = argparse.ArgumentParser(prog="cargo xtask bench --peers", description=__doc__.splitlines()[0])
    names = lambda text: text.lower().split(",")
    parser.add_argument("--firstlight", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--case", type=names, default=list(CASES), help="of " + ", ".join(CASES))
    parser.add_argument("--peer", type=names, default=[], help="of " + ", ".join(PEERS))
    parser.add_argument("--model", type=Path, help="PLY file of triangles for the case dragon, y up (default: a bumpy ball)")
    parser.add_argument("--pictures", type=Path, help="folder to keep the pictures in")
    parser.add_argument("--runs", type=int, default=3, help="runs that medians are taken of (default: 3)")
    parser.add_argument("--limit", type=float, default=150, help="seconds for each renderer and scene (default: 150)")
    options = parser.parse_args()
    check_names(parser, "case", options.case, CASES)
    check_names(parser, "peer", options.peer, PEERS)
    if options.runs < 1 or not (has_package("numpy") and has_package("PIL")):
        parser.error("this takes at least one run and the Python packages numpy and pillow")
    return options


def check_names(parser, option, asked, known):
    for name in asked:
        if name not in known:
            parser.error(f"no {option} {name}; there are {', '.join(known)}")


def has_package(name):
    return importlib.util.find_spec(name) is not None


def main():
    options = arguments()
    find_llvm()
    contenders = renderers(options.firstlight.resolve(), options.peer)
    print("Whole processes, medians. Difference: of the pictures' light in blocks of 16×16 pixels, mean. Cycles and LuxCore")
    print("ask one light a sample, picked at random; the others all.\n")
    print("| scene | renderer | seconds | to ours | MB | difference |\n|---|---|---|---|---|---|", flush=True)
    for case in options.case:
        run_case(case, options, contenders)


if __name__ == "__main__":
    main()
