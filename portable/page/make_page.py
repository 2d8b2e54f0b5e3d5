#!/usr/bin/env python3
"""The page that solves, as one file: make_page.py DEA.js DEA.wasm SAMPLE.feb LICENCES.txt PAGE.html

DEA.js and DEA.wasm are what emscripten makes of the program. Packed: gzip, then 13 bits in two of the 94 characters from the space to ~
without <, which is an eighth less than base64. Python's standard library only."""
import gzip
import pathlib
import sys

MOST = 4_200_000  # bytes


def digits(data):
    alphabet = [chr(c) for c in range(32, 127) if c != ord("<")]
    pairs = [a + b for b in alphabet for a in alphabet]
    held = bits = 0
    for byte in data:
        held |= byte << bits
        bits += 8
        if bits >= 13:
            yield pairs[held & 8191]
            held >>= 13
            bits -= 13
    if bits:
        yield pairs[held]


def packed(name, data, attributes=""):
    small = gzip.compress(data, 9, mtime=0)
    return f'<script type="text/plain" id="{name}"{attributes} data-bytes="{len(small)}">{"".join(digits(small))}</script>\n'


def main():
    if len(sys.argv) != 6:
        sys.exit(__doc__)
    code, module, sample, licences, page = map(pathlib.Path, sys.argv[1:])
    here = pathlib.Path(__file__).parent
    report = here / "../../views/page/html"
    text = {
        "report_style": (report / "style.css").read_text(),
        "elements": (report / "elements.js").read_text(),
        "style": (here / "page.css").read_text(),
        "main": (here / "page.js").read_text(),
        "hand": (here / "hand.js").read_text(),
        "plan": (here / "plan.js").read_text(),
        "live": (here / "live.js").read_text(),
        "packed": packed("code", code.read_bytes() + b"\n" + (here / "worker.js").read_bytes())
        + packed("module", module.read_bytes())
        + packed("sample-model", sample.read_bytes(), f' data-gives-way="1" data-name="{sample.name}"')
        + packed("licence-texts", licences.read_bytes()),
    }
    html = (here / "dea.html").read_text()
    for name, content in text.items():
        html = html.replace(f"@{name}@", content.rstrip("\n"))
    page.write_bytes(html.encode())
    if len(html.encode()) > MOST:
        sys.exit(f"{page}: found {len(html.encode())} bytes, expected at most {MOST}")
    print(f"{page}: {len(html.encode())} bytes")


main()
