"""samples/workflows as its page says: python3 workflow.py DEA SOURCE SNAKEMAKE. Exit code 77 (skipped) where SNAKEMAKE is no program.

The command of the page, in a copy of the samples: its table is that of one dea study without shards; what is there is not made again,
a shard that is missing is, and what dea has solved is not solved again. A case without a solution is a row."""
import csv
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

dea, source = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
snakemake = shutil.which(sys.argv[3])
if snakemake is None:
    print("skipped: found no snakemake")
    sys.exit(77)
page = (source / "samples/workflows/README.md").read_text()
commands = [shlex.split(line) for line in page.splitlines() if line.startswith("    ")]
assert [words[0] for words in commands] == ["snakemake"], f"found the commands {commands}, expected one of snakemake"


def table(path):
    """The rows, without the seconds that a case took."""
    with open(path) as file:
        return [{key: value for key, value in row.items() if key != "seconds"} for row in csv.DictReader(file)]


with tempfile.TemporaryDirectory(prefix="dea_workflow_") as temporary:
    top = pathlib.Path(temporary)
    for name in ("hip/hip_walking.feb", "workflows/Snakefile"):
        (top / "samples" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source / "samples" / name, top / "samples" / name)
    (top / "build/release/app").mkdir(parents=True)
    (top / "build/release/app/dea").symlink_to(dea)
    made = top / "hip_study"
    environment = {**os.environ, "PWD": str(top), "HOME": str(top), "XDG_CACHE_HOME": str(top / "cache")}

    def run(words):
        done = subprocess.run(words, cwd=top, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert done.returncode == 0, f"{shlex.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}"
        return done.stdout

    def workflow():
        """What it said, and the rules that it ran."""
        said = run([snakemake, *(word.replace("$PWD", str(top)) for word in commands[0][1:])])
        return said, sorted(set(re.findall(r"^rule (\w+):", said, re.M)))

    said, rules = workflow()
    assert rules == ["merge", "page", "shard", "table"], said
    files = {path.name for path in made.iterdir() if path.is_file()}
    assert files == set(re.findall(r"`([\w.-]+\.(?:db|csv|html))`", page)) | {"plan.2-of-4.db", "plan.3-of-4.db"}, f"found {sorted(files)}"
    assert "</html>" in (made / "study.html").read_text()

    # One study without shards
    snakefile = top / "samples/workflows/Snakefile"
    cases = re.search(r"^CASES = '(.*)'$", snakefile.read_text(), re.M)[1]
    model = str(top / "samples/hip/hip_walking.feb")
    run([dea, "study", model, *shlex.split(cases), "-o", "whole.db", "--csv", "whole.csv"])
    whole = table(top / "whole.csv")
    assert len(whole) == 8 and all(row["case_outcome"] == "solved" for row in whole), whole
    assert table(made / "results.csv") == whole

    # Nothing twice; of a shard that was solved and not moved no case is solved again
    said, rules = workflow()
    assert rules == [], said
    for name in ("plan.2-of-4.db", "all.db", "results.csv", "study.html"):
        (made / name).unlink()
    shutil.move(made / "plan.3-of-4.db", made / "unfinished/plan.3-of-4.db")
    said, rules = workflow()
    assert rules == ["merge", "page", "shard", "table"] and len(re.findall("^rule shard:", said, re.M)) == 2, said
    assert "plan.3-of-4.db: all 2 cases are there already" in said, said
    assert table(made / "results.csv") == whole

    # Other cases: a socket that looks away has no solution
    text = snakefile.read_text()
    assert text.count("{-10:5:5}") == 1
    snakefile.write_text(text.replace("{-10:5:5}", "{0|80}"))
    said, rules = workflow()
    assert len(re.findall("^rule shard:", said, re.M)) == 4, said
    outcomes = [(row["tilt"], row["case_outcome"]) for row in table(made / "results.csv")]
    assert outcomes == 2 * [("0", "solved"), ("80", "failed")], outcomes

print("the workflow's table is that of one study")
