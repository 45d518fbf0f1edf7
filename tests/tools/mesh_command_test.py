#!/usr/bin/env python3
"""Runs `armature mesh` as a user would.

usage: mesh_command_test.py BUILD_DIRECTORY
"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARMATURE = Path(sys.argv[1]) / "bin" / "armature"
MODELS = Path(__file__).resolve().parents[3] / "shared" / "data" / "meshes"
KEYS = ["vertices", "faces", "components", "boundary_loops", "nonmanifold_edges", "degenerate_faces", "closed",
        "oriented", "genus", "bbox_diagonal"]
TETRAHEDRON = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"


def run(*arguments):
    return subprocess.run([ARMATURE, "mesh", *map(str, arguments)], capture_output=True, text=True, timeout=300)


class MeshInfo(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)

    def file(self, name, content):
        path = Path(self.directory.name) / name
        path.write_text(content)
        return path

    def info(self, path):
        result = run("info", path, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.count("\n"), 1)
        return json.loads(result.stdout)

    def assert_refused(self, path, *words):
        result = run("info", path, "--json")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for word in (path, *words):
            self.assertIn(str(word), result.stderr)

    def test_a_tetrahedron(self):
        report = self.info(self.file("tetrahedron.off", TETRAHEDRON))
        self.assertEqual(list(report)[: len(KEYS)], KEYS)
        self.assertEqual([report[key] for key in KEYS[:-1]], [4, 4, 1, 0, 0, 0, True, True, 0])
        self.assertAlmostEqual(report["bbox_diagonal"], 3 ** 0.5)

    def test_a_surface_with_one_side_has_no_genus(self):
        faces = "f 1 3 4\nf 1 4 2\nf 3 5 6\nf 3 6 4\nf 5 2 1\nf 5 1 6\n"
        strip = self.file("strip.obj", "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 0 1 0\nv 0 1 1\n" + faces)
        report = self.info(strip)
        self.assertFalse(report["oriented"])
        self.assertIsNone(report["genus"])

    def test_what_is_wrong_is_told_to_people(self):
        result = run("info", self.file("open.off", TETRAHEDRON.replace("4 4 6", "4 3 6").replace("3 0 3 2\n", "")))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("1 hole", result.stdout)

    def test_bad_files_are_refused_with_their_place(self):
        self.assert_refused(self.file("index.off", TETRAHEDRON.replace("3 0 3 2", "3 0 9 2")), "line 10", "found '9'")
        self.assert_refused(self.file("cut.obj", "v 0 0 0\nv 1 0"), "line 2", "three coordinates")
        self.assert_refused(self.file("empty.stl", ""))
        self.assert_refused(Path(self.directory.name) / "missing.ply", "No such file")

    def test_wrong_use_exits_2(self):
        for arguments in ((), ("info",), ("info", "a.off", "--yaml"), ("ponder", "a.off")):
            self.assertEqual(run(*arguments).returncode, 2, arguments)

    @unittest.skipUnless(MODELS.is_dir(), "the models are not here")
    def test_every_model_is_reported_or_refused(self):
        broken = {"geo_corrupted_invalid_double.obj", "geo_corrupted_invalid_facet_vertex.off", "geo_truncated.obj",
                  "geo_truncated.off", "geo_truncated.ply", "geo_truncated.stl", "tm_empty.obj", "tm_empty.ply",
                  "tm_empty.stl"}
        for path in sorted(MODELS.iterdir()):
            with self.subTest(path.name):
                if path.name in broken:
                    self.assert_refused(path)
                else:
                    self.assertGreater(self.info(path)["faces"], 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
