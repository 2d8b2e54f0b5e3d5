"""Settings as keywords. Their names, forms and help are those of the program's one table of settings."""
import os

from . import _febiodea
from ._errors import UsageError


def _number(value):
    """The text of a number from which the same number is read again."""
    return repr(int(value)) if hasattr(value, "__index__") else repr(float(value))


def _is_number(value):
    return hasattr(value, "__index__") or isinstance(value, float) or (hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0)


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
    raise UsageError(f"{keyword}: found a {type(value).__name__}, expected a number, a text, a sequence or a dictionary",
                     keyword, f"found a {type(value).__name__}", "expected a number, a text, a sequence or a dictionary")


def _placements(value, keyword):
    """[("pelvis", (0, 1, 0), 10), ...], one of them, or {"pelvis": ((0, 1, 0), 10)}: body and text of each, in order."""
    if isinstance(value, dict):
        value = [(body, turn) for body, turn in value.items()]
    elif isinstance(value, tuple) and value and isinstance(value[0], str):
        value = [value]
    form = '[("BODY", (x, y, z), DEGREES)]' if keyword == "rotate" else '[("BODY", (x, y, z))]'
    for one in value if _is_sequence(value) else [value]:
        if not _is_sequence(one) or len(one) < 2 or not isinstance(one[0], str):
            raise UsageError(f"{keyword}: found {one!r}, expected {form}", keyword, f"found {one!r}", f"expected {form}")
        yield one[0], _text(list(one[1:]) if len(one) > 2 else one[1], keyword)


def values(keywords):
    """(name, key, text) of each, for the compiled part. None: it is not given."""
    options = {option["keyword"]: option for option in _febiodea.setting_options()}
    all_values = []
    for keyword, value in keywords.items():
        option = options.get(keyword)
        if value is None:
            continue
        if option is not None and option["places"]:
            all_values += [(keyword, body, text) for body, text in _placements(value, keyword)]
        elif isinstance(value, dict):
            all_values += [(keyword, str(key), _text(one, keyword)) for key, one in value.items()]
        elif option is not None and option["repeatable"] and _is_sequence(value):
            all_values += [(keyword, "", _text(one, keyword)) for one in value]
        else:
            all_values.append((keyword, "", _text(value, keyword)))
    return all_values


class Settings:
    """What takes the place of the model's own statements, by keywords (docs/settings.md; settings_help() lists them).

    file: a settings file; keywords come before what it says.
    """

    def __init__(self, file=None, **keywords):
        self.file = None if file is None else os.fspath(file)
        self.keywords = keywords
        self._native = _febiodea.make_settings(self.file or "", values(keywords))

    def as_dict(self):
        """All of them by their names in JSON; None: not given."""
        return self._native.as_dict()

    def __reduce__(self):
        return _settings_again, (self.file, self.keywords)

    def __eq__(self, other):
        return isinstance(other, Settings) and self.as_dict() == other.as_dict()

    __hash__ = None

    def __repr__(self):
        words = ([] if self.file is None else [repr(self.file)]) + [f"{k}={v!r}" for k, v in self.keywords.items()]
        return f"febiodea.Settings({', '.join(words)})"


def _settings_again(file, keywords):
    return Settings(file, **keywords)


def settings_help():
    """A text with every setting: its keyword, its form, what it does."""
    lines, group = [], None
    for option in _febiodea.setting_options():
        if option["group"] != group:
            group = option["group"]
            lines += ["", group]
        key = {None: "", "name": '"NAME.PARAMETER"'}.get(option["key"], f'"{str(option["key"]).upper()}"')
        if option["places"]:
            form = f'[({key}, (x, y, z){", DEGREES" if option["keyword"] == "rotate" else ""})]'
        else:
            form = f'{{{key}: {option["value"]}}}' if key else option["value"]
        lines += [f'  {option["keyword"]}={form}', f'      {option["help"].replace("; may be repeated", "")}']
    return "\n".join(lines).strip("\n")
