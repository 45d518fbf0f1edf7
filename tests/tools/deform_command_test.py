#!/usr/bin/env python3
"""Runs `armature spheremesh deform` and `session` as a user would.

usage: deform_command_test.py BUILD_DIRECTORY
"""
import json
import math
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ARMATURE = Path(sys.argv[1]) / "bin" / "armature"
ANIMAL = Path(__file__).resolve().parents[2] / "tools/pictures/animal.py"
LEVEL = 12


def run(*arguments):
    return subprocess.run([ARMATURE, *map(str, arguments)], capture_output=True, text=True, timeout=300)


def vertices_of_off(path):
    lines = path.read_text().split("\n")
    return [tuple(map(float, line.split()[:3])) for line in lines[2 : 2 + int(lines[1].split()[0])]]


class SphereMeshDeform(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)
        self.here = Path(self.directory.name)
        self.mesh, self.hierarchy = self.build("creature", 3)
        self.vertices = vertices_of_off(self.mesh)
        low, high = ([pick(axis) for axis in zip(*self.vertices)] for pick in (min, max))
        self.diagonal = math.dist(low, high)

    def build(self, sample, rounds):
        mesh = self.here / f"{sample}_{rounds}.off"
        hierarchy = mesh.with_suffix(".smh")
        self.assertEqual(run("mesh", "sample", sample, mesh, "--rounds", rounds).returncode, 0)
        return mesh, self.hierarchy_of(mesh)

    def hierarchy_of(self, mesh):
        hierarchy = mesh.with_suffix(".smh")
        result = run("spheremesh", "build", mesh, mesh.with_suffix(".ma"), "--spheres", 5, "--hierarchy", hierarchy)
        self.assertEqual(result.returncode, 0, result.stderr)
        return hierarchy

    def moves(self, content):
        path = self.here / "moves.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    def deform(self, moves, *options, level=LEVEL, mesh=None, hierarchy=None):
        out = self.here / "out.off"
        result = run("spheremesh", "deform", mesh or self.mesh, hierarchy or self.hierarchy, self.moves(moves), out,
                     "--level", level, "--json", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return vertices_of_off(out), json.loads(result.stdout)

    def assert_refused(self, words, moves="[]", code=1, level=LEVEL, mesh=None, hierarchy=None, out="out.ply"):
        out = self.here / out
        result = run("spheremesh", "deform", mesh or self.mesh, hierarchy or self.hierarchy, self.moves(moves), out,
                     "--level", level)
        self.assertEqual(result.returncode, code, result.stderr)
        for word in words:
            self.assertIn(str(word), result.stderr)
        if code == 1:
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertFalse(out.exists())

    def assert_everywhere(self, deformed, expected, tolerance):
        self.assertEqual(len(deformed), len(self.vertices))
        worst = max(math.dist(a, expected(b)) for a, b in zip(deformed, self.vertices))
        self.assertLessEqual(worst, tolerance * self.diagonal)

    def test_without_moves_every_vertex_stays(self):
        everything = {"spheres": list(range(LEVEL))}
        for moves in ([], [{"spheres": []}], [everything], [everything | {"rotate": [0, 0, 0], "scale": 1}]):
            deformed, said = self.deform(moves)
            self.assert_everywhere(deformed, lambda p: p, 1e-12)
            self.assertEqual(said["moved_vertices"], 0)

    def test_all_spheres_moved_rigidly_move_the_mesh_rigidly(self):
        move = {"spheres": list(range(LEVEL)), "rotate": [0, 0, math.pi / 2], "about": [1, 0, 0], "translate": [0, 0, 3]}
        for options in ((), ("--blend", "linear"), ("--weights", "primitives")):
            deformed, said = self.deform([move], *options)
            self.assert_everywhere(deformed, lambda p: (1 - p[1], p[0] - 1, p[2] + 3), 1e-9)
            self.assertEqual(said["moved_vertices"], len(self.vertices))

    def test_spheres_have_the_numbers_that_level_writes(self):
        level = self.here / "level.ma"
        self.assertEqual(run("spheremesh", "level", self.hierarchy, level, "--spheres", LEVEL).returncode, 0)
        spheres = [tuple(map(float, line.split()[1:])) for line in level.read_text().splitlines() if line[0] == "v"]
        for sphere in range(LEVEL):
            deformed, _ = self.deform([{"spheres": [sphere], "translate": [0, 0, 1]}])
            most = max(range(len(deformed)), key=lambda v: deformed[v][2] - self.vertices[v][2])
            # Nearer to this sphere's surface than the middle of the others'.
            gaps = [abs(math.dist(self.vertices[most], s[:3]) - s[3]) for s in spheres]
            self.assertLess(gaps[sphere], sorted(gaps)[LEVEL // 2])

    def test_moves_come_one_after_the_other(self):
        one = [{"spheres": [3], "translate": [0, 0, 1], "rotate": [0, 1, 0], "about": [0, 0, 0]}]
        two = [{"spheres": [3], "rotate": [0, 1, 0], "about": [0, 0, 0]}, {"spheres": [3], "translate": [0, 0, 1]}]
        a, _ = self.deform(one)
        b, _ = self.deform(two)
        self.assertLess(max(math.dist(p, q) for p, q in zip(a, b)), 1e-9)

    def test_a_radius_makes_the_shape_swell(self):
        level = self.here / "level.ma"
        self.assertEqual(run("spheremesh", "level", self.hierarchy, level, "--spheres", 1).returncode, 0)
        radius = float(level.read_text().splitlines()[1].split()[4])
        deformed, _ = self.deform([{"spheres": [0], "radius": 1.5 * radius}], level=1)
        wider = [max(p[0] for p in points) - min(p[0] for p in points) for points in (deformed, self.vertices)]
        self.assertGreater(wider[0], wider[1] + radius / 2)

    def test_counterparts_move_likewise_in_their_own_frames(self):
        mesh, level, hierarchy = (self.here / name for name in ("animal.off", "animal.ma", "animal.smh"))
        subprocess.run([sys.executable, ANIMAL, mesh, "0.025"], check=True)
        made = run("decimate", mesh, level, "--target", 40, "--hierarchy", hierarchy)
        self.assertEqual(made.returncode, 0, made.stderr)
        spheres = [tuple(map(float, line.split()[1:])) for line in level.read_text().splitlines() if line[0] == "v"]
        up = 1  # the lowest four are the feet
        feet = sorted(range(40), key=lambda s: spheres[s][up])[:4]
        before = vertices_of_off(mesh)
        at_rest = {foot: min(range(len(before)), key=lambda v: math.dist(before[v], spheres[foot][:3])) for foot in feet}
        move = [{"spheres": [feet[0]], "translate": [0, 0.1, 0]}]
        gone = lambda after: [round(math.dist(after[v], before[v]), 2) for v in at_rest.values()]
        alone, said = self.deform(move, level=40, mesh=mesh, hierarchy=hierarchy)
        self.assertEqual(said["counterparts"], 0)
        self.assertLess(sorted(gone(alone))[2], 0.05)
        together, said = self.deform(move, "--similar", level=40, mesh=mesh, hierarchy=hierarchy)
        self.assertEqual(said["counterparts"], 3)
        self.assertGreater(min(gone(together)), 0.05)
        self.assertLess(max(gone(together)) - min(gone(together)), 0.03)
        still, _ = self.deform(move, "--similar", "--time", 0, level=40, mesh=mesh, hierarchy=hierarchy)
        self.assertEqual(still, before)
        for options in (("--phase", 0.5), ("--similar", "--phase", "soon"), ("--similar", "--time", "nan")):
            result = run("spheremesh", "deform", mesh, hierarchy, self.moves(move), self.here / "o.off", "--level", 40, *options)
            self.assertNotEqual(result.returncode, 0, options)
            self.assertIn(options[-2], result.stderr)
            self.assertFalse((self.here / "o.off").exists())

    def test_moves_that_cannot_be_are_refused_with_their_place(self):
        path = self.here / "moves.json"
        for moves, words in (
            ("", ["line 1, column 1", "no JSON"]),
            ("[{]", ["line 1, column 3", "no JSON"]),
            ("{}", ["expected a list of moves, found an object"]),
            ("3", ["expected a list of moves, found 3"]),
            ("[3]", ["[0]: expected an object, found 3"]),
            ("[{}]", ['[0], "spheres": expected a list', "found nothing"]),
            ('[{"spheres":4}]', ['[0], "spheres": expected a list', "found 4"]),
            ('[{"spheres":[]},{"spheres":[0,12]}]', ['[1], "spheres"[1]', "0 to 11", "found 12"]),
            ('[{"spheres":[-1]}]', ['[0], "spheres"[0]', "found -1"]),
            ('[{"spheres":[1.5]}]', ['[0], "spheres"[0]', "found 1.5"]),
            ('[{"spheres":["a"]}]', ['[0], "spheres"[0]', 'found "a"']),
            ('[{"spheres":[99999999999999999999]}]', ['[0], "spheres"[0]']),
            ('[{"spheres":[0],"translate":[NaN,0,0]}]', ["no JSON"]),
            ('[{"spheres":[0],"translate":[1e999,0,0]}]', ["too large"]),
            ('[{"spheres":[0],"translate":[0,0]}]', ['[0], "translate": expected three finite numbers']),
            ('[{"spheres":[0],"rotate":"up"}]', ['[0], "rotate": expected three finite numbers', 'found "up"']),
            ('[{"spheres":[0],"about":[0,null,0]}]', ['[0], "about": expected three finite numbers']),
            ('[{"spheres":[0],"scale":0}]', ['[0], "scale": expected a number above 0, found 0']),
            ('[{"spheres":[0],"scale":[2]}]', ['[0], "scale": expected a finite number, found a list']),
            ('[{"spheres":[0],"radius":-1}]', ['[0], "radius": expected a number that is not negative']),
            ('[{"spheres":[0],"turn":[0,0,1]}]', ['[0], "turn"', "translate, rotate"]),
            ('[{"spheres":[0],"spheres":[1]}]', ['"spheres"', "twice"]),
            (json.dumps(2 * [{"spheres": [0], "translate": [1e308, 0, 0]}]), ["use smaller numbers"]),
        ):
            with self.subTest(moves=moves):
                self.assert_refused([path, *words], moves)

    def test_what_does_not_belong_together_is_refused(self):
        other, _ = self.build("creature", 2)
        self.assert_refused([self.hierarchy, other, "another mesh", "--hierarchy"], mesh=other)
        lines = self.mesh.read_text().splitlines()
        lines[5] = "9 9 9"
        moved = self.here / "moved.off"
        moved.write_text("\n".join(lines) + "\n")
        self.assert_refused([self.hierarchy, moved, "vertex 3 lies elsewhere"], mesh=moved)
        self.assert_refused([self.mesh, "hierarchy"], hierarchy=self.mesh)
        self.assert_refused(["nowhere.off"], mesh=self.here / "nowhere.off")
        self.assert_refused(["nowhere.smh"], hierarchy=self.here / "nowhere.smh")

    def test_levels_that_are_not_there_are_refused(self):
        count = len(self.vertices)
        for level in (0, count + 1):
            self.assert_refused([f"--level {level}", self.hierarchy, f"1 to {count}"], level=level)
        for level in (-1, "many"):
            self.assert_refused(["--level"], code=2, level=level)
        self.assert_refused(["OUT", ".ply, .obj or .off"], code=2, out="out.stl")

    def test_meshes_with_holes_islands_and_non_manifold_edges_are_taken(self):
        lines = self.mesh.read_text().splitlines()
        first_face = 2 + len(self.vertices)
        island = [f"{x} {y} {z + 5}" for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (8, 8, 8))]
        points = lines[2:first_face] + island
        base = len(self.vertices)
        faces = lines[first_face : first_face + 900]  # the rest is a hole
        faces += [f"3 {base} {base + 1} {base + 2}"]  # an island, and a vertex on no face
        a, b, c = map(int, faces[0].split()[1:4])
        faces += [f"3 {a} {b} {base + 2}", f"3 {a} {b} {(c + 40) % base}"]  # an edge of four faces
        faces += [f"3 {a} {a} {b}"]
        broken = self.here / "broken.off"
        broken.write_text("\n".join([lines[0], f"{len(points)} {len(faces)} 0"] + points + faces) + "\n")
        self.vertices = vertices_of_off(broken)
        hierarchy = self.hierarchy_of(broken)
        for options in ((), ("--weights", "primitives")):
            everything = {"spheres": list(range(LEVEL)), "translate": [1, 2, 3]}
            deformed, _ = self.deform([everything], *options, mesh=broken, hierarchy=hierarchy)
            self.assert_everywhere(deformed, lambda p: (p[0] + 1, p[1] + 2, p[2] + 3), 1e-9)
            deformed, _ = self.deform([{"spheres": [0, 5], "rotate": [0.5, 0, 1], "radius": 0.3}], *options,
                                      mesh=broken, hierarchy=hierarchy)
            self.assertTrue(all(math.isfinite(c) for p in deformed for c in p))

    def session(self, steps, mesh=None, out="session.off", spheres="fit.ma"):
        text = self.here / "session.txt"
        if not text.is_dir():
            text.write_text(steps)
        out = self.here / out
        return run("spheremesh", "session", mesh or self.mesh, self.hierarchy, text, out, "--spheres",
                   self.here / spheres, "--json"), out

    def test_a_session_of_one_move_is_that_move(self):
        move = {"spheres": [3, 4], "translate": [0, 0, 1], "rotate": [0, 0.5, 0], "about": [0, 0, 0]}
        expected, _ = self.deform([move])
        result, out = self.session(f"armature deformation 1\nlevel {LEVEL}\n"
                                   "move spheres 3 4 translate 0 0 1 rotate 0 0.5 0 about 0 0 0\nlevel 5\n")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout), {"vertices": len(self.vertices), "spheres": 5})
        self.assertEqual(vertices_of_off(out), expected)
        self.assertEqual(sum(line[0] == "v" for line in (self.here / "fit.ma").read_text().splitlines()), 5)

    def test_sessions_that_cannot_be_are_refused_with_their_line(self):
        for steps, words in (("", ["is empty"]), ("no", ["line 1"]),
                             ("armature deformation 1\nlevel 4\nmove spheres 4", ["line 3", "0 to 3, found 4"])):
            result, out = self.session(steps)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr.count("\n"), 1)
            for word in ["session.txt", *words]:
                self.assertIn(word, result.stderr)
            self.assertFalse(out.exists())

    def test_sessions_refuse_files_that_do_not_fit_before_any_work(self):
        other, _ = self.build("creature", 2)
        result, _ = self.session("armature deformation 1\n", mesh=other)
        self.assertEqual(result.returncode, 1)
        for word in (str(self.hierarchy), str(other), "another mesh", "spheremesh build --hierarchy"):
            self.assertIn(word, result.stderr)
        nowhere = self.here / "nowhere.off"
        for names, words in (({"out": "out.stl"}, ["OUT", ".ply, .obj or .off"]),
                             ({"spheres": "fit.off"}, ["--spheres", ".ma, .ply or .urdf"])):
            result, out = self.session("armature deformation 1\n", mesh=nowhere, **names)
            self.assertEqual(result.returncode, 2)
            for word in words:
                self.assertIn(word, result.stderr)
            self.assertFalse(out.exists())
        (self.here / "session.txt").unlink()
        (self.here / "session.txt").mkdir()
        result, out = self.session("")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertIn("session.txt: cannot be read; expected a deformation session", result.stderr)
        self.assertFalse(out.exists())

    def test_the_benchmark_measures_any_level(self):
        for spheres in (2, 300):
            result = run("bench", "deform", self.mesh, "--spheres", spheres, "--rounds", 1, "--only", "times",
                         "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            said = {line["measure"]: line["value"] for line in map(json.loads, result.stdout.splitlines())}
            self.assertTrue({"finer", "coarser at most", "first level", "refit"} <= said.keys())
            for measure, value in said.items():
                self.assertIsInstance(value, (int, float), measure)
                self.assertTrue(math.isfinite(value), measure)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
