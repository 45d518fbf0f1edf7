#!/usr/bin/env python3
"""Runs `armature decimate` as a user would.

usage: decimate_command_test.py BUILD_DIRECTORY
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


class Decimate(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.here = Path(self.directory.name)
        self.mesh = self.here / "creature.off"
        self.assertEqual(run("mesh", "sample", "creature", self.mesh, "--rounds", 3).returncode, 0)

    def decimate(self, out, *arguments):
        result = run("decimate", self.mesh, self.here / out, "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.count("\n"), 1)
        return json.loads(result.stdout)

    def refused(self, status, said, *arguments):
        result = run("decimate", *arguments)
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertIn(said, result.stderr)
        self.assertEqual(result.stdout, "")
        if status == 1:
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_spheres_come_in_fewer_steps_than_collapses(self):
        told = self.decimate("c.ma", "--target", 40)
        self.assertEqual(set(told), {"levels", "collapses", "descriptor_ms", "counterparts_ms", "decimate_ms", "read_ms"})
        self.assertEqual(told["collapses"], 642 - 40)
        self.assertLess(2 * told["levels"], told["collapses"])
        self.assertEqual((self.here / "c.ma").read_text().split()[0], "40")

    def test_threshold_0_is_the_plain_hierarchy(self):
        told = self.decimate("a.ma", "--target", 40, "--similar", 0, "--hierarchy", self.here / "a.smh")
        self.assertEqual(told["levels"], told["collapses"])
        result = run("spheremesh", "build", self.mesh, self.here / "b.ma", "--spheres", 40, "--hierarchy",
                     self.here / "b.smh")
        self.assertEqual(result.returncode, 0, result.stderr)
        for kind in ("ma", "smh"):
            self.assertEqual((self.here / f"a.{kind}").read_bytes(), (self.here / f"b.{kind}").read_bytes())

    def test_an_adaptive_threshold_condenses_too(self):
        told = self.decimate("c.ma", "--target", 40, "--adaptive")
        self.assertLess(2 * told["levels"], told["collapses"])

    def test_every_descriptor_works(self):
        for name in ("gls-histogram", "gls-mean", "quadric", "gls-scaled", "gls-merged"):
            told = self.decimate("c.ma", "--target", 100, "--descriptor", name)
            self.assertLessEqual(told["levels"], told["collapses"])

    def test_a_mesh_comes_out_as_a_mesh(self):
        told = self.decimate("c.off", "--target", 100, "--kind", "mesh")
        self.assertEqual(told["collapses"], 642 - 100)
        self.assertEqual((self.here / "c.off").read_text().split()[1], "100")

    def test_a_hierarchy_can_be_walked_by_other_commands(self):
        self.decimate("c.ma", "--target", 40, "--hierarchy", self.here / "c.smh")
        result = run("spheremesh", "level", self.here / "c.smh", self.here / "l.ma", "--spheres", 40)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((self.here / "l.ma").read_bytes(), (self.here / "c.ma").read_bytes())

    def test_points_are_decimated_as_meshes_are(self):
        scan = self.here / "scan.xyz"
        self.assertEqual(run("mesh", "points", self.mesh, scan, "--count", 2000).returncode, 0)
        for name in ("gls-histogram", "gls-mean", "quadric"):
            result = run("decimate", scan, self.here / "p.ma", "--target", 40, "--descriptor", name, "--json", "--hierarchy",
                         self.here / "p.smh")
            self.assertEqual(result.returncode, 0, result.stderr)
            told = json.loads(result.stdout)
            self.assertEqual(told["collapses"], len(scan.read_text().splitlines()) - 40)
            self.assertLess(told["levels"], told["collapses"])
        level = run("spheremesh", "level", self.here / "p.smh", self.here / "l.ma", "--spheres", 40)
        self.assertEqual(level.returncode, 0, level.stderr)
        self.assertEqual((self.here / "l.ma").read_bytes(), (self.here / "p.ma").read_bytes())
        self.assertEqual(run("decimate", scan, self.here / "p.ma", "--target", 40, "--adaptive").returncode, 0)
        # The mean distance from the mesh itself, in percent of its diagonal.
        told = json.loads(run("spheremesh", "measure", self.mesh, self.here / "p.ma", "--json").stdout)
        self.assertLess(told["mean_input_to_approximation"], 0.5)

    def test_threshold_0_is_the_plain_hierarchy_of_points_too(self):
        scan = self.here / "scan.ply"
        self.assertEqual(run("mesh", "points", self.mesh, scan).returncode, 0)
        for command in (["decimate", scan, self.here / "a.ma", "--target", 40, "--similar", 0, "--hierarchy", self.here / "a.smh"],
                        ["spheremesh", "build", scan, self.here / "b.ma", "--spheres", 40, "--hierarchy", self.here / "b.smh"]):
            result = run(*command)
            self.assertEqual(result.returncode, 0, result.stderr)
        for kind in ("ma", "smh"):
            self.assertEqual((self.here / f"a.{kind}").read_bytes(), (self.here / f"b.{kind}").read_bytes())

    def test_what_needs_faces_says_so(self):
        scan = self.here / "scan.obj"
        self.assertEqual(run("mesh", "points", self.mesh, scan, "--count", 100).returncode, 0)
        out = self.here / "c.ma"
        for command in (["decimate", scan, self.here / "c.off", "--target", 5, "--kind", "mesh"],
                        ["mesh", "info", scan],
                        ["spheremesh", "measure", scan, out],
                        ["spheremesh", "build", scan, out, "--refine"],
                        ["spheremesh", "build", scan, out, "--importance", 1],
                        ["spheremesh", "build", scan, out, "--paper"]):
            result = run(*command)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertRegex(result.stderr, "scan.obj: has [0-9]+ points and no faces(; | to tell curvature by; )")
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn("add --importance 0 to --paper", result.stderr)
        self.assertFalse(out.exists())
        self.assertEqual(run("spheremesh", "build", scan, out, "--paper", "--importance", 0).returncode, 0)

    def test_areas_that_cannot_be_are_refused(self):
        scan = self.here / "scan.ply"
        names = ("x", "y", "z", "nx", "ny", "nz", "area")
        for area in (0, "1e-320", "1e34", "1e80"):
            rows = [f"{x} {y} {z} {x} {y} {z} {area}" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
            scan.write_text("ply\nformat ascii 1.0\nelement vertex 8\n" +
                            "".join(f"property double {name}\n" for name in names) + "end_header\n" +
                            "\n".join(rows) + "\n")
            for command in ("decimate", scan, self.here / "c.ma", "--target", 3), \
                           ("spheremesh", "build", scan, self.here / "c.ma", "--spheres", 3):
                result = run(*command)
                self.assertEqual(result.returncode, 1, area)
                self.assertIn("scan.ply: areas: expected what fits the points' places", result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_people_are_told_what_came_out(self):
        result = run("decimate", self.mesh, self.here / "c.ma", "--target", 40)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("40 spheres", result.stdout)
        self.assertIn("602 collapses in", result.stdout)

    def test_what_is_wrong_is_told_in_one_line(self):
        out = self.here / "c.ma"
        self.refused(1, "nothing.off", self.here / "nothing.off", out, "--target", 5)
        self.refused(1, "has 642 vertices", self.mesh, out, "--target", 643)
        self.refused(1, "expected a name that ends in .ma", self.mesh, self.here / "c.off", "--target", 5)
        self.refused(1, "--hierarchy", self.mesh, self.here / "c.off", "--target", 5, "--kind", "mesh", "--hierarchy",
                     self.here / "c.smh")
        empty = self.here / "empty.off"
        empty.write_text("OFF\n0 0 0\n")
        self.refused(1, "empty.off", empty, out, "--target", 1)
        self.assertFalse(out.exists())

    def test_wrong_use_is_told(self):
        out = self.here / "c.ma"
        self.refused(2, "--target", self.mesh, out)
        self.refused(2, "--target", self.mesh, out, "--target", 0)
        self.refused(2, "--descriptor", self.mesh, out, "--target", 5, "--descriptor", "colour")
        self.refused(2, "--similar", self.mesh, out, "--target", 5, "--similar", -1)
        self.refused(2, "--adaptive", self.mesh, out, "--target", 5, "--similar", 0.3, "--adaptive")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
