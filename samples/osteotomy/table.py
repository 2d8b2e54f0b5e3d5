#!/usr/bin/env python3
"""The largest pressure of a cycle for every position of the socket, as a table and a picture.

    samples/osteotomy/table.py STUDY.db [PICTURE.svg]

STUDY.db: a study with two factors that are numbers, as README.md beside this file makes it; a row of the table is a value of
the first, a column of the second. A position with a state that is no solution has "-" in the table and a cross in the picture.
"""
import sys

import numpy

import febiodea

MEASURES = {"headline_p99": ("p99 [MPa]", ".2f"), "headline_area": ("area [mm^2]", ".0f")}


def cycles(results):
    """Rows of the study by case, each case with a row per state and contact; a case that is no solution: None."""
    found = {}
    for row in results.table("results"):
        found.setdefault(row["case_id"], []).append(row)
    return [rows if rows[0]["case_outcome"] == "solved" else None for rows in found.values()], [rows[0] for rows in found.values()]


def grid(results, measure):
    """Values of the two factors, and the measure's value where the cycle's p99 is largest; NaN: no solution."""
    down, across = (factor.name for factor in results.factors)
    rows, heads = cycles(results)
    x, y = (sorted({head[name] for head in heads}) for name in (down, across))
    values = numpy.full((len(x), len(y)), numpy.nan)
    for case, head in zip(rows, heads):
        if case is not None:
            worst = max(case, key=lambda row: row["headline_p99"])
            values[x.index(head[down]), y.index(head[across])] = worst[measure]
    return numpy.array(x), numpy.array(y), values


def print_table(results, measure):
    title, digits = MEASURES[measure]
    down, across = (factor.name for factor in results.factors)
    x, y, values = grid(results, measure)
    print(f"{title}, at the cycle's largest p99; down: {down}, across: {across} [degrees]\n")
    print("| |" + "".join(f" {b:+g} |" for b in y) + "\n|---|" + "---|" * len(y))
    for a, row in zip(x, values):
        print(f"| {a:+g} |" + "".join(f" {format(value, digits)} |" if value == value else " - |" for value in row))
    print()


def draw(results, path):
    import matplotlib
    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "febiodea"  # the same file gives the same bytes
    from matplotlib import pyplot
    down, across = (factor.name for factor in results.factors)
    figure, axes = pyplot.subplots(1, len(MEASURES), figsize=(9, 3.8), layout="constrained")
    for axis, (measure, (title, digits)) in zip(axes, MEASURES.items()):
        x, y, values = grid(results, measure)
        filled = axis.contourf(x, y, numpy.ma.masked_invalid(values.T), 12, cmap="viridis")
        lines = axis.contour(x, y, numpy.ma.masked_invalid(values.T), filled.levels[::2], colors="white", linewidths=0.6)
        axis.clabel(lines, fontsize=7)
        axis.plot(*[[p[k] for p in ((a, b) for a in x for b in y)] for k in (0, 1)], ".", color="black", markersize=2)
        lost = [(x[i], y[j]) for i, j in zip(*numpy.nonzero(numpy.isnan(values)))]
        axis.plot([p[0] for p in lost], [p[1] for p in lost], "x", color="red")
        axis.set(xlabel=f"{down} [degrees]", ylabel=f"{across} [degrees]", title=title)
        figure.colorbar(filled, ax=axis, format=f"%{digits}")
    figure.savefig(path, metadata={"Date": None} if path.endswith((".svg", ".pdf")) else None)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    try:
        results = febiodea.read_study(sys.argv[1])
        if len(results.factors) != 2:
            sys.exit(f"{sys.argv[1]}: found {len(results.factors)} factors, expected two")
        for measure in MEASURES:
            print_table(results, measure)
        if len(sys.argv) > 2:
            draw(results, sys.argv[2])
    except febiodea.InputError as fault:
        sys.exit(f"table.py: {fault}")


if __name__ == "__main__":
    main()
