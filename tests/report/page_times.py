#!/usr/bin/env python3
"""How long pages take in a headless Chromium: page_times.py PAGE.html ... (docs/report.md, its table of sizes and times).

Per page: size [MB], seconds until it has been drawn (the better of two), and of eight states the median of the script's
time and of drawing all maps [ms].
"""
import os
import statistics
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402
from report_test import ready  # noqa: E402

STATES = """
  const n = Report.frames.length, gl = Page.maps.renderer.getContext(), script = [], draw = [];
  for (let k = 0; k < Math.min(n, 8); ++k) {
    const start = performance.now();
    Page.setFrame(Math.floor(k * (n - 1) / 7));
    const done = performance.now();
    Page.maps.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));  // drawing goes on after its commands
    script.push(done - start);
    draw.push(performance.now() - done);
  }
  return [script, draw]"""


def main():
    with Browser() as b:
        b.size(1400, 1000)
        for page in map(os.path.abspath, sys.argv[1:]):
            opened = []
            for _ in range(2):
                start = time.monotonic()
                ready(b, page)
                opened.append(time.monotonic() - start)
            script, draw = b.run(STATES)
            print(f"{os.path.basename(page)}: {os.path.getsize(page) / 1e6:.1f} MB, opens in {min(opened):.1f} s, next state "
                  f"{statistics.median(script):.0f} ms ({min(script):.0f} to {max(script):.0f}), drawing {statistics.median(draw):.0f} ms",
                  flush=True)


if __name__ == "__main__":
    main()
