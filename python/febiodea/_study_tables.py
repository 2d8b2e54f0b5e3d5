"""Tables in memory as names of columns and rows of texts: cases and subjects of a study."""
from . import _settings
from ._errors import usage_fault


def table_in_memory(table, keyword, row_of):
    """(names, rows of texts). table: a pandas.DataFrame or a list of dictionaries; keyword: of the caller's argument, for
    messages; row_of: what a row is of ("a case"). Raises UsageError."""
    if hasattr(table, "columns") and hasattr(table, "itertuples"):
        names = [str(name) for name in table.columns]
        rows = table.itertuples(index=False, name=None)
    elif isinstance(table, (list, tuple)) and all(isinstance(row, dict) for row in table):
        names = [str(name) for name in table[0]] if table else []
        for number, row in enumerate(table, 1):
            if list(map(str, row)) != names:
                raise usage_fault(f"{keyword}[{number - 1}]", f"found the columns {', '.join(map(str, row))}",
                                  f"expected those of the first row: {', '.join(names)}")
        rows = (row.values() for row in table)
    else:
        raise usage_fault(keyword, f"found a {type(table).__name__}",
                          f"expected a file, a pandas.DataFrame, or a list of dictionaries with a row {row_of}")
    cells = [[value if isinstance(value, str) else _settings._text(value, keyword) for value in row] for row in rows]
    if not cells:
        raise usage_fault(keyword, "found no row", "expected one or more")
    return names, cells
