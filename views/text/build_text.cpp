#include "views/text/build_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/time_text.h"

namespace dea {

namespace {

std::string percent(double part) { return fmt::format("{:.2g} %", 100 * part); }

/// What a layer's area and thickness gave way, and what else is not as it was wanted: empty: nothing.
std::vector<std::string> changes_of(const LayerReport& r) {
  const SheetChanges& c = r.changes;
  std::vector<std::string> parts;
  if (c.area_lost > 0)
    parts.push_back(fmt::format("{} mm^2 ({}) of its area left out, where elements would be inside out",
                                four_digits(c.area_lost), percent(c.lost_part())));
  if (c.most_change > 0)
    parts.push_back(fmt::format(
        "thickness changed by {:.2g} mm in the mean and {:.2g} mm ({}) at most, at {}, by more than a tenth over {} of "
        "the area",
        c.mean_change, c.most_change, percent(c.most_thinned), vector_text(c.where), percent(c.changed_part)));
  if (c.turned > 0)
    parts.push_back(fmt::format("lines through it turned by up to {:.2g} degrees, so that no element is inside out",
                                c.most_turned * kDegreesPerRadian));
  if (c.moved > 0) parts.push_back(fmt::format("folds spread by up to {:.2g} mm", c.most_moved));
  if (r.raised > 0 && c.wanted_area > 0)
    parts.push_back(
        fmt::format("raised to the least thickness over {} of its area", percent(r.raised_area / c.wanted_area)));
  if (r.thin.part > 0)
    parts.push_back(fmt::format(
        "thinner than the least thickness, {} mm, over {} of its area: {} mm at the least, at {}",
        four_digits(r.thin.least), percent(r.thin.part), four_digits(r.thin.thinnest), vector_text(r.thin.where)));
  const auto add = [&](int count, const char* noun, const char* what) {
    if (count > 0) parts.push_back(fmt::format("{} {}{} {}", count, noun, count == 1 ? "" : "s", what));
  };
  add(r.slivers, "sliver", "merged with what lies around");
  add(r.missed - r.under - r.beside, "point", "whose thickness is that to the nearest point of the bone");
  add(r.beside, "point", "beside the bone's open edge, as thick as those around");
  add(r.holes_filled, "hole", "filled");
  add(r.parts_left_out, "small part", "left out");
  return parts;
}

}  // namespace

std::vector<std::string> layer_changes(const BuildSummary& s) {
  std::vector<std::string> lines;
  for (std::size_t l = 0; l < s.joint.layers.size(); ++l) {
    std::string line;
    for (const std::string& part : changes_of(s.report.layers[l])) line += (line.empty() ? "" : "; ") + part;
    if (!line.empty()) lines.push_back(s.joint.layers[l].name + ": " + line);
  }
  return lines;
}

namespace {

std::vector<TitledTable> anatomy_tables(const Anatomy& anatomy) {
  std::vector<TitledTable> tables;
  if (!anatomy.frames.empty()) {
    TitledTable frames{"Frames: x forwards, y up, z to the right", {{"frame", "origin", "x", "y", "z"}, "lllll", {}}};
    for (const AnatomicalFrame& f : anatomy.frames) {
      std::vector<std::string> row = {f.name, vector_text(f.origin)};
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = f.axes.col(k);
        row.push_back(fmt::format("({:.4f}, {:.4f}, {:.4f})", axis.x() + 0.0, axis.y() + 0.0, axis.z() + 0.0));
      }
      frames.table.rows.push_back(row);
    }
    tables.push_back(frames);
  }
  if (!anatomy.hip) return tables;
  const HipMeasures& m = *anatomy.hip;
  TitledTable spheres{fmt::format("Hip, {} [mm]; axes {}", name(m.side), m.axes_words),
                      {{"sphere", "bone", "centre", "radius", "rms", "points"}, "lllrrr", {}}};
  const auto sphere = [&](const char* what, const std::string& bone, const SphereFit& fit, int points) {
    spheres.table.rows.push_back(
        {what, bone, vector_text(fit.center), four_digits(fit.radius), four_digits(fit.rms), std::to_string(points)});
  };
  sphere("head", m.head_bone, m.head, m.head_points);
  sphere("socket", m.socket_bone, m.socket, m.socket_points);
  tables.push_back(spheres);
  TitledTable angles{"Hip [degrees]", {{"angle", ""}, "lr", {}}};
  for (const HipAngle& angle : kHipAngles) {
    const double x = m.*angle.value;
    angles.table.rows.push_back(
        {angle.name, std::isfinite(x) ? fmt::format("{:.1f}", std::abs(x) < 0.05 ? 0.0 : x) : "-"});
  }
  tables.push_back(angles);
  return tables;
}

TitledTable layer_table(const BuildSummary& s) {
  TitledTable layers{"Cartilage [mm]",
                     {{"layer", "way", "triangles", "area", "mean edge", "least thickness", "mean thickness",
                       "most thickness", "least Jacobian", "mean Jacobian"},
                      "llrrrrrrrr",
                      {}}};
  for (std::size_t l = 0; l < s.joint.layers.size(); ++l) {
    const BuiltLayer& layer = s.joint.layers[l];
    const SheetQuality& q = s.report.layers[l].quality;
    std::vector<std::string> row = {layer.name, s.report.layers[l].way, std::to_string(layer.triangles.size()),
                                    four_digits(q.area), four_digits(q.mean_edge)};
    for (const double x : {q.least_thickness, q.mean_thickness, q.most_thickness, q.least_jacobian, q.mean_jacobian})
      row.push_back(layer.bare ? "-" : four_digits(x));
    layers.table.rows.push_back(row);
  }
  return layers;
}

TitledTable rim_table(const BuildSummary& s) {
  TitledTable rims{"Rims [mm]", {{"layer", "rims", "length", "thickness there", "thins out over"}, "lrrrr", {}}};
  for (std::size_t l = 0; l < s.joint.layers.size(); ++l) {
    const LayerReport& r = s.report.layers[l];
    if (s.joint.layers[l].bare) continue;
    rims.table.rows.push_back({s.joint.layers[l].name, std::to_string(r.rim.rims), four_digits(r.rim.length),
                               r.rim.rims == 0 ? "-" : four_digits(r.rim.thickness),
                               r.fade > 0 ? four_digits(r.fade) : "ends"});
  }
  return rims;
}

TitledTable contact_table(const BuildSummary& s) {
  TitledTable contacts{"Contacts [mm]", {{"primary", "secondary", "facing", "least gap"}, "llrr", {}}};
  for (std::size_t c = 0; c < s.joint.contacts.size(); ++c)
    contacts.table.rows.push_back(
        {s.joint.layers[at(s.joint.contacts[c].primary)].name, s.joint.layers[at(s.joint.contacts[c].secondary)].name,
         fmt::format("{:.0f} %", 100 * s.report.contacts[c].facing), four_digits(s.report.contacts[c].least_gap)});
  return contacts;
}

/// Free to turn, or turned by a table.
bool any_turns(const BuiltJoint& joint) {
  return std::any_of(joint.bodies.begin(), joint.bodies.end(), [](const BuiltBody& b) {
    return b.turns_freely() || (!b.fixed && (b.moved[3] || b.moved[4] || b.moved[5]));
  });
}

TitledTable seat_table(const BuildSummary& s) {
  TitledTable seats{"Balance by dea [mm, N]", {{"time", "bone", "force", "moves by"}, "rlll", {}}};
  const bool turns = any_turns(s.joint);
  if (turns) {
    seats.title = "Balance by dea [mm, N, degrees]";
    seats.table.headings.push_back("turns by");
    seats.table.left += 'l';
  }
  for (std::size_t i = 0; i < s.balances.size(); ++i)
    for (std::size_t b = 0; b < s.joint.bodies.size(); ++b) {
      if (s.joint.bodies[b].fixed) continue;
      const BuildBalance& balance = s.balances[i];
      seats.table.rows.push_back({time_text(balance.time), s.joint.bodies[b].name,
                                  vector_text(force_of(s.joint.bodies[b], i)),
                                  balance.found ? vector_text(balance.displacement[b]) : "no balance"});
      if (turns)
        seats.table.rows.back().push_back(balance.found ? vector_text(balance.turn[b] * kDegreesPerRadian) : "");
    }
  return seats;
}

TitledTable ligament_table(const BuildSummary& s) {
  TitledTable ligaments{
      "Ligaments as built [mm, N]",
      {{"ligament", "from", "to", "stiffness", "length", "slack length", "strain", "force"}, "lllrrrrr", {}}};
  for (const BuiltLigament& l : s.joint.ligaments) {
    const double length = length_of(l);
    ligaments.table.rows.push_back({l.name, s.joint.bodies[at(l.bone_a)].name, s.joint.bodies[at(l.bone_b)].name,
                                    four_digits(l.stiffness), four_digits(length), four_digits(l.slack_length),
                                    fmt::format("{:.2f} %", 100 * strain_of(l, length)),
                                    four_digits(force_of(l, length))});
  }
  return ligaments;
}

TitledTable pressure_table(const BuildSummary& s) {
  TitledTable pressures{"Pressure in balance [MPa, mm^2]",
                        {{"time", "contact", "p99", "mean", "area", "peak"}, "rlrrrr", {}}};
  for (const BuildBalance& b : s.balances)
    for (const BuildBalance::Contact& c : b.contacts) {
      if (!b.found) continue;
      pressures.table.rows.push_back({time_text(b.time), c.name});
      for (const HeadlineNumber& number : kHeadlineNumbers)
        pressures.table.rows.back().push_back(four_digits(c.headline.*number.value));
    }
  return pressures;
}

}  // namespace

std::vector<TitledTable> build_tables(const BuildSummary& s) {
  std::vector<TitledTable> tables = {layer_table(s), rim_table(s), contact_table(s)};
  if (!s.joint.ligaments.empty()) tables.push_back(ligament_table(s));
  tables.push_back(seat_table(s));
  const TitledTable pressures = pressure_table(s);
  if (!pressures.table.rows.empty()) tables.push_back(pressures);
  for (TitledTable& table : anatomy_tables(s.anatomy)) tables.push_back(std::move(table));
  return tables;
}

std::string build_text(const BuildSummary& s) {
  std::string text = s.output + "\n" + tables_text(build_tables(s));
  for (const std::string& change : layer_changes(s)) text += change + "\n";
  return text;
}

}  // namespace dea
