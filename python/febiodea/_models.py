"""Models, recognitions and results in a pickle: what they were made from; read, recognised and solved again."""
import hashlib
import os
import weakref

from . import _febiodea
from ._errors import input_fault


def _digest(files):
    digest = hashlib.sha256()
    for path, _, _ in files:
        with open(path, "rb") as file:
            digest.update(file.read())
    return digest.hexdigest()


def _unchanged(files):
    """Refuses files that are no longer what was read."""
    for path, size, written in files:
        try:
            now = os.stat(path)
            same = (now.st_size, now.st_mtime_ns) == (size, written)
        except OSError:
            same = False
        if not same:
            raise input_fault(os.fsdecode(path), "found that it has changed since it was read",
                              "expected the file as it was; read the model again")
    return files


def model_again(path, digest):
    """Reads a model again, and refuses another content."""
    model = _febiodea.read_feb(path)
    if _digest(model._files()) != digest:
        raise input_fault(os.fsdecode(path), "found another content than the pickled model had", "expected the same file")
    return model


def reduce_model(model):
    """The path and a digest of its files: unpickling reads it again, and refuses another content."""
    files = _unchanged(model._files())
    return model_again, (files[0][0], _digest(files))


def native_again(file, layers, tables):
    """Settings of the compiled part, said once more."""
    native = _febiodea.file_settings(file)
    for number, layer in enumerate(layers):
        native = _febiodea.laid_over(native, layer, tables if number == 0 else {})
    return native


def recognition_again(model, *said):
    """Recognises once more."""
    return _febiodea.recognise(model, native_again(*said))


def reduce_recognition(recognition):
    """Its model and settings: unpickling recognises again."""
    return recognition_again, (recognition.model, *recognition._said())


_ASKED = weakref.WeakKeyDictionary()  # result: which states it was asked for


def analysed(recognition, states, times_from, progress):
    """Solves, and remembers of the result what was asked for."""
    result = _febiodea.analyse(recognition, states, times_from, progress)
    _ASKED[result] = (states, times_from)
    return result


def result_again(recognition, states, times_from):
    """Solves once more."""
    return analysed(recognition, states, times_from, None)


def reduce_result(result):
    """Its recognition and which states: unpickling solves them again, to the same bits."""
    return result_again, (result.recognition, *_ASKED[result])
