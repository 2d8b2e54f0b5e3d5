"""A study's cases solved by the workers of dask.distributed. Dask schedules, and does again what a lost worker had."""
import hashlib
import pickle
import statistics
import threading

from . import _febiodea
from ._errors import Error, InputError

_LEAST, _GROWTH = 1.0, 4  # seconds of work in a batch; how much larger the next one may be
_MOST_BATCHES = 50        # that the client takes per second: with very many workers batches are longer
_MOST_STUDIES = 2         # that a worker keeps ready

_studies, _lock = {}, threading.Lock()  # of this worker process, by digest; the one that was used last comes last


def _memory():
    """For the joints of one study that are ready: of all studies half of what Dask lets this worker use; 0: it sets no limit."""
    from distributed import get_worker
    limit = get_worker().memory_manager.memory_limit
    return 0.5 / _MOST_STUDIES * limit if limit else 0.0


def _study(digest, planned):
    """This process's study with its joints that are ready; made once."""
    with _lock:
        if digest not in _studies:
            while len(_studies) >= _MOST_STUDIES:
                del _studies[next(iter(_studies))]
            request, identity = pickle.loads(planned)
            _studies[digest] = _febiodea.plan_study(*request, identity, _memory())
        _studies[digest] = _studies.pop(digest)
        return _studies[digest]


def _same(planned):
    return planned


def _solve_batch(digest, planned, keep_fields, first, last, indices):
    """Packed results of the cases, how each ended, and the seconds of each."""
    from distributed import get_worker
    try:
        study = _study(digest, planned)
    except InputError as fault:
        raise InputError(f"worker {get_worker().address}: {fault}", fault.place, fault.found, fault.expected) from None
    return study.solve(keep_fields, list(range(first, last)) if indices is None else indices)


class _Batches:
    """Cases in their order, cut into pieces that take about as long as is wanted."""

    def __init__(self, todo):
        self.todo, self.next, self.size = todo, 0, 1

    def take(self):
        """The next piece: first and last index, and the indices between where some are left out; None: no more."""
        piece = self.todo[self.next:self.next + self.size]
        self.next += len(piece)
        if not piece:
            return None
        first, last = piece[0], piece[-1] + 1
        return first, last, None if last - first == len(piece) else piece

    def measured(self, seconds, threads):
        """Of a batch. By the median: one case may have made its joint ready for all others."""
        wanted = max(_LEAST, threads / _MOST_BATCHES) / max(statistics.median(seconds), 1e-6)
        self.size = int(max(1, min(wanted, max(self.size, _GROWTH * len(seconds)))))


def _threads(client):
    return sum(worker["nthreads"] for worker in client.scheduler_info()["workers"].values())


def _result(future, piece):
    from distributed import CancelledError
    from distributed.scheduler import KilledWorker
    try:
        return future.result()
    except CancelledError as lost:
        raise Error(f"cases {piece[0] + 1} to {piece[1]}: found that the cluster has dropped them, expected it to stay as it is "
                    "(Client.restart, a scheduler begun anew); what is done is in the file, and the same call goes on") from lost
    except KilledWorker as lost:
        raise Error(f"cases {piece[0] + 1} to {piece[1]}: found their workers killed again and again, expected more memory "
                    "per worker, or fewer threads; what is done is in the file") from lost


def solve(client, study, file, keep_fields, progress):
    """Fills the file; results are written as they come."""
    from distributed import as_completed
    batches, done = _Batches(file.todo), file.count - len(file.todo)
    words = pickle.dumps((study._request, study._native.identity))
    digest = hashlib.sha256(words).hexdigest()
    planned = client.submit(_same, words, pure=False)  # a task, so that Dask makes it again if its worker is lost
    pieces, ended = {}, as_completed()

    def submit():
        while len(pieces) < 2 * _threads(client) + 2 and (piece := batches.take()) is not None:
            future = client.submit(_solve_batch, digest, planned, keep_fields, *piece, pure=False)
            pieces[future] = piece
            ended.add(future)
    try:
        submit()
        for future in ended:
            packed, outcomes, seconds = _result(future, pieces.pop(future))
            file.add(packed)
            batches.measured(seconds, _threads(client))
            submit()
            for outcome in outcomes:
                done += 1
                if progress is not None:
                    progress(_febiodea.case_progress(done, file.count, outcome))
    finally:
        file.finish()  # first: a client that lost its scheduler cannot cancel
        client.cancel([*pieces, planned])
