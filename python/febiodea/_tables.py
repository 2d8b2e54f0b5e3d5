"""Results as rows and small values."""
import base64
import html
import math
from typing import NamedTuple


class Headline(NamedTuple):
    """The one set of numbers that a pressure map is summed up by (docs/theory.md, 6.1).

    Of what is above the pressure `above`; NaN, and area 0: nothing is. `area` and `mean` are those within the edge of
    contact, which runs through facets; `p99` and `peak` of nodes, weighted by their areas.
    """
    p99: float
    mean: float
    area: float
    peak: float
    above: float

    def __str__(self):
        return f"p99 {self.p99:.4g}, mean {self.mean:.4g}, area {self.area:.4g}, peak {self.peak:.4g}"


def _flat(row, name, value):
    if isinstance(value, dict):
        for key, one in value.items():
            _flat(row, f"{name}_{key}", one)
    elif isinstance(value, list):
        if len(value) == 3 and not any(isinstance(one, (dict, list, str)) for one in value):
            for axis, one in zip("xyz", value):
                row[f"{name}_{axis}"] = math.nan if one is None else one
    else:
        row[name] = math.nan if value is None else value


def rows(result):
    """A dictionary per state and contact: `time`, `step`, `outcome`, `contact`, the headline as `headline_...`, then the
    contact's other numbers by their names in JSON (docs/results.md); vectors as three columns; what is null there is NaN.
    Other lists are in Contact.statistics alone."""
    all_rows = []
    for state in result.states:
        for contact in state.contacts:
            row = {"time": state.time, "step": state.step, "outcome": state.outcome, "contact": contact.name}
            numbers = contact.statistics
            _flat(row, "headline", numbers["headline"])  # first: it is what a map is summed up by
            for name, value in numbers.items():
                if name not in ("name", "headline", "compartments") and not (name == "inside" and value is None):
                    _flat(row, name, value)
            all_rows.append(row)
    return all_rows


def _cell(value):
    return html.escape(f"{value:.4g}" if isinstance(value, float) else str(value))


def html_table(states, most=20):
    """The headline numbers as a small table; of very many states the last ones."""
    heads = ["time", "contact", "outcome", "p99", "mean", "area", "peak"]
    lines = ["<table><tr>" + "".join(f"<th>{head}</th>" for head in heads) + "</tr>"]
    for state in states[-most:]:
        for contact in state.contacts:
            h = contact.headline
            cells = [state.time, contact.name, state.outcome, h.p99, h.mean, h.area, h.peak]
            lines.append("<tr>" + "".join(f"<td>{_cell(cell)}</td>" for cell in cells) + "</tr>")
    if len(states) > most:
        lines.append(f"<tr><td colspan='7'>the last {most} of {len(states)} states</td></tr>")
    return "\n".join(lines) + "</table>"


def html_pairs(pairs):
    """A table of two columns: names and values."""
    return "<table>" + "".join(f"<tr><th>{_cell(name)}</th><td>{_cell(value)}</td></tr>" for name, value in pairs) + "</table>"


def html_of_state(state):
    """The headline numbers of the state's contacts as a small table."""
    return html_table([state])


def html_of_contact(contact):
    """Its headline numbers, its force and which surfaces it has."""
    h = contact.headline
    pairs = [("contact", contact.name), ("surfaces", f"{contact.source.surface}, {contact.target.surface}"), ("p99", h.p99), ("mean", h.mean), ("area", h.area),
             ("peak", h.peak), ("force", float((contact.force ** 2).sum() ** 0.5))]
    return html_pairs(pairs)


def html_of(result):
    """The table, and the map of the last state."""
    from . import _errors, _maps
    try:
        drawn = base64.b64encode(_maps.picture(result, width=90)).decode()
    except _errors.Error:  # nothing is pressed, no surface to be shown: the table says so
        return html_table(result.states)
    # a picture of its own: letters of several drawings in one notebook would have the same names
    return f'{html_table(result.states)}\n<img alt="the map of the last state" src="data:image/svg+xml;base64,{drawn}">'
