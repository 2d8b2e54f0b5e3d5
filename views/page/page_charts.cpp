// Curves over time on the page of a run.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "src/base/numbers.h"
#include "views/page/page_data.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

constexpr const char* kHeadlineCaption = "Of nodes above the threshold, as in the table; of the surface with springs.";

PageChart empty_chart(const Analysis& analysis, const std::string& title, const std::string& caption,
                      const std::string& quantity, const std::string& dimension) {
  PageChart chart{title, caption, quantity, dimension, false, {}, {}, {}};
  for (const StateResult& s : analysis.states) chart.times.push_back(s.when.time);
  return chart;
}

/// A curve: a value per state.
template <class Get>
void add_curve(PageChart& chart, const Analysis& analysis, const std::string& name, Get get) {
  chart.names.push_back(name);
  chart.values.emplace_back();
  for (const StateResult& s : analysis.states) chart.values.back().push_back(get(s));
}

bool any_value(const PageChart& chart, bool (*counts)(double)) {
  return std::any_of(chart.values.begin(), chart.values.end(),
                     [&](const std::vector<double>& curve) { return std::any_of(curve.begin(), curve.end(), counts); });
}

void add_contact_charts(const Analysis& analysis, std::vector<PageChart>& charts) {
  const auto add = [&](const char* title, const char* caption, const char* quantity, const char* dimension, auto get) {
    PageChart chart = empty_chart(analysis, title, caption, quantity, dimension);
    for (std::size_t c = 0; c < analysis.joint.contacts.size(); ++c)
      add_curve(chart, analysis, analysis.joint.contacts[c].name,
                [&](const StateResult& s) { return get(s.statistics[c]); });
    charts.push_back(std::move(chart));
  };
  using S = const ContactStatistics&;
  add("Contact force", "Resultant of each contact.", "force", "force", [](S s) { return s.force.norm(); });
  add("99th percentile of pressure", kHeadlineCaption, "p99", "pressure", [](S s) { return s.headline.p99; });
  add("Mean pressure", kHeadlineCaption, "mean pressure", "pressure", [](S s) { return s.headline.mean; });
  add("Contact area", kHeadlineCaption, "contact area", "area", [](S s) { return s.headline.area; });
  add("Peak pressure", kHeadlineCaption, "peak pressure", "pressure", [](S s) { return s.headline.peak; });
}

/// Only where a body moves.
void add_body_charts(const Analysis& analysis, std::vector<PageChart>& charts) {
  const Joint& joint = analysis.joint;
  const auto add = [&](const char* title, const char* caption, const char* quantity, const char* dimension, auto get) {
    PageChart chart = empty_chart(analysis, title, caption, quantity, dimension);
    for (int b : reported_bodies(joint))
      add_curve(chart, analysis, joint.bodies[at(b)].name,
                [&](const StateResult& s) { return get(s.equilibrium.poses[at(b)], joint.bodies[at(b)]); });
    if (any_value(chart, [](double x) { return x != 0; })) charts.push_back(std::move(chart));
  };
  add("Motion of the bodies", "Distance of the centre of mass from its reference position.", "translation", "length",
      [](const Pose& pose, const Body& body) { return (pose.center - body.center_of_mass).norm(); });
  add("Rotation of the bodies", "Angle from the reference orientation.", "rotation", "degrees",
      [](const Pose& pose, const Body&) { return kDegreesPerRadian * Eigen::AngleAxisd(pose.rotation).angle(); });
}

void add_spring_chart(const Analysis& analysis, std::vector<PageChart>& charts) {
  const Joint& joint = analysis.joint;
  const std::vector<std::string> names = spring_names(joint);
  if (names.empty()) return;
  PageChart chart = empty_chart(analysis, "Ligaments and cables", "Tension.", "tension", "force");
  const auto value = [](const std::vector<double>& forces, std::size_t i) {
    return i < forces.size() ? forces[i] : kNaN;
  };
  for (std::size_t l = 0; l < joint.ligaments.size(); ++l)
    add_curve(chart, analysis, names[l], [&](const StateResult& s) { return value(s.equilibrium.ligament_force, l); });
  for (std::size_t c = 0; c < joint.cables.size(); ++c)
    add_curve(chart, analysis, names[joint.ligaments.size() + c],
              [&](const StateResult& s) { return value(s.equilibrium.cable_force, c); });
  charts.push_back(std::move(chart));
}

void add_balance_chart(const Analysis& analysis, std::vector<PageChart>& charts) {
  constexpr const char* kQuantity = "unbalanced force / load";
  PageChart chart = empty_chart(
      analysis, "Balance", "Force that is left unbalanced over the load; nothing where all motions are prescribed.",
      kQuantity, "");
  chart.logarithmic = true;
  add_curve(chart, analysis, kQuantity, [](const StateResult& s) {
    const double r = s.equilibrium.residual_force / s.equilibrium.load;
    return std::isfinite(r) && r > 0 ? r : kNaN;
  });
  if (any_value(chart, [](double x) { return !std::isnan(x); })) charts.push_back(std::move(chart));
}

}  // namespace

std::vector<PageChart> run_charts(const Analysis& analysis) {
  std::vector<PageChart> charts;
  add_contact_charts(analysis, charts);
  add_body_charts(analysis, charts);
  add_spring_chart(analysis, charts);
  add_balance_chart(analysis, charts);
  return charts;
}

}  // namespace dea
