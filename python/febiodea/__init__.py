"""Discrete element analysis of joint contact on FEBio models.

    import febiodea
    model = febiodea.read_feb("hip.feb")
    recognition = febiodea.recognise(model, law="layer")     # print(recognition): what it was taken for
    result = febiodea.analyse(recognition)
    contact = result.states[-1].contact()
    contact.springs.pressure                                 # numpy, one entry per spring
    contact.headline.p99

For many loads and poses of one joint: prepare, Prepared.solve, Prepared.press. For results of any program: read_xplt.
Thousands of cases into one file: Study, Study.run, read_study; statistics of many cases: febiodea.statistics.

Frame: global. Units: the model's own, throughout. Arrays look into the module's memory and cannot be written to; copy
what is to be changed.
"""
import atexit as _atexit
import os as _os
import sys as _sys

from . import _cells, _febiodea, _labelled, _models, _settings, _tables, statistics
from ._findings import Finding
from ._errors import Error, InputError, UsageError, WriteError, need as _need, usage_fault as _usage_fault
from ._febiodea import (Compartment, Contact, Facets, Model, Nodes, Part, PlotField, PlotFile, PlotState, PlotSurface,
                        Prepared, Pressed, PressedContact, Progress, Recognition, Result, Side, Springs, State, __version__,
                        distribution, pattern_difference, percentile)
from ._maps import picture, plot
from ._settings import Settings, settings_help
from ._states import states_text as _states_text
from ._study import Study
from ._study_results import Factor, StudyResults, StudyState, StudySurface, read_study
from ._tables import Headline

__all__ = ["read_feb", "recognise", "analyse", "prepare", "read_xplt", "picture", "plot", "distribution", "percentile",
           "pattern_difference", "read_study", "settings_help", "Settings", "Model", "Recognition", "Result", "State",
           "Part", "Contact", "Side", "Springs", "Facets", "Nodes", "Compartment", "Headline", "Prepared", "Pressed",
           "PressedContact", "Study", "StudyResults", "StudyState", "StudySurface", "Factor", "PlotFile", "PlotState",
           "PlotSurface", "PlotField", "Progress", "Finding", "Error", "InputError", "UsageError", "WriteError",
           "schema"]


@_atexit.register
def _end():
    # After an interrupt nobody waits: the process is about to end by that signal. Not so where somebody types: there the
    # interrupt was long ago.
    if getattr(_sys, "last_type", None) is not KeyboardInterrupt or hasattr(_sys, "ps1"):
        _febiodea.end_all_work()


def read_feb(path):
    """Reads a FEBio model (.feb, versions 1.2 to 4.0) with all that it includes. Raises InputError."""
    return _febiodea.read_feb(_os.fsencode(path))


def schema(name):
    """The JSON Schema that `dea schema NAME` prints, as a dictionary: "run" is that of Result.to_dict(). Raises UsageError."""
    return _febiodea.schema(name)


def recognise(model, settings=None, **keywords):
    """What joint a model describes, with every reason for which it could not be solved (Recognition.faults).

    model: a Model, or the path of one. settings: Settings, or the path of a settings file. keywords: settings one by one,
    which outweigh those of `settings`: law="linear", thickness={"tibial_cartilage": 1.8},
    rotate=[("pelvis", (0, 1, 0), 10)]; settings_help() lists them, help(Settings) has those that take tables and turns.
    Raises UsageError, InputError.
    """
    _need(model, (Model, str, bytes, _os.PathLike), "model", "a Model, or the path of one")
    _need(settings, (Settings, str, bytes, _os.PathLike, type(None)), "settings", "Settings, or the path of a settings file")
    if not isinstance(model, Model):
        model = read_feb(model)
    if not isinstance(settings, Settings):
        settings = Settings(settings)
    return _febiodea.recognise(model, _settings.laid_over(settings._native, keywords) if keywords else settings._native)


_RECOGNITION = "a Recognition, as recognise(...) makes it"


def analyse(recognition, states=None, *, times_from=None, progress=None):
    """Solves the states of a model, one after the other, each from the one before.

    states: "all", "last", a time, times [0.5, 1.0], or a text "0.5:1,last"; None: all, about 1000 where there are more than
    10000. times_from: a plot file whose times to take. progress: called with a Progress at each step, in this thread; what
    it raises ends the analysis. The process's other threads go on; Ctrl-C ends it. Raises InputError (the recognition has
    faults), UsageError.
    """
    _need(recognition, Recognition, "recognition", _RECOGNITION)
    return _models.analysed(recognition, _states_text(states), _os.fsencode(times_from or b""), progress)


def prepare(recognition):
    """Places the springs and factorises the layers once, for any number of loads and poses. Raises InputError."""
    _need(recognition, Recognition, "recognition", _RECOGNITION)
    return _febiodea.prepare(recognition)


def read_xplt(path, *, partial=False):
    """Reads a plot file of any program, compressed or not. One that is cut off is refused; partial: its complete states are
    read. Raises InputError."""
    return _febiodea.read_xplt(_os.fsencode(path), partial)


def _solve(self, body=None, force=None, moment=None, about=None, rotate=None, move=None, placements=None,
           rotate_about=None, free=None, start=None, progress=None):
    """The pose at which one load case balances: conditions at the end of the model's last step (of tables of loads and
    motion: their last row), but for what is said here.

    body, force, moment: what replaces all that the model puts on this body; (x, y, z), global; the force acts at
    `about`, (x, y, z) of the reference or "sphere-center" (None: the centre of mass), the moment is about it.
    rotate, move, placements: where the bodies stand, as in recognise; for a body that is named they take the place of what
    was said there, and turns come before moves: placements has both in any order. rotate_about, free: as in recognise.
    start: where free motions begin, a state or {"BODY": 4 x 4 array}; None: where the bodies are placed. What is held stays
    where it is placed. The same call gives the same bits. Answers a State. Raises UsageError, also for a load that the body
    is not free to follow; if a part of it has no effect: UserWarning.
    """
    keywords = {"rotate_about": rotate_about, "rotate": rotate, "move": move, "placements": placements, "free": free}
    if about is not None and body is None:
        raise _usage_fault("about", "found no body that it is of", 'expected body="BODY" beside it')
    if body is not None and not (about is None or (isinstance(about, str) and about == "com")):
        keywords["load_at"] = {body: about}
    return self._solve(body or "", force, moment, _settings.values(keywords), start, progress)


def _to_pandas(self):
    """table() as a pandas.DataFrame. Raises ImportError where pandas is not installed."""
    try:
        import pandas
    except ImportError as missing:
        raise ImportError("to_pandas needs pandas, which is not installed: install it, or use table()") from missing
    return pandas.DataFrame(self.table())


def _write_xplt(self, path, *, compress=False, overwrite=False):
    """Writes FEBio's plot file, complete or not at all. One that is there already is replaced if it is febiodea's own, of
    the same mesh and with no other states; overwrite: whatever it is. Raises WriteError."""
    self._write_xplt(_os.fsencode(path), compress, overwrite)


def _write_vtu(self, folder):
    """Writes files for ParaView into a folder (docs/vtk.md). Raises WriteError."""
    self._write_vtu(_os.fsencode(folder))


def _report(self, path):
    """Writes the results as one HTML page (docs/report.md). Raises WriteError."""
    self._report(_os.fsencode(path))


def _item(self, key):
    """result["hip_contact"]: this contact in the last state; result[0], result[-1]: a state. Raises KeyError, IndexError."""
    return self.states[-1][key] if isinstance(key, str) else self.states[key]


def _contact_item(self, name):
    """state["hip_contact"]: this contact. Raises KeyError."""
    for contact in self.contacts:
        if contact.name == name:
            return contact
    raise KeyError(f"found no contact {name!r}, expected one of {[c.name for c in self.contacts]}")


def _add(owner, **methods):
    for name, method in methods.items():
        method.__name__ = name
        method.__qualname__ = f"{owner.__name__}.{name}"
        setattr(owner, name, method)


_add(Prepared, solve=_solve)
_add(Result, table=_tables.rows, to_pandas=_to_pandas, write_xplt=_write_xplt, write_vtu=_write_vtu, report=_report,
     _repr_html_=_tables.html_of, to_xarray=_labelled.result_to_xarray, to_meshio=_labelled.result_to_meshio,
     to_pyvista=_labelled.result_to_pyvista, __reduce__=_models.reduce_result, __getitem__=_item)
_add(State, _repr_html_=_tables.html_of_state, __getitem__=_contact_item)
_add(Contact, _repr_html_=_tables.html_of_contact)
_add(PlotFile, to_xarray=_labelled.plot_file_to_xarray, to_meshio=_labelled.plot_file_to_meshio,
     to_pyvista=_labelled.plot_file_to_pyvista)
_add(Model, __reduce__=_models.reduce_model)
_add(Recognition, __reduce__=_models.reduce_recognition)
for _owner in (Model, PlotState, PlotSurface):
    _owner.cell_blocks = property(_cells.cell_blocks)
for _name in __all__:
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = "febiodea"  # as users know it, in messages and pickles
