# SPDX-License-Identifier: MIT
"""Every file of docs/examples ends well in a folder of its own, as its first lines say it is run."""

import os
import subprocess
import sys
import unittest

from support import ROOT, RoomCase

SKIPPED = 77


class Examples(RoomCase):
    def run_example(self, script):
        return subprocess.run(
            [sys.executable, str(script), str(self.room), "--iterations", "60"],
            cwd=self.folder, capture_output=True, text=True, env=os.environ,
        )

    def test_all(self):
        scripts = sorted((ROOT / "docs/examples").glob("*.py"))
        self.assertGreaterEqual(len(scripts), 3)
        for script in scripts:
            with self.subTest(script.name):
                done = self.run_example(script)
                if done.returncode == SKIPPED:
                    print(f"skipped: {script.name}: {done.stderr.strip()}", file=sys.stderr)
                    continue
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(done.stdout)

    def test_they_say_how_to_run_them(self):
        for script in (ROOT / "docs/examples").glob("*.py"):
            text = script.read_text()
            self.assertIn(f"python3 docs/examples/{script.name}", text)
            self.assertIn("PYTHONPATH=build/release/python", text)


if __name__ == "__main__":
    unittest.main()
