#include "views/data/run_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "io/settings/settings_xml.h"
#include "src/base/numbers.h"
#include "src/results/contact_numbers.h"
#include "src/rules/rules.h"
#include "views/data/csv.h"

namespace dea {

namespace {

/// A column: its name, and its cell in a row.
template <class Row>
struct Column {
  std::string name;
  std::function<std::string(const Row&)> cell;
};

template <class Row>
std::string header(const std::vector<Column<Row>>& columns) {
  std::string line;
  for (const Column<Row>& c : columns) line += (line.empty() ? "" : ",") + c.name;
  return line + '\n';
}

template <class Row>
std::string line(const std::vector<Column<Row>>& columns, const Row& row) {
  std::string line = columns.front().cell(row);
  for (std::size_t c = 1; c < columns.size(); ++c) line += ',' + columns[c].cell(row);
  return line + '\n';
}

/// NAMEx, NAMEy, NAMEz.
template <class Row, class Get>
void add_vector(std::vector<Column<Row>>& columns, const std::string& name, Get get) {
  for (int k = 0; k < 3; ++k)
    columns.push_back({name + "xyz"[k], [=](const Row& row) { return csv_number(get(row)[k]); }});
}

/// A contact in a state.
struct ContactRow {
  const Joint& joint;
  const StateResult& state;
  std::size_t contact;
  const Findings* findings = nullptr;  ///< the warnings
  bool first = false;                  ///< of the table
  const ContactPair& pair() const { return joint.contacts[contact]; }
  const ContactStatistics& statistics() const { return state.statistics[contact]; }
};

/// All of them, one after the other.
std::string warnings_text(const Findings& findings) {
  std::string all;
  for (const Finding& f : findings) all += (all.empty() ? "" : "; ") + worded(f, command_line_wording());
  return all;
}

/// The codes of those that are of this contact, or of no contact by itself, each once.
std::string codes_of(const Findings& findings, const std::string& contact) {
  std::vector<std::string> codes;
  for (const Finding& f : findings)
    if ((f.subject.contact.empty() || f.subject.contact == contact) &&
        std::find(codes.begin(), codes.end(), f.code) == codes.end())
      codes.push_back(f.code);
  return fmt::format("{}", fmt::join(codes, " "));
}

bool with_inside(const Analysis& analysis) {
  return std::any_of(analysis.states.begin(), analysis.states.end(), has_inside);
}

/// `inside`: also those of the inside of layers.
std::vector<Column<ContactRow>> contact_columns(bool inside) {
  using R = const ContactRow&;
  const auto body = [](R r, const Layer& layer) { return csv_word(r.joint.bodies[at(layer.body)].name); };
  std::vector<Column<ContactRow>> columns = {
      {"time", [](R r) { return csv_number(r.state.when.time); }},
      {"contact", [](R r) { return csv_word(r.pair().name); }},
      {"outcome", [](R r) { return std::string(name(r.state.equilibrium.outcome)); }},
      {"iterations", [](R r) { return std::to_string(r.state.equilibrium.iterations); }},
      {"residual_force", [](R r) { return csv_number(r.state.equilibrium.residual_force); }},
      {"residual_moment", [](R r) { return csv_number(r.state.equilibrium.residual_moment); }},
      {"source", [=](R r) { return body(r, r.pair().source_layer()); }},
      {"target", [=](R r) { return body(r, r.pair().target_layer()); }},
  };
  for (const NamedNumber<ContactStatistics>& n : spring_numbers())
    columns.push_back({n.name, [value = n.value](R r) { return csv_number(value(r.statistics())); }});
  const auto factor = [](R r, int side) { return csv_number(r.state.fields[r.contact].sides[side].resultant_factor); };
  columns.push_back({"source_resultant_factor", [=](R r) { return factor(r, r.pair().source); }});
  columns.push_back({"target_resultant_factor", [=](R r) { return factor(r, 1 - r.pair().source); }});
  for (const NamedNumber<Headline>& n : headline_columns())
    columns.push_back({n.name, [value = n.value](R r) { return csv_number(value(r.statistics().headline)); }});
  columns.push_back({"warnings", [](R r) { return csv_word(r.first ? warnings_text(*r.findings) : ""); }});
  if (inside)
    for (const NamedNumber<ContactStatistics>& n : inside_numbers())
      columns.push_back({n.name, [value = n.value](R r) { return csv_number(value(r.statistics())); }});
  columns.push_back({"codes", [](R r) { return csv_word(codes_of(*r.findings, r.pair().name)); }});
  return columns;
}

/// A compartment of a contact in a state.
struct CompartmentRow {
  const ContactRow& contact;
  std::size_t compartment;
  const CompartmentLoad& load() const { return contact.statistics().compartments[compartment]; }
};

std::vector<Column<CompartmentRow>> compartment_columns(bool inside) {
  using R = const CompartmentRow&;
  std::vector<Column<CompartmentRow>> columns = {
      {"time", [](R r) { return csv_number(r.contact.state.when.time); }},
      {"contact", [](R r) { return csv_word(r.contact.pair().name); }},
      {"compartment", [](R r) { return csv_word(compartment_names(r.contact.pair())[r.compartment]); }},
      {"outcome", [](R r) { return std::string(name(r.contact.state.equilibrium.outcome)); }},
  };
  for (const NamedNumber<CompartmentLoad>& n : compartment_numbers())
    columns.push_back({n.name, [value = n.value](R r) { return csv_number(value(r.load())); }});
  if (!inside) return columns;
  for (const NamedNumber<CompartmentLoad>& n : compartment_inside_numbers())
    columns.push_back({n.name, [value = n.value](R r) { return csv_number(value(r.load())); }});
  return columns;
}

/// Of the facets of a surface, in the reference configuration.
struct FacetShape {
  std::vector<double> area;
  std::vector<Vector3d> centroid;
  std::vector<double> thickness;  ///< of the surface's layer, mean over the facet
};

FacetShape facet_shape(const JointModel& model, const Layer& layer, const std::vector<double>& vertex_thickness) {
  const Surface& surface = model.surfaces[at(layer.surface)];
  const std::size_t n = at(surface.size());
  FacetShape out{std::vector<double>(n, 0.0), std::vector<Vector3d>(n, Vector3d::Zero()), std::vector<double>(n, 0.0)};
  const SurfaceMesh& mesh = layer.articular;
  for (int t = 0; t < mesh.size(); ++t) {
    const std::size_t f = at(mesh.facet[at(t)]);
    const double area = mesh.areas[at(t)];
    out.area[f] += area;
    out.centroid[f] += area * mesh.centroid(t);
    for (int vertex : mesh.triangles[at(t)]) out.thickness[f] += area / 3.0 * vertex_thickness[at(vertex)];
  }
  for (std::size_t f = 0; f < n; ++f) {
    if (out.area[f] > 0) {
      out.centroid[f] /= out.area[f];
      out.thickness[f] /= out.area[f];
      continue;
    }
    const int begin = surface.begin[f], count = surface.begin[f + 1] - begin;  // a facet of no area
    for (int k = 0; k < count; ++k) out.centroid[f] += model.nodes[at(surface.nodes[at(begin + k)])] / count;
    out.thickness[f] = std::nan("");
  }
  return out;
}

/// A facet of one side of a contact in a state.
struct FacetRow {
  const std::string& start;  ///< the cells that all facets of the surface share
  const Body& body;
  const Pose& pose;
  const SideFields& fields;
  const FacetShape& shape;
  std::size_t facet;
};

/// After the columns that all facets of a surface share: those of the facet itself.
std::vector<Column<FacetRow>> facet_columns(bool inside) {
  using R = const FacetRow&;
  std::vector<Column<FacetRow>> columns = {
      {"time,outcome,contact,surface,body", [](R r) { return r.start; }},
      {"facet", [](R r) { return std::to_string(r.facet + 1); }},
  };
  add_vector(columns, "reference_", [](R r) { return r.shape.centroid[r.facet]; });
  add_vector(columns, "", [](R r) -> Vector3d {
    return r.pose.center + r.pose.rotation * (r.shape.centroid[r.facet] - r.body.center_of_mass);
  });
  columns.push_back({"area", [](R r) { return csv_number(r.shape.area[r.facet]); }});
  for (const FacetField& field : facet_fields()) {
    const auto values = field.values;
    columns.push_back({field.column, [values](R r) { return csv_number((r.fields.*values)[r.facet]); }});
    if (values == &SideFields::pressure)
      columns.push_back({"thickness", [](R r) { return csv_number(r.shape.thickness[r.facet]); }});
  }
  if (!inside) return columns;
  for (const FacetField& field : inside_facet_fields())
    columns.push_back({field.column, [values = field.values](R r) {
                         const std::vector<double>& of = r.fields.*values;
                         return of.empty() ? std::string() : csv_number(of[r.facet]);
                       }});
  return columns;
}

}  // namespace

std::string run_csv(const Analysis& analysis) {
  const Findings warned = warnings(analysis.findings);
  const std::vector<Column<ContactRow>> columns = contact_columns(with_inside(analysis));
  std::string text = header(columns);
  bool first = true;
  for (const StateResult& state : analysis.states)
    for (std::size_t c = 0; c < analysis.joint.contacts.size(); ++c, first = false)
      text += line(columns, ContactRow{analysis.joint, state, c, &warned, first});
  return text;
}

std::string compartments_csv(const Analysis& analysis) {
  const std::vector<Column<CompartmentRow>> columns = compartment_columns(with_inside(analysis));
  std::string text = header(columns);
  for (const StateResult& state : analysis.states)
    for (std::size_t c = 0; c < analysis.joint.contacts.size(); ++c) {
      const ContactRow contact{analysis.joint, state, c};
      for (std::size_t i = 0; i < contact.statistics().compartments.size(); ++i)
        text += line(columns, CompartmentRow{contact, i});
    }
  return text;
}

bool has_inside(const StateResult& state) {
  return std::any_of(state.statistics.begin(), state.statistics.end(),
                     [](const ContactStatistics& s) { return s.inside[0] || s.inside[1]; });
}

std::string facets_csv_names(bool inside) { return header(facet_columns(inside)); }

std::string facets_csv_lines(const JointModel& model, const Joint& joint, const StateResult& state, bool inside) {
  const std::vector<Column<FacetRow>> columns = facet_columns(inside);
  std::string text;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = joint.contacts[c].layers[side];
      const SideFields& fields = state.fields[c].sides[side];
      const Body& body = joint.bodies[at(layer.body)];
      const Pose& pose = state.equilibrium.poses[at(layer.body)];
      const FacetShape shape = facet_shape(model, layer, fields.vertex_thickness);
      const std::string start = fmt::format("{},{},{},{},{}", csv_number(state.when.time),
                                            name(state.equilibrium.outcome), csv_word(joint.contacts[c].name),
                                            csv_word(model.surfaces[at(layer.surface)].name), csv_word(body.name));
      for (std::size_t f = 0; f < shape.area.size(); ++f)
        text += line(columns, FacetRow{start, body, pose, fields, shape, f});
    }
  }
  return text;
}

std::string facets_csv(const JointModel& model, const Analysis& analysis) {
  const bool inside = with_inside(analysis);
  std::string text = facets_csv_names(inside);
  for (const StateResult& state : analysis.states) text += facets_csv_lines(model, analysis.joint, state, inside);
  return text;
}

}  // namespace dea
