#include <fmt/format.h>

#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/views/text/build_text.h>
#include <febiodea/views/text/table.h>

namespace dea {

namespace {

/// Where layers are not as they were wanted.
std::string changes_text(const BuildSummary& s) {
  std::string text;
  for (std::size_t l = 0; l < s.joint.layers.size(); ++l) {
    const LayerReport& r = s.report.layers[l];
    const auto add = [&](int count, const std::string& what) {
      if (count > 0) text += fmt::format("{}: {} {}\n", s.joint.layers[l].name, count, what);
    };
    add(r.changes.turned,
        fmt::format("points turned, by {:.2g} degrees at most, so that no element is inside out; most at {}",
                    r.changes.most_turned * kDegreesPerRadian, vector_text(r.changes.where)));
    add(r.changes.thinned,
        fmt::format("points of another thickness for that, by {:.2g} % at most", 100 * r.changes.most_thinned));
    add(r.raised, "points raised to the least thickness");
    add(r.under, "points inside the bone");
    add(r.missed - r.under, "points whose thickness is that to the nearest point of the bone");
    add(r.holes_filled, "holes filled");
    add(r.parts_left_out, "small parts left out");
  }
  return text;
}

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
  for (const HipAngle& angle : kHipAngles)
    angles.table.rows.push_back(
        {angle.name, std::isfinite(m.*angle.value) ? fmt::format("{:.1f}", m.*angle.value) : "-"});
  tables.push_back(angles);
  return tables;
}

}  // namespace

std::string build_text(const BuildSummary& s) {
  TitledTable layers{"Cartilage [mm]",
                     {{"layer", "way", "triangles", "area", "edge", "thickness", "mean", "most", "Jacobian", "mean"},
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
  TitledTable contacts{"Contacts [mm]", {{"primary", "secondary", "facing", "least gap"}, "llrr", {}}};
  for (std::size_t c = 0; c < s.joint.contacts.size(); ++c)
    contacts.table.rows.push_back(
        {s.joint.layers[at(s.joint.contacts[c].primary)].name, s.joint.layers[at(s.joint.contacts[c].secondary)].name,
         fmt::format("{:.0f} %", 100 * s.report.contacts[c].facing), four_digits(s.report.contacts[c].least_gap)});
  std::vector<TitledTable> tables = {layers, contacts};
  for (const TitledTable& table : anatomy_tables(s.anatomy)) tables.push_back(table);
  std::string text = s.output + "\n" + tables_text(tables) + changes_text(s);
  if (s.balanced) {
    for (std::size_t b = 0; b < s.joint.bodies.size(); ++b)
      if (!s.joint.bodies[b].fixed)
        text += fmt::format("{} seats at {}\n", s.joint.bodies[b].name, vector_text(s.seat[b]));
    text += fmt::format("pressure there [MPa, mm^2]: p99 {}, mean {}, area {}, peak {}\n", four_digits(s.headline.p99),
                        four_digits(s.headline.mean), four_digits(s.headline.area), four_digits(s.headline.peak));
  }
  return text;
}

}  // namespace dea
