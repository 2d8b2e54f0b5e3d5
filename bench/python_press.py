"""python_press.py MODEL...: how much longer `press` takes from Python than in C++, both in turns in one run.

Needs the build tree that holds it, or --build FOLDER. What is printed and how to read it: README.md."""
import argparse
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


def seconds(work, count):
    start = time.perf_counter()
    for _ in range(count):
        work()
    return time.perf_counter() - start


class Native:
    """dea_bench, waiting for how often it is to press."""

    def __init__(self, build, model, law):
        self.process = subprocess.Popen([build / "bench" / "dea_bench", "press", model, law], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.springs = int(self.process.stdout.readline())
        self.force = None

    def seconds(self, count):
        self.process.stdin.write(f"{count}\n")
        self.process.stdin.flush()
        taken, force = map(float, self.process.stdout.readline().split())
        self.force = force
        return taken

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def measure(build, model, law, rounds):
    import febiodea
    joint = febiodea.prepare(febiodea.recognise(model, law=law))
    poses = joint.press(joint.solve()).poses
    native = Native(build, model, law)

    def press():
        return joint.press(poses)
    count = max(1, round(0.1 / native.seconds(10) * 10))  # a tenth of a second each
    seconds(press, count)
    ours, theirs = [], []
    for k in range(rounds):  # now one first, now the other
        for turn in ((0, 1) if k % 2 else (1, 0)):
            if turn:
                ours.append(seconds(press, count) / count)
            else:
                theirs.append(native.seconds(count) / count)
    force = sum(contact.normal_force for contact in press().contacts)
    if abs(force - native.force) > 1e-6 * native.force:
        sys.exit(f"{model}: forces {force} and {native.force}: not the same work")
    native.end()
    ratios = [a / b for a, b in zip(ours, theirs)]
    print(f"{pathlib.Path(model).name:20} {law:7} {native.springs:8} {1 / min(theirs):9.1f} {1 / min(ours):9.1f} "
          f"{100 * (min(ours) / min(theirs) - 1):8.1f} {100 * (statistics.median(ratios) - 1):8.1f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--rounds", type=int, default=40)
    asked = parser.parse_args()
    sys.path.insert(0, str(asked.build / "python"))
    print(f"{'model':20} {'law':7} {'springs':>8} {'C++ /s':>9} {'Python /s':>9} {'least %':>8} {'median %':>8}")
    for model in asked.models:
        for law in ("linear", "layer"):
            measure(asked.build, model, law, asked.rounds)


if __name__ == "__main__":
    main()
