"""Which states of a model or file are meant."""
from ._errors import usage_fault

_FORMS = 'expected "all", "last", a time, or times [0.5, 1.0]'


def states_text(states):
    """As the program's option takes it; None: all, as a model's user would expect them."""
    if states is None or isinstance(states, str):
        return states or ""
    several = hasattr(states, "__iter__") and getattr(states, "ndim", 1) > 0
    try:
        times = [repr(float(time)) for time in (states if several else [states])]
    except (TypeError, ValueError):
        raise usage_fault("states", f"found {states!r}", _FORMS) from None
    if not times:
        raise usage_fault("states", "found no time", _FORMS)
    return ",".join(times)
