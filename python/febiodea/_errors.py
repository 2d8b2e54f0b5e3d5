"""What a user can do wrong, as exceptions. Made by the compiled part."""
import operator


class Error(Exception):
    """A fault in what was given. str() is one line: where, what was found, what was expected, what to do.

    place     file and line, or the setting that cannot be followed; "": no one place
    found     what there is
    expected  what is needed, and what to do; "": not said
    remedy    settings that would help, as keywords
    others    further faults of the same model, as exceptions
    """

    def __init__(self, message="", place="", found="", expected="", remedy=(), others=()):
        super().__init__(message)
        self.place = place
        self.found = found
        self.expected = expected
        self.remedy = tuple(remedy)
        self.others = tuple(others)


class InputError(Error, ValueError):
    """A model or a file cannot be used."""


class UsageError(Error, ValueError):
    """A setting or an argument cannot be followed."""


class WriteError(Error):
    """An output cannot be written."""


def _line(place, found, expected):
    return f"{place}: {found}, {expected}", place, found, expected


def usage_fault(place, found, expected):
    """A UsageError of the module's Python part."""
    return UsageError(*_line(place, found, expected))


def input_fault(place, found, expected):
    """An InputError of the module's Python part."""
    return InputError(*_line(place, found, expected))


def need(value, types, place, expected):
    """Refuses a value of another type; `expected`: what it must be, and how it is made."""
    if not isinstance(value, types):
        raise usage_fault(place, f"found a value of type {type(value).__name__}", f"expected {expected}")


def whole_number(value, place, expected):
    """The number, be it numpy's; `expected`: what it must be."""
    try:
        return operator.index(value)
    except TypeError:
        raise usage_fault(place, f"found {value!r}", f"expected {expected}") from None
