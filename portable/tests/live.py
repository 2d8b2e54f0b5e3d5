#!/usr/bin/env python3
"""live.py DEA.js DEA ROOT: what a joint in the hand answers in node against `dea run` of the same line.

Of the hip and the knee of samples: twenty poses, loads and cartilages between quick ones; one beyond the strain limit, one
in which the surfaces part, one whose line is at fault. Exit code 0: all agree; 77: there is no node.
"""

import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from page import leaves  # noqa: E402

NEAR = 1e-9  # of the largest number of its kind, or of 1
faults = []


def check(what, ok, told=""):
    if not ok:
        faults.append(f"{what} {told}".strip())


# How the search went, and what is left of its tolerance.
OF_THE_SEARCH = ("residual", "complementarity", "iterations", "least_stiffness", "message", "unstable", "held_directions")


def furthest(mine, run):
    """The largest difference of a number, relative to the largest of its kind or to 1, and which it is."""
    a, b = list(leaves(mine)), list(leaves(run))
    if [p for p, x in a] != [p for p, x in b]:
        return math.inf, "other keys"
    sizes = {}
    for path, x in b:
        if isinstance(x, (int, float)) and not isinstance(x, bool):
            sizes[path] = max(sizes.get(path, 1.0), abs(x))
    worst = (0.0, "")
    for (path, x), (_, y) in zip(a, b):
        if any(word in path for word in OF_THE_SEARCH):
            continue
        if path in sizes and isinstance(x, (int, float)):
            worst = max(worst, (abs(x - y) / sizes[path], path))
        elif x != y:
            return math.inf, f"{path}: {x} and {y}"
    return worst


def lines(model):
    """Words of `dea run` behind the model: where the hand goes."""
    out = [[]]
    if model == "hip_walking.feb":
        for k in range(8):
            out.append(["--force", f"femur={430 + 20 * math.cos(k):.3f},{-260 + 90 * math.sin(k):.3f},{1500 + 40 * k}"])
        for k in range(6):
            out.append(["--rotate", f"femur=1,0,0,{k - 2.5}"])
        out += [["--E", "9"], ["--nu", "0.4"], ["--law", "linear"], ["--law", "linear", "--E", "14"], ["--thickness", "2"],
                ["--law", "linear", "--force", "femur=8000,-5000,60000"], ["--force", "femur=0,0,-200"]]  # beyond the strain limit; apart
    else:
        out += [["--E", f"{8 + k}"] for k in range(4)]
    return out


def ask(program, folder, questions):
    done = subprocess.run(
        ["node", os.path.join(os.path.dirname(os.path.abspath(__file__)), "live.js"), program],
        cwd=folder, input="".join(json.dumps(q) + "\n" for q in questions), capture_output=True, text=True)
    check("node", done.returncode == 0, done.stderr)
    return [json.loads(line) for line in done.stdout.splitlines()], done.stderr


def of_model(program, native, sample):
    name = os.path.basename(sample)
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(sample, folder)
        asked = []
        for extra in lines(name):
            words = ["run", name, *extra, "--states", "last"]
            asked += [{"words": words, "quick": True}, {"words": words, "quick": False}]
        far = {"words": ["run", name, "--force", "no_such_body=1,0,0", "--states", "last"], "quick": False}
        asked += [far, asked[1]]
        answers, told = ask(program, folder, asked)
        check(name, len(answers) == len(asked), f"{len(answers)} answers to {len(asked)} questions")
        outcomes = set()
        worst, seconds = (0.0, ""), {True: [], False: []}
        for question, answer in zip(asked, answers):
            run = subprocess.run([native, *question["words"], "--no-xplt", "--json", "run.json", "--overwrite", "-q"],
                                 cwd=folder, capture_output=True, text=True)
            what = f"{name} {' '.join(question['words'][2:])}"
            if question is far:
                check(what, answer["code"] == run.returncode and run.stderr.strip() in told, f"exit {answer['code']}")
                continue
            seconds[question["quick"]].append(answer["seconds"])
            if question["quick"]:
                check(what, answer["text"] is not None and answer["text"]["quick"], "no quick answer")
                continue
            check(what, answer["code"] == run.returncode, f"exit {answer['code']}, natively {run.returncode}")
            outcomes.add(answer["text"]["state"]["outcome"])
            with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
                state = json.load(file)["states"][-1]
            difference = furthest(answer["text"]["state"], state)
            worst = max(worst, difference)
            check(what, difference[0] <= NEAR, f"{difference[0]:.1e} in {difference[1]}")
        check(name, answers[-1]["text"]["state"] == answers[1]["text"]["state"], "the same question has two answers")
        if name == "hip_walking.feb":
            check(name, {"Balanced", "BeyondStrainLimit", "SurfacesApart"} <= outcomes, f"outcomes are {sorted(outcomes)}")
        print(f"{name}: {len(answers)} answers, {worst[0]:.1e} in {worst[1] or 'nothing'}; quick {statistics.median(seconds[True][1:]):.3f} s, "
              f"largest {max(seconds[True][1:]):.3f} s; exact {statistics.median(seconds[False][1:]):.3f} s; "
              f"memory {answers[-1]['memory'] / 1e6:.0f} MB")


def main():
    program, native, root = (os.path.abspath(p) for p in sys.argv[1:4])
    if shutil.which("node") is None:
        print("live: there is no node here")
        return 77
    hand = subprocess.run(["node", os.path.join(root, "portable/tests/hand.js")], capture_output=True, text=True)
    check("hand", hand.returncode == 0, hand.stderr)
    for sample in ("samples/hip/hip_walking.feb", "samples/knee/knee.feb"):
        of_model(program, native, os.path.join(root, sample))
    for fault in faults:
        print("FAILED:", fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
