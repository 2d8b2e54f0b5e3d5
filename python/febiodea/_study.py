"""Studies: thousands of cases into one file, as `dea study` writes it."""
import collections.abc
import os

from . import _febiodea, _settings
from ._errors import need, usage_fault, whole_number
from ._states import states_text
from ._study_results import read_study
from ._study_tables import table_in_memory
from ._tables import html_pairs

_PAIRS = 'expected {"NAME": "OPTION VALUE"} or a list of ("NAME", "OPTION VALUE") pairs, such as ("stiffness", "E={8|12}")'


def _pairs(vary):
    """(name, text) of each factor, and of each option between them (name None), in their order."""
    pairs = list(vary.items()) if isinstance(vary, dict) else vary
    if not isinstance(pairs, (list, tuple)):
        raise usage_fault("vary", f"found a {type(vary).__name__}", _PAIRS)
    for pair in pairs:
        if not (isinstance(pair, (list, tuple)) and len(pair) == 2 and isinstance(pair[1], str)
                and isinstance(pair[0], (str, type(None)))):
            raise usage_fault("vary", f"found {pair!r}", _PAIRS)
        yield pair


def _option(text):
    """Name and value of "rotate pelvis=0,1,0,10" or "E=8"."""
    space, equals = text.find(" "), text.find("=")
    end = min((at for at in (space, equals) if at >= 0), default=len(text))
    return text[:end], text[end + 1:].strip()


def _options(keywords, vary):
    """All options as `dea study` takes them: settings, then factors and what stands between them."""
    for name, key, text in _settings.values(keywords):
        yield name.replace("_", "-"), f"{key}={text}" if key else text
    for name, text in _pairs(vary):
        yield _option(text) if name is None else ("vary", f"{name}: {text}")


def _sample(sample):
    """("sobol", 64) or ("sobol", 64, 1) as texts: design, count, seed."""
    if sample is None:
        return ["", "", ""]
    if not isinstance(sample, (list, tuple)) or len(sample) not in (2, 3) or not isinstance(sample[0], str):
        raise usage_fault("sample", f"found {sample!r}", 'expected ("sobol", COUNT) or ("sobol", COUNT, SEED)')
    return ([sample[0]] + [_settings._text(number, "sample") for number in sample[1:]] + [""])[:3]


def _paths(models):
    """As bytes: a name that is no UTF-8 is a name, too."""
    named = [models] if isinstance(models, (str, bytes, os.PathLike)) else models
    need(named, collections.abc.Iterable, "models", "a path, or several")
    found = list(named)
    for model in found:
        need(model, (str, bytes, os.PathLike), "models", "a path, or several")
    return [os.fsencode(model) for model in found]


def _check_run(client, workers, keep, again, shard, progress):
    if again not in (None, "failed"):
        raise usage_fault("again", f"found {again!r}", 'expected "failed" or None')
    if client is not None and (not hasattr(client, "submit") or not hasattr(client, "scheduler_info")):
        raise usage_fault("client", f"found a value of type {type(client).__name__}", "expected a dask.distributed.Client")
    if client is not None and getattr(client, "asynchronous", False):
        raise usage_fault("client", "found a Client that is asynchronous", "expected Client(..., asynchronous=False)")
    if workers is not None and (client is not None or not isinstance(workers, int) or not 1 <= workers <= 1024):
        raise usage_fault("workers", f"found {workers!r}" + (" beside a client" if client is not None else ""),
                          "expected a number from 1 to 1024, without a client")
    for word in keep:
        need(word, str, "keep", '"fields", "xplt" or both')
    if client is not None and "xplt" in keep:
        raise usage_fault("keep", 'found "xplt" beside a client, whose workers would write them on their own disks',
                          'expected "fields", or no client')
    need(shard, (str, type(None)), "shard", '"2/4" or "auto"')
    need(progress, (collections.abc.Callable, type(None)), "progress", "a function of a Progress")


class Study:
    """Every combination of models and values of factors, to be solved into one file: what `dea study` does.

    models: a path or several. vary: the factors, {"tilt": "rotate pelvis=0,1,0,{-20:20:5}", "stiffness": "E={8|12|16}"},
    values in braces as in docs/studies.md; or a list of ("tilt", "rotate ...") pairs, in which (None, "rotate ...") is an
    option without a factor: options act in their order. settings: a settings file, or Settings without tables in memory;
    keywords: settings of all cases, which act before the factors. cases: the values of factors with {}, a row a case: a
    file, a pandas.DataFrame or a list of dictionaries. sample: ("sobol", COUNT, SEED), or latin or saltelli: values of
    factors with a spread. states: those of every case, as in analyse.
    The models are read, but nothing is solved. len() is the number of cases. Pickled, it is what was asked for: whoever
    reads it reads the models again, at the same paths. Raises UsageError, InputError.
    """

    def __init__(self, models=(), vary=(), *, cases=None, sample=None, states=None, settings=None, **keywords):
        need(settings, (str, bytes, os.PathLike, _settings.Settings, type(None)), "settings",
             "a settings file, or Settings")
        if isinstance(settings, _settings.Settings):
            keywords, settings = {**settings.keywords, **keywords}, settings.file
        _settings.laid_over(_febiodea.file_settings(b""), keywords)  # what is wrong with them, in Python's words
        for name in ("loads", "motion", "thickness_from"):
            values = keywords.get(name)
            if any(not isinstance(one, (str, os.PathLike, type(None)))
                   for one in (values.values() if name == "thickness_from" and isinstance(values, dict) else [values])):
                raise usage_fault(name, "found a table in memory", "expected a file, which whoever goes on reads again")
        in_file = cases is None or isinstance(cases, (str, bytes, os.PathLike))
        self._request = (_paths(models), list(_options(keywords, vary)), None if in_file else table_in_memory(cases, "cases", "a case"),
                         [os.fsencode(cases or b"") if in_file else "", *_sample(sample), states_text(states),
                          os.fsencode(settings or b"")])
        self._native = _febiodea.plan_study(*self._request, None, 0.0)

    def __getstate__(self):
        return self._request

    def __setstate__(self, request):
        self._request = request
        self._native = _febiodea.plan_study(*request, None, 0.0)

    def __len__(self):
        return len(self._native)

    @property
    def factors(self):
        """Names of the factors, in their order."""
        return self._native.factors

    @property
    def models(self):
        """Paths of the models, in their order."""
        return self._native.models

    def case(self, number):
        """What case `number` (from 1) is: "model", and the text of each factor's value. Raises UsageError."""
        number = whole_number(number, "number", f"a case from 1 to {len(self)}")
        if not 1 <= number <= len(self):
            raise usage_fault("number", f"found {number}", f"expected a case from 1 to {len(self)}")
        model, values = self._native.case(number - 1)
        return {"model": model, **dict(zip(self.factors, values))}

    def run(self, path, client=None, workers=None, keep=(), again=None, *, overwrite=False, shard=None, progress=None):
        """Solves the cases that the file lacks, and answers the file as read_study does.

        path: the study's file; one of the same study is gone on with. client: a Client of dask.distributed, whose workers
        solve; None: this computer. workers: how many cases are solved here at a time, None: as many as there are cores.
        keep: "fields" (pressures at nodes, in the file), "xplt" (a plot file per case; not with a client), or both. again:
        "failed" solves cases that are no solution again. overwrite: begins anew. shard: "2/4" or "auto", as --shard.
        progress: called with a Progress (stage "case") as cases end; what it raises ends the study. Ctrl-C ends it
        and keeps the cases that are done. Cases that cannot be solved are rows of the file, and raise nothing.
        Raises InputError (the file is of another study), UsageError, WriteError.
        """
        keep = [keep] if isinstance(keep, str) else list(keep or ())
        _check_run(client, workers, keep, again, shard, progress)
        need(path, (str, bytes, os.PathLike), "path", "the study's file")
        file = _febiodea.open_study(self._native, os.fsencode(path), keep, shard or "", bool(overwrite), again is not None)
        try:
            if client is not None:
                from . import _study_dask
                _study_dask.solve(client, self, file, "fields" in keep, progress)
            elif file.todo:
                file.solve(workers or 0, progress)
        finally:
            file.close()
        return read_study(file.path)

    def _repr_html_(self):
        """Its models, factors and how many cases it has."""
        return html_pairs([*(("model", model) for model in self.models), *((name, "factor") for name in self.factors), ("cases", len(self))])

    def __repr__(self):
        return f"<febiodea.Study of {len(self)} cases: {', '.join(self.factors) or 'no factor'}>"
