#!/usr/bin/env python3
"""Solves joints of the population with FEBio: run_febio.py FEBIO4 RESULTS [--jobs N] [--config FEBIO.xml] [NAME...]

RESULTS gets NAME.xplt, the state under full load, compressed, and febio.json: version, how long each took, what did not converge. Joints that
are there are left as they are. NAME may be NAME_finer. Without names: all, then those with a finer mesh."""
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import joints


def run(febio, config, name, results):
    with tempfile.TemporaryDirectory() as folder:
        finer = name.endswith("_finer")
        model = joints.make(name.removesuffix("_finer"), folder, finer)
        start = time.monotonic()
        done = subprocess.run([febio, "-i", model, *(["-cnf", config] if config else [])], cwd=folder, capture_output=True, text=True,
                              env={**os.environ, "OMP_NUM_THREADS": "1"})
        seconds = time.monotonic() - start
        log = done.stdout
        version = re.search(r"version\s+([\d.]+)", log)
        about = {"seconds": round(seconds), "version": version[1] if version else "", "ended": "N O R M A L" in log,
                 "iterations": sum(map(int, re.findall(r"Total number of equilibrium iterations[ .:]+: (\d+)", log)))}
        plot = model.with_suffix(".xplt")
        if about["ended"] and plot.exists():
            (results / plot.name).write_bytes(plot.read_bytes())
        else:
            (results / f"{name}.log").write_text(log[-20000:])
    return name, about


def main():
    words, jobs, config = sys.argv[1:], 1, None
    for option in ("--jobs", "--config"):
        if option in words:
            at = words.index(option)
            value = words[at + 1]
            del words[at:at + 2]
            jobs, config = (int(value), config) if option == "--jobs" else (jobs, value)
    if len(words) < 2:
        sys.exit(__doc__)
    febio, results = shutil.which(words[0]), pathlib.Path(words[1])
    if not febio:
        sys.exit(f"{words[0]}: no such program")
    febio, config = os.path.abspath(febio), config and os.path.abspath(config)
    results.mkdir(exist_ok=True)
    names = words[2:] or [*joints.NAMES, *(f"{n}_finer" for n in joints.FINER)]
    if unknown := [n for n in names if n.removesuffix("_finer") not in joints.NAMES]:
        sys.exit(f"found {', '.join(unknown)}, expected joints of joints.py list")
    table = results / "febio.json"
    found = json.loads(table.read_text()) if table.exists() else {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for name, about in pool.map(lambda n: run(febio, config, n, results), [n for n in names if not (results / f"{n}.xplt").exists()]):
            found[name] = about
            table.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")
            print(name, about, flush=True)
    if failed := [n for n in names if not (results / f"{n}.xplt").exists()]:
        sys.exit(f"not solved: {', '.join(failed)} (their .log is in {results})")


if __name__ == "__main__":
    main()
