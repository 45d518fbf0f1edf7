#!/usr/bin/env python3
"""Runs the programs as a user would and holds them to their manners: bad input gives one clear line on stderr, exit 1
and nothing half-written; wrong use exits 2; the same recording gives the same bytes.

usage: programs_test.py BUILD_DIRECTORY
"""
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

BIN = Path(sys.argv[1]) / "bin"
SHARE = Path(sys.argv[1]) / "share" / "armature"


def run(program, *arguments, cwd=None):
    return subprocess.run([BIN / program, *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=300)


class Programs(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.here = Path(self.directory.name)
        self.addCleanup(self.directory.cleanup)

    def file(self, name, content):
        path = self.here / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def assert_refused(self, result, *words):
        self.assertEqual(result.returncode, 1, result.stderr)
        lines = [line for line in result.stderr.splitlines() if line.strip()]
        self.assertEqual(len(lines), 1, result.stderr)
        for word in words:
            self.assertIn(str(word), lines[0])
        self.assertEqual(result.stdout, "")

    def test_a_source_that_is_no_recording_is_refused_by_name(self):
        missing = self.here / "missing.oni"
        self.assert_refused(run("armature", "replay", f"oni:{missing}"), missing)
        empty = self.file("empty.oni", b"")
        self.assert_refused(run("armature", "replay", f"oni:{empty}", "--json"), empty)
        text = self.file("text.oni", "this is no recording, whatever its name says\n" * 100)
        self.assert_refused(run("armature", "replay", f"oni:{text}", "--json"), text)
        self.assert_refused(run("armatured", "--source", f"oni:{text}", "--endpoint", f"ipc://{self.here}/nav"), text)
        self.assert_refused(run("armature", "replay", f"fakenect:{self.here}/nothing"), "nothing")
        self.assert_refused(run("armature", "replay", "carrier-pigeon:1"), "carrier-pigeon")

    def test_a_truncated_recording_is_refused(self):
        whole = self.here / "whole.oni"
        self.assertEqual(run("armature", "record", "synth:stand?size=160x120", whole, "--frames", 20).returncode, 0)
        bytes_of_it = whole.read_bytes()
        cut = self.file("cut.oni", bytes_of_it[: len(bytes_of_it) // 2])
        self.assert_refused(run("armature", "replay", f"oni:{cut}", "--json"), cut)

    def test_absurd_images_are_refused(self):
        raw = self.file("raw.u16", b"\0" * 1000)
        for size in ("0x240", "999999x999999"):
            result = run("armature", "import", "--raw", size, raw, self.here / "out.oni")
            self.assertIn(result.returncode, (1, 2), result.stderr)
            self.assertFalse((self.here / "out.oni").exists())
        self.assertIn(run("armature", "import", "--raw", "320x240", raw, self.here / "out.oni").returncode, (1, 2))
        self.assertEqual(sorted(path.name for path in self.here.iterdir()), ["raw.u16"])

    def test_a_mistake_in_the_configuration_is_named_with_file_line_and_key(self):
        for text, words in (("[navigation]\nwlak = 'step'\n", (":2:", "wlak")),
                            ("[navigation]\nwalk = 3\n", (":2:", "navigation.walk")),
                            ("[motions.step]\nalpha = 7\n", (":2:", "motions.step.alpha", "0.9")),
                            ("[navigation\n", (":1:",))):
            config = self.file("kiosk.toml", text)
            self.assert_refused(run("armatured", "--config", config, "--source", "synth:stand"), config, *words)
            self.assert_refused(run("armature", "replay", "synth:stand", "--config", config), config, *words)

    def test_a_model_that_is_truncated_altered_or_no_model_is_refused(self):
        model = (SHARE / "person.forest").read_bytes()
        altered = bytearray(model)
        altered[len(altered) // 2] ^= 1
        version = bytearray(model)
        version[8] ^= 0x7F
        for name, content in (("short", model[:1000]), ("altered", bytes(altered)), ("version", bytes(version)),
                              ("other", b"not a forest"), ("empty", b"")):
            path = self.file(name + ".forest", content)
            self.assert_refused(run("armature", "replay", "synth:stand?size=160x120", "--model", path), path)
        self.assert_refused(run("armature", "replay", "synth:stand", "--model", self.here / "none"), "none")

    def test_a_model_is_measured_on_scenes_beside_just_the_paper(self):
        model = SHARE / "person.forest"
        result = run("armature", "forest", "evaluate", model, "--quick", "--category", "standing", "--json",
                     "--plots", self.here / "plots")
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = [json.loads(line) for line in result.stdout.splitlines()]
        self.assertEqual([row["system"] for row in rows], 2 * ["whole", "mask", "paper"])
        for whole, scene in zip(rows[:3], rows[3:]):
            self.assertEqual((whole["data"], whole["frames"]), ("scenes", 60))
            self.assertEqual(list(whole["categories"]), ["standing"])
            self.assertEqual((scene["data"], scene["number"]), ("scene", 1))
        self.assertEqual(sorted(path.name for path in (self.here / "plots").iterdir()),
                         ["joint_errors.svg", "map_of_categories.svg", "map_over_distance.svg"])
        self.assert_refused(run("armature", "forest", "evaluate", model, "--category", "flying"), "flying", "standing")
        self.assert_refused(run("armature", "forest", "evaluate", model, "--plots", model), model, "no folder")
        self.assertEqual(run("armature", "forest", "evaluate", model, "--size", "1x1").returncode, 2)

    def test_what_print_config_writes_is_a_configuration(self):
        printed = run("armatured", "--print-config")
        self.assertEqual(printed.returncode, 0)
        config = self.file("all.toml", printed.stdout)
        self.assertEqual(run("armatured", "--config", config, "--print-config").stdout, printed.stdout)

    def test_wrong_use_exits_2(self):
        self.assertEqual(run("armature").returncode, 2)
        self.assertEqual(run("armature", "fly").returncode, 2)
        self.assertEqual(run("armature", "replay").returncode, 2)
        self.assertEqual(run("armatured").returncode, 2)
        for program in ("armature", "armatured"):
            self.assertEqual(run(program, "--help").returncode, 0)

    def test_two_replays_of_a_recording_are_the_same_bytes_and_compare_names_a_difference(self):
        recording = self.here / "person.oni"
        self.assertEqual(run("armature", "record", "synth:lean_bust?size=160x120", recording, "--frames", 120).returncode, 0)
        first = run("armature", "replay", f"oni:{recording}", "--json")
        second = run("armature", "replay", f"oni:{recording}", "--json")
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stdout, second.stdout)
        lines = first.stdout.splitlines()
        self.assertEqual(len(lines), 120)
        frame = json.loads(lines[60])
        self.assertEqual(len(frame["joints"]), 30)
        self.assertEqual(len(frame["motions"]), 8)

        earlier = self.file("earlier.jsonl", first.stdout)
        self.assertEqual(run("armature", "replay", f"oni:{recording}", "--compare", earlier).returncode, 0)
        frame["joints"]["head"]["xyz"][1] += 0.5
        changed = self.file("changed.jsonl", "\n".join(lines[:60] + [json.dumps(frame)] + lines[61:]) + "\n")
        differs = run("armature", "replay", f"oni:{recording}", "--compare", changed)
        self.assertEqual(differs.returncode, 1)
        self.assertIn("frame 60 differs: joints.head.xyz[1]", differs.stderr)

    def test_pictures_are_whole_the_same_every_time_and_told_of(self):
        if run("armature", "render", "--help").returncode != 0:
            self.skipTest("built without the viewer")
        mesh = self.file("pyramid.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
        shape = self.file("pair.ma", "2 1 0\nv 0 0 0 0.5\nv 1 0 0 0.25\ne 0 1\n")
        first, second = self.here / "first.png", self.here / "second.png"
        result = run("armature", "render", mesh, shape, first, "--size", "301x100", "--structure", "--json")
        if "no OpenGL" in result.stderr:
            self.skipTest(result.stderr.strip())
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        self.assertEqual((told["width"], told["height"], told["columns"], told["rows"]), (301, 100, 3, 1))
        self.assertEqual([cell[0]["kind"] for cell in told["cells"]], ["mesh", "sphere-mesh", "structure"])
        picture = first.read_bytes()
        self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", picture[16:24]), (301, 100))
        self.assertEqual(run("armature", "render", mesh, shape, second, "--size", "301x100", "--structure").returncode, 0)
        self.assertEqual(picture, second.read_bytes())

        names = sorted(path.name for path in self.here.iterdir())
        cut = self.file("cut.ma", "2 1 0\nv 0 0 0 0.5\n")
        self.assert_refused(run("armature", "render", cut, self.here / "cut.png"), cut)
        self.assert_refused(run("armature", "render", mesh, self.here / "nowhere" / "out.png"), "nowhere/out.png")
        self.assertEqual(run("armature", "render", mesh, shape).returncode, 2)
        self.assertEqual(run("armature", "render", mesh, self.here / "x.png", "--size", "0x5").returncode, 2)
        self.assertEqual(sorted(path.name for path in self.here.iterdir()), sorted([*names, "cut.ma"]))

    def test_an_endpoint_in_use_is_refused_and_sigterm_stops_cleanly(self):
        endpoint = f"ipc://{self.here}/nav"
        daemon = subprocess.Popen([BIN / "armatured", "--source", "synth:stand", "--endpoint", endpoint],
                                  stderr=subprocess.DEVNULL)
        try:
            for _ in range(200):
                if (self.here / "nav").exists():
                    break
                time.sleep(0.05)
            self.assert_refused(run("armatured", "--source", "synth:stand", "--endpoint", endpoint, "--quiet"), endpoint)
            listener = subprocess.Popen([BIN / "armature", "listen", endpoint, "--json"], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
            time.sleep(0.5)
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(timeout=30), 0)
            heard = listener.communicate(timeout=30)[0]
            self.assertIn('"exit"', heard)
        finally:
            daemon.kill()
        self.assertFalse(os.path.exists(self.here / "nav"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
