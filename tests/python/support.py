# SPDX-License-Identifier: MIT
"""What tests of the Python module share. GLINT_BIN is the folder of the programs; without NumPy tests are skipped."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
except ImportError:
    print("skipped: no NumPy", file=sys.stderr)
    sys.exit(77)

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ["GLINT_BIN"])


def run_program(*arguments, check=True):
    done = subprocess.run([str(word) for word in arguments], capture_output=True, text=True)
    if check and done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.stderr}")
    return done


def tool(name, *arguments):
    """The JSON of glint-NAME."""
    return json.loads(run_program(BIN / f"glint-{name}", *arguments, "--json", "--quiet").stdout)


def make_room(folder, width=64, height=36, views=8, spp=2):
    run_program(
        BIN / "glint-bench", "dataset", "make", "glassroom", "--scene", "room_1", "--width", width, "--height",
        height, "--views", views, "--spp", spp, "--out", folder, "--quiet",
    )
    return folder


def write_lpips_weights(path):
    """Made-up weights of AlexNet, as safetensors."""
    rng = np.random.default_rng(3)
    shapes = [(64, 3, 11, 11), (192, 64, 5, 5), (384, 192, 3, 3), (256, 384, 3, 3), (256, 256, 3, 3)]
    arrays = {}
    for layer, (place, shape) in enumerate(zip((0, 3, 6, 8, 10), shapes)):
        arrays[f"features.{place}.weight"] = rng.normal(0, 0.05, shape)
        arrays[f"features.{place}.bias"] = rng.normal(0, 0.05, shape[:1])
        arrays[f"lin{layer}.weight"] = rng.random(shape[0])
    header, values = {}, b""
    for name, array in arrays.items():
        data = array.astype("<f4").tobytes()
        offsets = [len(values), len(values) + len(data)]
        header[name] = {"dtype": "F32", "shape": list(array.shape), "data_offsets": offsets}
        values += data
    text = json.dumps(header).encode()
    Path(path).write_bytes(len(text).to_bytes(8, "little") + text + values)


class FolderCase(unittest.TestCase):
    """A folder of its own for each test."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="glint_python_")
        self.addCleanup(self._folder.cleanup)
        self.folder = Path(self._folder.name)

    def save(self, name, array):
        path = self.folder / name
        np.save(path, array)
        return path


class RoomCase(FolderCase):
    """One tiny room for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="glint_python_room_")
        cls.addClassCleanup(folder.cleanup)
        cls.room = make_room(Path(folder.name) / "room")
