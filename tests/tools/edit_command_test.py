#!/usr/bin/env python3
"""Runs `armature edit` as a user would.

usage: edit_command_test.py BUILD_DIRECTORY
"""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARMATURE = Path(sys.argv[1]) / "bin" / "armature"
CELLS = 60
BUMPS = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5)]


def run(*arguments):
    return subprocess.run([ARMATURE, *map(str, arguments)], capture_output=True, text=True, timeout=300)


def table():
    """A table of side 2 in OFF with three bumps that are alike."""
    rows = [(2 * i / CELLS - 1, 2 * j / CELLS - 1) for i in range(CELLS + 1) for j in range(CELLS + 1)]
    lines = [f"OFF\n{len(rows)} {CELLS * CELLS} 0"]
    lines += [f"{x} {y} {sum(0.2 * math.exp(-((x - a) ** 2 + (y - b) ** 2) / 0.01) for a, b in BUMPS)}" for x, y in rows]
    at = lambda i, j: i * (CELLS + 1) + j
    lines += [f"4 {at(i, j)} {at(i + 1, j)} {at(i + 1, j + 1)} {at(i, j + 1)}"
              for i in range(CELLS) for j in range(CELLS)]
    return "\n".join(lines) + "\n"


def vertices(path):
    lines = [line for line in path.read_text().split("\n") if line and not line.startswith("#")]
    return [tuple(map(float, line.split()[:3])) for line in lines[2 : 2 + int(lines[1].split()[0])]]


class Edit(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.here = Path(self.directory.name)
        self.mesh = self.file("table.off", table())
        x, y = BUMPS[0]
        self.gesture = self.file("gesture.json", json.dumps(
            {"tool": "patch", "strokes": [[[x - 0.05, y, 0.16], [x + 0.05, y, 0.16]]], "radius": 0.12}))

    def file(self, name, content):
        path = self.here / name
        path.write_text(content)
        return path

    def edit(self, out, *arguments):
        result = run("edit", self.mesh, self.here / out, "--gesture", self.gesture, "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.count("\n"), 1)
        return json.loads(result.stdout)

    def refused(self, status, said, *arguments):
        result = run("edit", *arguments)
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertIn(said, result.stderr)
        self.assertEqual(result.stdout, "")
        if status == 1:
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def heights(self, out):
        points = {(round(x, 6), round(y, 6)): z for x, y, z in vertices(self.here / out)}
        return [points[bump] for bump in BUMPS], points[(0.5, 0.5)]

    def test_what_is_done_to_one_bump_is_done_to_its_likes(self):
        told = self.edit("pulled.off", "--op", "pull", "--amount", 0.05, "--expand", 2)
        self.assertEqual(set(told), {"matches", "moved", "farthest", "select_ms", "edit_ms"})
        self.assertEqual(told["matches"], 2)
        (first, *others), flat = self.heights("pulled.off")
        diagonal = math.dist((-1, -1, 0), (1, 1, 0.2))
        self.assertAlmostEqual(first, 0.2 + 0.05 * diagonal, delta=0.002 * diagonal)
        for other in others:
            self.assertAlmostEqual(other, first, delta=0.01 * diagonal)  # the goal: 1 % of the diagonal
        self.assertLess(flat, 1e-12)

    def test_every_map_displaces_what_is_like_the_selection(self):
        for name in ("gls", "gls-histogram", "quadric", "hks", "si-hks", "wks", "psc"):
            told = self.edit(f"{name}.off", "--op", "displace", "--amount", 0.01, "--map", name)
            self.assertGreater(told["moved"], 0, name)
            self.assertLessEqual(told["farthest"], 0.01 * math.dist((-1, -1, 0), (1, 1, 0.2)) * 1.0001, name)

    def test_every_operation_writes_a_mesh(self):
        for op, amount, *more in (("smooth", 0.02), ("sharpen", 0.5), ("paint", 1), ("displace", 0.01, "--expand", 2),
                                  ("smooth", 0.02, "--expand", 2), ("paint", 1, "--expand", 2),
                                  ("copy", 1, "--expand", 2), ("alike", 1, "--expand", 2), ("alike", -0.5, "--expand", 2)):
            self.edit("out.ply", "--op", op, "--amount", amount, *more)
            self.assertTrue((self.here / "out.ply").read_bytes().startswith(b"ply"))

    def points(self, out):
        result = run("mesh", "points", self.mesh, out, "--count", 4000)
        self.assertEqual(result.returncode, 0, result.stderr)
        return out

    def test_points_are_coloured_and_displaced_by_their_likeness(self):
        scan = self.points(self.here / "scan.xyz")
        before = [tuple(map(float, line.split())) for line in scan.read_text().splitlines()]
        for name in ("gls", "gls-histogram"):
            result = run("edit", scan, self.here / "out.xyz", "--gesture", self.gesture, "--op", "displace", "--amount", 0.01,
                         "--map", name, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertGreater(json.loads(result.stdout)["moved"], 0)
        result = run("edit", scan, self.here / "out.obj", "--gesture", self.gesture, "--op", "paint", "--amount", 1)
        self.assertEqual(result.returncode, 0, result.stderr)
        painted = [tuple(map(float, line.split()[1:])) for line in (self.here / "out.obj").read_text().splitlines()
                   if line.startswith("v ")]
        self.assertEqual([p[:3] for p in painted], [p[:3] for p in before])
        blue = [p for p in painted if p[3] < 0.3]
        self.assertTrue(blue)
        for bump in BUMPS:  # all three, and nothing far from them
            self.assertTrue(any(math.dist(p[:2], bump) < 0.15 for p in blue), bump)
        for p in blue:
            self.assertLess(min(math.dist(p[:2], bump) for bump in BUMPS), 0.3)
        self.assertEqual(run("edit", scan, self.here / "out.ply", "--gesture", self.gesture, "--op", "paint", "--amount",
                             1).returncode, 0)
        self.assertIn(b"property uchar red", (self.here / "out.ply").read_bytes())

    def test_what_needs_faces_says_so_of_points(self):
        scan = self.points(self.here / "scan.ply")
        out = self.here / "out.ply"
        paint = ("--op", "paint", "--amount", 1)
        said = "points and no faces; "
        self.refused(1, said + "--op", scan, out, "--gesture", self.gesture, "--op", "smooth", "--amount", 0.1)
        self.refused(1, said + "--map", scan, out, "--gesture", self.gesture, *paint, "--map", "quadric")
        self.refused(1, said + "--expand", scan, out, "--gesture", self.gesture, *paint, "--expand", 2)
        self.refused(1, "there is no face to click on", scan, out, "--gesture",
                     self.file("click.json", '{"tool":"component","face":0}'), *paint)
        self.refused(1, said + "a gesture of the tool patch", scan, out, "--gesture",
                     self.file("cut.json", '{"tool":"part","stroke":[[0,0,0],[1,0,0]]}'), *paint)
        self.refused(1, "no point lies within", scan, out, "--gesture",
                     self.file("far.json", '{"tool":"patch","strokes":[[[9,9,9]]],"radius":0.1}'), *paint)
        self.refused(1, "points are written as", scan, self.here / "out.off", "--gesture", self.gesture, *paint)
        self.refused(1, "expected a name that ends in .ply", self.mesh, self.here / "out.xyz", "--gesture", self.gesture, *paint)
        self.refused(1, "out.xyz: XYZ keeps no colours", scan, self.here / "out.xyz", "--gesture", self.gesture, *paint)
        self.assertFalse(out.exists())

    def test_amounts_that_leave_nothing_finite_are_refused(self):
        scan = self.points(self.here / "scan.ply")
        out = self.here / "out.ply"
        for amount in (1e200, 1e300, 1e308):
            for shape in (scan, self.mesh):
                self.refused(1, f"--amount: {amount} moves vertices beyond all numbers", shape, out, "--gesture",
                             self.gesture, "--op", "displace", "--amount", amount)
            for op in ("pull", "displace"):
                self.refused(1, "--amount", self.mesh, out, "--gesture", self.gesture, "--op", op, "--amount", amount,
                             "--expand", 2)
        self.refused(1, "--amount", self.mesh, out, "--gesture", self.gesture, "--op", "sharpen", "--amount", 1e308)
        self.assertFalse(out.exists())
        self.assertEqual(self.edit("out.ply", "--op", "displace", "--amount", 1e100)["moved"] > 0, True)

    def test_more_likes_than_there_are_is_no_mistake(self):
        told = self.edit("out.off", "--op", "displace", "--amount", 0.01, "--expand", 100000)
        self.assertLess(told["matches"], 100000)

    def test_without_anything_alike_the_selection_alone_is_edited(self):
        box = ("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        click = self.file("click.json", '{"tool":"component","face":0}')
        result = run("edit", self.file("box.off", box), self.here / "out.off", "--gesture", click, "--op", "displace",
                     "--amount", 0.1, "--expand", 5, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["matches"], 0)

    def test_what_is_wrong_is_told_in_one_line(self):
        out = self.here / "out.off"
        fine = ("--op", "displace", "--amount", 0.1)
        self.refused(1, "nothing.off", self.here / "nothing.off", out, "--gesture", self.gesture, *fine)
        self.refused(1, "nothing.json", self.mesh, out, "--gesture", self.here / "nothing.json", *fine)
        self.refused(1, "bad.json", self.mesh, out, "--gesture", self.file("bad.json", "{"), *fine)
        self.refused(2, "out.txt: expected a name that ends in", self.mesh, self.here / "out.txt", "--gesture", self.gesture,
                     *fine)
        self.refused(1, "--expand", self.mesh, out, "--gesture", self.gesture, "--op", "copy", "--amount", 1)
        self.refused(1, "--expand", self.mesh, out, "--gesture", self.gesture, "--op", "alike", "--amount", 1)
        self.refused(1, "--to", self.mesh, out, "--gesture", self.gesture, *fine, "--from", 0.9, "--to", 0.1)
        self.refused(1, "--amount", self.mesh, out, "--gesture", self.gesture, "--op", "displace", "--amount", "inf")
        self.assertFalse(out.exists())

    def test_maps_that_tell_components_apart_alone_are_refused(self):
        tetrahedra = [(x + 2 * k, y, z) for k in range(120) for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
        faces = [tuple(4 * k + c for c in f) for k in range(120) for f in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
        off = "\n".join([f"OFF\n{len(tetrahedra)} {len(faces)} 0"] + [" ".join(map(str, p)) for p in tetrahedra] +
                        [" ".join(map(str, (3, *f))) for f in faces]) + "\n"
        self.refused(1, "120 components", self.file("many.off", off), self.here / "out.off", "--gesture",
                     self.file("click.json", '{"tool":"component","face":0}'), "--op", "displace", "--amount", 0.1, "--map",
                     "hks")

    def test_wrong_use_is_told(self):
        out = self.here / "out.off"
        self.refused(2, "--gesture", self.mesh, out, "--op", "displace", "--amount", 0.1)
        self.refused(2, "--op", self.mesh, out, "--gesture", self.gesture, "--amount", 0.1)
        self.refused(2, "--op", self.mesh, out, "--gesture", self.gesture, "--op", "melt", "--amount", 0.1)
        self.refused(2, "--map", self.mesh, out, "--gesture", self.gesture, "--op", "displace", "--amount", 0.1, "--map",
                     "taste")
        self.refused(2, "--amount", self.mesh, out, "--gesture", self.gesture, "--op", "displace")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
