"""Settings as keywords. Their names, forms and help are those of the program's one table of settings."""
import copy
import os
import re

from . import _febiodea, _number_tables
from ._errors import usage_fault


def _number(value):
    """The text of a number from which the same number is read again."""
    return repr(int(value)) if hasattr(value, "__index__") else repr(float(value))


def _is_number(value):
    return hasattr(value, "__index__") or (hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0)


def _is_sequence(value):
    return isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) > 0


def _text(value, keyword):
    """A value as it is written in a settings file."""
    if isinstance(value, bool) or type(value).__name__ == "bool_":
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if _is_sequence(value):
        parts = list(value)
        if not parts:
            return "none"
        axes = len(parts) == 3 and all(_is_sequence(part) for part in parts)
        return ("/" if axes else ",").join(_text(part, keyword) for part in parts)
    if _is_number(value):
        return _number(value)
    raise usage_fault(keyword, f"found a value of type {type(value).__name__}",
                      "expected a number, a text, a sequence or a dictionary")


def _placements(value, keyword):
    """[("pelvis", (0, 1, 0), 10), ...], one of them, or {"pelvis": ((0, 1, 0), 10)}: body and text of each, in order."""
    if isinstance(value, dict):
        value = [(body, *turn) if keyword == "rotate" and _is_sequence(turn) else (body, turn) for body, turn in value.items()]
    elif isinstance(value, tuple) and value and isinstance(value[0], str):
        value = [value]
    parts, form = (3, '[("BODY", (x, y, z), DEGREES)]') if keyword == "rotate" else (2, '[("BODY", (x, y, z))]')
    for one in value if _is_sequence(value) else [value]:
        if not _is_sequence(one) or len(one) != parts or not isinstance(one[0], str):
            raise usage_fault(keyword, f"found {one!r}", f"expected {form}")
        yield one[0], _text(list(one[1:]) if parts == 3 else one[1], keyword)


def _placements_in_turn(value):
    """[("rotate", "pelvis", (0, 1, 0), 10), ("move", "pelvis", (1, 0, 0)), ...]: keyword, body and text of each."""
    form = 'expected [("rotate", "BODY", (x, y, z), DEGREES), ("move", "BODY", (x, y, z)), ...]'
    if not _is_sequence(value):
        raise usage_fault("placements", f"found {value!r}", form)
    for one in value:
        if not _is_sequence(one) or len(one) == 0 or one[0] not in ("rotate", "move"):
            raise usage_fault("placements", f"found {one!r}", form)
        for body, text in _placements([tuple(one[1:])], one[0]):
            yield one[0], body, text


def _values_of(keyword, value, option):
    if keyword == "placements":
        return list(_placements_in_turn(value))
    if option is not None and option["places"]:
        return [(keyword, body, text) for body, text in _placements(value, keyword)]
    if isinstance(value, dict):
        return [(keyword, str(key), _text(one, keyword)) for key, one in value.items()]
    if option is not None and option["repeatable"] and _is_sequence(value):
        return [(keyword, "", _text(one, keyword)) for one in value]
    return [(keyword, "", _text(value, keyword))]


def values(keywords):
    """(name, key, text) of each, for the compiled part. None: it is not given."""
    options = {option["keyword"]: option for option in _febiodea.setting_options()}
    return [said for keyword, value in keywords.items() if value is not None
            for said in _values_of(keyword, value, options.get(keyword))]


class Settings:
    """What takes the place of the model's own statements, by keywords (docs/settings.md; settings_help() lists them).

    file: a settings file; a keyword outweighs what it says. placements: turns and moves in the order in which they act,
    [("rotate", "BODY", (x, y, z), DEGREES), ("move", "BODY", (x, y, z)), ...]; rotate and move by themselves act in the
    order of the keywords. loads, motion, thickness_from: a file, or a table whose columns have names: a pandas.DataFrame, a
    dictionary of sequences, a structured array. Raises UsageError, InputError.
    """

    def __init__(self, file=None, **keywords):
        self.file = None if file is None else os.fspath(file)
        self.keywords = copy.deepcopy(keywords)
        self._native = laid_over(_febiodea.file_settings(os.fsencode(file or b"")), keywords)

    def as_dict(self):
        """All of them by their names in JSON; None: not given."""
        return self._native.as_dict()

    def __reduce__(self):
        return Settings, (self.file,), {"keywords": self.keywords}

    def __setstate__(self, state):
        self.__init__(self.file, **state["keywords"])

    def __eq__(self, other):
        return (isinstance(other, Settings) and self.as_dict() == other.as_dict()
                and _number_tables.same(self._native.said()[2], other._native.said()[2]))

    __hash__ = None

    def __repr__(self):
        words = ([] if self.file is None else [repr(self.file)]) + [f"{k}={v!r}" for k, v in self.keywords.items()]
        return f"febiodea.Settings({', '.join(words)})"


def laid_over(native, keywords):
    """The compiled part's settings with keywords over them."""
    said, tables = _number_tables.taken_out(keywords)
    return _febiodea.laid_over(native, values(said), tables)


def settings_help():
    """A text with every setting: its keyword, its form, what it does."""
    lines, group = [], None
    for option in _febiodea.setting_options():
        if option["group"] != group:
            group = option["group"]
            lines += ["", group]
        key = "" if option["key"] is None else f'"{option["key_form"]}"'
        if option["places"]:
            form = f'[({key}, (x, y, z){", DEGREES" if option["keyword"] == "rotate" else ""})]'
        else:
            form = f'{{{key}: {option["value"]}}}' if key else option["value"]
        help = re.sub(r"\{([a-z-]+)\}", lambda named: named[1].replace("-", "_"), option["help"])
        lines += [f'  {option["keyword"]}={form}', f'      {help.replace("; may be repeated", "")}']
        if option["keyword"] == "move":
            lines += ['  placements=[("rotate", "BODY", (x, y, z), DEGREES), ("move", "BODY", (x, y, z)), ...]',
                      "      Both in the order in which they act"]
    return "\n".join(lines).strip("\n")
