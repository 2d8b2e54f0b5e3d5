"""Names are data: python3 names.py DEA MAKE_SAMPLES.

A small model is solved with its own names and with nasty ones. Every command must do the same with both, and what it prints
must be text: no control character but its own line breaks, nothing that is no UTF-8, and short. Cells of CSV are no formulas."""
import csv
import io
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.dom.minidom

dea, make_samples = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
NASTY = {
    "escape": b"red&#27;[31m&#7;", "line": b"two&#10;lines", "return": b"a&#13;b", "tab": b"a&#9;b", "formula": b"=cmd|' /C calc'!A0",
    "at": b"@SUM(1)", "minus": b"-1+cmd|x", "page": b"&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;", "latin": b"\xfcber\x80",
    "turned": "a\u202eb\u009bc".encode(), "quote": b"a&quot;b&amp;c", "long": b"m" * 1000000,
}
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
COMMANDS = [
    "run m.feb -o m.xplt --csv m.csv --json m.json --report m.html --vtu m_vtu", "info m.feb", "cite m.feb",
    "converge m.feb --max-springs 3000", "convert m.feb -o again.feb", "run again.feb -o again.xplt --csv again.csv",
    "compare m.xplt again.xplt --csv compared.csv", "plot m.xplt -o m.svg", "plot m.xplt -o m.png",
    "study m.feb --vary scale:E={8|9} -o m.db --csv study.csv --report study.html", "run m.feb --thickness none=2 --no-xplt",
]
faults = []


def with_names(model, names):
    """Its names replaced by the nasty ones in turn, a number behind each so that they differ."""
    for i, name in enumerate(sorted(set(re.findall(rb' name="([^"]+)"', model)))):
        new = names[i % len(names)] + b" %d" % i
        for before, behind in ((b'"', b'"'), (b">", b"<")):
            model = model.replace(before + name + behind, before + new + behind)
    return model


def numbers(text):
    """Of a table: its cells that are numbers, but for seconds."""
    rows = list(csv.reader(io.StringIO(text)))
    kept = [i for i, name in enumerate(rows[0]) if name not in ("seconds", "warnings")]
    return [[row[i] for i in kept if re.fullmatch(r"[-+0-9.e]+", row[i])] for row in rows[1:]]


def look(folder, names):
    """Codes of all commands and the numbers of all tables; what is printed is looked at."""
    codes, tables = [], {}
    for command in COMMANDS:
        done = subprocess.run([dea, *command.split()], cwd=folder, capture_output=True)
        codes.append(done.returncode)
        try:
            text = (done.stdout + done.stderr).decode()
        except UnicodeDecodeError as e:
            faults.append(f"{names}: {command}: {e}")
            continue
        if CONTROL.search(text):
            faults.append(f"{names}: {command}: control character in {text[max(0, CONTROL.search(text).start() - 60):][:120]!r}")
        if len(text) > 100000:
            faults.append(f"{names}: {command}: prints {len(text)} characters")
    for path in pathlib.Path(folder).glob("*.csv"):
        text = path.read_bytes().decode()
        tables[path.name] = numbers(text)
        for row in csv.reader(io.StringIO(text)):
            for cell in row:
                if re.match(r"[=@\t\r]|[-+](?![-+0-9.e,]*$)", cell):
                    faults.append(f"{names}: {path.name}: the cell {cell[:60]!r}")
    for page in ("m.html", "study.html"):
        text = (pathlib.Path(folder) / page).read_bytes().decode()
        if "<script>alert" in text:
            faults.append(f"{names}: {page} runs a name")
    json.loads((pathlib.Path(folder) / "m.json").read_text())
    for file in [pathlib.Path(folder) / "m.svg", *(pathlib.Path(folder) / "m_vtu").glob("*.pvd")]:
        xml.dom.minidom.parse(str(file))
    return codes, tables


with tempfile.TemporaryDirectory() as folder:
    model = pathlib.Path(folder) / "m.feb"
    subprocess.run([make_samples, "--plateaus", "4", model], check=True)
    own = model.read_bytes()
    plain = look(folder, "own names")
    assert max(plain[0][:-1]) <= 1 and plain[0][-1] == 2, plain[0]
    short = [n for kind, n in NASTY.items() if kind != "long"]
    for kind, names in [("short names", short), ("a long name", [NASTY["long"], b"part"]), ("one kind, turned", short[::-1])]:
        with tempfile.TemporaryDirectory() as other:
            (pathlib.Path(other) / "m.feb").write_bytes(with_names(own, names))
            found = look(other, kind)
        if found != plain:
            faults.append(f"{kind}: other codes or numbers: {found[0]}")
for fault in faults:
    print(fault)
sys.exit(1 if faults else 0)
