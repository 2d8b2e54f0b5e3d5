#include <fmt/format.h>

#include <algorithm>

#include "io/settings/settings_xml.h"
#include "src/base/numbers.h"
#include "src/rules/look.h"
#include "src/rules/rules.h"
#include "src/version.h"
#include "views/data/build_json.h"
#include "views/text/table.h"

namespace dea {

namespace {

Json layer_json(const BuildSummary& s, std::size_t l) {
  const BuiltLayer& layer = s.joint.layers[l];
  const LayerReport& r = s.report.layers[l];
  Json j;
  j["name"] = layer.name;
  j["bone"] = s.joint.bodies[at(layer.body)].name;
  j["way"] = r.way;
  j["triangles"] = layer.triangles.size();
  j["area"] = json_number(r.quality.area);
  j["mean_edge"] = json_number(r.quality.mean_edge);
  const auto number = [&](double x) { return layer.bare ? Json(nullptr) : json_number(x); };
  j["thickness_least"] = number(r.quality.least_thickness);
  j["thickness_mean"] = number(r.quality.mean_thickness);
  j["thickness_most"] = number(r.quality.most_thickness);
  j["jacobian_least"] = number(r.quality.least_jacobian);
  j["jacobian_mean"] = number(r.quality.mean_jacobian);
  j["points_turned"] = r.changes.turned;
  j["most_turned"] = json_number(r.changes.most_turned * kDegreesPerRadian);
  j["points_thinned"] = r.changes.thinned;
  j["most_thinned"] = json_number(r.changes.most_thinned);
  j["points_raised"] = r.raised;
  j["points_missed"] = r.missed;
  j["points_in_bone"] = r.under;
  j["holes_filled"] = r.holes_filled;
  j["parts_left_out"] = r.parts_left_out;
  j["fade"] = json_number(r.fade);
  j["rims"] = r.rim.rims;
  j["rim_length"] = json_number(r.rim.length);
  j["rim_thickness"] = number(r.rim.thickness);
  j["points_below_least"] = r.below_least;
  j["area_lost"] = json_number(r.changes.area_lost);
  j["thickness_change_mean"] = number(r.changes.mean_change);
  j["thickness_change_most"] = number(r.changes.most_change);
  j["thickness_changed_part"] = number(r.changes.changed_part);
  j["points_moved"] = r.changes.moved;
  j["most_moved"] = json_number(r.changes.most_moved);
  const bool least = r.thin.least > 0;
  j["least_wanted"] = least ? json_number(r.thin.least) : Json(nullptr);
  j["thin_part"] = least ? json_number(r.thin.part) : Json(nullptr);
  j["thinnest_at"] = least ? json_vector(r.thin.where) : Json(nullptr);
  return j;
}

Json load_json(const BuildSummary& s, std::size_t i) {
  const BuildBalance& b = s.balances[i];
  Json j;
  j["time"] = json_number(b.time);
  j["table_time"] = i < s.load_times.size() ? json_number(s.load_times[i]) : Json(nullptr);
  j["balanced"] = b.found;
  j["balance"] = b.words;
  j["bones"] = Json::array();
  for (std::size_t k = 0; k < s.joint.bodies.size(); ++k) {
    const BuiltBody& body = s.joint.bodies[k];
    if (body.fixed) continue;
    j["bones"].push_back({{"name", body.name},
                          {"force", json_vector(force_of(body, i))},
                          {"displacement", b.found ? json_vector(b.displacement[k]) : Json(nullptr)},
                          {"turn", b.found ? json_vector(b.turn[k] * kDegreesPerRadian) : Json(nullptr)}});
  }
  j["contacts"] = list_json(b.contacts, [&](const BuildBalance::Contact& c) -> Json {
    return {{"name", c.name}, {"headline", b.found ? headline_json(c.headline) : Json(nullptr)}};
  });
  return j;
}

Json ligament_json(const BuiltJoint& joint, const BuiltLigament& l) {
  const double length = length_of(l);
  return {{"name", l.name},
          {"from", joint.bodies[at(l.bone_a)].name},
          {"to", joint.bodies[at(l.bone_b)].name},
          {"stiffness", json_number(l.stiffness)},
          {"toe_strain", json_number(l.toe_strain)},
          {"length", json_number(length)},
          {"slack_length", json_number(l.slack_length)},
          {"strain", json_number(strain_of(l, length))},
          {"force", json_number(force_of(l, length))}};
}

Json frame_json(const AnatomicalFrame& f) {
  Json j = {{"name", f.name}, {"origin", json_vector(f.origin)}};
  for (int k = 0; k < 3; ++k) j[std::string(1, "xyz"[k])] = json_vector(f.axes.col(k));
  j["from"] = f.words;
  return j;
}

Json hip_json(const HipMeasures& m) {
  Json j;
  j["socket_bone"] = m.socket_bone;
  j["head_bone"] = m.head_bone;
  j["side"] = name(m.side);
  j["axes"] = m.axes_words;
  for (int k = 0; k < 3; ++k) j[std::string("axes_") + "xyz"[k]] = json_vector(m.axes.col(k));
  const auto sphere = [&](const std::string& name, const SphereFit& fit, int points) {
    j[name + "_center"] = json_vector(fit.center);
    j[name + "_radius"] = json_number(fit.radius);
    j[name + "_rms"] = json_number(fit.rms);
    j[name + "_points"] = points;
  };
  sphere("head", m.head, m.head_points);
  sphere("socket", m.socket, m.socket_points);
  j["offset"] = json_vector(m.offset);
  const bool rim = !m.rim.empty();
  j["rim_center"] = rim ? json_vector(m.rim_center) : Json(nullptr);
  j["rim_normal"] = rim ? json_vector(m.rim_normal) : Json(nullptr);
  j["rim_radius"] = json_number(m.rim_radius);
  j["rim_rms"] = json_number(m.rim_rms);
  j["rim_points"] = m.rim.size();
  j["rim_points_in_plane"] = std::count(m.rim_in_plane.begin(), m.rim_in_plane.end(), 1);
  for (const HipAngle& angle : kHipAngles) j[angle.key] = json_number(m.*angle.value);
  j["missing"] = m.missing;
  return j;
}

/// The joint surface that can bear a body's load: of each of its contacts the smaller side [mm^2].
double bearing_area(const BuiltJoint& joint, const BuildReport& report, int body) {
  double area = 0;
  for (const BuiltContact& c : joint.contacts) {
    const std::size_t sides[] = {at(c.primary), at(c.secondary)};
    if (joint.layers[sides[0]].body == body || joint.layers[sides[1]].body == body)
      area += std::min(report.layers[sides[0]].quality.area, report.layers[sides[1]].quality.area);
  }
  return area;
}

}  // namespace

bool all_balanced(const BuildSummary& s) {
  return std::all_of(s.balances.begin(), s.balances.end(), [](const BuildBalance& b) { return b.found; });
}

std::vector<std::string> load_questions(const BuiltJoint& joint, const BuildReport& report) {
  std::vector<std::string> lines;
  constexpr double kMost = 50, kLeast = 2e-3;  // MPa over all of the joint's surface; a walking hip's has 1
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BuiltBody& body = joint.bodies[b];
    double most = 0;
    for (std::size_t i = 0; i < joint.loads(); ++i) most = std::max(most, force_of(body, i).norm());
    const double area = bearing_area(joint, report, static_cast<int>(b)), pressure = most / area;
    if (body.fixed || most == 0 || !(area > 0) || (pressure <= kMost && pressure >= kLeast)) continue;
    lines.push_back(fmt::format(
        "{}: {} {:.4g} N on {:.4g} mm^2 of joint surface, {:.2g} MPa, expected 0.1 to 10: {}", body.name,
        body.forces.empty() ? "found a force of" : "found a table whose largest force is", most, area, pressure,
        body.forces.empty() ? "is it in N (--force)?"
                            : "check the table's units, and the body weight in N (--load-units, --body-weight)"));
  }
  return lines;
}

std::string modulus_question(const BuiltModelSettings& model) {
  const auto megapascals = odd_modulus(model.E, unit_names(model.units));
  return megapascals ? fmt::format(
                           "cartilage: E = {:g} is {:.3g} MPa in the model's units, {}; cartilage has 0.1 to 100 "
                           "MPa: check the modulus and the units",
                           model.E, *megapascals, model.units)
                     : "";
}

std::vector<std::string> change_warnings(const BuiltJoint& joint, const BuildReport& report) {
  std::vector<std::string> lines;
  for (std::size_t l = 0; l < joint.layers.size(); ++l) {
    const SheetChanges& c = report.layers[l].changes;
    const ThinPlaces& thin = report.layers[l].thin;
    if (thin.part > kMuchArea)
      lines.push_back(fmt::format(
          "{}: found it thinner than its least thickness, {:.2g} mm, over {:.2g} % of its area, {:.2g} mm at "
          "the least, at {}: lines through it lean there, or its surface is rough; a smoother surface or other "
          "triangles "
          "(--edge) may do",
          joint.layers[l].name, thin.least, 100 * thin.part, thin.thinnest, vector_text(thin.where)));
    if (!much_changed(c)) continue;
    std::string found;
    if (c.changed_part > kMuchArea)
      found = fmt::format(
          "a thickness that had to change by more than a tenth over {:.2g} % of its area, {:.2g} mm "
          "({:.2g} %) at most, at {}",
          100 * c.changed_part, c.most_change, 100 * c.most_thinned, vector_text(c.where));
    if (c.lost_part() > kMuchArea)
      found += fmt::format("{}{:.2g} % of its area that had to be left out", found.empty() ? "" : ", and ",
                           100 * c.lost_part());
    lines.push_back(
        fmt::format("{}: found {}; the surface folds or lies inside the bone there: look at the map "
                    "\"Change\" of the page (--report); a smoother surface or other triangles (--edge) may do",
                    joint.layers[l].name, found));
  }
  return lines;
}

std::vector<std::string> own_warnings(const BuildSummary& s) {
  std::vector<std::string> lines = s.anatomy.warnings;
  for (const std::string& change : change_warnings(s.joint, s.report)) lines.push_back(change);
  if (const std::string odd = modulus_question(s.model); !odd.empty()) lines.push_back(odd);
  for (const std::string& question : load_questions(s.joint, s.report)) lines.push_back(question);
  for (const BuildBalance& b : s.balances)
    if (!b.found)
      lines.push_back(s.balances.size() == 1
                          ? "dea finds no balance under the force: " + b.words
                          : fmt::format("dea finds no balance under the load at time {:g}: {}", b.time, b.words));
  return lines;
}

std::vector<std::string> build_warnings(const BuildSummary& s) {
  std::vector<std::string> lines = own_warnings(s);
  const std::vector<std::string> of_run = coded_words(s.of_run, command_line_wording());
  lines.insert(lines.end(), of_run.begin(), of_run.end());
  return lines;
}

Json build_json(const BuildSummary& s) {
  Json j;
  j["schema"] = "dea.build/1";
  j["version"] = kVersion;
  j["model"] = s.output;
  for (std::size_t b = 0; b < s.joint.bodies.size(); ++b) {
    const BuiltBody& body = s.joint.bodies[b];
    Json one = {{"name", body.name}, {"center", json_vector(body.center)}};
    one["center_from"] = body.center_words;
    one["held"] = body.fixed;
    one["force"] = body.fixed ? Json(nullptr) : json_vector(body.force);
    const BuildBalance& first = s.balances.front();
    one["seat"] = body.fixed || !first.found ? Json(nullptr) : json_vector(first.displacement[b]);
    one["held_directions"] = Json::array();
    for (std::size_t c = 0; c < 3; ++c)
      if (body.fixed || body.held[c]) one["held_directions"].push_back(std::string(1, "xyz"[c]));
    one["free"] = Json::array();
    one["moved"] = Json::array();
    for (std::size_t k = 0; k < kDofs; ++k) {
      if (body.free(k)) one["free"].push_back(kDofNames[k]);
      if (!body.fixed && body.moved[k]) one["moved"].push_back(kDofNames[k]);
    }
    j["bones"].push_back(one);
  }
  for (std::size_t l = 0; l < s.joint.layers.size(); ++l) j["layers"].push_back(layer_json(s, l));
  for (std::size_t c = 0; c < s.joint.contacts.size(); ++c) {
    const BuiltContact& contact = s.joint.contacts[c];
    j["contacts"].push_back({{"name", contact.name},
                             {"primary", s.joint.layers[at(contact.primary)].name},
                             {"secondary", s.joint.layers[at(contact.secondary)].name},
                             {"least_gap", json_number(s.report.contacts[c].least_gap)},
                             {"facing", json_number(s.report.contacts[c].facing)}});
  }
  const auto failed =
      std::find_if(s.balances.begin(), s.balances.end(), [](const BuildBalance& b) { return !b.found; });
  const BuildBalance& first = s.balances.front();
  j["balanced"] = failed == s.balances.end();
  j["balance"] = failed == s.balances.end() ? first.words : failed->words;
  j["headline"] =
      first.found && !first.contacts.empty() ? headline_json(first.contacts.front().headline) : Json(nullptr);
  j["findings"] = s.report.findings;
  for (std::size_t i = 0; i < s.balances.size(); ++i) j["loads"].push_back(load_json(s, i));
  j["side"] = s.anatomy.side ? Json(name(*s.anatomy.side)) : Json(nullptr);
  j["frames"] = list_json(s.anatomy.frames, frame_json);
  j["hip"] = s.anatomy.hip ? hip_json(*s.anatomy.hip) : Json(nullptr);
  j["warnings"] = build_warnings(s);
  j["finding_values"] = findings_json(s.of_run);
  j["ligaments"] = list_json(s.joint.ligaments, [&](const BuiltLigament& l) { return ligament_json(s.joint, l); });
  return j;
}

}  // namespace dea
