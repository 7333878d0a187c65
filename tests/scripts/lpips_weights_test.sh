#!/usr/bin/env bash
# scripts/fetch_lpips_weights.sh and convert_lpips_weights.py, on files in the formats of torch.save: lpips_weights_test.sh GLINT_LPIPS
set -euo pipefail
for program in python3 curl; do
  command -v "$program" >/dev/null || { echo "skipped: no $program"; exit 77; }
done
lpips=$(readlink -f "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
cd "$folder"
export PYTHONPATH=$root/tests/scripts PYTHONDONTWRITEBYTECODE=1
export GLINT_LPIPS_NETWORKS=file://$folder/web GLINT_LPIPS_LINEAR=file://$folder/web
fetch() { "$root/scripts/fetch_lpips_weights.sh" --out "$folder/out" "$@"; }

# Without a network: which file to put where.
code=0
fetch alex >said 2>&1 || code=$?
[ "$code" -eq 6 ] || fail "exit code $code, expected 6"
grep -q "web/alex.pth  ->  $folder/out/downloads/alex.pth" said || fail "$(cat said)"
grep -q "alexnet-owt-7be5be79.pth  ->" said || fail "$(cat said)"

# Made-up weights in both formats, and a name that promises other bytes.
mkdir web
python3 - <<'PYTHON'
from torch_save import Tensor, save_row, save_zip
shapes = [(64, 3, 11, 11), (192, 64, 5, 5), (384, 192, 3, 3), (256, 384, 3, 3), (256, 256, 3, 3)]
features, lin = {}, {}
for layer, (place, shape) in enumerate(zip((0, 3, 6, 8, 10), shapes)):
    count = shape[0] * shape[1] * shape[2] * shape[3]
    features[f"features.{place}.weight"] = Tensor(shape, [((7 * i + layer) % 23 - 11) / 400 for i in range(count)])
    features[f"features.{place}.bias"] = Tensor((shape[0],), [0.01 * (i % 3) for i in range(shape[0])])
    lin[f"lin{layer}.model.1.weight"] = Tensor((1, shape[0], 1, 1), [0.001 * (i % 5) for i in range(shape[0])])
features["classifier.1.weight"] = Tensor((2, 2), [0, 0, 0, 0])
save_zip("features.pth", features)
save_row("features_row.pth", features)
save_zip("web/alexnet-owt-7be5be79.pth", features)
save_row("web/alex.pth", lin)
PYTHON
fetch alex >said 2>&1 && fail "a file that is not what its name says was taken"
grep -q "its name says 7be5be79" said || fail "$(cat said)"
convert() { "$root/scripts/convert_lpips_weights.py" --net alex --lin web/alex.pth "$@"; }
convert --features features.pth --out none >said 2>&1 && fail "made-up weights passed for the published"
grep -q "other values than those that were published" said && [ ! -e none ] || fail "$(cat said)"
convert --features features.pth --out a --unpublished >/dev/null
convert --features features_row.pth --out b --unpublished >/dev/null
cmp a/lpips_alex_v0.1.safetensors b/lpips_alex_v0.1.safetensors || fail "the two formats gave other bytes"
python3 - <<'PYTHON'
import json, struct, zipfile
data = open("a/lpips_alex_v0.1.safetensors", "rb").read()
(length,) = struct.unpack_from("<Q", data)
with zipfile.ZipFile("lpips_alex_v0.1.npz", "w", zipfile.ZIP_DEFLATED) as archive:
    for name, tensor in json.loads(data[8:8 + length]).items():
        begin, end = tensor["data_offsets"]
        header = repr({"descr": "<f4", "fortran_order": False, "shape": tuple(tensor["shape"])}).encode()
        values = data[8 + length + begin:8 + length + end]
        archive.writestr(name + ".npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + values)
PYTHON
convert --npz lpips_alex_v0.1.npz --out c --unpublished >/dev/null
cmp a/lpips_alex_v0.1.safetensors c/lpips_alex_v0.1.safetensors || fail "an .npz of earlier versions gave other bytes"
head -c 1000 lpips_alex_v0.1.npz >lpips_alex_cut.npz
convert --npz lpips_alex_cut.npz --out none --unpublished >said 2>&1 && fail "a cut .npz was taken"
grep -q "lpips_alex_cut.npz: no .npz of LPIPS weights" said || fail "$(cat said)"
head -c 1000000 features_row.pth >cut.pth
convert --features cut.pth --out none --unpublished >said 2>&1 && fail "a cut file was taken"
grep -q "cut off" said || fail "$(cat said)"

# They are weights to glint-lpips.
python3 - <<'PYTHON'
import struct, zlib
def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
for name, shift in (("a.png", 0), ("b.png", 40)):
    rows = b"".join(b"\0" + bytes((x * 3 + y * 5 + c * 60 + shift) % 256 for x in range(64) for c in range(3)) for y in range(64))
    open(name, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", 64, 64, 8, 2, 0, 0, 0)) +
                           chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
PYTHON
"$lpips" a.png b.png --net alex --weights a/lpips_alex_v0.1.safetensors --quiet >value
grep -Eq "[0-9]\.[0-9]" value || fail "no distance: $(cat value)"
echo "weights are fetched, checked and converted"
