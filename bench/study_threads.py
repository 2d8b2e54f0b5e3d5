"""study_threads.py: two threads of one study, and two shards, beside two independent processes. What is printed and how to
read it: README.md."""
import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
OTHERS = "two processes"


def ways(a):
    """Commands that run at a time, by name; together each way solves the same cases."""
    half, n = a.cases // 2, 2 * (a.cases // 2)

    def line(first, last, *words):
        tilts = f"tilt: rotate {a.body}=0,1,0,{{{first / 100:g}:{last / 100:g}:0.01}}"
        return [a.dea, "study", a.model, "--law", a.law, "--skip-steps", "--states", "last", "-q", "--overwrite", "--vary", tilts, *words]
    return {"two threads": [line(1, n, "--threads", "2", "-o", "threads.db")],
            "two shards": [line(1, n, "--threads", "1", "-o", "shards.db", "--shard", f"{i}/2") for i in (1, 2)],
            OTHERS: [line(1, half, "--threads", "1", "-o", "a.db"), line(half + 1, n, "--threads", "1", "-o", "b.db")]}


def timed(commands, folder, name, seconds):
    """Wall time of all together, and the processors' of each, into seconds[name]."""
    start, processors = time.perf_counter(), 0.0
    for process in [subprocess.Popen(words, cwd=folder) for words in commands]:
        _, status, used = os.wait4(process.pid, 0)
        if status != 0:
            raise SystemExit(f"{name}: no solution")
        processors += used.ru_utime + used.ru_stime
    seconds[name] = time.perf_counter() - start, processors


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", nargs="?", type=pathlib.Path, default=ROOT / "samples/hip/hip_walking.feb")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--turns", type=int, default=6)
    parser.add_argument("--law", default="layer")
    parser.add_argument("--body", default="pelvis")
    parser.add_argument("--dea", type=pathlib.Path, default=ROOT / "build/release/app/dea")
    arguments = parser.parse_args()
    commands = ways(arguments)
    with tempfile.TemporaryDirectory() as folder:
        for name in ("two threads", "two shards"):
            ratios = []
            for turn in range(arguments.turns):
                seconds = {}
                both = [threading.Thread(target=timed, args=(commands[way], folder, way, seconds))
                        for way in ((name, OTHERS), (OTHERS, name))[turn % 2]]
                for thread in both:
                    thread.start()
                for thread in both:
                    thread.join()
                ratios.append([theirs / mine for mine, theirs in zip(seconds[name], seconds[OTHERS])])
            for what, values in zip(("speed", "work per processor second"), zip(*ratios)):
                print(f"{name} over {OTHERS}, {what}: median {statistics.median(values):.2f}, {min(values):.2f} to {max(values):.2f}",
                      flush=True)


if __name__ == "__main__":
    main()
