#!/usr/bin/env python3
"""Plays scripts/*.txt with armature-viewer, without a display, and what needs more than a script."""
import json
import math
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from pathlib import Path

import x_hands

HERE = Path(__file__).resolve().parent
BINARIES = Path("bin")  # set by main


def run(program, *arguments, folder, environment=None, timeout=300):
    return subprocess.run([BINARIES / program, *map(str, arguments)], cwd=folder, timeout=timeout,
                          env={**os.environ, "XDG_CONFIG_HOME": str(folder), **(environment or {})},
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def size_of(png):
    return struct.unpack(">II", png.read_bytes()[16:24])


def pixels_of(png):
    """Rows of RGB bytes of a PNG file of 8-bit RGB without interlacing."""
    data, at, packed = png.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    width, height = size_of(png)
    raw, before, rows = zlib.decompress(packed), bytes(3 * width), []
    for y in range(height):
        kind, line = raw[y * (3 * width + 1)], bytearray(raw[y * (3 * width + 1) + 1:(y + 1) * (3 * width + 1)])
        for i in range(3 * width):
            left, up, corner = line[i - 3] if i > 2 else 0, before[i], before[i - 3] if i > 2 else 0
            nearest = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        before = bytes(line)
        rows.append(before)
    return rows


class Viewer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.models = Path(tempfile.mkdtemp())
        made = run("armature", "mesh", "sample", "creature", "creature.off", "--rounds", 5, folder=cls.models)
        assert made.returncode == 0, made.stderr
        subprocess.run([sys.executable, HERE.parents[1] / "tools/pictures/animal.py", cls.models / "animal.off"], check=True)
        # A face in each octant: seen from any side, four of them meet in the middle.
        (cls.models / "octahedron.off").write_text("OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"
                                                  "3 0 2 4\n3 1 4 2\n3 1 3 4\n3 0 4 3\n"
                                                  "3 0 5 2\n3 1 2 5\n3 1 5 3\n3 0 3 5\n")
        (cls.models / "broken.moves").write_text("armature deformation 1\nlevel 8\nmove spheres 0 translate 0 1 0\n"
                                                "move nothing\n")
        (cls.models / "long.moves").write_text("armature deformation 1\nlevel 20\n" +
                                              2000 * "move spheres 3 translate 0 0.01 0\n")
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

    def wait_for(self, is_there, program):
        deadline = time.monotonic() + 60
        while not is_there() and time.monotonic() < deadline and program.poll() is None:
            time.sleep(0.05)

    def highest(self, name):
        """The largest y of the vertices of an OFF file."""
        words = (self.folder / name).read_text().split()
        return max(float(y) for y in words[5:4 + 3 * int(words[1]):3])

    def script(self, name):
        played = self.view("--headless", "--script", HERE / "scripts" / name)
        self.assertEqual(played.returncode, 0, played.stderr)
        self.assertEqual(played.stderr, "")

    def test_models(self):
        self.script("models.txt")
        self.assertNotEqual((self.folder / "models.png").read_bytes(), (self.folder / "components.png").read_bytes())

    def test_sphere_meshes(self):
        self.script("spheres.txt")

    def test_errors_that_are_found_quickly_are_those_that_are_measured(self):
        for level in (15, 300):
            opened = ["open creature.off", "build", f"level {level}"]
            quick = self.facts([*opened, "wait 60 measured quickly"])
            full = self.facts([*opened, 'wait 200 measured "in full"'])
            ratio = float(quick["mean_percent"]) / float(full["mean_percent"])
            self.assertLess(abs(ratio - 1), 0.03, level)
            ratio = float(quick["hausdorff_percent"]) / float(full["hausdorff_percent"])
            self.assertTrue(0.85 < ratio < 1.02, f"{ratio} at {level}")

    def test_selections(self):
        self.script("select.txt")

    def test_edits_of_what_is_alike(self):
        self.script("edit.txt")
        self.assertNotEqual((self.folder / "smooth.off").read_bytes(), (self.folder / "animal.off").read_bytes())

    def test_hierarchies_side_by_side(self):
        self.script("alike.txt")

    def test_poses_and_sessions_that_are_played_again(self):
        self.script("pose.txt")
        self.assertEqual((self.folder / "kept.moves").read_bytes(), (self.folder / "pose.moves").read_bytes())
        self.assertGreater(self.highest("posed.off"), 6)
        self.assertEqual(self.highest("rest.off"), self.highest("creature.off"))
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

    def test_nothing_is_written_that_nobody_asked_for(self):
        self.facts(["person synth:stand?size=320x240", "wait 30 walk.fresh yes", "disconnect"],
                   environment={"TMPDIR": str(self.folder)})
        left = {path.name for path in self.folder.iterdir()} - {path.name for path in self.models.iterdir()}
        self.assertEqual(left, {"script.txt"})

    def test_settings_that_were_changed_hold_when_the_recording_starts_again(self):
        made = run("armature", "synth", "stand", "person.oni", "--size", "320x240", folder=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        facts = self.facts(["person oni:person.oni", "wait 30 walk.turn lean_bust", "pair rotate_shoulders bend_bust",
                            "wait 30 walk.turn rotate_shoulders", "wait 60 walk.rounds 1",
                            "wait 60 walk.turn rotate_shoulders"])
        self.assertEqual(facts["walk.walk"], "bend_bust")

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
        facts = self.facts(["person oni:person.oni", "wait 30 walk.fresh yes", "wait 120 walk.rounds 1"])
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
            'wait 30 walk.fresh yes\nscreenshot there.png\nwait 60 walk.fresh no\nexpect notice "~fallen silent"\n'
            "screenshot gone.png\nwait 60 walk.fresh yes\nreport\n")
        viewer = subprocess.Popen([BINARIES / "armature-viewer", "--headless", "--connect", endpoint, "--script",
                                   "script.txt"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            self.wait_for((self.folder / "there.png").exists, viewer)
            first.send_signal(signal.SIGKILL)
            first.wait()
            self.wait_for((self.folder / "gone.png").exists, viewer)
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
        small, large = pixels_of(self.folder / "1.png"), pixels_of(self.folder / "2.png")
        away = 0
        for y in range(0, 400, 2):
            for x in range(640):
                mean = [sum(large[2 * y + v][3 * (2 * x + u) + c] for u in (0, 1) for v in (0, 1)) / 4 for c in range(3)]
                away += max(abs(mean[c] - small[y][3 * x + c]) for c in range(3)) > 60
        self.assertLess(away, 0.03 * 640 * 200, "only the edges of letters may differ")

    def test_an_opengl_that_is_too_old_is_named(self):
        done = self.view("--screenshot", "old.png", environment={"MESA_GL_VERSION_OVERRIDE": "2.1"})
        self.assertEqual(done.returncode, 1)
        self.assertIn("OpenGL 3.3", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_whatever_the_window_issues_is_a_command_of_scripts(self):
        listed = self.play(["help"])
        self.assertEqual(listed.returncode, 0, listed.stderr)
        commands = {line.split()[0] for line in listed.stdout.splitlines() if line.strip()}
        issued = {}
        for source in sorted((HERE.parents[1] / "viewer/app").rglob("*.cpp")):
            for word in re.findall(r'\b(?:issue\(|issue_gesture_line\(ui, (?:fmt::format\()?)\s*"([a-z-]+)', source.read_text()):
                issued.setdefault(word, source.name)
        self.assertGreater(len(issued), 40)
        self.assertEqual({word: source for word, source in issued.items() if word not in commands}, {})

    def test_wrong_use_is_told_in_one_line(self):
        for arguments, code, part in ((["--size", "big"], 2, "WIDTHxHEIGHT"),
                                      (["--size", "640x480junk"], 2, "640x480junk"), (["--nonsense"], 2, "--nonsense"),
                                      (["--screenshot", "x.jpg"], 2, "ends in .png"),
                                      (["--headless", "--script", "none.txt"], 1, "none.txt"),
                                      (["--headless", "missing.off"], 1, "armature-viewer: missing.off"),
                                      (["--headless", "--script", "."], 1, "is a folder"),
                                      (["--server", "x"], 2, "--keys"),
                                      (["--headless", "--connect", "tcp://127.0.0.1:9", "--keys", "none.key", "--server",
                                        "x"], 1, "none.key")):
            done = self.view(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(part, done.stderr)

    def test_scripts_name_the_line_that_failed(self):
        done = self.play(["open creature.off", "", "tool hammer"])
        self.assertEqual(done.returncode, 1)
        self.assertIn("script.txt, line 3: tool", done.stderr)
        done = self.play(["open creature.off", "screenshot nowhere/x.png", "save-session after.txt"])
        self.assertEqual(done.returncode, 1)
        self.assertIn("script.txt, line 2: nowhere/x.png", done.stderr)
        self.assertFalse((self.folder / "after.txt").exists())

    def test_a_daemon_that_lets_in_known_keys_alone(self):
        def public_key(file):
            return json.loads(run("armature", "keys", "new", file, "--json", folder=self.folder).stdout)["public"]

        server, ours = public_key("kiosk.key"), public_key("wall.key")
        public_key("stranger.key")
        run("armature", "keys", "allow", "allow", "--", ours, "wall", folder=self.folder)
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = min(probe.getsockname()[1], 65000)
        endpoint = f"tcp://127.0.0.1:{port}"
        (self.folder / "kiosk.toml").write_text(
            f"[publish]\nendpoint = '{endpoint}'\nkeys = 'kiosk.key'\nallow = 'allow'\n"
            f"[control]\nendpoint = 'ipc://{self.folder}/control'\n")
        daemon = subprocess.Popen([BINARIES / "armatured", "--config", "kiosk.toml", "--source",
                                   "synth:stand?size=320x240"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(daemon.stderr.close)
        self.addCleanup(daemon.wait)
        self.addCleanup(daemon.terminate)
        (self.folder / "heard.txt").write_text(
            "wait 30 walk.fresh yes\nwait 30 walk.feed 320x240\n"
            'try rerest\nexpect notice "~own machine"\nsave-session again.txt\n')
        done = self.view("--headless", "--connect", endpoint, "--keys", "wall.key", f"--server={server}", "--script",
                         "heard.txt")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "again.txt", "a") as script:
            script.write("wait 30 walk.fresh yes\n")
        done = self.view("--headless", "--script", "again.txt")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.play([f'connect {endpoint} stranger.key "{server}"', "wait 2", "expect walk.fresh no"])
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_ctrl_c_leaves_nothing_behind(self):
        (self.folder / "script.txt").write_text("person synth:stand?size=320x240\nwait 30 walk.fresh yes\n"
                                                "save-session there.txt\nwait 100\n")
        viewer = subprocess.Popen([BINARIES / "armature-viewer", "--headless", "--script", "script.txt"], cwd=self.folder,
                                  env={**os.environ, "TMPDIR": str(self.folder), "XDG_CONFIG_HOME": str(self.folder)},
                                  stderr=subprocess.PIPE, text=True)
        self.wait_for((self.folder / "there.txt").exists, viewer)
        viewer.send_signal(signal.SIGINT)
        _, error = viewer.communicate(timeout=60)
        self.assertEqual((viewer.returncode, error), (1, "armature-viewer: interrupted\n"))
        self.assertEqual(list(self.folder.glob("armature-viewer.*")), [])

    @unittest.skipUnless(shutil.which("xvfb-run"), "xvfb is missing")
    def test_a_window(self):
        (self.folder / "script.txt").write_text("open creature.off\nscreenshot window.png\n"
                                                "screenshot small.png 320x200\nquit\n")
        done = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1400x900x24", BINARIES / "armature-viewer", "--script",
                               "script.txt"], cwd=self.folder, timeout=300, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(size_of(self.folder / "window.png"), (1280, 800))
        self.assertEqual(size_of(self.folder / "small.png"), (320, 200))

    def in_a_window(self, command, **options):
        """Starts a program on a display of its own; the program's process and hands at its window."""
        display = subprocess.Popen(["Xvfb", "-displayfd", "1", "-screen", "0", "1400x900x24"], stdout=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL)
        self.addCleanup(display.stdout.close)
        self.addCleanup(display.wait)
        self.addCleanup(display.terminate)
        name = ":" + display.stdout.readline().decode().strip()
        environment = {**os.environ, "DISPLAY": name, "XDG_CONFIG_HOME": str(self.folder), "TMPDIR": str(self.folder),
                       **options.pop("environment", {})}
        environment.pop("WAYLAND_DISPLAY", None)
        program = subprocess.Popen(command, cwd=self.folder, env=environment, stderr=subprocess.PIPE, text=True, **options)
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.wait)
        self.addCleanup(program.kill)
        hands = x_hands.Hands(name, "Armature")
        self.addCleanup(hands.close)
        return program, hands

    def expect_saved_by_hand(self, hands, name, expected):
        """Ctrl+S and a name, a longer one each time, until what is expected has been written: opening it may take a
        while, and nothing is saved meanwhile."""
        before, deadline = set(self.folder.glob("*.off")), time.monotonic() + 60
        while all(file.read_bytes() != expected for file in set(self.folder.glob("*.off")) - before):
            self.assertLess(time.monotonic(), deadline, f"what was expected of {name} was not written")
            name += "x"
            hands.press("Control_L", "s")
            hands.type(name + ".off\n")
            time.sleep(0.5)

    @unittest.skipUnless(shutil.which("Xvfb") and x_hands.load(), "Xvfb or libXtst is missing")
    def test_files_that_are_dropped_and_chosen_by_hand(self):
        expected = {}
        for model in ("creature", "animal"):
            played = self.play([f"open {model}.off", f"save {model}2.off"])
            self.assertEqual(played.returncode, 0, played.stderr)
            expected[model] = (self.folder / f"{model}2.off").read_bytes()
        viewer, hands = self.in_a_window([BINARIES / "armature-viewer"])
        hands.point()
        hands.drop(self.folder / "creature.off")
        self.expect_saved_by_hand(hands, "dropped", expected["creature"])
        hands.press("Control_L", "o")
        hands.type("animal.off\n")
        self.expect_saved_by_hand(hands, "opened", expected["animal"])
        hands.ask_to_close()
        self.assertEqual(viewer.wait(timeout=60), 0)

    @unittest.skipUnless(shutil.which("Xvfb") and x_hands.load(), "Xvfb or libXtst is missing")
    def test_the_demo_opens_a_window_where_a_display_is(self):
        made = run("armature", "synth", "stand", "person.oni", "--size", "320x240", folder=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        # The script as it is, in a tree that is set up and built already.
        tree = self.folder / "tree"
        (tree / "tools").mkdir(parents=True)
        (tree / "build/release").mkdir(parents=True)
        (tree / "build/release/bin").symlink_to(BINARIES)
        shutil.copy(HERE.parents[1] / "tools/demo", tree / "tools/demo")
        for done in (tree / "tools/setup", tree / "cmake"):
            done.write_text("#!/bin/sh\n")
            done.chmod(0o755)
        path = {"PATH": f"{tree}:{os.environ['PATH']}"}
        demo, hands = self.in_a_window([tree / "tools/demo", "person.oni"], environment=path)
        self.wait_for(lambda: list(self.folder.glob("armature-viewer.*/nav")), demo)
        self.assertEqual(len(list(self.folder.glob("armature-viewer.*/nav"))), 1, "a daemon of its own")
        hands.ask_to_close()
        _, error = demo.communicate(timeout=60)
        self.assertEqual(demo.returncode, 0, error)
        self.assertEqual([left.name for left in self.folder.glob("armature*")], [])
        plain = subprocess.run([tree / "tools/demo", "--plain", "--seconds", "3", "person.oni"], cwd=self.folder,
                               env={**os.environ, **path}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
        self.assertEqual(plain.returncode, 0, plain.stderr)
        self.assertGreater(len(plain.stdout.splitlines()), 2)


if __name__ == "__main__":
    BINARIES = Path(sys.argv.pop(1)).resolve() / "bin"
    with tempfile.TemporaryDirectory() as probed:
        probe = run("armature-viewer", "--screenshot", "probe.png", folder=probed)
    if "no OpenGL" in probe.stderr:
        print("skipped:", probe.stderr)
        sys.exit(77)
    unittest.main()
