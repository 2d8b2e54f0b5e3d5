"""Maps of results: pictures, and the same drawn by matplotlib."""
import os

from . import _febiodea
from ._errors import need, usage_fault
from ._states import states_text


def _file(source):
    need(source, (_febiodea.Result, _febiodea.PlotFile), "source",
         "a Result or a PlotFile; for the pose of a prepared joint's State: the Result of analyse with the same rotate and move")
    return source if isinstance(source, _febiodea.PlotFile) else _febiodea.plot_file_of(source)


def _within(value, keyword, least, most):
    try:
        if least <= float(value) <= most:
            return float(value)
    except (TypeError, ValueError):
        pass
    raise usage_fault(keyword, f"found {value!r}", f"expected a number from {least} to {most}")


def _files(source, labels):
    """Of one source or several; their names on the picture, none or one each."""
    sources = list(source) if isinstance(source, (list, tuple)) else [source]
    if not sources:
        raise usage_fault("source", "found nothing", "expected a Result, a PlotFile, or a list of them")
    names = [] if labels is None else [labels] if isinstance(labels, str) else [str(label) for label in labels]
    if names and len(names) != len(sources):
        raise usage_fault("labels", f"found {len(names)}", f"expected {len(sources)}, one per source")
    return [_file(one) for one in sources], names


def picture(source, path=None, *, labels=None, format=None, field="contact pressure", surface="", states="last", smooth=False,
            unrolled=False, width=None, dpi=200.0):
    """The map that `dea plot` draws, as bytes of a PNG, SVG or PDF; path: it is written there instead, its ending says which.

    source: a Result or a PlotFile, or a list of them: side by side, with one scale. labels: their names on it. states: as
    in analyse. width: mm, None: by the number of panels. dpi: of a PNG. Without path and format: SVG. Raises InputError (no such field or surface), UsageError, WriteError.
    """
    if path is not None and not os.fspath(path):
        raise usage_fault("path", 'found ""', "expected the name of a file, or None for bytes")
    if format is None:
        format = os.path.splitext(os.fsdecode(path))[1][1:].lower() if path is not None else "svg"
    if format not in ("png", "svg", "pdf"):
        raise usage_fault("format", f'found "{format}"', "expected png, svg or pdf")
    wide = 0.0 if width is None else _within(width, "width", 20, 2000)
    fine = _within(dpi, "dpi", 20, 2400)
    drawn = _febiodea.picture(*_files(source, labels), os.fsencode(path or b""), format, wide, fine, field, surface,
                              states_text(states), smooth, unrolled)
    return drawn if path is None else None


def _fill(axes, figure, panel, layer, shown, colours, norm):
    """The values of one layer: bands of one colour each, as in the picture."""
    from matplotlib import collections, tri
    points, triangles = panel["points"], panel["triangles"]
    if not figure["smooth"]:
        axes.add_collection(collections.PolyCollection(points[triangles[shown]], array=panel["facets"][panel["facet"][shown]],
                                                       cmap=colours, norm=norm, edgecolors="face", linewidths=0.2))
    if not layer["interpolated"].any():
        return
    net = tri.Triangulation(points[:, 0], points[:, 1], triangles, mask=~layer["interpolated"])
    if figure["smooth"]:
        count = colours.N
        bands = [figure["low"] + (figure["high"] - figure["low"]) * k / count for k in range(count + 1)]
        start = max(panel["edge"], bands[0])
        levels = [start] + [level for level in bands if level > start]
        if len(levels) > 1:
            axes.tricontourf(net, panel["nodes"], levels=levels, antialiased=False, extend="max",
                             colors=[*colours.colors[count + 1 - len(levels):], colours.colors[-1]])
    for level, line in figure["contours"]:
        if level >= panel["edge"] and (panel["nodes"][triangles[layer["interpolated"]]] > level).any():
            axes.tricontour(net, panel["nodes"], levels=[level], colors=[line], alpha=0.75, linewidths=0.8)


def _draw(axes, figure, panel, colours, norm):
    from matplotlib import collections
    points, triangles = panel["points"], panel["triangles"]
    for layer in panel["layers"]:  # those behind first
        for name, colour in (("all", figure["nothing"]), ("away", figure["turned_away"])):
            axes.add_collection(collections.PolyCollection(points[triangles[layer[name]]], facecolors=[colour],
                                                           edgecolors="face", linewidths=0.2))
        if not figure["empty"]:
            _fill(axes, figure, panel, layer, layer["valued"], colours, norm)
        axes.add_collection(collections.LineCollection(layer["rim"], colors=[figure["line"]], linewidths=0.8))
    for name, marker in (("center_of_pressure", "+"), ("peak", "v")):
        if panel[name] is not None:
            axes.plot(*panel[name], marker, color="black", markerfacecolor="none", markersize=8, gid=name)


def plot(source, axes=None, *, field="contact pressure", surface="", state="last", smooth=False, unrolled=False):
    """One panel of that map on matplotlib's axes: same projection, colours, scale and marks (v: peak, +: centre of
    pressure). Answers the axes.

    state: "last" or a time. Lengths are the model's. Raises InputError and UsageError as picture does, ImportError where
    matplotlib is not installed.
    """
    try:
        from matplotlib import cm, colors, pyplot
    except ImportError as missing:
        raise ImportError("plot needs matplotlib, which is not installed: install it, or use picture()") from missing
    figure = _febiodea.map_of(_file(source), field, surface, states_text(state), smooth, unrolled)
    if len(figure["panels"]) != 1:
        raise usage_fault("state", f"found {len(figure['panels'])} panels", 'expected one: "last" or a time')
    panel = figure["panels"][0]
    axes = axes if axes is not None else pyplot.gca()
    norm, colours = colors.Normalize(figure["low"], figure["high"]), colors.ListedColormap(figure["colours"])
    _draw(axes, figure, panel, colours, norm)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(panel["title"])
    if not figure["empty"]:
        axes.figure.colorbar(cm.ScalarMappable(norm, colours), ax=axes, ticks=figure["ticks"], label=figure["quantity"])
    return axes
