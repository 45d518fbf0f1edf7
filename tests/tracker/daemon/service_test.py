#!/usr/bin/env python3
"""What armatured tells systemd, and that its unit and package hold. usage: service_test.py BUILD SOURCE"""
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

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
