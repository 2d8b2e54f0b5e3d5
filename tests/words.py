"""What dea says of a model: python3 words.py DEA SOURCE.

dea cite says what holds for this model with these options and nothing else; dea info says in which step a spring acts; words
of Control that FEBio does not know are told or refused."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

dea, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
samples = source / "samples"
HIP, HIP_FEBIO = samples / "hip/hip_walking.feb", samples / "hip/hip_walking_febio.xplt"
faults = []


def run(*words, code=0):
    done = subprocess.run([dea, *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != code:
        faults.append(f"dea {' '.join(map(str, words))}: exit code {done.returncode}, expected {code}: {done.stderr}")
    return done.stderr if code else done.stdout


def check(text, there=(), not_there=(), of=""):
    for word in there:
        if word not in text:
            faults.append(f"{of}: found no \"{word}\" in\n{text}")
    for word in not_there:
        if word in text:
            faults.append(f"{of}: found \"{word}\" in\n{text}")


with tempfile.TemporaryDirectory() as temporary:
    folder = pathlib.Path(temporary)
    version = re.match(r"FEBioDEA (\S+) \(commit (\S+)\)", run("--version")).groups()

    # CITATION.cff is of this version, and names the papers that dea cite names
    citation = (source / "CITATION.cff").read_text()
    check(citation, [f"version: {version[0]}\n"], of="CITATION.cff")
    check((source / "CHANGELOG.md").read_text(), [f"\n## {version[0]}\n"], of="CHANGELOG.md")
    two = ".".join(version[0].split(".")[:2])
    for page in sorted([source / "README.md", *source.glob("docs/**/*.md"), source / "packaging/debian.cmake",
                        source / "plugin/febio_log.h"]):
        text = page.read_text()
        for found, expected in [(r"dea (\d+\.\d+\.\d+), SDK", version[0]), (r"febio_dea\S+ \(version ([\d.]+)\)", version[0]),
                                (r"with FEBioDEA (\d+\.\d+\.\d+)", version[0]),
                                (r"libfebiodea(\d+\.\d+)", two), (r"libfebiodea\.so\.(\d+\.\d+)", two)]:
            for named in re.findall(found, text):
                if named != expected:
                    faults.append(f"{page.name}: names version {named}, expected {expected}")
    cited = run("cite", HIP, "--compared", HIP_FEBIO)
    check(cited, re.findall(r"doi: (\S+)", citation), of="dea cite, papers of CITATION.cff")

    # BibTeX has an entry for each reference of the paragraph, with what CITATION.cff says of it
    bibtex = run("cite", HIP, "--bibtex")
    check(bibtex, [f"doi     = {{{doi}}}" for doi in re.findall(r"doi: (\S+)", citation)] + [f"version = {{{version[0]}}}"]
          + [f"{family}, {given}" for family, given in re.findall(r"family-names: (\S+)\n *given-names: (.+)", citation)], of="dea cite --bibtex")
    titles = re.findall(r"title: (.+)", citation)
    if not all(title.strip('"') in bibtex.replace("{", "").replace("}", "") for title in titles):
        faults.append(f"dea cite --bibtex: not the titles of CITATION.cff, {titles}:\n{bibtex}")
    entries = re.findall(r"^@\w+\{(\w+),\n(?:  \w+ += \{.+\},?\n)+\}\n", bibtex, re.MULTILINE)
    references = run("cite", HIP).split("\nReferences\n")[1].count("\n* ")
    if len(entries) != references or bibtex.count("@") != references or bibtex.count("{") != bibtex.count("}"):
        faults.append(f"dea cite --bibtex: entries {entries}, expected {references}, one for each reference:\n{bibtex}")

    # The paragraph says what dea info recognises
    plain = run("cite", HIP)
    info = json.loads(run("info", HIP, "--json", "-"))
    contact = info["contacts"][0]
    layers = [contact["primary"], contact["secondary"]]
    check(plain, [f"FEBioDEA {version[0]} (commit {version[1]})", "hip_walking.feb (Maas et al., 2012; format 4.0, 11220 nodes", '"femur" and "pelvis" were rigid',
                  f"{contact['springs']} springs stood on the articular surface of \"acetabular_articulating\"",
                  "law layer", "two terms", "smooth surfaces", "frictionless", "23 states (time 0 to 2)", "force (432, -262, 1834)",
                  "10.1016/j.jbiomech.2013.01.012", "at 157 of 2809 vertices", "small-strain constants of the model's materials",
                  "All settings were inferred", "* Maas SA, Ellis"],
          ["confined modulus", "Blankevoort", "series", "ligament", "Settings given", "inside the cartilage", "skip", "nan"], "dea cite")
    for layer in layers:
        check(plain, [f"{layer['thickness_mean']:.4g} thick (mean; {layer['thickness_min']:.4g} to {layer['thickness_max']:.4g})"
                      if "thickness_mean" in layer else "thick (mean;", f"E = {layer['E']:g}, nu = {layer['nu']:g}"], of="dea cite, layers")

    # Each option changes its own sentence, and no other
    linear = run("cite", HIP, "--law", "linear", "--E", "8", "--refine", "2", "--facets", "flat", "--interface-stiffness", "50", "--skip-steps")
    check(linear, ["Each spring acted for itself, its pressure being M e", "E = 8,", "divided into 2 x 2", "facets as they are", "of 50 between the surfaces",
                   "without walking through", "the two layers were in series", "those given", "Settings given: law linear, ", "E 8", "refine 2", "facets flat",
                   "skip-steps true"],
          ["law layer", "Johnson", "smooth surfaces", "small-strain constants of the model's materials.\n", "All settings"], "dea cite --law linear")
    check(run("cite", HIP, "--law", "logarithmic"), ["-M ln(1-e)", "Blankevoort L"], ["M e with", "Johnson"], "dea cite --law logarithmic")
    check(run("cite", HIP, "--law", "neo-Hookean"), ["neo-Hookean column"], ["M e with", "Johnson", "Blankevoort"], "dea cite --law neo-Hookean")
    check(run("cite", HIP, "--springs-at", "bone"), ["on the bone surface", "M e with"], ["articular surface of", "law layer"], "dea cite --springs-at bone")
    check(run("cite", HIP, "--inside"), ["inside the cartilage"], of="dea cite --inside")
    check(run("cite", HIP, "--layer-terms", "1"), ["one term"], ["two terms"], "dea cite --layer-terms 1")
    check(run("cite", HIP, "--thickness", "2", "--thickness-scale", "0.5"), ["1 thick", "given, times 0.5"], ["measured in the mesh"], "dea cite --thickness")
    check(run("cite", HIP, "--units", "mm-N-s"), ["E = 11.85 MPa", "mm thick"], of="dea cite --units")
    (folder / "s.xml").write_text('<febiodea_settings version="1"><law>linear</law></febiodea_settings>')
    check(run("cite", HIP, "--settings", folder / "s.xml"), ["Settings given: law linear;"], of="dea cite --settings")

    # Rows of tables are the states that are solved; what they replace of the model is not told as what holds
    gait = samples / "osteotomy/gait.csv"
    (folder / "path.csv").write_text("time,tx,ty,tz\n3,0,0,0.1\n4,0,0,0.2\n")
    held = '"pelvis": x held, y held, z held, Ru held, Rv held, Rw held'
    femur = '"femur": x free, y free, z free, Ru held, Rv held, Rw held'
    def in_paper(text):  # what dea info says, in words of the field
        for half in ((", ".join(f"{axis} {state}" for axis in axes), f"{word} {state}")
                     for axes, word in ((("x", "y", "z"), "translations"), (("Ru", "Rv", "Rw"), "rotations")) for state in ("held", "free")):
            text = text.replace(*half)
        return re.sub(r"\b([xyz]) prescribed", r"translation along \1 prescribed", text)

    for table, skip, conditions, states in (
            (("--loads", gait, "--load-body", "femur"), (), f"{femur}; the load of the table {gait}.", 13),
            (("--loads", gait, "--load-body", "femur"), ("--skip-steps",), f"{femur}; the load of the table {gait}.", 13),
            (("--motion", folder / "path.csv", "--motion-body", "femur"), (),
             '"femur": x prescribed by the table, y prescribed by the table, z prescribed by the table, Ru held, Rv held, Rw held; '
             f"force (432, -262, 1834); the motion of the table {folder / 'path.csv'}.", 2)):  # the model's force stays
        way = ", without walking through the model's steps." if skip else ", after the ends of the model's steps."
        check(run("cite", HIP, *table, *skip), [f"In every row of the table, {in_paper(conditions)}", f"In every row of the table, {in_paper(held)}.",
                                               f"sought in {states} states, one for each row of the table{way}"],
              (["1834"] if gait in table else []) + ["x prescribed 0", "23 states", "last step", "cycle [%] is not", "Ru"], "dea cite with a table")
        info = run("info", HIP, *table, *skip)
        check(info, [f"  in every row of the table:\n    {conditions[:-1]}\n".replace('"', "", 2), f"times of the {states} states\n",
                     "step size 0.05, not walked through; at its end:" if skip else "step size 0.05, solved at its end alone, on the way to the table's rows; there:"],
              ["20 states"], "dea info with a table")
        run("run", HIP, *table, *skip, "-q", "--json", folder / "rows.json", "-o", folder / "rows.xplt", "--overwrite")
        solved = [s["time"] for s in json.loads((folder / "rows.json").read_text())["states"]]
        told = json.loads(run("info", HIP, *table, *skip, "--json", "-"))
        if told["times"] != solved or len(solved) != states or [s["states"] for s in told["steps"]] != ([0, 0] if skip else [1, 1]):
            faults.append(f"dea info --json with a table: times {told['times']}, expected those of dea run, {solved}; steps {told['steps']}")
    check(run("cite", HIP, "--skip-steps"), ["sought in 1 state (time 2), without walking"], of="dea cite --skip-steps")
    check(run("info", HIP, "--skip-steps"), ["time of the state\n  2\n", "step size 0.5, 1 state; at its end:"], of="dea info --skip-steps")

    # Compared with FEBio: only with a result of FEBio's
    check(run("cite", HIP, "--compared", HIP_FEBIO), ["FEBio 4.11.0", "10.1115/1.4005694"], of="dea cite --compared")
    run("run", samples / "sphere_on_flat/sphere_on_flat.feb", "--states", "last", "-q", "-o", folder / "ours.xplt")
    check(run("cite", HIP, "--compared", folder / "ours.xplt", code=3), ["written by FEBioDEA", "expected a result of FEBio"], of="dea cite --compared")

    # What joins bodies
    knee = run("cite", samples / "knee/knee.feb")
    check(knee, ["11 springs or ligaments joined bodies", '"femur", "tibia" and "patella" were rigid'], ["cable", "ideal joint"], "dea cite knee.feb")
    check(run("cite", samples / "sphere_on_flat/sphere_on_flat.feb"), ["was rigid, without cartilage"], ["in series", "springs or ligaments"], "dea cite sphere_on_flat.feb")

    # A converted model states its law and cartilage itself
    run("convert", HIP, "--law", "linear", "-o", folder / "converted.feb")
    converted = run("cite", folder / "converted.feb")
    check(converted, ['Contact "hip_contact" was of type dea, as dea convert writes it', "Each spring acted for itself",
                      "E and nu were those stated in the contact", "All settings were stated in the model, inferred from it"], ["inferred from the model or"],
          "dea cite converted.feb")
    check(run("cite", folder / "converted.feb", "--E", "8"), ["E and nu were those given, else those stated in the contact", "Settings given: E 8; all others were stated"],
          of="dea cite converted.feb --E")

    # Cut where x is least: a plane of symmetry
    text = (samples / "sphere_on_flat/sphere_on_flat.feb").read_text()
    nodes = [(number, float(x)) for number, x in re.findall(r'<node id="(\d+)">([^,<]+),', text)]
    edge = ",".join(number for number, x in nodes if x == min(x for _, x in nodes))
    (folder / "cut.feb").write_text(text.replace("</Mesh>", f'<NodeSet name="cut">{edge}</NodeSet></Mesh>').replace(
        "</febio_spec>", '<Boundary><bc type="zero displacement" node_set="cut"><x_dof>1</x_dof></bc></Boundary></febio_spec>'))
    check(run("cite", folder / "cut.feb"), ["walls without friction (x = ", "part that was meshed"], of="dea cite cut.feb")

    # Parts that give way are neither rigid nor layers
    menisci = run("cite", samples / "menisci/menisci.feb")
    check(menisci, ['"tibia" and "femur" were rigid', 'Part "medial_meniscus" gave way as a mesh of 108 elements and 228 nodes', "Hughes, 1980",
                    "static condensation (Guyan, 1965)", "contacts and springs alone held it", 'Its material was "lateral_meniscus"',
                    "its fibres were linear, with their modulus at a strain of 0%", "* Guyan RJ (1965)", "* Hughes TJR (1980)"],
          ["was rigid", "Bonet"], "dea cite menisci.feb")
    check(run("cite", samples / "menisci/menisci.feb", "--fibre-strain", "0.03", "--E", "medial_meniscus_top=9"),
          ["at a strain of 3%", "E and nu as given"], of="dea cite menisci.feb --fibre-strain")
    whole = run("info", samples / "menisci/menisci.feb")
    check(whole, ["medial_meniscus: a part that gives way and nothing holds, material \"medial_meniscus\"; centre ("], ["material ;"], "dea info menisci.feb")

    check(run("convert", samples / "menisci/menisci.feb", "-o", folder / "c.feb", code=3),
          ['part "medial_meniscus" gives way as its elements do, which a contact of type dea cannot; solve it with dea run, or take it as rigid'], of="dea convert menisci.feb")

    # A model that is refused has no paragraph
    (folder / "bad.feb").write_text(text.replace("<rb>sphere</rb>", "<rb>spere</rb>", 1))
    refused = run("cite", folder / "bad.feb", code=3)
    check(refused, ['did you mean "sphere"?'], of="dea cite bad.feb")

    # In which step a spring acts
    ligament = (samples / "ligament/ligament.feb").read_text()
    spring = re.search(r'<rigid_connector name="lateral ligament".*?</rigid_connector>', ligament, re.S).group(0)
    check(run("info", samples / "ligament/ligament.feb"), ["springs between bodies"], ["only in step"], "dea info ligament.feb")
    step = re.search(r"<step .*?</step>", ligament, re.S).group(0)
    second = step.replace('id="1" name="load"', 'id="2" name="later"').replace("<Rigid>", "<Rigid>" + spring, 1)
    (folder / "later.feb").write_text(ligament.replace(spring, "").replace(step, step + second))
    told = run("info", folder / "later.feb")
    check(told, [", only in step 2\n"], [", only in step 1"], "dea info later.feb")
    check("".join(line for line in told.splitlines() if "only in step 2" in line), ['"lateral ligament"'], ["medial"], "dea info later.feb")
    found = {l["name"]: l["step"] for l in json.loads(run("info", folder / "later.feb", "--json", "-"))["ligaments"]}
    if found != {"medial ligament": None, "lateral ligament": 2, "tethers": None}:
        faults.append(f"dea info later.feb --json: found the steps {found}")

    # Words of Control
    def control(old, new):
        assert text.count(old) > 0, old
        (folder / "c.feb").write_text(text.replace(old, new))
        return folder / "c.feb"

    for wrong, right in (("time_step", "time_steps"), ("stepsize", "step_size"), ("timesteps", "time_steps")):
        (folder / "d.feb").write_text(text.replace(f"<{right}>", f"<{wrong}>").replace(f"</{right}>", f"</{wrong}>"))
        check(run("info", folder / "d.feb", code=3), [f"<{wrong}> in Control is none of FEBio's words: did you mean <{right}>?"], of=f"<{wrong}>")
    told = run("info", control("<time_steps>", "<max_refz>5</max_refz><time_steps>"))
    check(told, ['<max_refz> in Control, none of FEBio\'s words (did you mean "max_refs"?)'], of="<max_refz>")
    check(run("info", control("<time_steps>", "<max_refs>5</max_refs><plot_level>PLOT_MAJOR_ITRS</plot_level><time_steps>")),
          not_there=["none of FEBio's words"], of="words of FEBio's")

print("\n".join(faults) or "what dea says of a model holds")
sys.exit(bool(faults))
