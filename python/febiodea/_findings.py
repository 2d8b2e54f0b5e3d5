"""What was concluded, left out or is doubtful."""


def _value(name, doc):
    return property(lambda self: self._of[name], doc=doc)


class Finding(str):
    """One line, as the program prints it, with what it was made of (docs/findings.md). What does not apply is None."""

    def __new__(cls, line, **of):
        finding = super().__new__(cls, line)
        finding._of = of
        return finding

    def __reduce__(self):
        return _again, (str(self), self._of)

    code = _value("code", "Of the rule: \"narrow-contact\". Never renamed.")
    severity = _value("severity", "\"warning\", \"note\" or \"ignored\".")
    place = _value("place", "File and line of the model.")
    contact = _value("contact", "The contact it is of.")
    surface = _value("surface", "The surface it is of.")
    body = _value("body", "The body it is of.")
    time = _value("time", "The state's time.")
    values = _value("values", "Its numbers and names, in the model's units.")


def _again(line, of):
    return Finding(line, **of)
