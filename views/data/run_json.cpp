#include "views/data/run_json.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/settings/settings_xml.h"
#include "src/base/numbers.h"
#include "src/model/settings_table.h"
#include "src/results/contact_numbers.h"
#include "src/rules/rules.h"
#include "src/version.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

Json json_value(std::monostate) { return nullptr; }
Json json_value(double number) { return json_number(number); }
Json json_value(const Vector3d& vector) { return json_vector(vector); }
template <class Value>
Json json_value(const Value& value) {
  return value;
}

Json item_json(const SettingItem& item) {
  return std::visit([](const auto& value) { return json_value(value); }, item);
}

Json content_json(const SettingContent& content) {
  if (const auto* item = std::get_if<SettingItem>(&content)) return item_json(*item);
  Json j = Json::object();
  for (const auto& entry : std::get<1>(content)) j[entry.first] = item_json(entry.second);
  return j;
}

Json body_json(const Body& body, const Pose& pose, const Vector6& reaction) {
  const Eigen::AngleAxisd turn(pose.rotation);
  Json j;
  j["translation"] = json_vector(pose.center - body.center_of_mass);
  j["rotation"] = json_vector(turn.angle() * turn.axis());
  j["force"] = json_vector(reaction.head<3>());
  j["moment"] = json_vector(reaction.tail<3>());
  return j;
}

/// Of ligaments or cables.
template <class Springs>
Json tensions_json(const Springs& springs, const std::vector<double>& forces) {
  Json list = Json::array();
  for (std::size_t i = 0; i < forces.size() && i < springs.size(); ++i)
    list.push_back({{"name", springs[i].name}, {"force", json_number(forces[i])}});
  return list;
}

Json inside_json(const std::optional<InsideEnds>& ends) {
  if (!ends) return nullptr;
  Json j;
  for (const InsideEnd& end : kInsideEnds)
    for (const InsideMeasure& measure : kInsideMeasures)
      j[end.name][measure.name] = numbers_json((*ends).*end.value.*measure.value, kInsideNumbers);
  j["peak_near_free_edge"] = ends->peak_near_free_edge;
  return j;
}

/// With no states in it.
Json frame_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings) {
  const Joint& joint = analysis.joint;
  Json j;
  j["schema"] = "dea.run/1";
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
  j["timings"] = {{"read", timings.read},
                  {"joint", timings.joint},
                  {"solve", timings.solve},
                  {"write", timings.write},
                  {"total", timings.total}};
  j["bodies"] = list_json(reported_bodies(joint), [&](int b) { return joint.bodies[at(b)].name; });
  j["states"] = Json::array();
  j["units"] = json_word(model.units);
  j["findings"] = lines(analysis.findings, command_line_wording());
  j["unit_names"] = units_json(model.units);
  j["finding_values"] = findings_json(analysis.findings);
  return j;
}

/// A text of json_text as an entry of a list in an object: no line feed at the end, all lines two farther in. Line
/// feeds in values are written as \n, so each is one of the layout.
std::string entry(const std::string& text) {
  std::string out = "  ";
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    out += text[i];
    if (text[i] == '\n') out += "  ";
  }
  return out;
}

}  // namespace

Json contact_json(const JointModel& model, const Joint& joint, const ContactPair& pair, const ContactStatistics& s,
                  const ContactFields& fields) {
  Json j;
  j["name"] = pair.name;
  j["source"] = joint.bodies[at(pair.source_layer().body)].name;
  j["target"] = joint.bodies[at(pair.target_layer().body)].name;
  for (const SpringNumber& row : spring_table())
    std::visit([&](auto value) { j[row.name] = json_value(s.*value); }, row.value);
  j["source_resultant_factor"] = json_number(fields.sides[pair.source].resultant_factor);
  j["target_resultant_factor"] = json_number(fields.sides[1 - pair.source].resultant_factor);
  j["complementarity"] = json_number(s.complementarity);
  j["law"] = name(pair.law);
  j["facets"] = name(pair.facets);
  j["refine"] = pair.refine;
  Json& h = j["headline"] = {{"surface", model.surfaces[at(pair.source_layer().surface)].name}};
  h.update(headline_json(s.headline));
  j["compartments"] = Json::array();
  for (std::size_t i = 0; i < s.compartments.size(); ++i) {
    const CompartmentLoad& load = s.compartments[i];
    j["compartments"].push_back({{"name", compartment_names(pair)[i]},
                                 {"headline", headline_json(load.headline)},
                                 {"force", json_vector(load.force)},
                                 {"center_of_pressure", json_vector(load.center_of_pressure)},
                                 {"inside", inside_json(load.inside)}});
  }
  j["inside"] = nullptr;
  if (s.inside[0] || s.inside[1])
    j["inside"] = {{"source", inside_json(s.inside[0])}, {"target", inside_json(s.inside[1])}};
  return j;
}

Json state_json(const JointModel& model, const Joint& joint, const StateResult& state) {
  const Equilibrium& e = state.equilibrium;
  Json j;
  j["time"] = json_number(state.when.time);
  j["outcome"] = name(e.outcome);
  j["iterations"] = e.iterations;
  j["residual_force"] = json_number(e.residual_force);
  j["residual_moment"] = json_number(e.residual_moment);
  j["bodies"] = Json::object();
  for (int b : reported_bodies(joint))
    j["bodies"][joint.bodies[at(b)].name] = body_json(joint.bodies[at(b)], e.poses[at(b)], e.reaction[at(b)]);
  j["contacts"] = Json::array();
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    j["contacts"].push_back(contact_json(model, joint, joint.contacts[c], state.statistics[c], state.fields[c]));
  j["message"] = outcome_text(e, command_line_wording());
  j["step"] = state.when.step + 1;
  j["load"] = json_number(e.load);
  j["residual_history"] = list_json(e.history, json_number);
  j["held_directions"] = e.held;
  j["least_stiffness"] = json_number(e.least_stiffness);
  j["unstable"] = e.unstable;
  j["ligaments"] = tensions_json(joint.ligaments, e.ligament_force);
  j["cables"] = tensions_json(joint.cables, e.cable_force);
  j["joints"] = Json::array();
  for (std::size_t c = 0; c < e.connector_force.size() && c < joint.connectors.size(); ++c) {
    const Connector& connector = joint.connectors[c];
    j["joints"].push_back({{"name", connector.name},
                           {"type", connector.type},
                           {"body_a", joint.bodies[at(connector.body_a)].name},
                           {"body_b", joint.bodies[at(connector.body_b)].name},
                           {"force", json_vector(e.connector_force[c].head<3>())},
                           {"moment", json_vector(e.connector_force[c].tail<3>())},
                           {"translation", json_vector(e.connector_motion[c].head<3>())},
                           {"rotation", json_vector(e.connector_motion[c].tail<3>())}});
  }
  return j;
}

Json settings_json(const Settings& settings) {
  Json j;
  for (const SettingOption& option : setting_options()) {
    std::string key = option.name;
    std::replace(key.begin(), key.end(), '-', '_');
    j[key] = content_json(option.content(settings));
  }
  j["placements"] = list_json(settings.placements, [](const Placement& p) {  // as they act one after the other
    return fmt::format("{} {}", p.kind == Placement::Kind::Rotate ? "rotate" : "move", placement_text(p));
  });
  return j;
}

Json run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings) {
  Json j = frame_json(model, settings, analysis, timings);
  for (const StateResult& state : analysis.states) j["states"].push_back(state_json(model, analysis.joint, state));
  return j;
}

void put_run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings,
                  const std::function<void(const std::string& piece)>& put) {
  const std::string frame = json_text(frame_json(model, settings, analysis, timings));
  const std::string empty_list = "\n \"states\": [";  // one space: of the object itself, not of one in it
  const std::size_t states = frame.find(empty_list) + empty_list.size();
  put(frame.substr(0, states));
  for (std::size_t i = 0; i < analysis.states.size(); ++i)
    put((i > 0 ? ",\n" : "\n") + entry(json_text(state_json(model, analysis.joint, analysis.states[i]))));
  if (!analysis.states.empty()) put("\n ");
  put(frame.substr(states));
}

Json converge_json(const JointModel& model, const Settings& settings, const std::vector<Convergence>& studies,
                   double target, int max_springs) {
  Json j;
  j["schema"] = "dea.converge/1";
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
  j["settings"].erase("refine");  // it is what the study varies
  j["target"] = target;
  j["max_springs"] = max_springs;
  j["contacts"] = Json::array();
  for (const Convergence& study : studies) {
    Json c = {{"name", study.contact}};
    c["springs_5_percent"] = study.springs_5_percent < 0 ? Json(nullptr) : Json(study.springs_5_percent);
    c["springs_1_percent"] = study.springs_1_percent < 0 ? Json(nullptr) : Json(study.springs_1_percent);
    c["rows"] = list_json(study.rows, [](const ConvergenceRow& row) {
      Json r;
      r["refine"] = row.refine;
      r["springs"] = row.springs;
      r["springs_hit"] = row.springs_hit;
      r["springs_active"] = row.springs_active;
      r["outcome"] = name(row.outcome);
      r["peak_pressure"] = json_number(row.peak);
      r["mean_pressure"] = json_number(row.mean);
      r["contact_area"] = json_number(row.area);
      r["change_peak"] = json_number(row.change_peak);
      r["change_mean"] = json_number(row.change_mean);
      r["change_area"] = json_number(row.change_area);
      r["headline"] = headline_json(row.headline);
      r["change_headline"] = numbers_json(row.change_headline, kHeadlineNumbers);
      return r;
    });
    j["contacts"].push_back(c);
  }
  j["units"] = json_word(model.units);
  j["unit_names"] = units_json(model.units);
  return j;
}

}  // namespace dea
