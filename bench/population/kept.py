#!/usr/bin/env python3
"""What is kept of FEBio's results: kept.py RESULTS KEPT packs each RESULTS/NAME.xplt that KEPT has not, as KEPT/NAME.xz.

Of the state under full load, in single precision as FEBio writes it: contact pressure, gap and force per facet, the displacement of the nodes of
the contact surfaces, the stress of the row of elements at the bone, the motion of the moving body. The mesh is not kept: joints.py makes it."""
import io
import json
import lzma
import pathlib
import struct
import sys
import tempfile
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/developers"))
import joints  # noqa: E402
from xplt_reader import PlotFile  # noqa: E402

SURFACE = {"pressure": ("contact pressure", 1), "gap": ("contact gap", 1), "force": ("contact force", 3)}


def joint_of(name):
    return joints.Joint(name.removesuffix("_finer"), name.endswith("_finer"))


def pack(arrays):
    """A line that says what follows, then the bytes of all, those of equal weight together: they pack better so."""
    head, body = {}, io.BytesIO()
    for name, a in arrays.items():
        a = np.ascontiguousarray(a, "<f4")
        head[name] = list(a.shape)
        body.write(a.reshape(-1).view("u1").reshape(-1, 4).T.tobytes())
    return lzma.compress(json.dumps(head).encode() + b"\n" + body.getvalue(), preset=9 | lzma.PRESET_EXTREME)


def unpack(data):
    head, _, body = lzma.decompress(data).partition(b"\n")
    out, at = {}, 0
    for name, shape in json.loads(head).items():
        size = 4 * int(np.prod(shape))
        out[name] = np.ascontiguousarray(np.frombuffer(body[at:at + size], "u1").reshape(4, -1).T).view("<f4").reshape(shape)
        at += size
    return out


def plain(path, out):
    """The plot file without compression: header and mesh are plain, each chunk after them is a zlib stream, one behind the other."""
    data = path.read_bytes()
    end = 4
    for _ in range(2):  # root, mesh
        end += 8 + struct.unpack_from("<I", data, end + 4)[0]
    head, rest = bytearray(data[:end]), data[end:]
    while rest:
        inflate = zlib.decompressobj()
        head += inflate.decompress(rest)
        rest = inflate.unused_data
    out.write_bytes(head)


def keep(path, joint):
    with tempfile.NamedTemporaryFile(suffix=".xplt") as file:
        plain(path, pathlib.Path(file.name))
        plot = PlotFile(file.name)
    reference, moved = np.array(plot.reference), np.array(plot.nodes)
    out, first, element = {}, 0, 0
    regions = [len(p.points.reshape(-1, 3)) for p in joint.patches]
    for k, patch in enumerate(joint.patches):
        rows, columns = patch.points.shape[:2]
        top = slice(first + joint.layers * rows * columns, first + (joint.layers + 1) * rows * columns)
        if np.abs(reference[top] - patch.points.reshape(-1, 3)).max() > 1e-4:
            raise SystemExit(f"{path}: found another mesh than that of {joint.name}")
        out[f"{patch.name}/displacement"] = moved[top] - reference[top]
        for name, (field, size) in SURFACE.items():
            _, values = plot.surface(patch.name, field)
            out[f"{patch.name}/{name}"] = np.array(values).reshape(-1, size)
        # domains of solids come first, in the order of the patches; their first row of elements is at the bone
        stress = np.array(plot.values(0x01024000, 0x02020400, "stress", k + 1)).reshape(-1, 6)
        out[f"{patch.name}/stress"] = stress[:(rows - 1) * (columns - 1)]
        first += (joint.layers + 1) * rows * columns
    mover = next(k for k, p in enumerate(joint.patches) if p.body == "mover")
    at = sum((joint.layers + 1) * n for n in regions[:mover])
    out["motion"] = (moved[at:at + regions[mover]] - reference[at:at + regions[mover]]).mean(axis=0)
    return pack(out)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    results, kept = map(pathlib.Path, sys.argv[1:])
    kept.mkdir(exist_ok=True)
    for path in sorted(results.glob("*.xplt")):
        target = kept / f"{path.stem}.xz"
        if target.exists():
            print(f"{target.name}: is there, left as it is")
            continue
        target.write_bytes(keep(path, joint_of(path.stem)))
        print(target.name, target.stat().st_size)
    about = [json.loads(file.read_text()) for file in (results / "febio.json", kept / "febio.json") if file.exists()]
    (kept / "febio.json").write_text(json.dumps({k: v for one in about for k, v in one.items()}, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
