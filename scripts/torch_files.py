# SPDX-License-Identifier: MIT
"""Reads tensors of files that torch.save wrote, without PyTorch and without running anything of them.

Both formats: the zip of PyTorch 1.6 and later, and the older one, a row of pickles with the values behind. Of the
pickle only tensors of 32-bit floats and plain containers are made; whatever else it names becomes an empty
placeholder that does nothing.
"""
import array
import collections
import io
import pickle
import struct
import sys
import zipfile

MAGIC = 0x1950A86A20F9469CFC6C  # first in the older format


class BadFile(Exception):
    pass


class Tensor:
    """A tensor of 32-bit floats; values() reads them, rows first."""

    def __init__(self, storage, offset, shape, stride):
        self.storage, self.offset, self.shape, self.stride = storage, offset, tuple(shape), tuple(stride)
        self.name = "a tensor"  # with its file

    def values(self):
        count, steps = 1, []
        for extent in reversed(self.shape):
            steps.insert(0, count)
            count *= extent
        if any(extent > 1 and a != b for extent, a, b in zip(self.shape, self.stride, steps)):
            raise BadFile(f"{self.name}: not contiguous")
        floats = self.storage()
        if self.offset < 0 or self.offset + count > len(floats):
            raise BadFile(f"{self.name}: damaged: {count} values from {self.offset} on, but only {len(floats)} are there")
        return floats[self.offset:self.offset + count]


class Placeholder:
    """Optimisers, random states, configurations, and whatever else a file names."""

    def __init__(self, *_, **__):
        pass

    def __call__(self, *_, **__):
        return Placeholder()

    def __setstate__(self, _):
        pass

    def __setitem__(self, *_):
        pass

    def append(self, _):
        pass

    def extend(self, _):
        pass


def rebuild_tensor(storage, offset, shape, stride, *_):
    return Placeholder() if storage is None else Tensor(storage, offset, shape, stride)


KNOWN = {
    ("torch._utils", "_rebuild_tensor_v2"): rebuild_tensor,
    ("torch._utils", "_rebuild_tensor"): rebuild_tensor,
    ("torch._utils", "_rebuild_parameter"): lambda data, *_: data,
    ("collections", "OrderedDict"): collections.OrderedDict,
    ("torch", "FloatStorage"): "float",
}


class Reader(pickle.Unpickler):
    def __init__(self, file, storages):
        super().__init__(file)
        self.storages = storages  # key -> floats

    def find_class(self, module, name):
        return KNOWN.get((module, name), Placeholder)

    def persistent_load(self, identity):
        _, kind, key = identity[:3]
        return (lambda: self.storages(str(key))) if kind == "float" else None


def floats_of(data):
    if len(data) % 4:
        raise BadFile("cut off")
    floats = array.array("f")
    floats.frombytes(data)
    if sys.byteorder == "big":
        floats.byteswap()
    return floats


def load_zip(path):
    archive = zipfile.ZipFile(path)
    names = set(archive.namelist())
    pickles = [name for name in names if name.rpartition("/")[2] == "data.pkl"]
    if len(pickles) != 1:
        raise BadFile(f"{len(pickles)} files data.pkl, expected one")
    prefix = pickles[0][:-len("data.pkl")]

    def storage(key):
        if f"{prefix}data/{key}" not in names:
            raise BadFile(f"no {prefix}data/{key}")
        return floats_of(archive.read(f"{prefix}data/{key}"))

    return Reader(io.BytesIO(archive.read(pickles[0])), storage).load()


def load_row(path):
    with open(path, "rb") as file:
        def plain():
            return Reader(file, None).load()

        if plain() != MAGIC:
            raise BadFile("not a file of torch.save")
        plain(), plain()  # version, sizes of C types
        stored = {}
        payload = Reader(file, stored.__getitem__).load()
        for key in plain():
            (count,) = struct.unpack("<q", file.read(8))
            data = file.read(4 * count) if count >= 0 else b""
            if len(data) != 4 * count:
                raise BadFile("cut off")
            stored[str(key)] = floats_of(data)
    return payload


def load(path):
    """What torch.save was given. Errors: BadFile, also for damaged ones."""
    try:
        return load_zip(path) if zipfile.is_zipfile(path) else load_row(path)
    except BadFile as error:
        raise BadFile(f"{path}: {error}") from None
    except (pickle.UnpicklingError, EOFError, AttributeError, ImportError, IndexError, KeyError, MemoryError,
            OverflowError, TypeError, ValueError, struct.error, zipfile.BadZipFile) as error:
        raise BadFile(f"{path}: damaged, or no file of torch.save: {error}") from None


def tensors(path, prefixes=("",)):
    """name -> Tensor of a file that holds a dictionary of them, or one below "model"."""
    payload = load(path)
    state = payload.get("model", payload) if isinstance(payload, dict) else None
    if not isinstance(state, dict):
        raise BadFile(f"{path}: holds no dictionary of tensors")
    found = {name: value for name, value in state.items() if isinstance(value, Tensor) and name.startswith(prefixes)}
    for name, tensor in found.items():
        tensor.name = f"{path}: {name}"
    return found
