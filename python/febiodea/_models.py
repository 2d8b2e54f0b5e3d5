"""Models and recognitions in a pickle: what they were made from, read and recognised again."""
import hashlib
import os

from . import _febiodea
from ._errors import InputError


def _digest(files):
    digest = hashlib.sha256()
    for file in files:
        with open(file, "rb") as f:
            digest.update(f.read())
    return digest.hexdigest()


def model_again(path, digest):
    model = _febiodea.read_feb(path)
    if _digest(model.files) != digest:
        raise InputError(f"{path}: found another content than the pickled model had, expected the same file", path,
                         "found another content than the pickled model had", "expected the same file")
    return model


def reduce_model(model):
    """The path and a digest of its files: unpickling reads it again, and refuses another content."""
    return model_again, (os.path.abspath(model.files[0]), _digest(model.files))


def recognition_again(model, file, values):
    return _febiodea.recognise(model, _febiodea.make_settings(file, values))


def reduce_recognition(recognition):
    """Its model and settings: unpickling recognises again."""
    return recognition_again, (recognition.model, *recognition._said())
