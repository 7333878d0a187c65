#!/usr/bin/env bash
# scripts/glint_checkpoint_to_ply.py reads a checkpoint as PyTorch writes it, runs nothing of it, and says what is
# wrong with others.
set -euo pipefail
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
cd "$folder"

export PYTHONPATH=$root/tests/scripts PYTHONDONTWRITEBYTECODE=1
python3 - <<'PYTHON'
import collections
from torch_save import Tensor, Trap, save_zip

def count(shape):
    product = 1
    for extent in shape: product *= extent
    return product

model = collections.OrderedDict()
for number, prefix in enumerate(["pcd", "trans_env", "env"]):
    rows = 2 + number
    shapes = {"_xyz": (rows, 3), "_features_dc": (rows, 1, 3), "_features_rest": (rows, 15, 3), "_scaling": (rows, 2),
              "_rotation": (rows, 4), "_opacity": (rows, 1)}
    if prefix != "env": shapes.update({"_specular": (rows, 1), "_transmission_coeff": (rows, 1)})
    for k, (name, shape) in enumerate(shapes.items()):
        model[f"sampler.{prefix}.{name}"] = Tensor(shape, range(1000 * k, 1000 * k + count(shape)))
save_zip("latest.pt", {"model": model, "epoch": 7, "optimizer": Trap()})
PYTHON

python3 "$root/scripts/glint_checkpoint_to_ply.py" latest.pt --out model >said
[ ! -e trapped ] || fail "the checkpoint's own code ran"
grep -q "interface.ply: 2 surfels" said && grep -q "transmission.ply: 3" said && grep -q "reflection.ply: 4" said || fail "$(cat said)"
grep -q "specularity of the transmission set is left out" said || fail "$(cat said)"
cat >look.py <<'PYTHON'
import array
header, _, body = open("model/interface.ply", "rb").read().partition(b"end_header\n")
fields = [line.split()[2].decode() for line in header.splitlines() if line.startswith(b"property")]
values = array.array("f"); values.frombytes(body)
row = dict(zip(fields, values[len(fields):]))  # of the second surfel
assert len(values) == 2 * len(fields), len(values)
expected = {"x": 3, "z": 5, "f_dc_1": 1004, "f_rest_0": 2045, "f_rest_15": 2046, "f_rest_1": 2048, "scale_1": 3003,
            "rot_0": 4004, "opacity": 5001, "specular": 6001, "transparency": 7001}
assert {name: row[name] for name in expected} == expected, row
PYTHON
python3 look.py

refused() {
  python3 "$root/scripts/glint_checkpoint_to_ply.py" "$1" --out none >refusal 2>&1 && fail "$1 was taken"
  grep -q "$2" refusal || fail "$1: expected '$2', found: $(cat refusal)"
}
head -c 300 latest.pt >cut.pt
refused cut.pt "damaged, or no file of torch.save"
refused missing.pt "not there"
python3 - <<'PYTHON'
import zipfile
with zipfile.ZipFile("latest.pt") as old, zipfile.ZipFile("short.pt", "w") as new, zipfile.ZipFile("mangled.pt", "w") as mangled:
    first = next(name for name in old.namelist() if "/data/" in name)
    for name in old.namelist():
        new.writestr(name, old.read(name)[:4] if name.endswith(first) else old.read(name))
        mangled.writestr(name, old.read(name)[:200] if name.endswith("data.pkl") else old.read(name))
PYTHON
refused short.pt "damaged"
refused mangled.pt "damaged"
[ ! -e none ] || fail "something was written"
echo "checkpoints are read, and nothing of them is run"
