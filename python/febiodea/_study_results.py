"""A study's file, read: also while somebody adds cases to it."""
import os
import pathlib
import sqlite3
import zlib
from typing import NamedTuple, Optional

import numpy

from . import _febiodea, _labelled
from ._errors import input_fault, need, usage_fault, whole_number
from ._study_tables import table_in_memory
from ._tables import html_pairs

_SHOWN = {"results": "case_id, state, contact_id", "part_results": "case_id, state, contact_id, part_id",
          "layer_results": "case_id, state, layer_id", "layers": "case_id, state, layer_id",
          "soft_part_results": "case_id, state, soft_part_id", "soft_parts": "case_id, state, soft_part_id",
          "cases": "case_id", "states": "case_id, state", "statistics": "case_id, state, contact_id",
          "parts": "case_id, state, contact_id, part_id", "poses": "case_id, state, body_id",
          "warnings": "case_id, number", "factors": "number", "models": "model_id", "inputs": "number",
          "options": "number"}  # table or view: its order


class Factor(NamedTuple):
    """What differs from case to case.

    name of its column; option of `dea run` without dashes; text of the option, {} for what differs; spread: "uniform",
    "normal" or "lognormal", and its numbers a and b; None: it is not drawn.
    """
    name: str
    option: str
    text: str
    spread: Optional[str]
    a: Optional[float]
    b: Optional[float]


class StudyState(NamedTuple):
    """One state of a case.

    time: the model's. outcome, message: as in State. contacts: by name, the numbers of each under the names of `dea run
    --csv`; what is undefined is NaN. bodies: by name, of each "center" (3,) its current centre of mass, "rotation" (3,) its
    rotation vector from the reference [rad], "force" (3,) and "moment" (3,) on it, the moment about that centre; global.
    """
    case: int
    state: int
    time: float
    outcome: str
    message: str
    iterations: int
    residual_force: float
    residual_moment: float
    contacts: dict
    bodies: dict


class StudySurface(NamedTuple):
    """The surface that fields stand on, in the reference configuration: name, vertices (vertices, 3) in the model's length,
    triangles (triangles, 3), from 0."""
    name: str
    vertices: numpy.ndarray
    triangles: numpy.ndarray


def _number(value):
    return numpy.nan if value is None else value


def _array(stream, kind, columns=None):
    values = numpy.frombuffer(zlib.decompress(stream), kind)
    return values if columns is None else values.reshape(-1, columns)


def _of_head(index, doc):
    """A property: one part of what _febiodea.study_head answers."""
    return property(lambda self: self._head[index], doc=doc)


class StudyResults:
    """The file of a study, `dea study`'s or Study.run's. It is only read; each call sees what is there at that time.

    Made by read_study.
    """

    def __init__(self, path, subjects=None):
        need(path, (str, bytes, os.PathLike), "path", "a study's file")
        self._path = os.fsdecode(path)
        self._head = _febiodea.study_head(os.fsencode(path))
        self._subjects = (subjects if subjects is None else os.fsencode(subjects)
                          if isinstance(subjects, (str, bytes, os.PathLike)) else table_in_memory(subjects, "subjects", "a model"))

    def _read(self, sql, *values):
        """Names of columns, and rows as tuples."""
        _febiodea.study_head(os.fsencode(self._path))  # what a killed program had begun is taken back
        address = pathlib.Path(self._path).absolute().as_uri() + "?mode=ro"
        try:
            connection = sqlite3.connect(address, uri=True, timeout=10)
            try:
                connection.text_factory = os.fsdecode  # a path may be no UTF-8
                found = connection.execute(sql, values)
                return [column[0] for column in found.description], found.fetchall()
            finally:
                connection.close()
        except sqlite3.Error as fault:
            raise input_fault(self._path, f"found that it cannot be read: {fault}", "expected a study's file") from None

    def _rows(self, sql, *values):
        """Dictionaries."""
        names, rows = self._read(sql, *values)
        return [dict(zip(names, row)) for row in rows]

    path = property(lambda self: self._path, doc="Of the file.")
    version = _of_head(0, "Of the program that made it, with its commit.")
    options = _of_head(1, "What the cases depend on, as the program's options, in their order.")
    inputs = _of_head(2, "Every file that was read, and its digest.")
    models = _of_head(3, "Paths of the models.")
    planned = _of_head(5, "Cases of the whole study, of all shards.")
    shard = property(lambda self: self._head[6:8], doc="(2, 4): the second of four shards; (1, 1): the whole.")

    @property
    def factors(self):
        """The factors, in their order: a list of Factor."""
        return [Factor(r["name"], r["option"], r["text"], r["spread"], r["a"], r["b"]) for r in self.table("factors")]

    @property
    def counts(self):
        """Cases that are there: {"solved": ..., "failed": ..., "refused": ...}."""
        there = self._rows("SELECT case_outcome, count(*) AS n FROM cases GROUP BY case_outcome")
        return {"solved": 0, "failed": 0, "refused": 0, **{r["case_outcome"]: r["n"] for r in there}}

    def table(self, name="results"):
        """A table or view of the file (docs/studies.md) as a list of dictionaries in the order of cases, states and
        contacts. Raises UsageError, InputError."""
        return self._rows(self._all_of(name))

    def _all_of(self, name):
        if name not in _SHOWN:
            raise usage_fault("name", f"found {name!r}", f"expected one of {', '.join(_SHOWN)}")
        return f"SELECT * FROM {name} ORDER BY {_SHOWN[name]}"

    def to_pandas(self, name="results"):
        """table(name) as a pandas.DataFrame: without a name a row per case, state and contact. Raises ImportError where
        pandas is not installed."""
        try:
            import pandas
        except ImportError as missing:
            raise ImportError("to_pandas needs pandas, which is not installed: install it, or use table()") from missing
        names, rows = self._read(self._all_of(name))
        return pandas.DataFrame.from_records(rows, columns=names)  # with its columns, also where no case is done yet

    def parts(self):
        """A row per case, state, contact and compartment, as a pandas.DataFrame: to_pandas("part_results")."""
        return self.to_pandas("part_results")

    def failed(self):
        """The cases that are no solution, as dictionaries: case_id, model, case_outcome, case_message, the factors."""
        names = "".join(', c."' + name.replace('"', '""') + '"' for name in self._head[4])
        return self._rows(f"SELECT c.case_id, m.path AS model, c.case_outcome, c.case_message{names} FROM cases c "
                          "JOIN models m USING (model_id) WHERE c.case_outcome <> 'solved' ORDER BY c.case_id")

    def _case(self, case):
        expected = f"a case that is in the file, of 1 to {self.planned}"
        found = self._rows("SELECT * FROM cases WHERE case_id = ?", whole_number(case, "case", expected))
        if not found:
            raise usage_fault("case", f"found {case}", f"expected {expected}")
        return found[0]

    def _state(self, case, state):
        """The row of a state; None: the last one."""
        row = self._case(case)
        if state is not None:
            state = whole_number(state, "state", f"a state of case {case}, from 1, or None: the last")
        which = "ORDER BY state DESC LIMIT 1" if state is None else "AND state = ?"
        found = self._rows(f"SELECT * FROM states WHERE case_id = ? {which}", row["case_id"], *([] if state is None else [state]))
        if not found:
            raise usage_fault("state" if row["case_message"] is None or state is not None else "case",
                              f"found {case if state is None else state}",
                              f"expected a state of case {case}, which is {row['case_outcome']}")
        return found[0]

    def state(self, case, state=None):
        """One state of a case as a StudyState. state: its number, from 1; None: the last. Raises UsageError."""
        row = self._state(case, state)
        key = row["case_id"], row["state"]
        contacts, bodies = {}, {}
        for r in self._rows("SELECT * FROM statistics WHERE case_id = ? AND state = ? ORDER BY contact_id", *key):
            contacts[r["contact"]] = {k: v if isinstance(v, str) else _number(v) for k, v in r.items()
                                      if k not in ("case_id", "state", "contact_id", "contact")}
        for r in self._rows("SELECT * FROM poses WHERE case_id = ? AND state = ? ORDER BY body_id", *key):
            bodies[r["body"]] = {name: numpy.array([_number(r[f"{name}_{axis}"]) for axis in "xyz"])
                                 for name in ("center", "rotation", "force", "moment")}
        return StudyState(*key, row["time"], row["outcome"], row["message"] or "", row["iterations"],
                          _number(row["residual_force"]), _number(row["residual_moment"]), contacts, bodies)

    def _contact(self, case, state, contact):
        names = [(r["contact_id"], r["contact"], r["source"]) for r in self._rows(
            "SELECT contact_id, contact, source FROM statistics WHERE case_id = ? AND state = ? ORDER BY contact_id", case,
            state)]
        found = [one for one in names if one[1] == contact] if contact else names
        if len(found) == 1:
            return found[0]
        raise usage_fault("contact", f"found {contact!r}",
                          f"expected one of {', '.join(name for _, name, _ in names) or 'none: there is no contact'}")

    def fields(self, case, state=None, contact=None):
        """Pressures at the vertices of surface(case, contact), as keep="fields" keeps them: (vertices,), single precision.
        state: None is the last; contact: None is the only one. Raises UsageError."""
        key = self._state(case, state)
        number = self._contact(key["case_id"], key["state"], contact)[0]
        found = self._rows("SELECT pressure FROM fields WHERE case_id = ? AND state = ? AND contact_id = ?",
                           key["case_id"], key["state"], number)
        if not found:
            raise self._no_fields()
        return _array(found[0]["pressure"], "<f4")

    def surface(self, case, contact=None):
        """The surface that the fields of a case stand on: a StudySurface. Raises UsageError."""
        key = self._state(case, None)
        _, name, source = self._contact(key["case_id"], key["state"], contact)
        found = self._rows("SELECT * FROM surfaces WHERE model_id = ? AND contact = ? AND source = ?",
                           self._case(case)["model_id"], name, source)
        if not found:
            raise self._no_fields()
        return StudySurface(found[0]["surface"], _array(found[0]["vertices"], "<f8", 3), _array(found[0]["triangles"], "<i4", 3))

    # ---- statistics, and the page ----

    def _which(self, number, place, state):
        """The study's numbers as they are now, and which of them are asked for."""
        numbers = _febiodea.study_numbers(self._path, self._subjects)
        names = [name.replace("headline_", "") for name in numbers.statistics]
        if number not in names:
            raise usage_fault("number", f"found {number!r}", f"expected one of {', '.join(names)}")
        places = numbers.places
        if place is not None and place not in places:
            raise usage_fault("place", f"found {place!r}", f"expected one of {', '.join(places)}")
        if state != "largest" and not (isinstance(state, int) and 1 <= state <= numbers.states):
            raise usage_fault("state", f"found {state!r}", f'expected one from 1 to {numbers.states}, or "largest"')
        if not places:
            raise usage_fault(self._path, "found no contact in any case", "expected one")
        choice = numbers.choices - 1 if state == "largest" else state - 1
        return numbers, [names.index(number), 0 if place is None else places.index(place), choice]

    def outputs(self, number="p99", place=None, state="largest"):
        """One number per case: (case numbers, values), NaN where the case has none.

        number: "p99", "mean", "area", "peak" or "force", of a study with inside=True also those of whole contacts such as
        "source_bone_max_shear_stress_p99" (docs/studies.md, "The page"); place: a contact, or "contact: compartment", None: the
        first contact; state: from 1, or "largest" of all states. Raises UsageError."""
        numbers, which = self._which(number, place, state)
        return numbers.cases, numbers.outputs(which)

    def influence(self, number="p99", place=None, state="largest"):
        """What the number of `outputs` depends on: "factors" (standardised "coefficient", Spearman's "rho" of each),
        "r_squared", "slopes" one at a time about a base case, "sobol" where the cases are a Saltelli design, else None."""
        numbers, which = self._which(number, place, state)
        return numbers.influence(which)

    def groups(self, column, number="p99", place=None, state="largest"):
        """Values of a column ("model", a factor or one of the subjects) as groups: "levels", "boxes" (as statistics.box_plot), "differences" of
        each level but the first from the first, that level less the first (as statistics.difference)."""
        numbers, which = self._which(number, place, state)
        return numbers.groups(column, which)

    def pairs(self, column, number="p99", place=None, state="largest", *, by=None):
        """Cases that differ in one column alone, "COLUMN" of two values or "COLUMN=A,B": as statistics.pairs, A less B, with "levels"
        and how many cases are "alone". by: of the subjects' columns partners share this one, None: all others."""
        numbers, which = self._which(number, place, state)
        return numbers.pairs(column, by or "", which)

    def report(self, path, *, group=None, pair=None, pair_by=None, regions=None, up=None, anterior=None, axis=None, center=None,
               dose_above=None, cycles_per_year=None, years=None, cycle_seconds=None):
        """Writes the study as one page for any browser, as `dea study FILE.db --report` does with the options of these
        names; regions: "socket", "anterior-superior-posterior" or a number of sectors. Answers what is thinned on it, a list of sentences.
        Raises UsageError, InputError, WriteError."""
        if not os.fspath(path).lower().endswith((".html", ".htm")):
            raise usage_fault("path", f"found {os.fspath(path)!r}", "expected a name that ends in .html or .htm")
        words = ("socket", "anterior-superior-posterior")
        if regions is not None and regions not in words and not (isinstance(regions, int) and 2 <= regions <= 72):
            raise usage_fault("regions", f"found {regions!r}", 'expected "socket", "anterior-superior-posterior", or a number of sectors from 2 to 72')
        if regions is not None and (up is None or (regions in words and anterior is None)):
            raise usage_fault("regions", "found no directions", "expected up, and for a socket anterior")
        if (cycles_per_year is None) != (years is None) or (dose_above is None and (years or cycle_seconds)):
            raise usage_fault("dose_above", "found a history of loading that is not whole",
                              "expected dose_above, and cycles_per_year with years")
        if pair_by and not (pair and self._subjects):
            raise usage_fault("pair_by", f"found {pair_by!r}", "expected pair with it, and read_study(..., subjects=...)")
        return _febiodea.study_report(self._path, os.fspath(path), {
            "group": group or "", "pair": pair or "", "pair_by": pair_by or "", "subjects": self._subjects, "socket": regions == words[0], "thirds": regions == words[1],
            "sectors": regions if isinstance(regions, int) else 0, "up": up, "anterior": anterior, "axis": axis, "center": center,
            "dose_above": dose_above, "cycles_per_year": cycles_per_year, "years": years, "cycle_seconds": cycle_seconds})

    def _no_fields(self):
        return usage_fault(self._path, "found no pressures at nodes", 'expected a study that was run with keep="fields"')

    def to_xarray(self):
        return _labelled.study_to_xarray(self)
    to_xarray.__doc__ = _labelled.study_to_xarray.__doc__

    def _repr_html_(self):
        """Its factors, and how many cases are there."""
        pairs = [("file", self._path), *((factor.name, factor.text) for factor in self.factors), ("cases", f"{sum(self.counts.values())} of {self.planned}"),
                 *self.counts.items()]
        return html_pairs(pairs)

    def __repr__(self):
        counts = self.counts
        return (f"<febiodea.StudyResults {self._path}: {sum(counts.values())} of {self.planned} cases, "
                f"{counts['failed']} failed, {counts['refused']} refused>")


def read_study(path, subjects=None):
    """The file of a study, to be read. subjects: what is told of its models, as `dea study --subjects`: a file, a
    pandas.DataFrame or a list of dictionaries with a row per model, value of a factor or case_id; its columns are there for
    groups, pairs and the page. Raises InputError, UsageError."""
    return StudyResults(path, subjects)
