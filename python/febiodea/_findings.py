"""What was concluded, left out or is doubtful."""


class Finding(str):
    """One line, as the program prints it, with what it was made of.

    code: of the rule, "narrow-contact" (docs/findings.md). severity: "warning", "note", "ignored". place: file and line of the
    model, or None. contact, surface, body, time: whom it is of, or None. values: its numbers and names, a dictionary in the
    model's units.
    """

    def __new__(cls, line, *, text, **of):
        return super().__new__(cls, line)

    def __init__(self, line, *, code, severity, place, contact, surface, body, time, values, text):
        self.code, self.severity, self.place = code, severity, place
        self.contact, self.surface, self.body, self.time = contact, surface, body, time
        self.values = values

    def __reduce__(self):
        return _again, (str(self), {**self.__dict__, "text": ""})


def _again(line, of):
    return Finding(line, **of)
