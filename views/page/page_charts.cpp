// Curves over time on the page of a run.
#include <algorithm>
#include <cmath>
#include <string>

#include "src/base/numbers.h"
#include "views/page/page_data.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

constexpr const char* kHeadlineCaption = "Above the threshold, as in the table; of the surface with springs.";

struct Curve {
  std::string name;
  std::vector<double> values;  ///< per state; NaN: a gap
};

template <class Get>
Curve curve(const Analysis& analysis, const std::string& name, Get get) {
  Curve c{name, {}};
  for (const StateResult& s : analysis.states) c.values.push_back(get(s));
  return c;
}

bool any_value(const std::vector<Curve>& curves, bool (*counts)(double)) {
  return std::any_of(curves.begin(), curves.end(),
                     [&](const Curve& c) { return std::any_of(c.values.begin(), c.values.end(), counts); });
}

Json chart(const Analysis& analysis, const char* title, const char* caption, const char* quantity,
           const char* dimension, const std::vector<Curve>& curves, bool logarithmic = false) {
  return {{"title", title},
          {"caption", caption},
          {"quantity", quantity},
          {"dimension", dimension},
          {"logarithmic", logarithmic},
          {"times", list_json(analysis.states, [](const StateResult& s) { return time_json(s.when.time); })},
          {"names", list_json(curves, [](const Curve& c) { return c.name; })},
          {"values", list_json(curves, [](const Curve& c) { return list_json(c.values, short_number); })}};
}

void add_contact_charts(const Analysis& analysis, Json& charts) {
  const auto add = [&](const char* title, const char* caption, const char* quantity, const char* dimension, auto get) {
    std::vector<Curve> curves;
    for (std::size_t c = 0; c < analysis.joint.contacts.size(); ++c)
      curves.push_back(
          curve(analysis, analysis.joint.contacts[c].name, [&](const StateResult& s) { return get(s.statistics[c]); }));
    charts.push_back(chart(analysis, title, caption, quantity, dimension, curves));
  };
  using S = const ContactStatistics&;
  add("Contact force", "Resultant of each contact.", "force", "force", [](S s) { return s.force.norm(); });
  add("99th percentile of pressure", kHeadlineCaption, "p99", "pressure", [](S s) { return s.headline.p99; });
  add("Mean pressure", kHeadlineCaption, "mean pressure", "pressure", [](S s) { return s.headline.mean; });
  add("Contact area", kHeadlineCaption, "contact area", "area", [](S s) { return s.headline.area; });
  add("Peak pressure", kHeadlineCaption, "peak pressure", "pressure", [](S s) { return s.headline.peak; });
}

/// Only where a body moves.
void add_body_charts(const Analysis& analysis, Json& charts) {
  const Joint& joint = analysis.joint;
  const auto add = [&](const char* title, const char* caption, const char* quantity, const char* dimension, auto get) {
    std::vector<Curve> curves;
    for (int b : reported_bodies(joint))
      curves.push_back(curve(analysis, joint.bodies[at(b)].name, [&](const StateResult& s) {
        return get(s.equilibrium.poses[at(b)], joint.bodies[at(b)]);
      }));
    if (any_value(curves, [](double x) { return x != 0; }))
      charts.push_back(chart(analysis, title, caption, quantity, dimension, curves));
  };
  add("Motion of the bodies", "Distance of the centre of mass from its reference position.", "translation", "length",
      [](const Pose& pose, const Body& body) { return (pose.center - body.center_of_mass).norm(); });
  add("Rotation of the bodies", "Angle from the reference orientation.", "rotation", "degrees",
      [](const Pose& pose, const Body&) { return kDegreesPerRadian * Eigen::AngleAxisd(pose.rotation).angle(); });
}

void add_spring_chart(const Analysis& analysis, Json& charts) {
  const Joint& joint = analysis.joint;
  const std::vector<std::string> names = spring_names(joint);
  if (names.empty()) return;
  std::vector<Curve> curves;
  const auto add = [&](std::size_t i, std::size_t name, std::vector<double> Equilibrium::*forces) {
    curves.push_back(curve(analysis, names[name], [&](const StateResult& s) {
      const std::vector<double>& of = s.equilibrium.*forces;
      return i < of.size() ? of[i] : kNaN;
    }));
  };
  for (std::size_t l = 0; l < joint.ligaments.size(); ++l) add(l, l, &Equilibrium::ligament_force);
  for (std::size_t c = 0; c < joint.cables.size(); ++c) add(c, joint.ligaments.size() + c, &Equilibrium::cable_force);
  charts.push_back(chart(analysis, "Ligaments and cables", "Tension.", "tension", "force", curves));
}

void add_balance_chart(const Analysis& analysis, Json& charts) {
  constexpr const char* kQuantity = "unbalanced force / load";
  const Curve balance = curve(analysis, kQuantity, [](const StateResult& s) {
    const double r = s.equilibrium.residual_force / s.equilibrium.load;
    return std::isfinite(r) && r > 0 ? r : kNaN;
  });
  if (any_value({balance}, [](double x) { return !std::isnan(x); }))
    charts.push_back(chart(analysis, "Balance",
                           "Force that is left unbalanced over the load; nothing where all motions are prescribed.",
                           kQuantity, "", {balance}, true));
}

}  // namespace

Json run_charts(const Analysis& analysis) {
  Json charts = Json::array();
  add_contact_charts(analysis, charts);
  add_body_charts(analysis, charts);
  add_spring_chart(analysis, charts);
  add_balance_chart(analysis, charts);
  return charts;
}

}  // namespace dea
