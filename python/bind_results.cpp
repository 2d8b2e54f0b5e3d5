#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "io/results/plot_file.h"
#include "io/vtu/write_vtu.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/plain.h"
#include "python/views.h"
#include "python/work.h"
#include "src/base/names.h"
#include "src/rules/rules.h"
#include "views/data/run_csv.h"
#include "views/data/run_json.h"
#include "views/page/write_page.h"
#include "views/text/run_text.h"

namespace dea::python {

namespace {

using namespace py::literals;
using Result_ = std::shared_ptr<Analysed>;

const JointModel& model_of(const Analysed& a) { return a.recognised->recognition.model; }

std::vector<double> times_of(const Analysed& a) {
  std::vector<double> times;
  for (const StateResult& s : a.analysis.states) times.push_back(s.when.time);
  return times;
}

void write_plot_file(const Result_& a, const std::string& path, bool compress, bool overwrite) {
  run_work([a, path, compress, overwrite](Work&) {
    const std::string why = overwrite ? "" : why_kept(path, model_of(*a), times_of(*a));
    if (!why.empty()) throw WriteError(fmt::format("{}: {}; overwrite=True replaces it", path, why));
    write_xplt(path, make_plot_file(model_of(*a), a->analysis, compress));
  });
}

void write_vtu_folder(const Result_& a, const std::string& folder) {
  run_work([a, folder](Work&) { write_vtu(folder, make_plot_file(model_of(*a), a->analysis)); });
}

void write_report(const Result_& a, const std::string& path) {
  require_page_name("report", path);
  run_work([a, path](Work&) {
    const std::string& model = model_of(*a).files.front();
    write_run_page(path, a->recognised->recognition, a->analysis, make_plot_file(model_of(*a), a->analysis), model,
                   model, {"febiodea.analyse", model}, {{"the model", model}, {"report", path}});
  });
}

Json result_json(const Analysed& a) {
  return run_json(model_of(a), a.recognised->recognition.settings, a.analysis, a.timings);
}

py::list states_of(const Result_& a) {
  return list_of(a->analysis.states.size(), [&](std::size_t s) { return view_of(a, s); });
}

void bind_result(py::module_& m) {
  Class<Analysed, Result_>(m, "Result", "All states of an analysis.\n\nMade by analyse.")
      .value("recognition", "What was analysed.",
             [](const Analysed& a) { return std::const_pointer_cast<Recognised>(a.recognised); })
      .value("states", "Its states in order of time.", &states_of)
      .value("solved", "Every state is a solution.", [](const Analysed& a) { return all_solved(a.analysis); })
      .value("findings", "What was concluded, left out or is doubtful, a line each.",
             [](const Analysed& a) { return findings_list(a.analysis.findings); })
      .def(
          "to_dict", [](const Analysed& a) { return plain(unlocked([&] { return result_json(a); })); },
          "What `dea run --json` writes, as a dictionary.")
      .def(
          "to_json", [](const Analysed& a) { return text(unlocked([&] { return json_text(result_json(a)); })); },
          "What `dea run --json` writes.")
      .def(
          "facets_csv",
          [](const Analysed& a) { return text(unlocked([&] { return facets_csv(model_of(a), a.analysis); })); },
          "What `dea run --facets-csv` writes: a line per state, contact, side and facet.")
      .def("__str__", [](const Analysed& a) { return text(printable(run_text(model_of(a), a.analysis, false))); })
      .def("__repr__",
           [](const Analysed& a) {
             return text(fmt::format("<febiodea.Result of {}: {} states{}>", model_of(a).files.front(),
                                     a.analysis.states.size(), all_solved(a.analysis) ? "" : ", not all solved"));
           })
      .def("_write_xplt", &write_plot_file)
      .def("_write_vtu", &write_vtu_folder)
      .def("_report", &write_report);
}

py::dict poses_of(const StateView& v) {
  py::dict all;
  for (const int b : reported_bodies(*v.joint))
    all[text(v.joint->bodies[at(b)].name)] =
        matrix_of(v.state->equilibrium.poses[at(b)], v.joint->bodies[at(b)].center_of_mass);
  return all;
}

py::dict reactions_of(const StateView& v) {
  py::dict all;
  for (const int b : reported_bodies(*v.joint))
    all[text(v.joint->bodies[at(b)].name)] = force_and_moment(v.state->equilibrium.reaction[at(b)]);
  return all;
}

/// A dictionary per part of deformable solid elements.
py::list inside_of(const StateView& v) {
  py::list all;
  if (v.state->inside.empty()) return all;
  for (InsideDomain& d : with_parts(v.model(), *v.joint, v.state->parts, v.state->inside)) {
    const Domain& domain = v.model().domains[at(d.domain)];
    all.append(py::dict("part"_a = text(domain.name),
                        "material"_a = text(v.model().materials[at(domain.material)].name),
                        "element"_a = view_of(domain.element_ids, v.owner), "stress"_a = kept(std::move(d.stress)),
                        "strain"_a = kept(std::move(d.strain))));
  }
  return all;
}

Json statistics_of(const StateView& v) { return state_json(v.model(), *v.joint, *v.state); }

std::vector<Vector3d> displacements_of(const PartView& v) {
  std::vector<Vector3d> moved;
  for (const int node : v.part().model_nodes) moved.push_back(v.in.state->displacements[at(node)]);
  return moved;
}

std::vector<int> element_ids_of(const PartView& v) {
  std::vector<int> ids;
  for (const PartElement& e : v.part().elements)
    ids.push_back(v.in.model().domains[at(e.domain)].element_ids[at(e.place)]);
  return ids;
}

void bind_part(py::module_& m) {
  Class<PartView>(m, "Part", "A part that gives way, such as a meniscus, in one state (docs/parts.md).")
      .value("name", "Of the part.", [](const PartView& v) { return v.part().name; })
      .value("index", "(nodes,) rows of Model.points.",
             [](const PartView& v) { return view_of(v.part().model_nodes, v.in.owner); })
      .value("displacements", "(nodes, 3) of its nodes, global.",
             [](const PartView& v) { return kept(displacements_of(v)); })
      .value("element", "(elements,) ids.", [](const PartView& v) { return kept(element_ids_of(v)); })
      .value("stress",
             "(elements, 6) mean of each element, global, xx yy zz xy yz xz; (0, 6): no contact that presses it acts.",
             [](const PartView& v) { return view_of(v.stress().stress, v.in.owner); })
      .value("strain", "(elements, 6) as `stress`, in the part's frame.",
             [](const PartView& v) { return view_of(v.stress().strain, v.in.owner); })
      .value("statistics", "All numbers of the part by their names in JSON.",
             [](const PartView& v) { return statistics_of(v.in)["parts"][v.index]; })
      .def("__repr__", [](const PartView& v) {
        return text(fmt::format("<febiodea.Part {}: {} elements>", v.part().name, v.part().mesh.elements()));
      });
}

void bind_state(py::module_& m) {
  Class<StateView>(m, "State", "One state: poses, forces, contacts.")
      .value("time", "The model's time.", [](const StateView& v) { return v.state->when.time; })
      .value("step", "Step of the model, from 1 on.", [](const StateView& v) { return v.state->when.step + 1; })
      .value("outcome", "\"Balanced\", \"Prescribed\", ... (docs/theory.md)",
             [](const StateView& v) { return name(v.state->equilibrium.outcome); })
      .value("solved", "It is a solution.", [](const StateView& v) { return solved(v.state->equilibrium.outcome); })
      .value("message", "The sentence behind the outcome.",
             [](const StateView& v) { return outcome_text(v.state->equilibrium, python_wording()); })
      .value("iterations", "Newton steps.", [](const StateView& v) { return v.state->equilibrium.iterations; })
      .value("poses", "Per body its pose, (4, 4): x = R X + t, the identity is where the file has it. Global.",
             &poses_of)
      .value("reactions", "Per body (force, moment) by what loads and holds it, about its current centre of mass.",
             &reactions_of)
      .value("displacements", "(nodes, 3) of all nodes of the model, cartilage compressed.",
             [](const StateView& v) { return view_of(v.state->displacements, v.owner); })
      .value("inside",
             "With the setting inside: per part of deformable solid elements a dictionary: \"part\", \"material\",\n"
             "\"element\" (elements,) ids, \"stress\" (elements, 6) Cauchy, global, and \"strain\" (elements, 6) "
             "Lagrange,\n"
             "xx yy zz xy yz xz at the centroids, 0 where no contact's cartilage is; []: without.",
             &inside_of)
      .value("statistics", "All numbers of the state by their names in JSON.", &statistics_of)
      .value("layers",
             "Layers that several contacts press: a dictionary each, with surfaces, contacts, body, headline and force "
             "of all of them.",
             [](const StateView& v) { return statistics_of(v)["layers"]; })
      .value("parts", "Its parts that give way, such as menisci; []: it has none.",
             [](const StateView& v) {
               return list_of(v.joint->parts.size(), [&](std::size_t k) { return PartView{v, k}; });
             })
      .def(
          "part",
          [](const StateView& v, const std::string& name) {
            return PartView{v, find_name("part", name, names_of(v.joint->parts))};
          },
          py::arg("name") = "", "The part of this name; without a name: the only one.")
      .value("contacts", "Its contacts, in the order of the model.",
             [](const StateView& v) {
               return list_of(v.joint->contacts.size(), [&](std::size_t c) { return ContactView{v, c}; });
             })
      .def(
          "contact",
          [](const StateView& v, const std::string& name) {
            return ContactView{v, find_name("contact", name, names_of(v.joint->contacts))};
          },
          py::arg("name") = "", "The contact of this name; without a name: the only one.")
      .def("__repr__", [](const StateView& v) {
        return text(
            fmt::format("<febiodea.State at time {}: {}>", v.state->when.time, name(v.state->equilibrium.outcome)));
      });
}

SideView source_side(const ContactView& v) { return {v, v.pair().source}; }
SideView target_side(const ContactView& v) { return {v, 1 - v.pair().source}; }

const std::string& body_of(const SideView& v) { return v.of.in.joint->bodies[at(v.layer().body)].name; }
const std::string& surface_name(const SideView& v) { return v.of.in.model().surfaces[at(v.layer().surface)].name; }

void bind_contact(py::module_& m) {
  Class<ContactView>(m, "Contact", "One contact in one state. Its springs stand on the source and press the target.")
      .value("name", "Of the contact.", [](const ContactView& v) { return v.pair().name; })
      .value("source", "The side with the springs.", &source_side)
      .value("target", "The other side.", &target_side)
      .value("springs", "Its springs: arrays, one entry per spring.",
             [](const ContactView& v) {
               return SpringsView{v.in.owner, &(*v.in.springs)[v.index]};
             })
      .value("facets", "Facets of the source's surface: arrays.",
             [](const ContactView& v) { return FacetsView{source_side(v)}; })
      .value("nodes", "Nodes of the source's articular surface: arrays.",
             [](const ContactView& v) { return NodesView{source_side(v)}; })
      .value("headline", "p99, mean, area, peak of the pressure above `above` (docs/theory.md, 6.1).",
             [](const ContactView& v) { return v.statistics().headline; })
      .value("compartments", "The pieces of its surface, such as a tibia's plateaus; []: it is one piece.",
             [](const ContactView& v) {
               return list_of(v.statistics().compartments.size(), [&](std::size_t i) { return CompartmentView{v, i}; });
             })
      .value("force", "(3,) on the target, global.", [](const ContactView& v) { return v.statistics().force; })
      .value("moment", "(3,) on the target, about its current centre of mass.",
             [](const ContactView& v) { return v.statistics().moment; })
      .value("center_of_pressure", "(3,) current; NaN: no pressure.",
             [](const ContactView& v) { return v.statistics().center_of_pressure; })
      .value("statistics", "All numbers of the contact by their names in JSON.",
             [](const ContactView& v) {
               return (contact_json(v.in.model(), *v.in.joint, v.pair(), v.statistics(), v.in.state->fields[v.index]));
             })
      .def("__repr__", [](const ContactView& v) {
        return text(fmt::format("<febiodea.Contact {}: p99 {:.4g}, area {:.4g}>", v.pair().name,
                                v.statistics().headline.p99, v.statistics().headline.area));
      });
}

void bind_side(py::module_& m) {
  Class<SideView>(m, "Side", "One side of a contact: a surface and the body it moves with.")
      .value("body", "Name of its body.", &body_of)
      .value("surface", "Name of its surface.", &surface_name)
      .value("facets", "Its facets: arrays.", [](const SideView& v) { return FacetsView{v}; })
      .value("nodes", "Its nodes: arrays.", [](const SideView& v) { return NodesView{v}; })
      .value("force", "(3,) of the contact on this side.", [](const SideView& v) { return v.fields().force; })
      .def("__repr__", [](const SideView& v) {
        return text(fmt::format("<febiodea.Side {} of body {}>", surface_name(v), body_of(v)));
      });
  Class<CompartmentView>(m, "Compartment", "What one piece of a contact's surface carries.")
      .value("name", "Its name.", [](const CompartmentView& v) { return compartment_names(v.of.pair())[v.index]; })
      .value("headline", "p99, mean, area, peak of its share.",
             [](const CompartmentView& v) { return v.load().headline; })
      .value("force", "(3,) on the target, global.", [](const CompartmentView& v) { return v.load().force; })
      .value("center_of_pressure", "(3,) of its springs, current; NaN: it carries nothing.",
             [](const CompartmentView& v) { return v.load().center_of_pressure; })
      .def("__repr__", [](const CompartmentView& v) {
        return text(fmt::format("<febiodea.Compartment {}: p99 {:.4g}, area {:.4g}>",
                                compartment_names(v.of.pair())[v.index], v.load().headline.p99,
                                v.load().headline.area));
      });
}

/// A column of springs: a member of SpringStates.
template <class Values>
void add_column(Class<SpringsView>& to, const char* name, Values SpringStates::*values, const char* help) {
  to.value(name, help, [values](const SpringsView& v) { return view_of(v.states->*values, v.owner); });
}

void bind_springs(py::module_& m) {
  Class<SpringsView> springs(
      m, "Springs",
      "Springs of a contact at one pose, one entry each: current configuration, global frame, the model's units.");
  add_column(springs, "pressure", &SpringStates::pressure, "(springs,) >= 0.");
  add_column(springs, "area", &SpringStates::carrying,
             "(springs,) that the pressure acts on, with what bulges out over a free edge.");
  add_column(springs, "strain", &SpringStates::strain, "(springs,) the larger of both layers' strains.");
  add_column(springs, "strain_source", &SpringStates::strain_source, "(springs,) of the source's layer.");
  add_column(springs, "strain_target", &SpringStates::strain_target, "(springs,) of the target's layer.");
  add_column(springs, "overlap", &SpringStates::overlap, "(springs,) of both surfaces, >= 0.");
  add_column(springs, "gap", &SpringStates::gap, "(springs,) > 0 apart, < 0 overlap; infinity: the ray met nothing.");
  add_column(springs, "coverage", &SpringStates::coverage,
             "(springs,) share of the foot that lies over the target, 0 to 1.");
  add_column(springs, "foot", &SpringStates::foot, "(springs, 3) where each stands.");
  add_column(springs, "direction", &SpringStates::direction, "(springs, 3) unit vector towards the target.");
  add_column(springs, "end", &SpringStates::end, "(springs, 3) where its ray meets the target.");
  add_column(springs, "thickness_source", &SpringStates::t_source, "(springs,) of the source's layer.");
  add_column(springs, "thickness_target", &SpringStates::t_target, "(springs,) of the target's layer.");
  add_column(springs, "too_deep", &SpringStates::too_deep, "(springs,) flag: deeper than both layers are thick.");
  springs.def("__len__", [](const SpringsView& v) { return v.states->size(); })
      .def("__repr__",
           [](const SpringsView& v) { return fmt::format("<febiodea.Springs: {} of them>", v.states->size()); });
}

const SurfaceMesh& mesh_of(const SideView& v) { return v.layer().articular; }

std::vector<Vector3d> facet_centers_of(const SideView& v) {
  const SurfaceMesh& mesh = mesh_of(v);
  std::vector<Vector3d> centers(at(mesh.facets), Vector3d::Zero());
  for (int t = 0; t < mesh.size(); ++t) centers[at(mesh.facet[at(t)])] += mesh.areas[at(t)] * mesh.centroid(t);
  for (std::size_t f = 0; f < centers.size(); ++f) {
    const double area = v.map().facet_area[f];
    centers[f] = area > 0 ? Vector3d(centers[f] / area) : Vector3d::Constant(kNaN);
  }
  return centers;
}

void bind_facets(py::module_& m) {
  Class<FacetsView> facets(m, "Facets", "Facets of one side's surface in one state, in the model's order.");
  for (const FacetField& field : facet_fields()) {  // a new one appears by itself
    const auto values = field.values;
    facets.value(field.column, (std::string("(facets,) ") + field.name + ".").c_str(),
                 [values](const FacetsView& v) { return view_of(v.fields().*values, v.of.in.owner); });
  }
  for (const FacetField& field : inside_facet_fields()) {
    const auto values = field.values;
    facets.value(
        field.column,
        (std::string("(facets,) ") + field.name + ", with the setting inside; None: without, or no cartilage.").c_str(),
        [values](const FacetsView& v) -> py::object {
          const std::vector<double>& of = v.fields().*values;
          if (of.empty()) return py::none();
          return view_of(of, v.of.in.owner);
        });
  }
  facets
      .value("area", "(facets,) reference; 0: left out.",
             [](const FacetsView& v) { return view_of(v.map().facet_area, v.of.in.owner); })
      .value("center", "(facets, 3) centroid, reference; NaN: left out.",
             [](const FacetsView& v) { return kept(facet_centers_of(v)); })
      .value("nodes", "(facets, most nodes) rows of Model.points, filled up with -1.",
             [](const FacetsView& v) {
               const Surface& s = v.of.in.model().surfaces[at(v.layer().surface)];
               return padded(s.begin, s.nodes);
             })
      .def("__len__", [](const FacetsView& v) { return mesh_of(v).facets; })
      .def("__repr__",
           [](const FacetsView& v) { return fmt::format("<febiodea.Facets: {} of them>", mesh_of(v).facets); });
}

std::vector<double> node_strain(const SideView& v) {
  const SideFields& f = v.fields();
  std::vector<double> strain;
  for (std::size_t i = 0; i < f.vertex_shortening.size(); ++i)
    strain.push_back(f.vertex_thickness[i] > 0 ? f.vertex_shortening[i] / f.vertex_thickness[i] : kNaN);
  return strain;
}

void bind_nodes(py::module_& m) {
  Class<NodesView>(m, "Nodes", "Nodes of one side's articular surface in one state.")
      .value("index", "(nodes,) rows of Model.points.",
             [](const NodesView& v) { return view_of(mesh_of(v).model_nodes, v.of.in.owner); })
      .value("point", "(nodes, 3) reference positions.",
             [](const NodesView& v) { return view_of(mesh_of(v).vertices, v.of.in.owner); })
      .value("triangles",
             "(triangles, 3) the surface as triangles of these nodes, seen from outside counter-clockwise.",
             [](const NodesView& v) { return view_of(mesh_of(v).triangles, v.of.in.owner); })
      .value("area",
             "(nodes,) a third of each triangle around it, reference; p99 and peak of the headline take a quarter of\n"
             "each quadrilateral (docs/theory.md, 6.1).",
             [](const NodesView& v) { return view_of(mesh_of(v).vertex_areas, v.of.in.owner); })
      .value("pressure", "(nodes,) area-weighted mean of the facets around.",
             [](const NodesView& v) { return view_of(v.fields().vertex_pressure, v.of.in.owner); })
      .value("thickness", "(nodes,) of the cartilage.",
             [](const NodesView& v) { return view_of(v.fields().vertex_thickness, v.of.in.owner); })
      .value("shortening", "(nodes,) of the cartilage, >= 0.",
             [](const NodesView& v) { return view_of(v.fields().vertex_shortening, v.of.in.owner); })
      .value("strain", "(nodes,) shortening over thickness; NaN: no cartilage.",
             [](const NodesView& v) { return kept(node_strain(v)); })
      .def("__len__", [](const NodesView& v) { return mesh_of(v).vertices.size(); })
      .def("__repr__",
           [](const NodesView& v) { return fmt::format("<febiodea.Nodes: {} of them>", mesh_of(v).vertices.size()); });
}

}  // namespace

void bind_results(py::module_& m) {
  bind_springs(m);
  bind_facets(m);
  bind_nodes(m);
  bind_side(m);
  bind_contact(m);
  bind_part(m);
  bind_state(m);
  bind_result(m);
}

}  // namespace dea::python
