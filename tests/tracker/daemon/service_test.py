#!/usr/bin/env python3
"""What armatured tells systemd, and that its unit and package hold. usage: service_test.py BUILD SOURCE"""
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "support"))
from free_ports import four_free_ports  # noqa: E402

SOURCE = Path(sys.argv.pop(2)).resolve()
BUILD = Path(sys.argv.pop(1)).resolve()
MOST_EXPOSURE = 2.0


class Notify(unittest.TestCase):
    def test_says_ready_feeds_the_watchdog_without_a_sensor_and_says_stopping(self):
        with tempfile.TemporaryDirectory() as folder:
            listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            self.addCleanup(listener.close)
            listener.bind(f"{folder}/notify")
            listener.settimeout(20)
            environment = dict(os.environ, NOTIFY_SOCKET=f"{folder}/notify", WATCHDOG_USEC="800000")
            daemon = subprocess.Popen(
                [BUILD / "bin" / "armatured", "--source", f"process:fakenect:{folder}/nothing", "--endpoint",
                 f"ipc://{folder}/nav", "--quiet"], env=environment)
            try:
                self.assertEqual(listener.recv(4096).decode(), "READY=1")
                fed, said = 0, []
                while fed < 3 or not any("INDEX.txt" in line for line in said):
                    heard = listener.recv(4096).decode()
                    fed += heard == "WATCHDOG=1"
                    said += [heard] if heard.startswith("STATUS=") else []
                self.assertEqual(said[0], "STATUS=running")
                self.assertIn("STATUS=source lost: ", said[-1])
            finally:
                daemon.terminate()
                self.assertEqual(daemon.wait(timeout=20), 0)
            heard = listener.recv(4096).decode()
            while heard == "WATCHDOG=1" or heard.startswith("STATUS="):
                heard = listener.recv(4096).decode()
            self.assertIn("STOPPING=1", heard)


class Program:
    """armatured with a synthetic person, its log in a pipe of which it is told that it is the journal's, or not."""

    def __init__(self, folder, *words, endpoint=None, journal=False):
        self.endpoint = endpoint or f"ipc://{folder}/nav"
        self.reader, writer = os.pipe()
        pipe = os.fstat(writer)
        environment = dict(os.environ, JOURNAL_STREAM=f"{pipe.st_dev}:{pipe.st_ino if journal else pipe.st_ino + 1}")
        self.process = subprocess.Popen([BUILD / "bin" / "armatured", "--source", "synth:stand?size=160x120", "--endpoint",
                                         self.endpoint, *words], stderr=writer, env=environment)
        os.close(writer)

    def read_until(self, word):
        """Up to the line with that word, or to the end."""
        lines = ""
        while not re.search(f"{word}.*\n", lines):
            some = os.read(self.reader, 65536).decode()
            if not some:
                break
            lines += some
        return lines

    def ask(self, *words):
        return subprocess.run([BUILD / "bin" / "armature", "status", self.endpoint, *words], capture_output=True,
                              timeout=60).returncode

    def end(self):
        self.process.terminate()
        return self.process.wait(timeout=20)


class Log(unittest.TestCase):
    def test_has_the_journals_priorities_and_no_clock_there_and_a_clock_elsewhere(self):
        for journal, info, warning in ((True, r"<6>started: ", r"<4>config_rejected: "),
                                       (False, r"\d\d:\d\d:\d\d\.\d{3} armatured: started: ",
                                        r"\d\d:\d\d:\d\d\.\d{3} armatured: config_rejected: ")):
            with tempfile.TemporaryDirectory() as folder:
                program = Program(folder, journal=journal)
                lines = program.read_until("started")
                program.process.send_signal(signal.SIGHUP)  # without a file to read
                lines += program.read_until("config_rejected")
                self.assertEqual(program.end(), 0)
                self.assertRegex(lines, f"(?m)^{info}armatured ")
                self.assertRegex(lines, f"(?m)^{warning}started without --config")
                os.close(program.reader)

    def test_says_why_it_does_not_start_with_a_priority_too(self):
        with tempfile.TemporaryDirectory() as folder:
            for journal, begin in ((True, "<3>--endpoint: publish.endpoint = bogus: expected "),
                                   (False, "armatured: --endpoint: publish.endpoint = bogus: expected ")):
                program = Program(folder, endpoint="bogus", journal=journal)
                self.assertEqual(program.read_until("expected")[:len(begin)], begin)
                self.assertEqual(program.process.wait(timeout=20), 1)
                os.close(program.reader)

    def test_says_even_if_quiet_that_anybody_may_listen(self):
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder, "kiosk.toml")
            config.write_text(f"[publish]\ninsecure = true\n[control]\nendpoint = 'ipc://{folder}/nav'\n")
            endpoint = f"tcp://127.0.0.1:{four_free_ports()}"
            program = Program(folder, "--quiet", "--config", config, endpoint=endpoint, journal=True)
            self.assertIn(f"<3>{endpoint} is insecure", program.read_until("insecure"))
            self.assertEqual(program.end(), 0)
            self.assertEqual(program.read_until("nothing else"), "")
            os.close(program.reader)

    def test_may_lose_its_reader_while_the_daemon_goes_on(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Program(folder)
            program.read_until("started")
            os.close(program.reader)
            for _ in range(3):
                program.process.send_signal(signal.SIGHUP)  # each of which it would say something about
                self.assertEqual(program.ask(), 0)
            self.assertEqual(program.end(), 0)


class Unit(unittest.TestCase):
    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is missing")
    def test_is_hardened(self):
        unit = SOURCE / "tracker" / "daemon" / "armatured.service"
        told = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager", unit], capture_output=True,
                              text=True, env=dict(os.environ, LC_ALL="C.UTF-8"))
        exposure = re.search(r"exposure level for \S+: ([\d.]+)", told.stdout)
        self.assertIsNotNone(exposure, told.stdout + told.stderr)
        self.assertLessEqual(float(exposure[1]), MOST_EXPOSURE)


    def test_leaves_the_capture_process_to_the_daemon_and_lets_it_save(self):
        unit = (SOURCE / "tracker" / "daemon" / "armatured.service").read_text()
        self.assertIn("KillMode=mixed", unit.splitlines())
        config = Path(re.search(r"--config (\S+)", unit)[1])
        self.assertIn(f"ReadWritePaths={config.parent}", unit.splitlines())


if __name__ == "__main__":
    unittest.main()
