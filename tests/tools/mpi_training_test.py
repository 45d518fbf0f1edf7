#!/usr/bin/env python3
"""Trains a small forest in one process and under mpirun: the files must be the same.

usage: mpi_training_test.py BUILD_DIRECTORY
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = Path(sys.argv[1])
ARMATURE = BUILD / "bin" / "armature"
PLUGIN = BUILD / "lib" / "armature" / "armature_mpi.so"
SMALL = ["--images", 12, "--trees", 2, "--depth", 9, "--pixels", 100, "--features", 30, "--min-leaf", 5,
         "--correction-images", 20]

# OpenMPI refuses root, and more ranks than cores, unless told; a test in a container is both.
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_rmaps_base_oversubscribe="1")


def train(model, *arguments, ranks=0, program=ARMATURE):
    command = [program, "forest", "train", model, *SMALL, "--threads", 1, *arguments]
    if ranks:
        command = ["mpirun", "-n", ranks, *command]
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, env=ENVIRONMENT, timeout=500)


def lines_of_ours(result):
    return [line for line in result.stderr.splitlines() if line.startswith("armature:")]


class MpiTraining(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.here = Path(directory.name)
        self.addCleanup(directory.cleanup)

    def test_one_process_and_four_ranks_write_the_same_file(self):
        alone = train(self.here / "one.forest")
        self.assertEqual(alone.returncode, 0, alone.stderr)
        together = train(self.here / "four.forest", ranks=4)
        self.assertEqual(together.returncode, 0, together.stderr)
        self.assertEqual((self.here / "four.forest").read_bytes(), (self.here / "one.forest").read_bytes())
        shares = [int(share) for share in re.findall(r"growing trees: +(\d+) %", together.stderr)]
        self.assertTrue(shares, together.stderr)
        self.assertEqual(shares, sorted(set(shares)), "progress of one rank alone:\n" + together.stderr)
        self.assertEqual(sorted(path.name for path in self.here.iterdir()), ["four.forest", "one.forest"])

    def test_what_fails_is_said_once(self):
        result = train(self.here / "missing" / "model.forest", ranks=3)
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(len(lines_of_ours(result)), 1, result.stderr)
        self.assertIn("missing", lines_of_ours(result)[0])

    def test_without_the_plugin_ranks_are_refused_and_one_process_trains(self):
        (self.here / "bin").mkdir()
        program = self.here / "bin" / "armature"
        shutil.copy(ARMATURE, program)
        result = train(self.here / "model.forest", ranks=3, program=program)
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(len(lines_of_ours(result)), 1, result.stderr)
        self.assertIn("libopenmpi-dev", lines_of_ours(result)[0])
        self.assertFalse((self.here / "model.forest").exists())
        self.assertEqual(train(self.here / "model.forest", program=program).returncode, 0)

    def test_the_program_itself_needs_no_mpi(self):
        linked = subprocess.run(["ldd", ARMATURE], capture_output=True, text=True, check=True).stdout
        self.assertNotIn("libmpi", linked)


if __name__ == "__main__":
    if not shutil.which("mpirun") or not PLUGIN.exists():
        print("skipped: no mpirun, or built without MPI (tools/setup --mpi installs it)")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
