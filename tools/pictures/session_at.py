#!/usr/bin/env python3
"""Puts numbers of spheres into a deformation session that names them by places, so that it outlives changes of how
hierarchies are built.

usage: session_at.py ARMATURE H.smh < TEMPLATE > SESSION

@X,Y,Z in TEMPLATE becomes the number of the sphere nearest to that point, of the undeformed level that it is at.
"""
import math
import subprocess
import sys
import tempfile
from pathlib import Path

armature, hierarchy = sys.argv[1:]
spheres = []
for line in sys.stdin:
    words = line.split()
    if words[:1] == ["level"]:
        with tempfile.TemporaryDirectory() as folder:
            level = Path(folder) / "level.ma"
            subprocess.run([armature, "spheremesh", "level", hierarchy, level, "--spheres", words[1]], check=True,
                           stdout=subprocess.DEVNULL)
            spheres = [tuple(map(float, row.split()[1:4])) for row in level.read_text().splitlines() if row[0] == "v"]
    for i, word in enumerate(words):
        if word.startswith("@"):
            point = tuple(map(float, word[1:].split(",")))
            words[i] = str(min(range(len(spheres)), key=lambda s: math.dist(spheres[s], point)))
    print(*words)
