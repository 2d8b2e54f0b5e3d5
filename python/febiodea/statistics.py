"""Statistics of many cases: the functions behind the page of a study, on arrays of any origin.

Numbers of cases that failed are NaN (or None): they are left out and counted ("left_out"), never taken for numbers. Nothing
depends on the order of cases. Results are dictionaries; what is undefined is None. A fault raises UsageError.
docs/studies.md, "The page", says what each number is, with its paper."""
import numpy

from . import _febiodea
from ._errors import usage_fault

__all__ = ["box_plot", "influence", "sobol_indices", "pairs", "difference", "dose", "share_above", "mean_map",
           "map_difference", "sectors", "socket_regions", "vertex_areas"]


def _numbers(values):
    return numpy.array(values, dtype=float).ravel()


def _rows(fields):
    return numpy.atleast_2d(numpy.asarray(fields, dtype=float))


def box_plot(values):
    """Quartiles, whiskers (1.5 times the box), mean and standard deviation: "count", "left_out", "least", "low", "q1", "median",
    "q3", "high", "largest", "mean", "sd"; "low" and "high" are the whiskers."""
    return _febiodea.box_plot(_numbers(values))


def influence(factors, outputs):
    """Which factors a number depends on.

    factors: {"name": one number per case}; outputs: one number per case. Answers "cases", "left_out", "r_squared" of the
    standardised regression, "regression" {"name": coefficient, None: undetermined} and "spearman" {"name": rho}."""
    names = list(factors)
    found = _febiodea.influence([list(_numbers(factors[name])) for name in names], list(_numbers(outputs)))
    for key in ("regression", "spearman"):
        found[key] = dict(zip(names, found[key]))
    return found


def sobol_indices(outputs, dimensions, resamples=1000, seed=1):
    """First and total Sobol indices of Saltelli's design, N (dimensions + 2) outputs in the order of --sample saltelli: a
    list with, per factor, "first", "total", their 95 % intervals by bootstrap, "rows", "left_out"."""
    return _febiodea.sobol_indices(list(_numbers(outputs)), int(dimensions), int(resamples), int(seed))


def pairs(first, second):
    """Two numbers of the same cases, or two methods: difference first less second with its interval, Bland and Altman's
    limits of agreement with theirs, effect size d_z."""
    return _febiodea.pairs(list(_numbers(first)), list(_numbers(second)))


def difference(first, second):
    """Means of two groups: "mean" (first less second), Welch's "interval", Cohen's "d", Hedges' "g", "count"."""
    return _febiodea.difference(list(_numbers(first)), list(_numbers(second)))


def dose(times, pressures, above, *, cycle_seconds=None, cycles_per_year=None, years=None):
    """Exposure and overpressure of each place: (places,) each.

    times: (states,), rising; pressures: (states, places), linear between states; above: threshold of overpressure. Of one
    cycle in pressure x time; with cycle_seconds, cycles_per_year and years, all three, of all cycles in pressure x years."""
    history = (cycle_seconds, cycles_per_year, years)
    if any(x is None for x in history) and any(x is not None for x in history):
        raise usage_fault("dose", f"found {history!r}", "expected cycle_seconds, cycles_per_year and years, or none of them")
    return _febiodea.dose(_numbers(times), _rows(pressures), float(above), None if years is None else [float(x) for x in history])


def share_above(values, areas, threshold):
    """Share of the area, 0 to 1, whose value is above a threshold."""
    return _febiodea.share_above(_numbers(values), _numbers(areas), float(threshold))


def mean_map(fields, areas):
    """Mean and standard deviation over cases. fields: (cases, places); areas: (places,), as of vertex_areas."""
    return _febiodea.mean_map(_rows(fields), _numbers(areas))


def map_difference(first, second, areas):
    """Mean map of one group less that of another: "difference" (places,), "area_mean", "area_rms", "first", "second"."""
    return _febiodea.map_difference(_rows(first), _rows(second), _numbers(areas))


def sectors(points, center, axis, start, count):
    """Equal sectors about an axis, from `start` on, right-handed: (index per point, -1 on the axis; names)."""
    return _febiodea.sectors(_rows(points), list(center), list(axis), list(start), int(count))


def socket_regions(vertices, triangles, up, anterior):
    """Six regions of a socket, of its vertices: (index per vertex, names), as `dea study --regions socket`."""
    return _febiodea.socket_regions(_rows(vertices), numpy.asarray(triangles), list(up), list(anterior))


def vertex_areas(vertices, triangles):
    """Per vertex a third of each triangle around it."""
    return _febiodea.vertex_areas(_rows(vertices), numpy.asarray(triangles))
