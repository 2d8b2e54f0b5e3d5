"""What dea tells of every sample, word by word: python3 golden_words.py DEA SOURCE [--write].

tests/golden_words.txt has the findings of `dea run`, a line each, below the name of the sample. The words must be the same,
numbers within 2 %: compilers differ in their last digits. --write makes the file anew: look at what differs before you commit it."""
import json
import pathlib
import re
import subprocess
import sys

dea, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
golden = source / "tests/golden_words.txt"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def told():
    for model in sorted((source / "samples").rglob("*.feb")):
        done = subprocess.run([dea, "run", model.name, "--no-xplt", "--json", "-", "-q"], cwd=model.parent, capture_output=True, text=True)
        yield f"== {model.relative_to(source / 'samples').as_posix()}"
        if done.returncode > 1:
            yield done.stderr.strip()
            continue
        report = json.loads(done.stdout)
        for line, finding in zip(report["findings"], report["finding_values"]):
            yield f"{line} [{finding['code']}]"


def alike(a, b):
    """The same words, and nearly the same numbers."""
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return False
    pairs = zip(map(float, NUMBER.findall(a)), map(float, NUMBER.findall(b)))
    return all(abs(x - y) <= 0.02 * max(abs(x), abs(y)) for x, y in pairs)


found = list(told())
if "--write" in sys.argv:
    golden.write_text("\n".join(found) + "\n")
    sys.exit()
said = golden.read_text().splitlines()
faults = [f"expected: {a}\nfound:    {b}" for a, b in zip(said, found) if not alike(a, b)]
if len(said) != len(found):
    faults.append(f"expected {len(said)} lines, found {len(found)}")
print("\n".join(faults) or f"{len(found)} lines")
sys.exit(bool(faults))
