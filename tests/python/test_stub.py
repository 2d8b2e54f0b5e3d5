"""The stub names what the module has, and nothing else."""
import ast
import inspect
import pathlib

import pytest

import febiodea

STUB = ast.parse(pathlib.Path(febiodea.__file__).with_name("__init__.pyi").read_text())
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}
FUNCTIONS = {node.name: node for node in STUB.body if isinstance(node, ast.FunctionDef)}
PUBLIC = [name for name in febiodea.__all__]


def own_members(cls):
    """Without underscores, but for _repr_html_; of our own classes only."""
    names = set()
    for base in cls.__mro__:
        if base.__module__.startswith("febiodea"):
            names |= {name for name in vars(base) if not name.startswith("_") or name == "_repr_html_"}
    return names


def stub_members(name):
    names = set()
    for base in [name] + [b.id for b in CLASSES[name].bases if isinstance(b, ast.Name) and b.id in CLASSES]:
        for node in CLASSES[base].body:
            if isinstance(node, ast.FunctionDef) and (not node.name.startswith("_") or node.name == "_repr_html_"):
                names.add(node.name)
            if isinstance(node, ast.AnnAssign):
                names.add(node.target.id)
    return names


def test_names():
    assert set(PUBLIC) == set(CLASSES) | set(FUNCTIONS)
    assert all(hasattr(febiodea, name) for name in PUBLIC)


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_members(name):
    cls = getattr(febiodea, name)
    members = own_members(cls)
    if issubclass(cls, BaseException):
        members |= set(vars(cls("")))
    if name == "Settings":
        members |= {"file", "keywords"}
    if hasattr(cls, "_fields"):
        members = set(cls._fields)
    assert stub_members(name) == members


def parameters(node):
    a = node.args
    return [arg.arg for arg in a.posonlyargs + a.args + a.kwonlyargs if arg.arg != "self"]


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_parameters(name):
    function = getattr(febiodea, name)
    if inspect.isfunction(function):
        found = [p.name for p in inspect.signature(function).parameters.values()
                 if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]
        assert parameters(FUNCTIONS[name]) == found
    else:  # compiled: its first line has them
        line = function.__doc__.splitlines()[0]
        assert all(f"{p}:" in line for p in parameters(FUNCTIONS[name]))


def test_everything_says_what_it_is():
    for name in PUBLIC:
        thing = getattr(febiodea, name)
        assert thing.__doc__ and thing.__doc__.strip()
        if inspect.isclass(thing):
            for member in own_members(thing) - {"_repr_html_"}:
                assert getattr(thing, member).__doc__, f"{name}.{member}"
