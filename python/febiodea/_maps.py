"""Maps of results: pictures, and the same drawn by matplotlib."""
import os

from . import _febiodea
from ._errors import UsageError


def _file(source):
    return source if isinstance(source, _febiodea.PlotFile) else _febiodea.plot_file_of(source)


def picture(source, path=None, *, format=None, field="contact pressure", surface="", states="last", smooth=False,
            unrolled=False, width=0.0, dpi=200.0):
    """The map that `dea plot` draws, as bytes of a PNG, SVG or PDF; path: it is written there, its ending says which.

    source: a Result or a PlotFile. states: "last", "all", or times "0.5,1". width: mm, 0: by the number of panels.
    Raises InputError (no such field or surface), UsageError, OSError.
    """
    if format is None:
        format = os.path.splitext(os.fspath(path))[1][1:].lower() if path is not None else "svg"
    if format not in ("png", "svg", "pdf"):
        raise UsageError(f'format: found "{format}", expected png, svg or pdf', "format", f'found "{format}"',
                         "expected png, svg or pdf")
    drawn = _febiodea.picture(_file(source), format, width, dpi, field, surface, states, smooth, unrolled)
    if path is not None:
        with open(path, "wb") as f:
            f.write(drawn)
    return drawn


def plot(source, axes=None, *, field="contact pressure", surface="", state="last", smooth=False, unrolled=False):
    """One panel of that map on matplotlib's axes: same projection, colours and scale. Answers the axes.

    Lengths are the model's. Raises ImportError where matplotlib is not installed.
    """
    try:
        from matplotlib import collections, colors, pyplot
    except ImportError as missing:
        raise ImportError("plot needs matplotlib, which is not installed: install it, or use picture()") from missing
    figure = _febiodea.map_of(_file(source), field, surface, state, smooth, unrolled)
    panel = figure["panels"][-1]
    axes = axes if axes is not None else pyplot.gca()
    scale = colors.Normalize(figure["low"], figure["high"])
    colours = colors.ListedColormap(figure["colours"])
    for layer in range(int(panel["layer"].max(initial=-1)) + 1):  # those behind first
        shown = panel["layer"] == layer
        corners = panel["points"][panel["triangles"][shown]]
        values = (panel["nodes"][panel["triangles"][shown]].mean(axis=1) if smooth
                  else panel["facets"][panel["facet"][shown]])
        drawn = collections.PolyCollection(corners, array=values, cmap=colours, norm=scale, edgecolors="face",
                                           linewidths=0.2)
        axes.add_collection(drawn)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(panel["title"])
    bar = axes.figure.colorbar(drawn, ax=axes, ticks=figure["ticks"])
    bar.set_label(figure["quantity"])
    return axes
