#include "views/text/run_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/results/contact_numbers.h"

namespace dea {

namespace {

std::string residual_number(double x) { return std::isfinite(x) ? fmt::format("{:.1e}", x) : "-"; }
std::string share_in_percent(double x) { return std::isfinite(x) ? fmt::format("{:.2f}%", 100.0 * x) : "-"; }

/// For people: what is nothing but rounding beside `scale` is 0.
Vector3d without_rounding(const Vector3d& v, double scale) {
  Vector3d shown = v;
  for (int k = 0; k < 3; ++k)
    if (std::abs(shown[k]) < 1e-12 * scale) shown[k] = 0.0;
  return shown;
}

std::string law_text(const ContactPair& pair) {
  return fmt::format("law {}{}, springs at the {}", name(pair.law),
                     pair.law == Law::Layer && pair.layer_fit == LayerFit::OneTerm ? " of one term" : "",
                     pair.source_layer().springs_at == SpringsAt::Bone ? "bone" : "articular surface");
}

/// One line if all contacts are alike, else one each.
std::string laws_text(const Joint& joint) {
  std::set<std::string> different;
  for (const ContactPair& pair : joint.contacts) different.insert(law_text(pair));
  if (different.size() == 1) return *different.begin() + "\n";
  std::string text;
  for (const ContactPair& pair : joint.contacts) text += fmt::format("{}: {}\n", shown(pair.name), law_text(pair));
  return text;
}

Table contacts_table(const Joint& joint, const std::vector<StateResult>& states, const UnitNames& units) {
  Table table;
  table.headings = {"time", "contact", "outcome"};
  for (const HeadlineNumber& number : kHeadlineNumbers) table.headings.push_back(heading_of(number, units));
  table.headings.insert(table.headings.end(), {with_unit("force", units, Dimension::Force), "iterations", "residual"});
  table.left = "rll" + std::string(table.headings.size() - 3, 'r');
  for (const StateResult& state : states) {
    for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
      const ContactStatistics& s = state.statistics[c];
      std::vector<std::string> row = {time_text(state.when.time), joint.contacts[c].name,
                                      name(state.equilibrium.outcome)};
      for (const HeadlineNumber& number : kHeadlineNumbers) row.push_back(four_digits(s.headline.*number.value));
      row.insert(row.end(), {four_digits(s.force.norm()), fmt::format("{}", state.equilibrium.iterations),
                             residual_number(state.equilibrium.residual_force)});
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

/// A line per state, contact and compartment; no rows: all surfaces are in one piece.
Table compartments_table(const Joint& joint, const std::vector<StateResult>& states, const UnitNames& units) {
  Table table;
  table.headings = {"time", "contact", "compartment"};
  for (const HeadlineNumber& number : kHeadlineNumbers) table.headings.push_back(heading_of(number, units));
  table.headings.insert(table.headings.end(), {with_unit("force", units, Dimension::Force), "share"});
  table.left = "rll" + std::string(table.headings.size() - 3, 'r');
  for (const StateResult& state : states)
    for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
      const std::vector<CompartmentLoad>& loads = state.statistics[c].compartments;
      double all = 0.0;
      for (const CompartmentLoad& load : loads) all += load.force.norm();
      for (std::size_t i = 0; i < loads.size(); ++i) {
        std::vector<std::string> row = {time_text(state.when.time), joint.contacts[c].name,
                                        compartment_names(joint.contacts[c])[i]};
        for (const HeadlineNumber& number : kHeadlineNumbers)
          row.push_back(four_digits(loads[i].headline.*number.value));
        const double force = loads[i].force.norm();
        row.insert(row.end(), {four_digits(force), all > 0 ? fmt::format("{:.1f}%", 100 * force / all) : "-"});
        table.rows.push_back(std::move(row));
      }
    }
  return table;
}

/// A line per state and layer that several contacts press; no rows: there is none.
Table layers_table(const Joint& joint, const std::vector<StateResult>& states, const UnitNames& units) {
  Table table;
  table.headings = {"time", "surfaces", "body"};
  for (const HeadlineNumber& number : kHeadlineNumbers) table.headings.push_back(heading_of(number, units));
  table.headings.push_back(with_unit("sum of p A", units, Dimension::Force));
  table.left = "rll" + std::string(table.headings.size() - 3, 'r');
  for (const StateResult& state : states)
    for (std::size_t k = 0; k < state.layers.size(); ++k) {
      const LayerUse& use = joint.shared_layers[k].uses.front();
      std::vector<std::string> row = {time_text(state.when.time), joint.shared_layers[k].name,
                                      joint.bodies[at(joint.contacts[at(use.contact)].layers[use.side].body)].name};
      for (const HeadlineNumber& number : kHeadlineNumbers)
        row.push_back(four_digits(state.layers[k].headline.*number.value));
      row.push_back(four_digits(state.layers[k].force));
      table.rows.push_back(std::move(row));
    }
  return table;
}

/// A line per state and part; no rows: there is none.
Table parts_table(const Joint& joint, const std::vector<StateResult>& states, const UnitNames& units) {
  Table table;
  table.headings = {"time", "part"};
  for (const char* number : {"first principal p99", "peak", "along fibres p99", "peak"})
    table.headings.push_back(with_unit(number, units, Dimension::Pressure));
  table.headings.insert(table.headings.end(),
                        {"largest strain", "turn [rad]", with_unit("displacement", units, Dimension::Length)});
  table.left = "rlrrrrrrr";
  for (const StateResult& state : states)
    for (std::size_t k = 0; k < state.parts.size(); ++k) {
      std::vector<std::string> row = {time_text(state.when.time), joint.parts[k].name};
      for (const NamedNumber<PartStress>& number : part_numbers())
        row.push_back(four_digits(number.value(state.parts[k])));
      table.rows.push_back(std::move(row));
    }
  return table;
}

/// A line per state, contact, side and end of its layer; no rows: the inside was not asked for.
Table inside_table(const Joint& joint, const std::vector<StateResult>& states, const UnitNames& units) {
  Table table;
  table.headings = {"time", "contact", "cartilage of", ""};
  for (const InsideMeasure& measure : kInsideMeasures)
    for (const char* number : {"p99", "mean", "peak"})
      table.headings.push_back(with_unit(number == std::string("p99") ? fmt::format("{} p99", measure.words) : number,
                                         units, measure.stress ? Dimension::Pressure : Dimension::None));
  table.left = "rlll" + std::string(table.headings.size() - 4, 'r');
  for (const StateResult& state : states)
    for (std::size_t c = 0; c < joint.contacts.size(); ++c)
      for (const int side : {0, 1}) {
        const std::optional<InsideEnds>& ends = state.statistics[c].inside[side];
        if (!ends) continue;
        const ContactPair& pair = joint.contacts[c];
        const Layer& layer = side == 0 ? pair.source_layer() : pair.target_layer();
        for (const InsideEnd& end : kInsideEnds) {
          std::vector<std::string> row = {time_text(state.when.time), pair.name, joint.bodies[at(layer.body)].name,
                                          end.words};
          for (const InsideMeasure& measure : kInsideMeasures) {
            const InsideDistribution& of = (*ends).*end.value.*measure.value;
            row.insert(row.end(), {four_digits(of.p99), four_digits(of.mean), four_digits(of.peak)});
          }
          table.rows.push_back(std::move(row));
        }
      }
  return table;
}

/// All other numbers of a contact: what they are, and how they are found.
struct Detail {
  const char* name;
  Dimension dimension;
  std::string (*text)(const ContactStatistics&);
};

std::vector<Detail> details_of_contact() {
  using S = const ContactStatistics&;
  constexpr Dimension P = Dimension::Pressure, A = Dimension::Area, none = Dimension::None;
  return {{"threshold of p99, mean, area, peak", P, [](S s) { return four_digits(s.headline.above); }},
          {"springs", none, [](S s) { return fmt::format("{}", s.springs); }},
          {"springs under pressure", none, [](S s) { return fmt::format("{}", s.springs_active); }},
          {"p99, springs", P, [](S s) { return four_digits(s.p99); }},
          {"mean, springs", P, [](S s) { return four_digits(s.mean); }},
          {"median, springs", P, [](S s) { return four_digits(s.median); }},
          {"area, springs", A, [](S s) { return four_digits(s.contact_area); }},
          {"peak, springs", P, [](S s) { return four_digits(s.peak); }},
          {"area, facets > 0", A, [](S s) { return four_digits(s.facet_contact_area); }},
          {"peak, facets > 0", P, [](S s) { return four_digits(s.facet_peak); }},
          {"mean, nodes > 0, unweighted", P, [](S s) { return four_digits(s.nodal_mean); }},
          {"median, nodes > 0, unweighted", P, [](S s) { return four_digits(s.nodal_median); }}};
}

/// A line per state, contact and number.
Table details_table(const Joint& joint, const std::vector<StateResult>& states, const UnitNames& units) {
  Table table;
  table.headings = {"time", "contact", "number", "value"};
  table.left = "rllr";
  for (const StateResult& state : states)
    for (std::size_t c = 0; c < joint.contacts.size(); ++c)
      for (const Detail& d : details_of_contact())
        table.rows.push_back({time_text(state.when.time), joint.contacts[c].name, with_unit(d.name, units, d.dimension),
                              d.text(state.statistics[c])});
  return table;
}

Table bodies_table(const Joint& joint, const Equilibrium& e, const UnitNames& units) {
  Table table;
  table.headings = {"body", with_unit("translation", units, Dimension::Length), "rotation [rad]",
                    with_unit("force", units, Dimension::Force), with_unit("moment", units, Dimension::Moment)};
  table.left = "lllll";
  double farthest = 0.0, strongest = 0.0, turning = 0.0;
  for (int b : reported_bodies(joint)) {
    farthest = std::max(farthest, (e.poses[at(b)].center - joint.bodies[at(b)].center_of_mass).norm());
    strongest = std::max(strongest, e.reaction[at(b)].head<3>().norm());
    turning = std::max(turning, e.reaction[at(b)].tail<3>().norm());
  }
  for (int b : reported_bodies(joint)) {
    const Pose& pose = e.poses[at(b)];
    const Eigen::AngleAxisd turn(pose.rotation);
    const Vector6& reaction = e.reaction[at(b)];
    table.rows.push_back({joint.bodies[at(b)].name,
                          vector_text(without_rounding(pose.center - joint.bodies[at(b)].center_of_mass, farthest)),
                          vector_text(without_rounding(turn.angle() * turn.axis(), 1.0)),
                          vector_text(without_rounding(reaction.head<3>(), strongest)),
                          vector_text(without_rounding(reaction.tail<3>(), std::max(strongest, turning)))});
  }
  return table;
}

Table springs_table(const Joint& joint, const Equilibrium& e, const UnitNames& units) {
  Table table;
  table.headings = {joint.cables.empty() ? "spring between bodies" : "spring or cable between bodies",
                    with_unit("tension", units, Dimension::Force)};
  table.left = "lr";
  const std::vector<std::string> names = spring_names(joint);
  for (std::size_t l = 0; l < joint.ligaments.size() && l < e.ligament_force.size(); ++l)
    table.rows.push_back({names[l], number_text(e.ligament_force[l])});
  for (std::size_t c = 0; c < joint.cables.size() && c < e.cable_force.size(); ++c)
    table.rows.push_back({names[joint.ligaments.size() + c], number_text(e.cable_force[c])});
  return table;
}

Table connectors_table(const Joint& joint, const Equilibrium& e, const UnitNames& units) {
  Table table;
  table.headings = {"joint",
                    "bodies",
                    with_unit("force", units, Dimension::Force),
                    with_unit("moment", units, Dimension::Moment),
                    with_unit("translation", units, Dimension::Length),
                    "rotation [rad]"};
  table.left = "llllll";
  double largest = 0.0, reach = 0.0;
  for (const Vector6& f : e.connector_force)
    if (f.allFinite()) largest = std::max({largest, f.head<3>().norm(), f.tail<3>().norm()});
  for (const Pose& pose : e.poses) reach = std::max(reach, pose.center.norm());
  for (std::size_t c = 0; c < joint.connectors.size() && c < e.connector_force.size(); ++c) {
    const Connector& connector = joint.connectors[c];
    const Vector6 &force = e.connector_force[c], &motion = e.connector_motion[c];
    const auto cell = [&](const Vector3d& v) {
      return v.allFinite() ? vector_text(without_rounding(v, largest)) : std::string("-");
    };
    table.rows.push_back({connector.name.empty() ? "(unnamed)" : connector.name,
                          joint.bodies[at(connector.body_a)].name + " - " + joint.bodies[at(connector.body_b)].name,
                          cell(force.head<3>()), cell(force.tail<3>()),
                          vector_text(without_rounding(motion.head<3>(), std::max(reach, 1.0))),
                          vector_text(without_rounding(motion.tail<3>(), 1.0))});
  }
  return table;
}

}  // namespace

std::string units_text(const JointModel& model) {
  return model.units.empty() ? "units: the model's own (it names none); rotations in radians"
                             : fmt::format("units: the model's, {}; rotations in radians", model.units);
}

std::string unit_behind(const JointModel& model, Dimension dimension) {
  const std::string unit = unit_of(unit_names(model.units), dimension);
  return unit.empty() ? "" : " " + unit;
}

std::vector<std::string> spring_names(const Joint& joint) {
  std::vector<std::string> names;
  std::map<std::string, int> times;
  const auto add = [&](const std::string& own) {
    const std::string name = own.empty() ? "(unnamed)" : own;
    const int number = ++times[name];
    names.push_back(number > 1 ? fmt::format("{} ({})", name, number) : name);
  };
  for (const Ligament& l : joint.ligaments) add(l.name);
  for (const Cable& c : joint.cables) add(c.name);
  return names;
}

std::vector<int> reported_bodies(const Joint& joint) {
  std::vector<int> bodies;
  for (int b = 0; b < static_cast<int>(joint.bodies.size()); ++b) {
    bool used = !joint.bodies[at(b)].ground;
    for (const ContactPair& pair : joint.contacts) used = used || pair.layers[0].body == b || pair.layers[1].body == b;
    for (const Ligament& l : joint.ligaments) used = used || l.body_a == b || l.body_b == b;
    for (const Connector& c : joint.connectors) used = used || c.body_a == b || c.body_b == b;
    for (const Cable& c : joint.cables)
      for (const Cable::Point& p : c.points) used = used || p.body == b;
    if (used) bodies.push_back(b);
  }
  return bodies;
}

std::vector<TitledTable> run_tables(const Analysis& analysis, bool details, const UnitNames& units) {
  const Joint& joint = analysis.joint;
  std::vector<TitledTable> tables = {{"", contacts_table(joint, analysis.states, units)}};
  if (Table compartments = compartments_table(joint, analysis.states, units); !compartments.rows.empty())
    tables.push_back({"compartments; share: of the sum of their forces", std::move(compartments)});
  if (Table layers = layers_table(joint, analysis.states, units); !layers.rows.empty())
    tables.push_back(
        {"layers that several contacts press: of the maps on their own surfaces, with the pressures of all",
         std::move(layers)});
  if (Table parts = parts_table(joint, analysis.states, units); !parts.rows.empty())
    tables.push_back({"parts that give way: stress at the centres of their elements", std::move(parts)});
  if (Table inside = inside_table(joint, analysis.states, units); !inside.rows.empty())
    tables.push_back(
        {"inside the cartilage, where it is pressed; third principal strain: the least", std::move(inside)});
  if (details && !analysis.states.empty()) tables.push_back({"", details_table(joint, analysis.states, units)});
  if (analysis.states.empty()) return tables;
  const StateResult& last = analysis.states.back();
  const Equilibrium& e = last.equilibrium;
  tables.push_back(
      {fmt::format("bodies at time {}: motion of the centre of mass, rotation vector, force and moment on the body by "
                   "what loads and holds it",
                   time_text(last.when.time)),
       bodies_table(joint, e, units)});
  if (!joint.ligaments.empty() || !joint.cables.empty()) tables.push_back({"", springs_table(joint, e, units)});
  if (!e.connector_force.empty())
    tables.push_back(
        {"joints: force and moment on the second body at the joint, motion along and about the joint's axes",
         connectors_table(joint, e, units)});
  return tables;
}

std::string run_text(const JointModel& model, const Analysis& analysis, bool details) {
  return units_text(model) + "\n" + laws_text(analysis.joint) + headline_words() + "; of the surface with springs\n" +
         tables_text(run_tables(analysis, details, unit_names(model.units)));
}

std::string converge_text(const JointModel& model, const std::vector<Convergence>& studies, int max_springs) {
  std::string text = units_text(model) + "\n" + headline_words() + "; of the surface with springs\n";
  const UnitNames units = unit_names(model.units);
  for (const Convergence& study : studies) {
    Table table{{"refine", "springs"}, "rr", {}};
    for (const HeadlineNumber& number : kHeadlineNumbers) {
      table.headings.insert(table.headings.end(), {heading_of(number, units), fmt::format("{} changes", number.name)});
      table.left += "rr";
    }
    table.headings.emplace_back("outcome");
    table.left += "l";
    for (const ConvergenceRow& r : study.rows) {
      table.rows.push_back({fmt::format("{}", r.refine), fmt::format("{}", r.springs)});
      for (const HeadlineNumber& number : kHeadlineNumbers)
        for (const std::string& cell :
             {four_digits(r.headline.*number.value), share_in_percent(r.change_headline.*number.value)})
          table.rows.back().push_back(cell);
      table.rows.back().emplace_back(name(r.outcome));
    }
    text += fmt::format("\ncontact {}, last state; changes against the row above\n{}", in_quotes(study.contact),
                        table_text(table));
    const auto needed = [&](int springs, const char* limit) {
      return springs < 0
                 ? fmt::format("changes below {}: not reached (at most {} springs allowed)\n", limit, max_springs)
                 : fmt::format("changes below {}: from {} springs on\n", limit, springs);
    };
    text += needed(study.springs_5_percent, "5%");
    text += needed(study.springs_1_percent, "1%");
  }
  text += "\nthe springs are divided, the facets are not: what shorter facets would change only a finer mesh tells\n";
  return text;
}

}  // namespace dea
