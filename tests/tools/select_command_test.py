#!/usr/bin/env python3
"""Runs `armature select` as a user would.

usage: select_command_test.py BUILD_DIRECTORY
"""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARMATURE = Path(sys.argv[1]) / "bin" / "armature"
CUBE = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
SQUARES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def boxes(*placed):
    """Boxes in OFF, of squares: (shift along x, height) each."""
    lines = [f"OFF\n{8 * len(placed)} {6 * len(placed)} 0"]
    lines += [f"{x + shift} {y} {z * height}" for shift, height in placed for x, y, z in CUBE]
    lines += ["4 " + " ".join(str(corner + 8 * i) for corner in square) for i in range(len(placed)) for square in SQUARES]
    return "\n".join(lines) + "\n"


def table(bumps):
    """A table of side 2 in OFF, 60 x 60 squares, with bumps at (x, y, height)."""
    side = 61
    rows = [(2 * i / 60 - 1, 2 * j / 60 - 1) for i in range(side) for j in range(side)]
    heights = [sum(h * math.exp(-((x - a) ** 2 + (y - b) ** 2) / 0.01) for a, b, h in bumps) for x, y in rows]
    lines = [f"OFF\n{side * side} {60 * 60} 0"] + [f"{x} {y} {z}" for (x, y), z in zip(rows, heights)]
    lines += [f"4 {i * side + j} {(i + 1) * side + j} {(i + 1) * side + j + 1} {i * side + j + 1}"
              for i in range(60) for j in range(60)]
    return "\n".join(lines) + "\n"


def horned_ball(rings=80, around=60, lean=0.0):
    """A ball around the origin with a horn up and one down, in OFF: a surface of revolution, or horns that lean over."""
    profile = []
    for i in range(1, rings):
        t = math.pi * i / rings
        horn = max(0.0, 1 - math.sin(t) / 0.35)  # near the poles
        profile.append((math.sin(t) * (1 if horn == 0 else 1 - 0.2 * horn), math.cos(t) * (1 + 0.8 * horn ** 0.5)))
    points = [(0, 0, profile[0][1] + 0.02)]
    points += [(r * math.cos(2 * math.pi * j / around), r * math.sin(2 * math.pi * j / around), z)
               for r, z in profile for j in range(around)]
    points.append((0, 0, profile[-1][1] - 0.02))
    points = [(x + lean * max(0, abs(z) - 1) ** 2, y, z) for x, y, z in points]
    at = lambda i, j: 1 + i * around + j % around
    faces = [(0, at(0, j), at(0, j + 1)) for j in range(around)]
    faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i in range(rings - 2) for j in range(around)]
    faces += [(len(points) - 1, at(rings - 2, j + 1), at(rings - 2, j)) for j in range(around)]
    lines = [f"OFF\n{len(points)} {len(faces)} 0"] + [" ".join(map(str, p)) for p in points]
    return "\n".join(lines + [" ".join(map(str, (len(f), *f))) for f in faces]) + "\n"


def run(*arguments):
    return subprocess.run([ARMATURE, "select", *map(str, arguments)], capture_output=True, text=True, timeout=300)


class Select(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.mesh = self.file("boxes.off", boxes((0, 1), (3, 4), (6, 1), (9, 2)))

    def file(self, name, content):
        path = Path(self.directory.name) / name
        path.write_text(content)
        return path

    def select(self, gesture, *arguments):
        return self.select_on(None, gesture, *arguments)

    def select_on(self, off, gesture, *arguments):
        mesh = self.mesh if off is None else self.file("other.off", off)
        result = run(mesh, "--gesture", self.file("gesture.json", json.dumps(gesture)), "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.count("\n"), 1)
        return json.loads(result.stdout)

    def assert_refused(self, text, *words):
        path = self.file("refused.json", text)
        result = run(self.mesh, "--gesture", path)
        self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for word in (path, *words):
            self.assertIn(str(word), result.stderr)

    def test_a_part_and_the_one_like_it(self):
        # A ball with two horns.
        result = self.select_on(horned_ball(), {"tool": "part", "stroke": [[0.25, 0, 1.3], [0.18, 0.18, 1.3], [0, 0.25, 1.3]]},
                                "--expand", 1)
        self.assertEqual(set(result["timings_ms"]), {"load", "select", "expand"})
        (match,) = result["matches"]
        self.assertGreater(match["score"], 0.9)
        self.assertTrue(match["reason"])
        self.assertLess(abs(len(match["faces"]) / len(result["reference"]["faces"]) - 1), 0.1)
        self.assertFalse(set(match["faces"]) & set(result["reference"]["faces"]))

    def test_a_part_of_another_mesh_and_those_like_it(self):
        stroke = {"tool": "part", "stroke": [[0.25, 0, 1.3], [0.18, 0.18, 1.3], [0, 0.25, 1.3]]}
        other = self.file("of.off", horned_ball(lean=0.5))
        result = self.select_on(horned_ball(lean=0.5), stroke, "--expand", 2, "--from", other)
        reference = set(result["reference"]["faces"])
        found = [set(match["faces"]) for match in result["matches"]]
        self.assertEqual(len(found), 2)
        self.assertGreater(max(len(faces & reference) for faces in found) / len(reference), 0.98)
        self.assertFalse(found[0] & found[1])

    def test_strokes_that_cannot_be_drawn(self):
        self.assert_refused('{"tool":"part"}', '"stroke"', "is missing")
        self.assert_refused('{"tool":"part","stroke":[]}', '"stroke"', "found none")
        self.assert_refused('{"tool":"part","stroke":[[0,0]]}', "expected three finite numbers")
        self.assert_refused('{"tool":"part","stroke":[[0,0,900]]}', "stroke 0, point 0", "draw within")
        self.assert_refused('{"tool":"part","stroke":[[0,0,0]],"radius":1}', '"radius"')

    def test_a_component_and_the_one_like_it(self):
        result = self.select({"tool": "component", "face": 5}, "--expand", 2)
        self.assertEqual(set(result), {"reference", "matches", "rejected", "timings_ms"})
        self.assertEqual(result["reference"]["faces"], list(range(12)))
        best, second = result["matches"]
        self.assertEqual(best["faces"], list(range(24, 36)))  # two triangles a square
        self.assertAlmostEqual(best["score"], 1, 5)
        self.assertEqual(second["faces"], list(range(36, 48)))
        self.assertLess(second["score"], best["score"])
        for value, expected in zip(best["transform"], [1, 0, 0, -6, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]):
            self.assertAlmostEqual(value, expected, 9)
        self.assertTrue(best["reason"])

    def test_a_component_of_another_mesh_and_those_like_it(self):
        result = self.select({"tool": "component", "face": 5}, "--expand", 9, "--from", self.mesh)
        self.assertEqual(result["matches"][0]["faces"], list(range(12)))
        self.assertEqual(len(result["matches"]), 1 + len(self.select({"tool": "component", "face": 5}, "--expand", 9)["matches"]))

    def test_a_patch_and_its_likes(self):
        self.mesh = self.file("table.off", table([(-0.5, -0.5, 0.2), (0.5, 0.5, 0.2), (0.5, -0.5, 0.08)]))
        gesture = {"tool": "patch", "strokes": [[[-0.5, -0.5, 0.2]]], "radius": 0.1, "background": [[-0.9, -0.9, 0]]}
        result = self.select(gesture, "--expand", 1)
        self.assertGreater(len(result["reference"]["faces"]), 10)
        self.assertGreater(result["matches"][0]["score"], 0.9)
        rows = [result["matches"][0]["transform"][i:i + 4] for i in (0, 4, 8)]
        top = [a * 0.5 + b * 0.5 + c * 0.2 + d for a, b, c, d in rows]  # the bump is round: any turn about it will do
        for value, expected in zip(top, [-0.5, -0.5, 0.2]):
            self.assertAlmostEqual(value, expected, 1)
        self.assertTrue(all(rejected["reason"] for rejected in result["rejected"]))
        other = self.file("other.off", table([(0, 0, 0.2)]))
        gesture = {"tool": "patch", "strokes": [[[0, 0, 0.2]]], "radius": 0.1}
        result = self.select(gesture, "--expand", 2, "--from", other, "--any-size")
        self.assertEqual(len(result["matches"]), 2)
        self.assertGreater(result["matches"][1]["score"], 0.8)

    def test_a_lasso_and_its_likes(self):
        self.mesh = self.file("table.off", table([(-0.5, -0.5, 0.2), (0.5, 0.5, 0.2), (0.5, -0.5, 0.08)]))
        loop = [[-0.7, -0.7, 1], [-0.3, -0.7, 1], [-0.3, -0.3, 1], [-0.7, -0.3, 1]]
        gesture = {"tool": "lasso", "loop": loop, "direction": [0, 0, -1]}
        result = self.select(gesture, "--expand", 1)
        self.assertEqual(len(result["reference"]["faces"]), 2 * 12 * 12)
        self.assertGreater(result["matches"][0]["score"], 0.9)
        self.assertNotEqual(self.select({**gesture, "snap": 0.1})["reference"], result["reference"])
        below = {"tool": "lasso", "loop": [[x, y, -1] for x, y, _ in loop], "eye": [-0.5, -0.5, -9]}
        self.assertGreater(len(self.select(below)["reference"]["faces"]), 0)

    def test_lassos_that_cannot_be_thrown(self):
        self.assert_refused('{"tool":"lasso"}', '"loop"')
        self.assert_refused('{"tool":"lasso","loop":[[0,0,0],[0,0,1],[0,1,1]]}', '"eye"', '"direction"')
        self.assert_refused('{"tool":"lasso","loop":[[0,0,0],[0,0,1],[0,1,1]],"eye":[0,0]}', '"eye"', "three")
        self.assert_refused('{"tool":"lasso","loop":[[0,0,0],[0,0,1],[0,1,1]],"eye":[0,0,9],"through":1}', '"through"', "true or")
        self.assert_refused('{"tool":"lasso","loop":[[0,0,0],[0,0,1],[0,1,1]],"direction":[0,0,0]}', "no direction")
        self.assert_refused('{"tool":"lasso","loop":[[0,0,0],[0,0,1],[0,1,1]],"direction":[1,0,0],"snap":-1}', '"snap"', "-1")

    def test_no_expansion_is_asked_for(self):
        self.assertEqual(self.select({"tool": "component", "face": 5})["matches"], [])

    def test_the_picture_shows_reference_and_matches(self):
        out = Path(self.directory.name) / "like.ply"
        self.select({"tool": "component", "face": 0}, "--expand", 1, "--ply", out)
        faces = out.read_bytes().split(b"end_header\n")[1][-48 * 16:]
        colours = [faces[16 * i + 13:16 * i + 16] for i in range(48)]
        self.assertEqual(len({bytes(c) for c in colours}), 3)
        self.assertGreater(colours[0][0], colours[0][2])
        self.assertGreater(colours[24][2], colours[24][0])

    def test_wrong_gestures_are_refused_with_their_place(self):
        self.assert_refused("", "line 1, column 1")
        self.assert_refused('{"tool":"component",\n"face":}', "line 2, column 8")
        self.assert_refused("[]", "object")
        self.assert_refused('{"face":1}', '"tool"', "missing")
        self.assert_refused('{"tool":"net"}', '"component"', '"net"')
        self.assert_refused('{"tool":"component"}', '"face"', "missing")
        self.assert_refused('{"tool":"component","face":48}', "0 to 47", "48")
        self.assert_refused('{"tool":"component","face":-1}', "-1")
        self.assert_refused('{"tool":"component","face":1.5}', "1.5")
        self.assert_refused('{"tool":"component","face":NaN}', "line 1")
        self.assert_refused('{"tool":"component","face":1e999}', "number")
        self.assert_refused('{"tool":"component","face":1,"face":2}', '"face"', "twice")
        self.assert_refused('{"tool":"component","face":1,"faces":2}', '"faces"', "no key")
        self.assert_refused("[" * 100_000, "line 1")
        self.assert_refused('{"tool":"patch","strokes":[[[0,0,0]]]}', '"radius"')
        self.assert_refused('{"tool":"patch","strokes":[[[0,0,0]]],"radius":-1}', '"radius"', "-1")
        self.assert_refused('{"tool":"patch","strokes":[],"radius":1}', '"strokes"')
        self.assert_refused('{"tool":"patch","strokes":[[]],"radius":1}', '"strokes"[0]', "none")
        self.assert_refused('{"tool":"patch","strokes":[[[0,0,0],[0,"a",0]]],"radius":1}', '"strokes"[0][1]')
        self.assert_refused('{"tool":"patch","strokes":[[[0,0,0]]],"radius":1,"background":[[[0,0]]]}', '"background"[0][0]')
        self.assert_refused('{"tool":"patch","strokes":[[[0,0,0]],[[99,0,0]]],"radius":1}', "strokes[1], point 0", "5 %")

    def test_wrong_use_exits_2(self):
        for arguments in ((), (self.mesh,), (self.mesh, "--gesture", "g.json", "--expand", "-1")):
            self.assertEqual(run(*arguments).returncode, 2, arguments)
        self.assertEqual(run(self.mesh, "--gesture", "missing.json").returncode, 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
