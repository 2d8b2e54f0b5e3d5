"""What a user writes, for mypy (test_types.py); it is not run."""
import febiodea

recognition = febiodea.recognise("hip.feb", law="layer")
result: febiodea.Result = febiodea.analyse(recognition, "last")
contact: febiodea.Contact = result["hip_contact"]
state: febiodea.State = result[-1]
p99: float = state["hip_contact"].headline.p99
mesh = result.to_meshio(state=-1)
data = result.to_xarray()
file = febiodea.read_xplt("hip.xplt")
pressure = file.states[-1].surface("acetabular_articulating").nodal("contact pressure")
study = febiodea.Study("hip.feb", {"E": "E={8|12}"}, states="last")
table = study.run("plan.db").table()
first: dict[str, object] = table[0]
