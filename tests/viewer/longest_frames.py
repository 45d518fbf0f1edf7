#!/usr/bin/env python3
"""Prints how long a window's frames are at most while something is done to a large model.

usage: longest_frames.py BUILD [ROUNDS]

BUILD is a build folder. The model is `armature mesh sample creature --rounds ROUNDS`: 8, as where it is not said, makes
1,310,720 triangles. The window is one of 1280x800 under Xvfb. A line a step: the longest frame in milliseconds, by the
clock and in processor time of the window's thread. Where a line of a step fails, so does this.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

# What is done, and the lines that do it, a frame or more apart. What takes long goes on in the background meanwhile, and
# the next line waits for it.
STEPS = [
    ("nothing", ["wait 2"]),
    ("open", ["open model.off", "wait 4"]),
    ("turn the camera", [f"camera {angle} 10" for angle in range(0, 90, 5)] + ["wait 3"]),
    ("colour by curvature", ["map curvature", "wait 2", "map none", "wait 2"]),
    ("show edges", ["wireframe on", "wait 4", "wireframe off", "wait 4"]),
    ("lasso", ["lasso -0.4 -0.4 0.4 -0.4 0.4 0.4 -0.4 0.4", "wait 2"]),
    ("a cut", ["tool cut", "cut new 0 1 0.5 0.1 1 0.5 0.2 1 0.5", "wait 2", "tool look"]),
    ("compare all vertices", ["similarity gls 1000", "wait 2"]),
    ("displace and smooth", ["edit displace 0.02 map", "wait 3", "edit smooth 0.02 map", "wait 3"]),
    ("keep and take back", ["keep-edit", "wait 3", "undo-edit", "wait 3", "map none", "wait 2"]),
    ("undo and redo a selection", ["undo", "wait 2", "redo", "wait 2"]),
    ("build the hierarchy twice", ["build", "wait 4", "build", "wait 4"]),
    ("drag the level", [f"level {level}" for level in (20, 50, 200, 1000, 5000, 20000, 100000, 400000, 1000, 60)] +
     ["wait 3"]),
    ("begin to pose", ["pose", "wait 4"]),
    ("hold and move", ["handle 3", "translate 0 1 0", "wait 3", "rotate 0 0 1 20", "wait 3"]),
    ("undo and redo the moves", ["undo", "wait 3", "undo", "wait 3", "redo", "wait 3"]),
    ("another level while posing", ["level 30", "wait 3"]),
    ("put it back", ["unpose", "wait 4"]),
    ("close", ["close", "wait 1"]),
]


def main(arguments):
    if not 2 <= len(arguments) <= 3:
        print(__doc__, file=sys.stderr)
        return 2
    programs = Path(arguments[1]).resolve() / "bin"
    rounds = arguments[2] if len(arguments) == 3 else "8"
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([programs / "armature", "mesh", "sample", "creature", "model.off", "--rounds", rounds], cwd=folder,
                       check=True, stdout=subprocess.DEVNULL)
        lines = []
        for _, step in STEPS:
            for line in step:
                lines += [line, "wait 0.02"]
            lines.append("report")
        # A window stays open where a line fails that may not, for people to read why: here they may, and are counted.
        lines = [line if line.startswith(("wait", "report")) else f"try {line}" for line in lines]
        (Path(folder) / "script.txt").write_text("\n".join([*lines, "quit"]) + "\n")
        viewer = subprocess.Popen(["xvfb-run", "-a", "-s", "-screen 0 1400x900x24", programs / "armature-viewer",
                                   "--script", "script.txt"], cwd=folder, stdout=subprocess.PIPE, text=True)
        left, clock, failed = list(STEPS), 0.0, 0
        for line in viewer.stdout:
            name, _, value = line.rstrip().partition(" ")
            if name == "failures" and int(value) > failed:
                print(f"{left[0][0]}: {int(value) - failed} of its lines failed; of no use are their times", file=sys.stderr)
                failed = int(value)
            elif name == "frame.longest_ms":
                clock = float(value)
            elif name == "frame.longest_work_ms":
                print(f"{left.pop(0)[0]:28} {clock:8.1f} ms {float(value):8.1f} ms of its thread", flush=True)
        if viewer.wait() != 0 or left:
            print("the viewer ended before all was done", file=sys.stderr)
            return 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
