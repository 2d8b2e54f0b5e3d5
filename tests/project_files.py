"""What hosts and archives read of the project: python3 project_files.py SOURCE. codemeta.json, CITATION.cff, CMakeLists.txt, LICENSE and
README.md say the same name, version, licence, authors and papers; the files for those who report and change are there, and every file that
they name is too. That the program says this version, and CHANGELOG.md: tests/words.py."""
import json
import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
faults = []


def text_of(name):
    path = source / name
    if not path.is_file():
        faults.append(f"{name} is not there")
        return ""
    return path.read_text()


def the_same(what, said):
    """One value in all files; one at least, for a pattern that finds nothing is a fault too."""
    if len(set(map(str, said.values()))) != 1 or not all(said.values()):
        faults.append(f"{what}: " + ", ".join(f"{name} says {value!r}" for name, value in said.items()))


def first(pattern, text):
    found = re.search(pattern, text, re.M)
    return found[1] if found else ""


# One name, version, licence
cmake, citation, meta = text_of("CMakeLists.txt"), text_of("CITATION.cff"), json.loads(text_of("codemeta.json") or "{}")
own = citation.partition("\nreferences:")[0]  # what is said of the program, not of papers
the_same("name", {"CMakeLists.txt": first(r"^project\((\S+)", cmake), "CITATION.cff": first(r'^title: "(\w+):', own), "codemeta.json": meta.get("name")})
the_same("version", {"CMakeLists.txt": first(r"^project\(\S+ VERSION (\S+)", cmake), "CITATION.cff": first(r"^version: (\S+)$", own),
                     "codemeta.json": meta.get("version")})
the_same("licence", {"LICENSE": first(r"\A(\S+) License$", text_of("LICENSE")), "CITATION.cff": first(r"^license: (\S+)$", own),
                     "codemeta.json": first(r"^https://spdx\.org/licenses/(\S+)$", meta.get("license", "")), "README.md": first(r"Licence: (\S+) ", text_of("README.md"))})
the_same("what it is", {"CMakeLists.txt": first(r'^ *DESCRIPTION "(.+)"\)$', cmake).lower(), "CITATION.cff": first(r'^title: "\w+: (.+)"$', own).lower(),
                        "codemeta.json": meta.get("description", "").lower()})
the_same("authors", {"CITATION.cff": re.findall(r"^  - name: (.+)$", own, re.M), "codemeta.json": [author["name"] for author in meta.get("author", [])]})
papers = [(title.strip('"'), f"https://doi.org/{doi}") for title, doi in re.findall(r"^    title: (.+)$(?:.|\n)*?^    doi: (\S+)$", citation, re.M)]
the_same("papers", {"CITATION.cff": papers, "codemeta.json": [(paper["name"], paper["@id"]) for paper in meta.get("referencePublication", [])]})

# CodeMeta 2.0: a key that its context does not have would mean nothing
KEYS = {"name", "description", "version", "license", "author", "keywords", "programmingLanguage", "operatingSystem", "readme", "buildInstructions", "releaseNotes",
        "referencePublication", "codeRepository", "issueTracker", "datePublished", "url", "identifier"}
faults += [f"codemeta.json has the key {key}: is it CodeMeta's? Then add it to KEYS of tests/project_files.py" for key in meta if key not in KEYS and key[0] != "@"]
the_same("context", {"codemeta.json": meta.get("@context"), "CodeMeta 2.0": "https://doi.org/10.5063/schema/codemeta-2.0"})
faults += [f"codemeta.json names {meta[key]}, which is not there" for key in ("readme", "buildInstructions", "releaseNotes") if not (source / meta.get(key, "?")).is_file()]

# What those files name: code of one word, but for options and the program; and names of files without any mark
names = 0
for file in ("CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "SECURITY.md", ".github/ISSUE_TEMPLATE/report.md", ".github/PULL_REQUEST_TEMPLATE.md"):
    text = text_of(file)
    named = set(re.findall(r"`([^`\s-][^`\s]*)`", text)) | set(re.findall(r"[\w./-]+\.(?:md|cff|json|txt)\b", text)) | set(re.findall(r"^    (\S+)$", text, re.M))
    for name in sorted(named - {"dea"}):
        names += 1
        if not (source / name).exists():
            faults.append(f"{file} names {name}, which is not there")
if names < 20:
    faults.append(f"found {names} names of files: they are not read as they should be")

print("\n".join(faults) or f"version {meta['version']} everywhere, {names} names of files")
sys.exit(bool(faults))
