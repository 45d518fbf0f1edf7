#!/usr/bin/env python3
"""Runs `armature spheremesh` as a user would.

usage: spheremesh_command_test.py BUILD_DIRECTORY
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARMATURE = Path(sys.argv[1]) / "bin" / "armature"


def run(*arguments):
    return subprocess.run([ARMATURE, *map(str, arguments)], capture_output=True, text=True, timeout=300)


class SphereMeshBuild(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.here = Path(self.directory.name)
        self.ball = self.here / "ball.off"
        self.assertEqual(run("mesh", "sample", "ball", self.ball, "--rounds", 3).returncode, 0)
        lines = self.ball.read_text().splitlines()
        self.vertices = [tuple(map(float, line.split())) for line in lines[2 : 2 + int(lines[1].split()[0])]]
        self.faces = lines[2 + len(self.vertices) :]

    def file(self, name, content):
        path = self.here / name
        path.write_text(content)
        return path

    def build(self, mesh, *options):
        """The spheres, (x, y, z, radius) each."""
        out = self.here / "out.ma"
        result = run("spheremesh", "build", mesh, out, "--json", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        spheres = [tuple(map(float, line.split()[1:])) for line in out.read_text().splitlines() if line[0] == "v"]
        self.assertEqual(json.loads(result.stdout)["spheres"], len(spheres))
        return spheres

    def assert_refused(self, code, words, *options):
        out = self.here / "refused.ma"
        result = run("spheremesh", "build", self.ball, out, *options)
        self.assertEqual(result.returncode, code, result.stderr)
        for word in words:
            self.assertIn(str(word), result.stderr)
        if code == 1:
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertFalse(out.exists())

    def test_pinned_spheres_stay_through_collapses_and_refinement(self):
        pins = self.file("pins.txt", "# a wart, and a vertex that stays\n\n7 0.5 0 0.25 0.125\r\n100  # alone\n")
        for options in ((), ("--refine",)):
            spheres = self.build(self.ball, "--spheres", 6, "--pin", pins, *options)
            self.assertEqual(len(spheres), 6)
            for sphere in ((0.5, 0, 0.25, 0.125), (*self.vertices[100], 0)):
                nearest = min(max(abs(a - b) for a, b in zip(sphere, other)) for other in spheres)
                self.assertLess(nearest, 1e-6)

    def test_labels_are_never_joined(self):
        upper = [z > 0.3 for x, y, z in self.vertices]
        labels = self.file("labels.txt", "".join(f"{int(up)}\n" for up in upper))
        spheres = self.build(self.ball, "--spheres", 2, "--labels", labels)
        self.assertLess(spheres[0][3], 1.0)
        self.assertEqual(len(self.build(self.ball, "--spheres", 2, "--labels", labels, "--refine")), 2)
        self.assert_refused(1, [self.ball, "--labels", "no fewer than 2 spheres", "1 were asked for"],
                            "--labels", labels, "--spheres", 1)

        colours = ["255 0 0" if up else "0 0 255" for up in upper]
        header = f"ply\nformat ascii 1.0\nelement vertex {len(upper)}\n"
        header += "".join(f"property float {axis}\n" for axis in "xyz")
        header += "".join(f"property uchar {colour}\n" for colour in ("red", "green", "blue"))
        header += f"element face {len(self.faces)}\nproperty list uchar uint vertex_indices\nend_header\n"
        rows = [f"{x!r} {y!r} {z!r} {colour}" for (x, y, z), colour in zip(self.vertices, colours)]
        painted = self.file("painted.ply", header + "\n".join(rows + self.faces) + "\n")
        self.assertEqual(len(self.build(painted, "--spheres", 2, "--painted")), 2)
        for by_paint, by_label in zip(self.build(painted, "--spheres", 9, "--painted"),
                                      self.build(self.ball, "--spheres", 9, "--labels", labels)):
            for a, b in zip(by_paint, by_label):
                self.assertAlmostEqual(a, b, 4)

    def test_constraints_that_do_not_fit_are_refused_by_file_and_line(self):
        count = len(self.vertices)
        for text, words in (("1\n999999\n", (":", "line 2", f"below {count}", "found '999999'")),
                            ("one\n", ("line 1", "found 'one'")), ("-1\n", ("line 1", "found '-1'")),
                            ("1\n\n1\n", ("line 3", "vertex 1 is pinned already")),
                            ("1 0 0\n", ("line 1", "VERTEX X Y Z RADIUS", "the line ends here")),
                            ("1 0 0 nan 1\n", ("line 1", "finite", "found 'nan'")),
                            ("1 0 0 0 -1\n", ("line 1", "not negative", "found '-1'")),
                            ("1 0 0 0 1 2\n", ("line 1", "nothing behind"))):
            pins = self.file("pins.txt", text)
            self.assert_refused(1, (pins, *words), "--pin", pins)
        for text, words in (("0\nred\n", ("line 2", "found 'red'")), ("0 1\n", ("line 1", "one label a line")),
                            ("0\n", (f"expected {count} labels", "found 1")),
                            ("0\n" * (count + 1), (f"line {count + 1}", f"no more than {count}"))):
            labels = self.file("labels.txt", text)
            self.assert_refused(1, (labels, *words), "--labels", labels)
        self.assert_refused(1, (self.here / "none.txt", "cannot be read"), "--pin", self.here / "none.txt")
        self.assert_refused(1, (self.here, "cannot be read"), "--labels", self.here)
        self.assert_refused(1, (self.ball, "--painted", "it has none"), "--painted")
        self.assert_refused(2, ("excludes",), "--painted", "--labels", "labels.txt")

    def test_what_cannot_go_together_is_refused(self):
        self.assert_refused(2, ("excludes",), "--keep-topology", "--enrich", "0.1")
        self.assert_refused(2, ("excludes",), "--inner", "--outer")
        self.file("ball.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.assert_refused(1, (self.ball, "closed mesh", "3 edges"), "--inner", "--spheres", 2)
        self.assert_refused(1, (self.ball, "4 spheres from 3 vertices"), "--spheres", 4)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
