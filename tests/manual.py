"""Manual pages and shell completion against --help: python3 manual.py DEA.

Each command and option that --help prints is in the manual page and in the completion of every shell, and none that it does
not print. The pages are typeset where man or mandoc is there, and the scripts are read by those shells that are there; bash's
is used as bash does."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

dea = pathlib.Path(sys.argv[1]).resolve()
faults = []


def out(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, check=True).stdout


def check(true, what):
    if not true:
        faults.append(what)


def options_of(help_text):
    """Names at the beginning of lines of --help: [["-q", "--quiet"], ...], and what is typed behind them."""
    found = {}
    for line in help_text.partition("\nExamples:")[0].splitlines():
        match = re.match(r"  (-{1,2}[\w-]+(?:,-{1,2}[\w-]+)*)(?: (\S.*?))?(?:  .*)?$", line)
        if match:
            found[tuple(match.group(1).split(","))] = (match.group(2) or "").strip()
    return found


def plain(page):
    """What troff prints of a line of a manual page."""
    return re.sub(r"\\f[BIR]", "", page).replace("\\-", "-").replace("\\e", "\\").replace("\\&", "")


def options_of_page(page):
    """The same of a manual page: what follows .TP and begins with a hyphen."""
    lines, found = plain(page).splitlines(), set()
    for tag, line in zip(lines, lines[1:]):
        if tag == ".TP" and line.startswith("-"):
            found.add(tuple(word.rstrip(",") for word in line.split() if word.startswith("-") and re.match(r"--?\w", word)))
    return found


help_text = {"": out(dea, "--help")}
commands = re.findall(r"^  ([a-z][\w-]*)  ", help_text[""].partition("Subcommands:")[2].partition("\n\n")[0], re.M)
check(len(commands) >= 9, f"found {commands} in dea --help, expected nine commands or more")
for command in commands:
    help_text[command] = out(dea, command, "--help")

# Manual pages
page = {command: out(dea, "man", *([command] if command else [])) for command in help_text}
for command, text in help_text.items():
    name = f"dea man {command}"
    options = options_of(text)
    check(len(options) >= (2 if command in ("", "man") else 3) or command in ("completion", "findings", "schema"), f"{name}: found the options {options}")
    check(options_of_page(page[command]) == set(options), f"{name}: found other options than --help has: "
          f"{sorted(options_of_page(page[command]) ^ set(options))}")
    examples = text.partition("\nExamples:\n")[2].strip()
    check(examples and examples in plain(page[command]), f"{name}: the examples of --help are missing")
    for typesetter in (["mandoc", "-Tutf8"], ["man", "--warnings", "-l", "-"]):
        if shutil.which(typesetter[0]):
            done = subprocess.run(typesetter, input=page[command], capture_output=True, text=True, env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "MANWIDTH": "200"})
            check(done.returncode == 0 and not done.stderr.strip(), f"{name}: {typesetter[0]}: {done.stderr}")
            check(done.stdout.count("\n") > 10, f"{name}: {typesetter[0]} prints nothing")
for command in commands:
    check(f"\n{command}\n" in plain(page[""]), f"dea man: no command {command}")
with tempfile.TemporaryDirectory() as folder:
    out(dea, "man", "-o", folder)
    written = {p.name: p.read_text() for p in pathlib.Path(folder).iterdir()}
    check(written == {"-".join(["dea"] + [c] * bool(c)) + ".1": text for c, text in page.items()},
          f"dea man -o: found {sorted(written)}")

# Completion: every option by name
script = {shell: out(dea, "completion", shell) for shell in ("bash", "zsh", "fish")}
for shell, text in script.items():
    if shutil.which(shell):
        done = subprocess.run([shell, "-n", "/dev/stdin"], input=text, capture_output=True, text=True)
        check(done.returncode == 0 and not done.stderr, f"dea completion {shell}: {done.stderr}")
fish = {command: set() for command in help_text}
for line in script["fish"].splitlines():
    match = re.match(r"complete -c dea -n '__dea_command (\S+)'((?: -[ls] \S+)+)", line)
    if match:
        fish["" if match.group(1) == '""' else match.group(1)] |= {
            ("--" if kind == "l" else "-") + name for kind, name in re.findall(r" -([ls]) (\S+)", match.group(2))}
zsh = {command: set() for command in help_text}
where = ""
for line in script["zsh"].splitlines():
    match = re.match(r"    ([a-z-]+)\)$", line)
    where = match.group(1) if match else where
    zsh[where] |= set(re.findall(r"^\s+'(?:\*|\([^)]*\))?(--?[\w-]+)=?\[", line))


def bash(*words):
    """What bash offers for the last word."""
    program = script["bash"] + '\nCOMP_WORDS=("$@")\nCOMP_CWORD=$(($# - 1))\n_dea\nprintf "%s\\n" "${COMPREPLY[@]}"\n'
    return set(out("bash", "-c", program, "bash", "dea", *words).split())


check(bash("") >= set(commands), "bash: commands are missing")
check(bash("plu") == {"plugin-build"}, "bash: dea plu")
check({"run", "settings"} <= bash("schema", ""), "bash: dea schema")
check(bash("run", "--la") == {"--law", "--layer-terms"}, "bash: dea run --la")
check(bash("run", "--law", "") == {"linear", "logarithmic", "neo-Hookean", "layer"}, "bash: dea run --law")
check(bash("run", "--law", "=", "li") == {"linear"} == bash("run", "--law", "li"), "bash: dea run --law=li")
check(bash("run", "--law", "=") == bash("run", "--law", ""), "bash: dea run --law=")
check(bash("run", "hip") == set() == bash("run", "-o", "hip") == bash("run", "--rotate-about", "f"), "bash: files, by readline")
check(bash("man", "pl") == {"plot", "plugin-build"}, "bash: dea man pl")
check(bash("completion", "") == {"bash", "zsh", "fish", "json"}, "bash: dea completion")
for command, text in help_text.items():
    names = {name for option in options_of(text) for name in option}
    offered = bash(*([command, "-"] if command else ["-"]))
    check(offered == names, f"bash, dea {command}: {sorted(offered ^ names)}")
    check(zsh[command] == names, f"zsh, dea {command}: {sorted(zsh[command] ^ names)}")
    check(fish[command] == names, f"fish, dea {command}: {sorted(fish[command] ^ names)}")
    for option, value in options_of(text).items():  # no value is typed: the next word is something else
        if not value and command:
            check(bash(command, option[-1], "--hel") == {"--help"}, f"bash: dea {command} {option[-1]} --hel")
tree = json.loads(out(dea, "completion", "json"))
for part in (tree, *tree["commands"]):
    command = part["name"] if part is not tree else ""
    found, expected = {tuple(o["names"]) for o in part["options"]}, set(options_of(help_text[command]))
    check(found == expected, f"dea completion json, dea {command}: {sorted(found ^ expected)}")
check({c["name"] for c in tree["commands"]} == set(commands), "dea completion json: commands")
check([(o["value"], o["words"]) for c in tree["commands"] if c["name"] == "run" for o in c["options"] if o["names"] == ["--layer-terms"]] == [("1|2", ["1", "2"])],
      "dea completion json: words of --layer-terms")
if shutil.which("fish"):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "dea.fish"
        file.write_text(script["fish"])
        offered = out("fish", "-c", f"source {file}; complete -C 'dea run --law l'").split("\n")
        check({line.split("\t")[0] for line in offered if line} == {"linear", "logarithmic", "layer"}, f"fish: {offered}")

# Wrong use is one line
for words, expected in ((["man", "rnu"], 'did you mean "run"'), (["completion", "bahs"], 'did you mean "bash"'),
                        (["man", "run", "-o", "."], "expected one"), (["man", "-o", "no/such"], "No such file or directory")):
    done = subprocess.run([dea, *words], capture_output=True, text=True)
    check(done.returncode in (2, 4) and done.stderr.count("\n") == 1 and expected in done.stderr and not done.stdout,
          f"dea {' '.join(words)}: found {done}")

print("\n".join(faults) or f"{len(page)} pages, {len(script)} shells: all that --help has")
sys.exit(bool(faults))
