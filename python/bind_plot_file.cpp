#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "io/files/encoded_text.h"
#include "io/results/result_file.h"
#include "python/bind.h"
#include "python/plain.h"
#include "python/views.h"
#include "python/work.h"
#include "src/base/names.h"
#include "src/results/comparison.h"
#include "src/results/headline.h"
#include "src/results/percentile.h"

namespace dea::python {

namespace {

using namespace py::literals;
using File = std::shared_ptr<ResultFile>;

struct PlotStateView {
  File file;
  int state = 0;
  const XpltState& values() const { return file->xplt.states[at(state)]; }
  const XpltMesh& mesh() const { return mesh_of(*file, state); }
};

/// One variable on one region.
struct FieldView {
  PlotStateView in;
  std::size_t variable = 0, region = 0;
  const XpltVariable& what() const { return in.file->xplt.variables[variable]; }
  const XpltRegion& where() const { return in.values().variables[variable][region]; }
};

struct PlotSurfaceView {
  PlotStateView in;
  int index = 0;
  std::shared_ptr<const ResultSurface> surface;
  const XpltFacets& facets() const { return in.mesh().surfaces[at(index)]; }
};

File read_plot(const std::string& path, bool partial) {
  return result_of([path, partial](Work&) {
    const auto file = std::make_shared<ResultFile>(read_result(path, std::filesystem::path(path).stem().string()));
    if (file->xplt.truncated && !partial)
      throw InputError(
          Fault{.place = path,
                .found = fmt::format("found a plot file that is cut off after {} complete state{},",
                                     file->xplt.states.size(), file->xplt.states.size() == 1 ? "" : "s"),
                .expected = "expected a whole one; read_xplt(path, partial=True) reads the complete states"});
    return file;
  });
}

const char* word_of_group(XpltGroup group) { return word_of(group, {"global", "nodal", "domain", "surface", "edge"}); }
const char* word_of_type(XpltType type) {
  return word_of(type, {"float", "vec3", "mat3s", "mat3d", "tens4s", "mat3", "array", "array_vec3"});
}
const char* word_of_format(XpltFormat format) { return word_of(format, {"node", "item", "mult", "region"}); }

/// FEBio gives domains of rigid bodies no name, but that of their part.
std::string domain_name(const XpltMesh& mesh, const XpltDomain& domain) {
  const std::size_t part = static_cast<std::size_t>(domain.part);
  return domain.name.empty() && part >= 1 && part <= mesh.parts.size() ? mesh.parts[part - 1] : domain.name;
}

std::string region_name(const FieldView& f) {
  const std::size_t region = at(f.where().region);
  const XpltMesh& mesh = f.in.mesh();
  if (region == 0) return "";
  const auto named = [&](const auto& list) { return region <= list.size() ? list[region - 1].name : std::string(); };
  switch (f.what().group) {
    case XpltGroup::Domain:
      return region <= mesh.domains.size() ? domain_name(mesh, mesh.domains[region - 1]) : "";
    case XpltGroup::Surface:
      return named(mesh.surfaces);
    case XpltGroup::Edge:
      return named(mesh.edges);
    default:
      return "";
  }
}

py::array in_rows(const std::vector<float>& values, std::size_t each, const File& file) {
  return view_of(py::dtype::of<float>(), values.size() / each, each, values.data(), file);
}

py::array values_of(const FieldView& f) {
  const std::size_t each = at(floats_per_value(f.what()));
  return each <= 1 ? view_of(f.where().values, f.in.file) : in_rows(f.where().values, each, f.in.file);
}

/// Of one region of a group; region 0: of all regions of all groups.
py::list fields_of(const PlotStateView& s, XpltGroup group, int region) {
  py::list all;
  for (std::size_t v = 0; v < s.values().variables.size(); ++v) {
    if (region != 0 && s.file->xplt.variables[v].group != group) continue;
    for (std::size_t r = 0; r < s.values().variables[v].size(); ++r)
      if (region == 0 || s.values().variables[v][r].region == region) all.append(FieldView{s, v, r});
  }
  return all;
}

PlotSurfaceView surface_of(const PlotStateView& s, const std::string& name) {
  const int index = static_cast<int>(find_name("surface", name, names_of(s.mesh().surfaces)));
  return {s, index,
          unlocked([&] { return std::make_shared<const ResultSurface>(result_surface(*s.file, s.state, index)); })};
}

/// Fields of a group that have values in this state, of one region (0: of any), and are of the kind that is asked for.
template <class Kind>
std::vector<std::string> fields_there(const PlotStateView& s, XpltGroup group, int region, const Kind& is_of_kind) {
  std::vector<std::string> names;
  for (std::size_t v = 0; v < s.values().variables.size(); ++v) {
    const XpltVariable& variable = s.file->xplt.variables[v];
    const auto& regions = s.values().variables[v];
    if (variable.group == group && is_of_kind(variable) &&
        std::any_of(regions.begin(), regions.end(),
                    [&](const XpltRegion& r) { return region == 0 || r.region == region; }))
      names.push_back(utf8(variable.name));
  }
  return names;
}

std::vector<double> facet_field(const PlotSurfaceView& v, const std::string& field) {
  const auto scalar_per_facet = [](const XpltVariable& variable) {
    return variable.type == XpltType::Float && variable.format != XpltFormat::Region;
  };
  find_name("field", field, fields_there(v.in, XpltGroup::Surface, v.index + 1, scalar_per_facet));
  return facet_values(*v.in.file, v.in.state, v.index, field, true);
}

VtkCells cells_of_mesh(const XpltMesh& mesh) {
  VtkCells cells;
  for (const XpltDomain& domain : mesh.domains) append_cells(cells, domain.element_type, domain.nodes);
  return cells;
}

VtkCells cells_of_surface(const XpltFacets& facets) {
  VtkCells cells;
  append_facets(cells, facets.begin, facets.nodes);
  return cells;
}

py::dict distribution_dict(const Distribution& d) {
  return py::dict("area"_a = d.area, "peak"_a = d.peak, "p99"_a = d.p99, "mean"_a = d.mean, "p5"_a = d.p5,
                  "p25"_a = d.p25, "median"_a = d.median, "p75"_a = d.p75, "p95"_a = d.p95,
                  "p99_unweighted"_a = d.p99_unweighted);
}

void bind_field(py::module_& m) {
  Class<FieldView>(m, "PlotField", "One variable on one region in one state.")
      .value("name", "\"contact pressure\"", [](const FieldView& f) { return f.what().name; })
      .value("group", "\"global\", \"nodal\", \"domain\", \"surface\" or \"edge\".",
             [](const FieldView& f) { return word_of_group(f.what().group); })
      .value("type", "\"float\", \"vec3\", \"mat3s\", ...",
             [](const FieldView& f) { return word_of_type(f.what().type); })
      .value("format",
             "What has a value: \"node\" of the region, \"item\" (element, facet), \"mult\" (each node of each\n"
             "item), \"region\".",
             [](const FieldView& f) { return word_of_format(f.what().format); })
      .value("units", "FEBio's code of its dimension, \"P\", \"L\"; \"\": none is given.",
             [](const FieldView& f) { return f.what().units; })
      .value("region", "Name of the region; \"\": all nodes, or none.", &region_name)
      .value("values", "(values,) or (values, components), single precision as in the file.", &values_of)
      .def("__repr__", [](const FieldView& f) {
        return text(fmt::format("<febiodea.PlotField {} ({}) on {}: {} numbers>", f.what().name,
                                word_of_type(f.what().type), region_name(f).empty() ? "all" : region_name(f),
                                f.where().values.size()));
      });
}

void add_surface_values(Class<PlotSurfaceView>& surface) {
  surface
      .value("facet_areas", "(facets,)",
             [](const PlotSurfaceView& v) { return view_of(v.surface->facet_areas, v.surface); })
      .value("nodal_areas", "(vertices,) equal shares of the facets around each.",
             [](const PlotSurfaceView& v) { return kept(nodal_areas(*v.surface)); })
      .value("fields", "All that the file has on it, as it is there.",
             [](const PlotSurfaceView& v) { return fields_of(v.in, XpltGroup::Surface, v.index + 1); })
      .def(
          "facet", [](const PlotSurfaceView& v, const std::string& field) { return kept(facet_field(v, field)); },
          py::arg("field"), "(facets,) a scalar field: the mean of values per node; NaN: not finite in the file.")
      .def(
          "nodal",
          [](const PlotSurfaceView& v, const std::string& field) {
            return kept(unlocked([&] { return nodal_average(*v.surface, facet_field(v, field)); }));
          },
          py::arg("field"),
          "(vertices,) a scalar field: the area-weighted mean of the facets around each of `points`.");
}

void need_same_size(std::size_t expected, std::size_t found, const char* place, const char* each) {
  if (expected != found)
    throw UsageError(Fault{.place = place,
                           .found = fmt::format("found {} values,", found),
                           .expected = fmt::format("expected {}, one per {}", expected, each)});
}

auto measured(const PlotSurfaceView& v, const std::string& field) {
  return unlocked([&] { return measure(*v.surface, {facet_field(v, field), {}}, {0.0}); });
}

void add_surface_numbers(Class<PlotSurfaceView>& surface) {
  surface
      .def(
          "headline",
          [](const PlotSurfaceView& v, const std::string& field) {
            return headline_tuple(unlocked([&] { return headline(*v.surface, facet_field(v, field)); }));
          },
          py::arg("field") = "contact pressure", "p99, mean, area, peak as every command prints them.")
      .def(
          "distribution",
          [](const PlotSurfaceView& v, const std::string& field, double above, bool nodal) {
            return distribution_dict(unlocked([&] {
              const std::vector<double> values = facet_field(v, field);
              return nodal ? distribution(nodal_average(*v.surface, values), nodal_areas(*v.surface), above)
                           : distribution(values, v.surface->facet_areas, above);
            }));
          },
          py::arg("field") = "contact pressure", py::arg("above") = 0.0, py::arg("nodal") = true,
          "How the values above a threshold are distributed, as `dea compare --details` has it: of nodal averages or "
          "facets.")
      .def(
          "resultant",
          [](const PlotSurfaceView& v, const std::string& field) { return vector3(measured(v, field).resultant); },
          py::arg("field") = "contact pressure", "(3,) sum of value, area and normal over the facets.")
      .def(
          "center_of_pressure",
          [](const PlotSurfaceView& v, const std::string& field) {
            return vector3(measured(v, field).center_of_pressure);
          },
          py::arg("field") = "contact pressure", "(3,) reference; NaN: no pressure.")
      .def(
          "carry_from",
          [](const PlotSurfaceView& v, const PlotSurfaceView& other, const py::object& values) {
            const std::vector<double> numbers = numbers_of(values, "values");
            need_same_size(other.surface->mesh.vertices.size(), numbers.size(), "values", "point of the other surface");
            return kept(unlocked(
                [&] { return carry_values(match_nodes(*v.surface, *other.surface), *other.surface, numbers); }));
          },
          py::arg("other"), py::arg("values"),
          "(vertices,) nodal values of another surface at this one's `points`; NaN: it does not cover them.")
      .def("__repr__", [](const PlotSurfaceView& v) {
        return text(fmt::format("<febiodea.PlotSurface {}: {} facets>", v.surface->name, v.surface->facets()));
      });
}

void bind_plot_surface(py::module_& m) {
  Class<PlotSurfaceView> surface(m, "PlotSurface",
                                 "A surface in one state. Areas and places are those of the reference configuration.");
  surface.value("name", "Its name.", [](const PlotSurfaceView& v) { return v.surface->name; })
      .value("facets", "(facets, most nodes) rows of PlotState.points, filled up with -1.",
             [](const PlotSurfaceView& v) { return padded(v.facets().begin, v.facets().nodes); })
      .value("cells", "Its facets as pyvista takes them, on PlotState.points.",
             [](const PlotSurfaceView& v) { return kept(cells_of_surface(v.facets()).cells); })
      .value("cell_types", "(facets,) VTK's number of each facet's type.",
             [](const PlotSurfaceView& v) { return kept(cells_of_surface(v.facets()).types); })
      .value("points", "(vertices, 3) of the surface alone, reference.",
             [](const PlotSurfaceView& v) { return view_of(v.surface->mesh.vertices, v.surface); })
      .value("triangles", "(triangles, 3) the surface as triangles of `points`.",
             [](const PlotSurfaceView& v) { return view_of(v.surface->mesh.triangles, v.surface); });
  add_surface_values(surface);
  add_surface_numbers(surface);
}

void bind_plot_state(py::module_& m) {
  Class<PlotStateView>(m, "PlotState", "One state of a plot file.")
      .value("time", "As the file has it, in single precision.", [](const PlotStateView& s) { return s.values().time; })
      .value("points", "(nodes, 3) reference positions.",
             [](const PlotStateView& s) { return in_rows(s.mesh().coordinates, 3, s.file); })
      .value("node_ids", "(nodes,) their numbers.",
             [](const PlotStateView& s) { return view_of(s.mesh().node_ids, s.file); })
      .value("cells", "All elements as pyvista takes them: number of nodes, nodes in VTK's order.",
             [](const PlotStateView& s) { return kept(cells_of_mesh(s.mesh()).cells); })
      .value("cell_types", "(elements,) VTK's number of each element's type.",
             [](const PlotStateView& s) { return kept(cells_of_mesh(s.mesh()).types); })
      .value("domains", "Their names, in the order of `cells`; of one without a name that of its part.",
             [](const PlotStateView& s) {
               const std::vector<XpltDomain>& domains = s.mesh().domains;
               return list_of(domains.size(), [&](std::size_t d) { return text(domain_name(s.mesh(), domains[d])); });
             })
      .value("domain_sizes", "How many elements each has.",
             [](const PlotStateView& s) {
               const std::vector<XpltDomain>& domains = s.mesh().domains;
               return list_of(domains.size(), [&](std::size_t d) { return py::int_(domains[d].element_ids.size()); });
             })
      .value("surfaces", "Names of the surfaces.", [](const PlotStateView& s) { return names_of(s.mesh().surfaces); })
      .value("node_sets", "By their names the rows of `points`.",
             [](const PlotStateView& s) {
               py::dict all;
               for (const XpltSet& set : s.mesh().node_sets) all[text(set.name)] = view_of(set.items, s.file);
               return all;
             })
      .value("fields", "Every field of the state.",
             [](const PlotStateView& s) { return fields_of(s, XpltGroup::Global, 0); })
      .def("surface", &surface_of, py::arg("name"), "The surface of this name.")
      .def(
          "nodal",
          [](const PlotStateView& s, const std::string& field) {
            find_name("field", field, fields_there(s, XpltGroup::Nodal, 0, [](const XpltVariable&) { return true; }));
            return values_of(FieldView{s, at(find_variable(s.file->xplt, XpltGroup::Nodal, field)), 0});
          },
          py::arg("field"), "(nodes,) or (nodes, components) a nodal field such as \"displacement\".")
      .def("__repr__",
           [](const PlotStateView& s) { return fmt::format("<febiodea.PlotState at time {}>", s.values().time); });
}

py::list plot_states(const File& file) {
  return list_of(file->xplt.states.size(), [&](std::size_t s) { return PlotStateView{file, static_cast<int>(s)}; });
}

void bind_file(py::module_& m) {
  Class<ResultFile, File>(m, "PlotFile", "A plot file of FEBio, of dea or of another program.\n\nMade by read_xplt.")
      .value("path", "As it was named.", [](const ResultFile& f) { return f.path; })
      .value("software", "What wrote it.", [](const ResultFile& f) { return f.xplt.software; })
      .value("units", "Its system of units; \"\": it names none.", [](const ResultFile& f) { return f.xplt.units; })
      .value("compressed", "It is compressed.", [](const ResultFile& f) { return f.xplt.compressed; })
      .value("truncated", "It was cut off; its last state was left out (read with partial=True).",
             [](const ResultFile& f) { return f.xplt.truncated; })
      .value("states", "Its states in order.", &plot_states)
      .def(
          "state",
          [](const File& f, double time) {
            return PlotStateView{f, find_state(*f, time)};
          },
          py::arg("time"), "The state at this time.")
      .def("__repr__", [](const ResultFile& f) {
        return text(fmt::format("<febiodea.PlotFile {}: {} states>", f.path, f.xplt.states.size()));
      });
}

/// Numbers of Python, each finite and, where `least` says so, not below it.
std::vector<double> finite_numbers(const py::object& given, const char* place, double least) {
  const std::vector<double> numbers = numbers_of(given, place);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i]) || numbers[i] < least)
      throw UsageError(Fault{.place = fmt::format("{}[{}]", place, i),
                             .found = fmt::format("found {},", numbers[i]),
                             .expected = std::isfinite(least) ? fmt::format("expected a finite number >= {}", least)
                                                              : std::string("expected a finite number")});
  return numbers;
}

py::dict distribution_of(const py::object& values, const py::object& areas, double above) {
  const std::vector<double> all = numbers_of(values, "values"), shares = finite_numbers(areas, "areas", 0);
  need_same_size(all.size(), shares.size(), "areas", "value");
  return distribution_dict(unlocked([&] { return distribution(all, shares, above); }));
}

double percentile_of(const py::object& values, const py::object& weights, double fraction) {
  const std::vector<double> all = finite_numbers(values, "values", -std::numeric_limits<double>::infinity()),
                            shares = finite_numbers(weights, "weights", 0);
  need_same_size(all.size(), shares.size(), "weights", "value");
  if (!(fraction >= 0 && fraction <= 1))
    throw UsageError(Fault{
        .place = "fraction", .found = fmt::format("found {},", fraction), .expected = "expected a number from 0 to 1"});
  std::vector<double> counted, their_weights;  // a value without a weight is none
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!(shares[i] > 0)) continue;
    counted.push_back(all[i]);
    their_weights.push_back(shares[i]);
  }
  return unlocked([&] { return weighted_percentile(counted, their_weights, fraction); });
}

py::dict pattern_difference_of(const py::object& a, const py::object& b, const py::object& areas, double above) {
  std::vector<double> ours = numbers_of(a, "a");
  const std::vector<double> theirs = numbers_of(b, "b"), shares = finite_numbers(areas, "areas", 0);
  need_same_size(ours.size(), theirs.size(), "b", "value of a");
  need_same_size(ours.size(), shares.size(), "areas", "value");
  for (std::size_t i = 0; i < ours.size(); ++i)
    if (std::isnan(theirs[i])) ours[i] = kNaN;
  const PatternDifference d = unlocked([&] { return pattern_difference(ours, theirs, shares, {above}); });
  return py::dict("correlation"_a = d.correlation, "rms"_a = d.rms, "mean"_a = d.mean, "largest"_a = d.largest,
                  "dice"_a = d.dice.front());
}

void bind_numbers(py::module_& m) {
  m.def(
      "distribution", &distribution_of, py::arg("values"), py::arg("areas"), py::arg("above") = 0.0,
      "How values above a threshold are distributed, weighted by areas: a dictionary with area, peak, p99, mean, p5,\n"
      "... NaN among the values: left out. Raises UsageError.");
  m.def("percentile", &percentile_of, py::arg("values"), py::arg("weights"), py::arg("fraction"),
        "Percentile of weighted values; fraction 0 to 1. NaN: no value has a weight. Raises UsageError.");
  m.def("pattern_difference", &pattern_difference_of, py::arg("a"), py::arg("b"), py::arg("areas"),
        py::arg("above") = 0.0,
        "How the pattern a differs from b, over nodes where either is above 0: correlation, rms, mean, largest, and "
        "dice\n"
        "of what lies above the threshold. NaN in a or b: left out. Raises UsageError.");
}

}  // namespace

void bind_plot_file(py::module_& m) {
  bind_field(m);
  bind_plot_surface(m);
  bind_plot_state(m);
  bind_file(m);
  bind_numbers(m);
  m.def("read_xplt", &read_plot);
}

}  // namespace dea::python
