"""What a user can do wrong, as exceptions. Made by the compiled part."""


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
