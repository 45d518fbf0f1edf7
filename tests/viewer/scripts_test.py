#!/usr/bin/env python3
"""Plays scripts/*.txt with armature-viewer, without a display, and what needs more than a script."""
import json
import math
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
BINARIES = Path("bin")  # set by main


def run(program, *arguments, folder, environment=None, timeout=300):
    return subprocess.run([BINARIES / program, *map(str, arguments)], cwd=folder, timeout=timeout,
                          env={**os.environ, "XDG_CONFIG_HOME": str(folder), **(environment or {})},
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def size_of(png):
    return struct.unpack(">II", png.read_bytes()[16:24])


class Viewer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.models = Path(tempfile.mkdtemp())
        made = run("armature", "mesh", "sample", "creature", "creature.off", "--rounds", 5, folder=cls.models)
        assert made.returncode == 0, made.stderr
        subprocess.run([sys.executable, HERE.parents[1] / "tools/pictures/animal.py", cls.models / "animal.off"], check=True)
        (cls.models / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1\n3 0 1 2\n")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.models)

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        for model in self.models.iterdir():
            (self.folder / model.name).symlink_to(model)

    def view(self, *arguments, **options):
        return run("armature-viewer", *arguments, folder=self.folder, **options)

    def play(self, lines, *arguments, **options):
        (self.folder / "script.txt").write_text("\n".join(lines) + "\n")
        return self.view("--headless", "--script", "script.txt", *arguments, **options)

    def facts(self, lines, **options):
        played = self.play([*lines, "report"], **options)
        self.assertEqual(played.returncode, 0, played.stderr)
        return dict(line.partition(" ")[::2] for line in played.stdout.splitlines())

    def script(self, name):
        played = self.view("--headless", "--script", HERE / "scripts" / name)
        self.assertEqual(played.returncode, 0, played.stderr)
        self.assertEqual(played.stderr, "")

    def test_models(self):
        self.script("models.txt")
        self.assertNotEqual((self.folder / "models.png").read_bytes(), (self.folder / "components.png").read_bytes())

    def test_sphere_meshes(self):
        self.script("spheres.txt")

    def test_selections(self):
        self.script("select.txt")

    def test_poses_and_sessions_that_are_played_again(self):
        self.script("pose.txt")
        first = self.facts((self.folder / "session.txt").read_text().splitlines())
        self.assertEqual(first["spheres"], "12")
        self.assertEqual(first["steps"], "2")
        self.assertGreater(float(first["highest.y"]), 6)
        again = self.facts((self.folder / "session.txt").read_text().splitlines())
        for fact in ("spheres", "steps", "lowest.x", "highest.x", "highest.y", "highest.z", "camera.distance"):
            self.assertEqual(first[fact], again[fact])

    def test_walking_by_hand(self):
        self.script("hands.txt")

    def test_a_person_of_our_own(self):
        self.script("person.txt")
        self.assertIn("rotate_shoulders", (self.folder / "armature/viewer.toml").read_text())

    def test_failures_leave_everything_as_it_was(self):
        self.script("failures.txt")
        self.assertEqual(size_of(self.folder / "small.png"), (200, 150))

    def test_the_camera_stands_where_a_recorded_person_walked(self):
        made = run("armature", "synth", "pair_h", "person.oni", "--size", "320x240", folder=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        replay = run("armature", "replay", "oni:person.oni", "--json", "--rest", "stillness", folder=self.folder)
        self.assertEqual(replay.returncode, 0, replay.stderr)
        x = y = heading = way = 0.0
        for line in replay.stdout.splitlines():
            frame = json.loads(line)
            if "linear_m_s" not in frame:
                continue
            linear, angular = frame["linear_m_s"], frame["angular_rad_s"]
            heading += angular / 60
            x, y = x + linear / 30 * math.cos(heading), y + linear / 30 * math.sin(heading)
            heading += angular / 60
            way += abs(linear) / 30
        self.assertGreater(way, 3, "the person walks")
        facts = self.facts(["person oni:person.oni", "wait 30 walk.fresh yes", 'wait 120 walk.state "~ended"'])
        away = math.hypot(float(facts["walk.x"]) - x, float(facts["walk.y"]) - y)
        self.assertLess(away, 0.08 * way, f"{facts['walk.x']}, {facts['walk.y']} for {x:.2f}, {y:.2f}, after {way:.1f} m")
        self.assertLess(abs(float(facts["walk.heading"]) - math.degrees(heading)), 10)

    def test_a_daemon_that_is_unplugged_and_comes_back(self):
        endpoint = f"ipc://{self.folder}/nav"

        def daemon():
            return subprocess.Popen([BINARIES / "armatured", "--source", "synth:stand?size=320x240", "--endpoint", endpoint],
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        first = daemon()
        (self.folder / "script.txt").write_text(
            'wait 30 walk.fresh yes\nwait 60 walk.fresh no\nexpect notice "~fallen silent"\nscreenshot gone.png\n'
            "wait 60 walk.fresh yes\nreport\n")
        viewer = subprocess.Popen([BINARIES / "armature-viewer", "--headless", "--connect", endpoint, "--script",
                                   "script.txt"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            time.sleep(3)
            first.send_signal(signal.SIGKILL)
            first.wait()
            deadline = time.monotonic() + 60
            while not (self.folder / "gone.png").exists() and time.monotonic() < deadline and viewer.poll() is None:
                time.sleep(0.1)
            second = daemon()
            try:
                out, error = viewer.communicate(timeout=120)
            finally:
                second.terminate()
                second.wait()
        finally:
            first.kill()
            viewer.kill()
        self.assertEqual(viewer.returncode, 0, error)
        self.assertIn("walk.fresh yes", out)

    def test_a_display_of_scale_two_shows_the_same_twice_as_large(self):
        for scale, size in ((1, "640x400"), (2, "1280x800")):
            done = self.view("creature.off", "--screenshot", f"{scale}.png", "--scale", scale, "--size", size)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(size_of(self.folder / "2.png"), (1280, 800))

    def test_an_opengl_that_is_too_old_is_named(self):
        done = self.view("--screenshot", "old.png", environment={"MESA_GL_VERSION_OVERRIDE": "2.1"})
        self.assertEqual(done.returncode, 1)
        self.assertIn("OpenGL 3.3", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_wrong_use_is_told_in_one_line(self):
        for arguments, code, part in ((["--size", "big"], 1, "WIDTHxHEIGHT"), (["--nonsense"], 2, "--nonsense"),
                                      (["--headless", "--script", "none.txt"], 1, "none.txt"),
                                      (["--headless", "missing.off"], 1, "missing.off")):
            done = self.view(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(part, done.stderr)

    def test_scripts_name_the_line_that_failed(self):
        done = self.play(["open creature.off", "", "tool hammer"])
        self.assertEqual(done.returncode, 1)
        self.assertIn("script.txt, line 3: tool", done.stderr)

    @unittest.skipUnless(shutil.which("xvfb-run"), "xvfb is missing")
    def test_a_window(self):
        (self.folder / "script.txt").write_text("open creature.off\nscreenshot window.png\nquit\n")
        done = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1400x900x24", BINARIES / "armature-viewer", "--script",
                               "script.txt"], cwd=self.folder, timeout=300, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(size_of(self.folder / "window.png"), (1280, 800))


if __name__ == "__main__":
    BINARIES = Path(sys.argv.pop(1)).resolve() / "bin"
    with tempfile.TemporaryDirectory() as probed:
        probe = run("armature-viewer", "--screenshot", "probe.png", folder=probed)
    if "no OpenGL" in probe.stderr:
        print("skipped:", probe.stderr)
        sys.exit(77)
    unittest.main()
