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
  return result_of<ResultFile>([path, partial](Work&) {
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

py::array values_of(const FieldView& f) {
  const std::size_t each = at(floats_per_value(f.what()));
  const std::vector<float>& values = f.where().values;
  if (each <= 1) return look(values, f.in.file);
  return look(py::dtype::of<float>(), values.size() / each, each, values.data(), f.in.file);
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

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& item : list) names.push_back(utf8(item.name));
  return names;
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

py::array floats_as_points(const std::vector<float>& values, const File& file) {
  return look(py::dtype::of<float>(), values.size() / 3, 3, values.data(), file);
}

VtkCells cells_of_mesh(const XpltMesh& mesh) {
  VtkCells cells;
  for (const XpltDomain& domain : mesh.domains) append_cells(cells, domain.element_type, domain.nodes);
  return cells;
}

py::dict distribution_dict(const Distribution& d) {
  py::dict all;
  const std::pair<const char*, double> numbers[] = {
      {"area", d.area}, {"peak", d.peak},     {"p99", d.p99}, {"mean", d.mean}, {"p5", d.p5},
      {"p25", d.p25},   {"median", d.median}, {"p75", d.p75}, {"p95", d.p95},   {"p99_unweighted", d.p99_unweighted}};
  for (const auto& number : numbers) all[number.first] = number.second;
  return all;
}

void bind_field(py::module_& m) {
  py::class_<FieldView>(m, "PlotField", "One variable on one region in one state.")
      .def_property_readonly(
          "name", [](const FieldView& f) { return text(f.what().name); }, "\"contact pressure\"")
      .def_property_readonly(
          "group", [](const FieldView& f) { return word_of_group(f.what().group); },
          "\"global\", \"nodal\", \"domain\", \"surface\" or \"edge\".")
      .def_property_readonly(
          "type", [](const FieldView& f) { return word_of_type(f.what().type); }, "\"float\", \"vec3\", \"mat3s\", ...")
      .def_property_readonly(
          "format", [](const FieldView& f) { return word_of_format(f.what().format); },
          "What has a value: \"node\" of the region, \"item\" (element, facet), \"mult\" (each node of each\n"
          "item), \"region\".")
      .def_property_readonly(
          "units", [](const FieldView& f) { return text(f.what().units); },
          "FEBio's code of its dimension, \"P\", \"L\"; \"\": none is given.")
      .def_property_readonly(
          "region", [](const FieldView& f) { return text(region_name(f)); },
          "Name of the region; \"\": all nodes, or none.")
      .def_property_readonly("values", &values_of,
                             "(values,) or (values, components), single precision as in the file.")
      .def("__repr__", [](const FieldView& f) {
        return text(fmt::format("<febiodea.PlotField {} ({}) on {}: {} numbers>", f.what().name,
                                word_of_type(f.what().type), region_name(f).empty() ? "all" : region_name(f),
                                f.where().values.size()));
      });
}

void add_surface_values(py::class_<PlotSurfaceView>& surface) {
  surface
      .def_property_readonly(
          "facet_areas", [](const PlotSurfaceView& v) { return look(v.surface->facet_areas, v.surface); }, "(facets,)")
      .def_property_readonly(
          "nodal_areas", [](const PlotSurfaceView& v) { return kept(nodal_areas(*v.surface)); },
          "(vertices,) equal shares of the facets around each.")
      .def_property_readonly(
          "fields", [](const PlotSurfaceView& v) { return fields_of(v.in, XpltGroup::Surface, v.index + 1); },
          "All that the file has on it, as it is there.")
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

void add_surface_numbers(py::class_<PlotSurfaceView>& surface) {
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
  py::class_<PlotSurfaceView> surface(
      m, "PlotSurface", "A surface in one state. Areas and places are those of the reference configuration.");
  surface
      .def_property_readonly(
          "name", [](const PlotSurfaceView& v) { return text(v.surface->name); }, "Its name.")
      .def_property_readonly(
          "facets", [](const PlotSurfaceView& v) { return padded(v.facets().begin, v.facets().nodes); },
          "(facets, most nodes) rows of PlotState.points, filled up with -1.")
      .def_property_readonly(
          "cells",
          [](const PlotSurfaceView& v) {
            VtkCells cells;
            append_facets(cells, v.facets().begin, v.facets().nodes);
            return kept(cells.cells);
          },
          "Its facets as pyvista takes them, on PlotState.points.")
      .def_property_readonly(
          "cell_types",
          [](const PlotSurfaceView& v) {
            VtkCells cells;
            append_facets(cells, v.facets().begin, v.facets().nodes);
            return kept(cells.types);
          },
          "(facets,) VTK's number of each facet's type.")
      .def_property_readonly(
          "points", [](const PlotSurfaceView& v) { return look(v.surface->mesh.vertices, v.surface); },
          "(vertices, 3) of the surface alone, reference.")
      .def_property_readonly(
          "triangles", [](const PlotSurfaceView& v) { return look(v.surface->mesh.triangles, v.surface); },
          "(triangles, 3) the surface as triangles of `points`.");
  add_surface_values(surface);
  add_surface_numbers(surface);
}

void bind_plot_state(py::module_& m) {
  py::class_<PlotStateView>(m, "PlotState", "One state of a plot file.")
      .def_property_readonly(
          "time", [](const PlotStateView& s) { return s.values().time; }, "As the file has it, in single precision.")
      .def_property_readonly(
          "points", [](const PlotStateView& s) { return floats_as_points(s.mesh().coordinates, s.file); },
          "(nodes, 3) reference positions.")
      .def_property_readonly(
          "node_ids", [](const PlotStateView& s) { return look(s.mesh().node_ids, s.file); }, "(nodes,) their numbers.")
      .def_property_readonly(
          "cells", [](const PlotStateView& s) { return kept(cells_of_mesh(s.mesh()).cells); },
          "All elements as pyvista takes them: number of nodes, nodes in VTK's order.")
      .def_property_readonly(
          "cell_types", [](const PlotStateView& s) { return kept(cells_of_mesh(s.mesh()).types); },
          "(elements,) VTK's number of each element's type.")
      .def_property_readonly(
          "domains",
          [](const PlotStateView& s) {
            py::list all;
            for (const XpltDomain& domain : s.mesh().domains) all.append(text(domain_name(s.mesh(), domain)));
            return all;
          },
          "Their names, in the order of `cells`; of one without a name that of its part.")
      .def_property_readonly(
          "surfaces", [](const PlotStateView& s) { return names_of(s.mesh().surfaces); }, "Names of the surfaces.")
      .def_property_readonly(
          "node_sets",
          [](const PlotStateView& s) {
            py::dict all;
            for (const XpltSet& set : s.mesh().node_sets) all[text(set.name)] = look(set.items, s.file);
            return all;
          },
          "By their names the rows of `points`.")
      .def_property_readonly(
          "fields", [](const PlotStateView& s) { return fields_of(s, XpltGroup::Global, 0); },
          "Every field of the state.")
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
  py::list all;
  for (int s = 0; s < static_cast<int>(file->xplt.states.size()); ++s) all.append(PlotStateView{file, s});
  return all;
}

void bind_file(py::module_& m) {
  py::class_<ResultFile, File>(m, "PlotFile",
                               "A plot file of FEBio, of dea or of another program.\n\nMade by read_xplt.")
      .def_property_readonly(
          "path", [](const ResultFile& f) { return text(f.path); }, "As it was named.")
      .def_property_readonly(
          "software", [](const ResultFile& f) { return text(f.xplt.software); }, "What wrote it.")
      .def_property_readonly(
          "units", [](const ResultFile& f) { return text(f.xplt.units); }, "Its system of units; \"\": it names none.")
      .def_property_readonly(
          "compressed", [](const ResultFile& f) { return f.xplt.compressed; }, "It is compressed.")
      .def_property_readonly(
          "truncated", [](const ResultFile& f) { return f.xplt.truncated; },
          "It was cut off; its last state was left out (read with partial=True).")
      .def_property_readonly("states", &plot_states, "Its states in order.")
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
  py::dict all;
  const std::pair<const char*, double> numbers[] = {{"correlation", d.correlation},
                                                    {"rms", d.rms},
                                                    {"mean", d.mean},
                                                    {"largest", d.largest},
                                                    {"dice", d.dice.front()}};
  for (const auto& number : numbers) all[number.first] = number.second;
  return all;
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
