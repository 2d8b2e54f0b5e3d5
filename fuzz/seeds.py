"""Seeds of all targets: python3 seeds.py DEA MAKE_SAMPLES FOLDER. One folder each, from the samples and from what dea writes."""
import base64
import pathlib
import re
import struct
import subprocess
import sys
import zlib

dea, make_samples, top = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
source = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(source / "tests"))
import stl_shapes  # noqa: E402


def folder(name):
    (top / name).mkdir(parents=True, exist_ok=True)
    return top / name


def run(*words):
    subprocess.run([str(w) for w in words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


models = folder("feb")
for name in ("spheres", "two-layer-spheres", "sphere-on-flat", "plateaus", "ligament", "knee", "menisci", "chain"):
    run(make_samples, f"--{name}", 2, models / f"{name}.feb")
model = models / "sphere-on-flat.feb"

# Plot files of dea: as they are, compressed, with rims and springs; and FEBio's beginning
plots = folder("xplt")
run(dea, "run", model, "-q", "--states", "last", "--law", "linear", "-o", plots / "run.xplt", "--overwrite")
run(dea, "run", model, "-q", "--states", "last", "--law", "linear", "-o", plots / "compressed.xplt", "--compress", "--overwrite")
run(dea, "info", model, "-o", plots / "check.xplt", "--overwrite")
(plots / "febio.xplt").write_bytes((source / "samples/hip/hip_walking_febio.xplt").read_bytes()[:20000])

# Every example of a setting, in a file of its own and all together
settings = folder("settings")
examples = re.findall(r"`(<([\w-]+)[^`]*</\2>)`", (source / "docs/settings.md").read_text())
for number, (example, _) in enumerate(examples):
    (settings / f"{number}.xml").write_text(f'<febiodea_settings version="1">\n{example}\n</febiodea_settings>\n')
(settings / "all.xml").write_text('<febiodea_settings version="1">\n' + "\n".join(e for e, _ in examples) + "\n</febiodea_settings>\n")

# The first byte says what the table is
tables = folder("tables")
gait = (source / "samples/osteotomy/gait.csv").read_bytes()
(tables / "loads").write_bytes(b"\0" + gait)
(tables / "sto").write_bytes(b"\1gait\nversion=1\nnRows=2\nnColumns=4\ninDegrees=no\nendheader\ntime\thip_fx\thip_fy\thip_fz\n0\t240\t-160\t1200\n1\t432\t-262\t1834\n")
(tables / "motion").write_bytes(b"\2time,tx,ty,tz,rx,ry,rz\n0,0,0,0,0,0,0\n1,0.1,0,-1,5,0,2e1\n")
(tables / "thickness").write_bytes(b"\3node,thickness\n1,1.5\n2,0\n")
(tables / "cases").write_bytes(b'\4tilt,model,"E, MPa"\n10,"a.feb",8\n-10,b.feb,"12"\n')
(tables / "landmarks").write_bytes(b"\5name,x,y,z\nASIS left,1,2,3\nASIS right,-1,2,3e0\n")
(tables / "markups").write_bytes(b"\6# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n# columns = id,x,y,z,label,defined\n1,1,2,3,hip,1\n2,0,0,0,knee,0\n")
(tables / "matrix").write_bytes(b"\x09# pose\n0 -1 0 1\n1 0 0 2e1\n0 0 1 3\n0 0 0 1\n")
(tables / "transform").write_bytes(b"\x09#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
                                  b"Parameters: 0 -1 0 1 0 0 0 0 1 0 0 5\nFixedParameters: 1 0 0\n")
(tables / "ligaments").write_bytes(b"\x0aname,body_a,x_a,y_a,z_a,body_b,x_b,y_b,z_b,stiffness [N],slack_length,reference_strain,curve,toe_strain\n"
                                  b"ACL,femur,1,2,3,tibia,4,5,6,5000,,0.06,,\nMCL,tibia,0,0,0,femur,1,1,1,2750,80,,linear,\n")
(tables / "json").write_bytes(b'\7{"markups": [{"coordinateSystem": "LPS", "controlPoints": [{"label": "RASIS", "position": [1.5, -2, 3e0], '
                             b'"positionStatus": "defined"}]}]}')
matrix = [1, 0, 0, 0.1, 0, 0, -1, 2, 0, 1, 0, 3, 0, 0, 0, 1]
(tables / "matrices").write_bytes(b"\x08time," + ",".join(f"femur_T{i}{j}" for i in range(1, 5) for j in range(1, 5)).encode()
                                 + b"\n1," + ",".join(map(str, matrix)).encode() + b"\n")

# One small shape in each format
surfaces = folder("surfaces")
corners, facets = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
text = {
    0: stl_shapes.cap(10, 40, True, 1),
    1: "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in facets),
    2: "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\n"
       "end_header\n" + "".join("%g %g %g\n" % p for p in corners) + "".join("3 %d %d %d\n" % f for f in facets),
    3: "# vtk DataFile Version 3.0\nshape\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n" + "".join("%g %g %g\n" % p for p in corners)
       + "POLYGONS 4 16\n" + "".join("3 %d %d %d\n" % f for f in facets),
    4: '<VTKFile type="PolyData" version="0.1"><PolyData><Piece NumberOfPoints="4" NumberOfPolys="4"><Points><DataArray type="Float32" '
       'NumberOfComponents="3" format="ascii">' + " ".join("%g %g %g" % p for p in corners) + '</DataArray></Points><Polys><DataArray type="Int32" '
       'Name="connectivity" format="ascii">' + " ".join("%d %d %d" % f for f in facets) + '</DataArray><DataArray type="Int32" Name="offsets" '
       'format="ascii">3 6 9 12</DataArray></Polys></Piece></PolyData></VTKFile>',
}
for kind, content in text.items():
    (surfaces / str(kind)).write_bytes(bytes([kind]) + content.encode())
(surfaces / "binary_stl").write_bytes(b"\0" + b"binary".ljust(80) + (1).to_bytes(4, "little") + bytes(12) + bytes.fromhex("0000803f" * 9) + bytes(2))


def vtp(packed, appended):
    """Numbers as bytes: in base64, or raw behind the XML."""
    raw, arrays = b"", []
    for kind, name, code, numbers in (("Float32", "Points", "f", sum(corners, ())), ("Int32", "connectivity", "i", sum(facets, ())),
                                      ("Int32", "offsets", "i", (3, 6, 9, 12))):
        data = struct.pack(f"<{len(numbers)}{code}", *numbers)
        short = zlib.compress(data)
        parts = [struct.pack("<4I", 1, len(data), 0, len(short)), short] if packed else [struct.pack("<I", len(data)) + data]
        arrays.append(f'<DataArray type="{kind}" Name="{name}" ' + (f'format="appended" offset="{len(raw)}"/>' if appended else
                      'format="binary">' + "".join(base64.b64encode(p).decode() for p in parts) + "</DataArray>"))
        raw += b"".join(parts)
    head = ('<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt32"' + (' compressor="vtkZLibDataCompressor"' if packed else "")
            + f"><PolyData><Piece><Points>{arrays[0]}</Points><Polys>{arrays[1]}{arrays[2]}</Polys></Piece></PolyData>")
    return head.encode() + (b'<AppendedData encoding="raw">_' + raw + b"</AppendedData>" if appended else b"") + b"</VTKFile>"


for packed in (False, True):
    for appended in (False, True):
        (surfaces / f"vtp{packed:d}{appended:d}").write_bytes(b"\4" + vtp(packed, appended))

studies = folder("study")
(studies / "study.db").unlink(missing_ok=True)
run(dea, "study", model, "--vary", "E: E={8|12}", "--law", "linear", "--states", "last", "--keep", "fields", "-o", studies / "study.db", "-q")

lines = folder("expressions")
for number, line in enumerate(("sin(2*pi*t)", "step(t-0.5)*max(t,1,2)^2", "-exp(-t/0.1)+H(t)", "atan2(1,t)", "avg(t,mod(t,2))")):
    (lines / f"formula{number}").write_bytes(b"\0\0" + line.encode())
    (lines / f"constant{number}").write_bytes(b"\1\0" + line.replace("t", "3").encode())
for number, line in enumerate(("tilt: rotate pelvis=0,1,0,{-10:10:5}", "E: E={8|12}", "E: E={normal(10,2)}", "f: force femur={}")):
    (lines / f"factor{number}").write_bytes(b"\2\0" + line.encode())
for number in range(60):
    (lines / f"setting{number}").write_bytes(bytes([3, number]) + (b"0,1,0,10", b"x,Ru", b"sphere-center", b"1,0,0/0,1,0/0,0,1", b"2.5", b"layer")[number % 6])
print("\n".join(f"{path.name}: {len(list(path.iterdir()))} seeds" for path in sorted(top.iterdir())))
