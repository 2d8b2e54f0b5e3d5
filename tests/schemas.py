"""The schemas that `dea schema` prints, and the JSON that results_page.py has the program write.

Each file must be valid, and without a key that its schema lacks: the schemas themselves allow more keys, for those that later
versions add. A value of another type, a word that is none, a missing key must be found."""
import copy
import json
import subprocess

import jsonschema

# Words out of a few, some of them. A letter more, and each must be refused.
WORDS = {"run": {"schema", "states.[].outcome", "states.[].contacts.[].law", "states.[].contacts.[].facets", "settings.springs_at",
                 "finding_values.[].severity"},
         "info": {"schema", "contacts.[].springs_at", "ligaments.[].law", "joints.[].motion.[]", "steps.[].bodies.femur.dofs.Ru"},
         "converge": {"schema", "contacts.[].rows.[].outcome"}, "compare": {"schema", "areas"},
         "build": {"schema", "side", "bones.[].free.[]", "hip.side", "frames.[].name"}}


def printed(dea, *name):
    return subprocess.run([dea, "schema", *name], capture_output=True, text=True, check=True).stdout


def strict(schema):
    """The same schema, with no other keys than those it names."""
    if isinstance(schema, list):
        return [strict(inner) for inner in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {name: strict(inner) for name, inner in schema.items()}
    if "properties" in schema and isinstance(schema.get("required"), list):
        closed["additionalProperties"] = False
    return closed


def place(path):
    return ".".join("[]" if isinstance(part, int) else part for part in path)


def leaves(value, path=()):
    """Places of all values that hold no others, with these; `values` of findings, each rule's own, are not among them."""
    if path[:1] == ("finding_values",) and path[2:3] == ("values",):
        return
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, one in inner:
        yield from leaves(one, (*path, key))
    if not isinstance(value, (dict, list)):
        yield path, value


def put(whole, path, value):
    for key in path[:-1]:
        whole = whole[key]
    whole[path[-1]] = value


def refused(validator, whole):
    """Places of what is refused; of what may be one thing or another, all in it."""
    paths = {tuple(error.absolute_path) for error in validator.iter_errors(whole)}
    either = {tuple(error.absolute_path) for error in validator.iter_errors(whole) if error.validator == "anyOf"}
    return {path for path, _ in leaves(whole) if path in paths or any(path[:len(e)] == e for e in either)}


def with_each(whole, changed):
    """A copy in which each value but null is `changed`, and where."""
    copied, places = copy.deepcopy(whole), set()
    for path, value in leaves(whole):
        if value is not None and changed(value) is not None:
            put(copied, path, changed(value))
            places.add(path)
    return copied, places


def another_type(value):
    return 0 if isinstance(value, str) else str(value).lower()


def another_word(value):
    return value + "x" if isinstance(value, str) else None


def faults(dea, files):
    """`files`: "run.json" -> those that were written."""
    found = []
    names = [line.split()[0] for line in printed(dea).splitlines()]
    for file in files:
        if file.endswith(".json") and file[:-5] not in names:
            found.append(f"dea schema: lacks {file[:-5]}")
    given = set()  # settings
    for name in names:
        schema = json.loads(printed(dea, name))
        jsonschema.Draft202012Validator.check_schema(schema)
        published, closed = jsonschema.Draft202012Validator(schema), jsonschema.Draft202012Validator(strict(schema))
        words = set()
        for file in files.get(f"{name}.json", []):
            whole = json.loads(file.read_text())
            errors = {f"{place(e.absolute_path)}: {e.message[:200]}" for e in closed.iter_errors(whole)}
            found += [f"dea schema {name}: {file.name}: {error}" for error in sorted(errors)]
            given |= {key for key, value in whole.get("settings", {}).items() if value != schema["properties"]["settings"][
                "properties"][key].get("default", [])}
            changed, places = with_each(whole, another_type)
            missed = {place(path) for path in places - refused(published, changed)}
            found += [f"dea schema {name}: {file.name}: takes another type of `{one}`" for one in sorted(missed)]
            changed, places = with_each(whole, another_word)
            words |= {place(path) for path in places & refused(published, changed)}
            for key in whole:
                if published.is_valid({other: value for other, value in whole.items() if other != key}):
                    found.append(f"dea schema {name}: {file.name}: takes a file without `{key}`")
        if f"{name}.json" in files:
            found += [f"dea schema {name}: takes another word of `{one}`" for one in sorted(WORDS[name] - words)]
    settings = json.loads(printed(dea, "settings"))
    found += [f"no JSON of this test has the setting `{key}`" for key in sorted(set(settings["properties"]) - given)]
    return found
