#!/usr/bin/env python3
"""The subcommands that look after an appliance, as an operator calls them. usage: appliance_command_test.py BUILD"""
import json
import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))
from free_ports import four_free_ports  # noqa: E402

BUILD = Path(sys.argv.pop(1)).resolve()
ARMATURE = BUILD / "bin" / "armature"
ARMATURED = BUILD / "bin" / "armatured"


def run(*words):
    return subprocess.run([ARMATURE, *map(str, words)], capture_output=True, text=True, timeout=60)


class Keys(unittest.TestCase):
    def test_are_made_allowed_and_listed(self):
        with tempfile.TemporaryDirectory() as folder:
            key, allow = Path(folder, "kiosk.key"), Path(folder, "allow")
            made = run("keys", "new", key, "--json")
            self.assertEqual(made.returncode, 0, made.stderr)
            public = json.loads(made.stdout)["public"]
            self.assertEqual(len(public), 40)
            self.assertEqual(os.stat(key).st_mode & 0o777, 0o600)
            self.assertEqual(run("keys", "new", key).returncode, 1, "an identity is never replaced")
            self.assertEqual(run("keys", "allow", allow, "--", public, "wall").returncode, 0)
            self.assertEqual(run("keys", "allow", allow, "--", public, "again").returncode, 1)
            listed = run("keys", "list", allow, "--json")
            self.assertEqual(json.loads(listed.stdout), {"public": public, "name": "wall"})
            allow.write_text("nonsense\n")
            wrong = run("keys", "list", allow)
            self.assertEqual(wrong.returncode, 1)
            self.assertIn(f"{allow}:1:", wrong.stderr)


class Devices(unittest.TestCase):
    def test_prints_one_object_a_sensor(self):
        listed = run("devices", "--json")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        for line in listed.stdout.splitlines():
            self.assertEqual(set(json.loads(line)), {"name", "serial", "uri", "where", "problem"})


class Doctor(unittest.TestCase):
    def test_names_line_and_remedy_of_a_bad_configuration(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            config.write_text("[engagement]\nfar_m = 'far'\n")
            found = run("doctor", "--config", config, "--json")
            self.assertEqual(found.returncode, 1)
            findings = [json.loads(line) for line in found.stdout.splitlines()]
            bad = [f for f in findings if f["what"] == "config"]
            self.assertIn(f"{config}:2: engagement.far_m", bad[0]["found"])
            self.assertTrue(bad[0]["remedy"])

    def test_finds_what_a_daemon_would_refuse(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            config.write_text(f"[publish]\nendpoint = 'ipc://{folder}/nav'\n[control]\nuids = 'somebody'\n")
            found = run("doctor", "--config", config, "--json")
            findings = {f["what"]: f for f in map(json.loads, found.stdout.splitlines())}
            self.assertEqual(findings["source"]["kind"], "problem")
            self.assertNotIn("config", findings, "it is not in order")
            self.assertIn("control.uids", findings["control"]["found"])
            self.assertIn("id -u", findings["control"]["remedy"])

    def test_names_file_line_and_key_of_what_a_daemon_would_refuse(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            for text, what, begin in (
                    ("[source]\nuri = 'kinect:0'\n", "source", ":2: source.uri = kinect:0: expected "),
                    ("[source]\nuri = 'synth:nobody'\n", "source", ":2: source.uri = synth:nobody: "),
                    ("[publish]\nendpoint = 'bogus'\n", "endpoint", ":2: publish.endpoint = bogus: expected "),
                    ("[publish]\nendpoint = 'tcp://127.0.0.1:24730'\nkeys = 'none'\nallow = 'none'\n", "endpoint",
                     ":3: publish.keys = none: no such file"),
                    ("[skeleton]\nmodel = 'none'\n", "model", ":2: skeleton.model = none: ")):
                config.write_text(text)
                started = subprocess.run([ARMATURED, "--config", config] + (["--source", "synth:stand"] if what != "source"
                                                                            else []),
                                         capture_output=True, text=True, timeout=60)
                self.assertEqual(started.returncode, 1)
                self.assertIn(f"armatured: {config}{begin}", started.stderr)
                found = run("doctor", "--config", config, "--json")
                findings = [json.loads(line) for line in found.stdout.splitlines()]
                self.assertIn(f"{config}{begin}", "".join(f["found"] for f in findings if f["what"] == what))
                self.assertNotIn("in order", "".join(f["found"] for f in findings if f["what"] == "config"))

    def test_finds_that_a_port_is_taken_unless_it_is_the_daemons(self):
        first = four_free_ports()
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            config.write_text("[source]\nuri = 'synth:stand?size=160x120'\n"
                              f"[publish]\nendpoint = 'tcp://127.0.0.1:{first}'\ninsecure = true\n"
                              f"[control]\nendpoint = 'ipc://{folder}/nav'\n")

            def endpoint():
                found = run("doctor", "--config", config, "--json")
                return [f for f in map(json.loads, found.stdout.splitlines())
                        if f["what"] == "endpoint" and f["kind"] != "note"]

            self.assertEqual([f["found"] for f in endpoint()], [f"tcp://127.0.0.1:{first} can be had"])
            for port in (first, first + 3):
                with socket.create_server(("127.0.0.1", port)):
                    taken = endpoint()
                self.assertEqual([f["kind"] for f in taken], ["problem"])
                self.assertIn(f":{port}", taken[0]["found"])
                self.assertIn("ss -ltnp", taken[0]["remedy"])
            daemon = subprocess.Popen([ARMATURED, "--config", config, "--quiet"], stderr=subprocess.DEVNULL)
            try:
                for _ in range(100):
                    if run("status", f"ipc://{folder}/nav").returncode == 0:
                        break
                    time.sleep(0.1)
                self.assertEqual(endpoint(), [])
            finally:
                daemon.terminate()
                daemon.wait()

    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("unshare"), "needs root, to have a user of the daemon's name")
    def test_finds_what_the_daemons_user_may_not_read(self):
        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o755)
            users, config = Path(folder, "passwd"), Path(folder, "kiosk.toml")
            users.write_text("root:x:0:0::/root:/bin/sh\narmature:x:4711:4711::/:/bin/false\n")
            config.write_text(f"[source]\nuri = 'synth:stand'\n[publish]\nendpoint = 'tcp://127.0.0.1:24750'\n"
                              f"keys = '{folder}/kiosk.key'\nallow = '{folder}/allow'\n"
                              f"[control]\nendpoint = 'ipc://{folder}/nav'\n")
            public = json.loads(run("keys", "new", f"{folder}/kiosk.key", "--json").stdout)["public"]
            run("keys", "allow", f"{folder}/allow", "--", public, "wall")
            within = ["unshare", "--mount", "sh", "-c", 'mount --bind "$0" /etc/passwd && exec "$@"', users]
            if subprocess.run([*within, "true"], capture_output=True).returncode != 0:
                self.skipTest("no mount of its own can be had here")

            def unreadable():
                found = subprocess.run([*within, ARMATURE, "doctor", "--config", config, "--json"], capture_output=True,
                                       text=True, timeout=60)
                return [Path(f["found"].split(" cannot be read")[0]).name for f in map(json.loads, found.stdout.splitlines())
                        if "cannot be read by the user armature" in f["found"]]

            config.chmod(0o640)
            os.chown(config, 4711, 4711)
            self.assertEqual(unreadable(), ["kiosk.key", "allow"])
            for name in ("kiosk.key", "allow"):
                os.chown(f"{folder}/{name}", 0, 4711)
                os.chmod(f"{folder}/{name}", 0o640)
            self.assertEqual(unreadable(), [])
            config.chmod(0o600)
            os.chown(config, 0, 0)
            self.assertEqual(unreadable(), ["kiosk.toml"])

    def test_asks_the_daemon_that_has_endpoint_and_port(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            config.write_text(f"[source]\nuri = 'process:fakenect:{folder}/none'\n"
                              f"[publish]\nendpoint = 'ipc://{folder}/nav'\n[health]\nmetrics_port = 29464\n")
            daemon = subprocess.Popen([ARMATURED, "--config", config, "--quiet"])
            try:
                findings = {}
                for _ in range(100):
                    found = run("doctor", "--config", config, "--json")
                    findings = {f["what"]: f for f in map(json.loads, found.stdout.splitlines())}
                    if "INDEX.txt" in findings.get("daemon", {}).get("found", ""):
                        break
                    time.sleep(0.1)
                self.assertIn("INDEX.txt", findings["daemon"]["found"], "why no frames come")
                self.assertNotIn("port", findings, "it is the daemon's")
                self.assertNotIn("endpoint", findings)
                self.assertRegex(run("status", f"ipc://{folder}/nav").stdout, "LOST: .*INDEX.txt")
            finally:
                daemon.terminate()
                daemon.wait()

    def test_looks_at_a_site(self):
        found = run("doctor", "--site", "synth:walk_in?size=320x240&seed=3", "--seconds", "1.5", "--json")
        findings = {f["what"]: f for f in map(json.loads, found.stdout.splitlines())}
        self.assertEqual(findings["stand"]["kind"], "ok", findings)
        self.assertIn("zone", findings)


    def test_stores_the_empty_site_for_the_daemon(self):
        with tempfile.TemporaryDirectory() as folder:
            picture, config = Path(folder, "empty.pgm"), Path(folder, "kiosk.toml")
            found = run("doctor", "--site", "synth:walk_in?size=320x240&seed=3", "--seconds", "1", "--background", picture,
                        "--json")
            findings = {f["what"]: f for f in map(json.loads, found.stdout.splitlines())}
            self.assertEqual(findings["background"]["kind"], "ok", findings)
            self.assertEqual(picture.read_bytes()[:17], b"P5\n320 240\n65535\n"[:17])
            config.write_text(f"[segmentation]\nbackground = '{picture}'\n[source]\nuri = 'synth:walk_in'\n")
            found = run("doctor", "--config", config, "--json")
            self.assertIn(f"{config} is in order", found.stdout)
            picture.write_bytes(picture.read_bytes()[:-1])
            found = run("doctor", "--config", config, "--json")
            self.assertIn(f"{config}:2: segmentation.background = {picture}: 153599 bytes of pixels: expected 153600",
                          found.stdout)

    def test_refuses_a_background_without_a_site(self):
        self.assertEqual(run("doctor", "--background", "empty.pgm").returncode, 2)


class Status(unittest.TestCase):
    def test_asks_a_running_daemon_which_takes_sighup_and_ends_with_sigterm(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            config.write_text("[navigation]\nmax_walk_m_s = 1.0\n")
            endpoint = f"ipc://{folder}/nav"
            self.assertEqual(run("status", endpoint, "--timeout", "0.2").returncode, 1, "nobody is there yet")
            daemon = subprocess.Popen([ARMATURED, "--config", config, "--source", "synth:stand?size=160x120", "--endpoint",
                                       endpoint], stderr=subprocess.PIPE, text=True)
            try:
                asked = None
                for _ in range(100):
                    asked = run("status", endpoint, "--json")
                    if asked.returncode == 0:
                        break
                    time.sleep(0.1)
                status = json.loads(asked.stdout)
                self.assertEqual(status["source"], "synth:stand?size=160x120")
                config.write_text("[navigation]\nmax_walk_m_s = 'fast'\n")
                refused = run("status", endpoint, "--request", "reload")
                self.assertEqual(refused.returncode, 1)
                self.assertIn(":2: navigation.max_walk_m_s", refused.stderr)
                daemon.send_signal(signal.SIGHUP)
                config.write_text("[navigation]\nmax_walk_m_s = 2.0\n")
                self.assertEqual(run("status", endpoint, "--request", "reload").returncode, 0)
            finally:
                daemon.terminate()
                log = daemon.communicate(timeout=30)[1]
            self.assertEqual(daemon.returncode, 0, log)
            self.assertIn("config_rejected", log)
            self.assertIn("config_reloaded", log)


    @unittest.skipUnless(os.geteuid() == 0, "needs root, to become somebody else")
    def test_tells_who_may_not_ask_that_it_is_a_matter_of_permission(self):
        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o755)
            endpoint = f"ipc://{folder}/nav"
            config = Path(folder, "kiosk.toml")
            config.write_text(f"[source]\nuri = 'synth:stand?size=160x120'\n[publish]\nendpoint = '{endpoint}'\n"
                              "[health]\nmetrics_port = 29465\n")
            config.chmod(0o644)
            daemon = subprocess.Popen([ARMATURED, "--config", config, "--quiet"])

            def as_nobody(*words):
                return subprocess.run([ARMATURE, *words], capture_output=True, text=True, timeout=60, user=65534,
                                      group=65534, extra_groups=[])

            try:
                answered = False
                for _ in range(100):
                    answered = run("status", endpoint).returncode == 0
                    if answered or daemon.poll() is not None:
                        break
                    time.sleep(0.1)
                self.assertTrue(answered, f"the daemon's exit code: {daemon.poll()}")
                for words in (["status", endpoint, "--timeout", "0.2"], ["listen", endpoint, "--plain", "--timeout", "30"]):
                    asked = as_nobody(*words)
                    self.assertEqual(asked.returncode, 1)
                    self.assertIn("permission denied", asked.stderr)
                    self.assertIn("adduser", asked.stderr)
                found = as_nobody("doctor", "--config", config, "--json")
                findings = {f["what"]: f for f in map(json.loads, found.stdout.splitlines())}
                self.assertEqual(found.returncode, 1)
                self.assertEqual(findings["daemon"]["kind"], "problem", findings)
                self.assertIn("permission denied", findings["daemon"]["found"])
                self.assertIn("adduser", findings["daemon"]["remedy"])
                self.assertNotIn("port", findings, "it is the daemon's")
                self.assertNotIn("endpoint", findings)
            finally:
                daemon.terminate()
                daemon.wait()


class Record(unittest.TestCase):
    def test_beside_a_daemon_and_killed_leaves_a_file_that_replays(self):
        with tempfile.TemporaryDirectory() as folder:
            endpoint, out = f"ipc://{folder}/nav", Path(folder, "visitor.oni")
            daemon = subprocess.Popen([ARMATURED, "--source", "synth:stand?size=160x120", "--endpoint", endpoint, "--quiet"])
            try:
                recorder = subprocess.Popen([ARMATURE, "record", f"feed:{endpoint}", out], stderr=subprocess.DEVNULL)
                for _ in range(200):
                    if out.exists() and out.stat().st_size > 300_000:
                        break
                    time.sleep(0.1)
                recorder.send_signal(signal.SIGKILL)
                recorder.wait()
            finally:
                daemon.terminate()
                daemon.wait()
            kept = out.read_bytes()
            refused = run("record", "process:fakenect:nowhere", out)
            self.assertEqual((refused.returncode, out.read_bytes()), (1, kept), "never overwritten")
            again = run("record", f"oni:{out}", Path(folder, "again.oni"), "--json")
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertGreater(json.loads(again.stdout)["frames"], 10)


    def test_on_a_full_disk_says_so_and_the_daemon_goes_on(self):
        def small_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

        with tempfile.TemporaryDirectory() as folder:
            endpoint, out = f"ipc://{folder}/nav", Path(folder, "visitor.oni")
            daemon = subprocess.Popen([ARMATURED, "--source", "synth:stand?size=160x120", "--endpoint", endpoint, "--quiet"])
            try:
                recorder = subprocess.run([ARMATURE, "record", f"feed:{endpoint}", out], stderr=subprocess.PIPE, text=True,
                                          timeout=60, preexec_fn=small_disk)
                self.assertEqual(recorder.returncode, 1)
                self.assertIn("is the disk full?", recorder.stderr)
                self.assertTrue(json.loads(run("status", endpoint, "--json").stdout)["source_alive"])
            finally:
                daemon.terminate()
                daemon.wait()
            again = run("record", f"oni:{out}", Path(folder, "again.oni"), "--json")
            self.assertGreater(json.loads(again.stdout)["frames"], 1, again.stderr)


if __name__ == "__main__":
    unittest.main()
