# SPDX-License-Identifier: MIT
"""Writes files in the two formats of torch.save, without PyTorch, for tests of scripts/torch_files.py."""
import array
import collections
import io
import os
import pickle
import struct
import sys
import types
import zipfile

torch, utils = types.ModuleType("torch"), types.ModuleType("torch._utils")
sys.modules.update({"torch": torch, "torch._utils": utils})


class FloatStorage:
    pass


def _rebuild_tensor_v2(*_):
    pass


# What they are called in files.
FloatStorage.__module__, _rebuild_tensor_v2.__module__ = "torch", "torch._utils"
torch.FloatStorage, torch._utils, utils._rebuild_tensor_v2 = FloatStorage, utils, _rebuild_tensor_v2


class Storage:
    def __init__(self, values):
        self.values = array.array("f", values)


class Tensor:
    def __init__(self, shape, values):
        self.shape, self.storage = tuple(shape), Storage(values)

    def __reduce__(self):
        stride, count = [], 1
        for extent in reversed(self.shape):
            stride.insert(0, count)
            count *= extent
        return _rebuild_tensor_v2, (self.storage, 0, self.shape, tuple(stride), False, collections.OrderedDict())


class Trap:
    """Touches a file where what the pickle names is called."""

    def __reduce__(self):
        return os.system, ("touch trapped",)


class Pickler(pickle.Pickler):
    def __init__(self, file):
        super().__init__(file, 2)
        self.stored = {}  # key -> values

    def persistent_id(self, value):
        if not isinstance(value, Storage):
            return None
        key = str(id(value))
        self.stored[key] = value.values
        return "storage", FloatStorage, key, "cpu", len(value.values), None


def save_zip(path, payload):
    pickled = io.BytesIO()
    pickler = Pickler(pickled)
    pickler.dump(payload)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("archive/data.pkl", pickled.getvalue())
        for key, values in pickler.stored.items():
            archive.writestr(f"archive/data/{key}", values.tobytes())


def save_row(path, payload):
    with open(path, "wb") as file:
        for plain in (0x1950A86A20F9469CFC6C, 1001, {"little_endian": True}):
            pickle.dump(plain, file, 2)
        pickler = Pickler(file)
        pickler.dump(payload)
        pickle.dump(list(pickler.stored), file, 2)
        for values in pickler.stored.values():
            file.write(struct.pack("<q", len(values)) + values.tobytes())
