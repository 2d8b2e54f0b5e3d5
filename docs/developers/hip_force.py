#!/usr/bin/env python3
"""The force of level walking in docs/from_scans.md: hip_force.py FOLDER, a clone of github.com/RWTHmediTEC/HipJointForceModel.

Its data: forces on the femoral head at the peaks of level walking of ten subjects with instrumented implants (Bergmann et al. 2016, PLoS ONE
11:e0155612), in % of the body weight along the axes of the femur used there, and landmarks of these femora (Fischer et al. 2021,
doi:10.1016/j.jbiomech.2021.110526). Printed: the opposite force, with which the femur presses, in the axes that dea calls frame:femur."""
import math
import os
import re
import sys


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def axes(up, lateral, right):
    """Forwards, up, lateral; `lateral` as far as it is across `up`."""
    up = unit(up)
    lateral = unit([a - dot(lateral, up) * b for a, b in zip(lateral, up)])
    return [cross(up, lateral) if right else cross(lateral, up), up, lateral]


def read(folder, *names):
    with open(os.path.join(folder, "data", "OrthoLoad", *names)) as file:
        return file.read()


def main():
    folder, forces = sys.argv[1], []
    for subject in ("H1L", "H2R", "H3L", "H4L", "H5L", "H6R", "H7R", "H8L", "H9L", "H10R"):
        point = {}
        for line in read(folder, "Landmarks", subject + "_FemurLandmarks.fcsv").splitlines():
            if not line.startswith("#"):
                words = line.split(",")
                point[words[11].rsplit("_", 1)[0]] = [float(x) for x in words[1:4]]
        lateral, anterior, up = (float(x) for x in re.findall("<HJF_pBW>(.*?)<", read(folder, "Forces", subject + "_LW.xml")))
        right = subject.endswith("R")
        theirs = axes(minus(point["P1"], point["P2"]), minus(point["LPC"], point["MPC"]), right)
        middle = [(a + b) / 2 for a, b in zip(point["MEC"], point["LEC"])]
        ours = axes(minus(point["HJC"], middle), minus(point["LEC"], point["MEC"]), right)
        on_head = [sum(f * axis[k] for f, axis in zip((anterior, up, lateral), theirs)) for k in range(3)]
        forces.append([-dot(on_head, axis) for axis in ours])
        print("%-5s forwards %6.1f, up %6.1f, medial %6.1f %% BW" % (subject, forces[-1][0], forces[-1][1], -forces[-1][2]))
    mean = [sum(f[k] for f in forces) / len(forces) for k in range(3)]
    spread = [math.sqrt(sum((f[k] - mean[k]) ** 2 for f in forces) / (len(forces) - 1)) for k in range(3)]
    print("mean  forwards %6.1f, up %6.1f, medial %6.1f %% BW" % (mean[0], mean[1], -mean[2]))
    print("s.d.  forwards %6.1f, up %6.1f, medial %6.1f" % tuple(spread))


if __name__ == "__main__":
    main()
