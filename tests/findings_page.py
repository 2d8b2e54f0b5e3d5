"""docs/findings.md has the table that `dea findings` prints, no more and no less: python3 findings_page.py DEA SOURCE."""
import pathlib
import subprocess
import sys

dea, source = sys.argv[1:]
table = subprocess.run([dea, "findings"], check=True, capture_output=True, text=True).stdout
page = (pathlib.Path(source) / "docs/findings.md").read_text()
codes = [line.split("`")[1] for line in table.splitlines()[2:]]
assert len(codes) == len(set(codes)) > 60, "a code stands twice"
if not page.endswith("\n\n" + table):
    sys.exit("docs/findings.md: its last section is not what dea findings prints; put that there")
print(len(codes), "findings")
