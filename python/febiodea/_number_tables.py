"""Tables of loads, motion and thickness that are in memory: columns by name."""
import numpy

from ._errors import usage_fault

_FORMS = ("expected a file, a pandas.DataFrame, a dictionary {name: column} or a structured array: "
          "columns of as many numbers each, with names")
_PATH = {"loads": "table of loads", "motion": "table of motion", "thickness_from": "table of thickness"}


def _columns(table):
    """Name and values of each column; None: it is no table."""
    if hasattr(table, "columns") and hasattr(table, "__getitem__"):  # pandas, polars
        return [(str(name), table[name]) for name in table.columns]
    names = getattr(getattr(table, "dtype", None), "names", None)
    if names:
        return [(name, table[name]) for name in names]
    if isinstance(table, dict) and table:
        return [(str(name), values) for name, values in table.items()]
    return None


def _numbers(table, keyword):
    """Names, and (rows, columns) numbers."""
    try:
        names, columns = zip(*_columns(table))
        numbers = [numpy.asarray(column, dtype=float) for column in columns]
        if all(column.shape == (len(numbers[0]),) for column in numbers):
            return list(names), numpy.column_stack(numbers)
    except (TypeError, ValueError):
        pass
    raise usage_fault(keyword, f"found a {type(table).__name__} that is no table of numbers", _FORMS)


def _is_table(value):
    """Not a file, and not a dictionary by surfaces."""
    return not isinstance(value, str) and not hasattr(value, "__fspath__") and value is not None


def taken_out(keywords):
    """The keywords with a name in place of each table, and the tables by these names: names of columns, numbers."""
    said, tables = dict(keywords), {}

    def put(path, table, keyword):
        tables[path] = _numbers(table, keyword)
        return path
    for keyword in ("loads", "motion"):
        if _is_table(said.get(keyword)):
            said[keyword] = put(_PATH[keyword], said[keyword], keyword)
    by_surface = said.get("thickness_from")
    if isinstance(by_surface, dict):
        said["thickness_from"] = {
            surface: put(f'{_PATH["thickness_from"]} of {surface}', table, "thickness_from") if _is_table(table) else table
            for surface, table in by_surface.items()}
    return said, tables


def same(ours, theirs):
    """The same tables, to the last bit."""
    return ours.keys() == theirs.keys() and all(
        ours[path][0] == theirs[path][0] and numpy.array_equal(ours[path][1], theirs[path][1]) for path in ours)
