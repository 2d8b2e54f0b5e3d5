// made_study.h – files of studies with made-up results, through io/study: nothing is solved.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include <febiodea/base/numbers.h>
#include <febiodea/base/parse.h>
#include <febiodea/io/study/study_file.h>

namespace dea::test {

inline constexpr int kSide = 15;  // nodes of the surface along an edge

/// A shallow socket over a square.
inline CaseSurface surface() {
  CaseSurface s;
  s.name = "socket";
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double x = 20.0 * (2.0 * i / (kSide - 1) - 1), y = 20.0 * (2.0 * j / (kSide - 1) - 1);
      s.vertices.emplace_back(x, y, -std::sqrt(35.0 * 35.0 - x * x - y * y));
    }
  for (int i = 0; i + 1 < kSide; ++i)
    for (int j = 0; j + 1 < kSide; ++j) {
      const int a = i * kSide + j, b = a + kSide;
      s.triangles.push_back({a, b, b + 1});
      s.triangles.push_back({a, b + 1, a + 1});
    }
  return s;
}

/// A hill of height p about (x, y), 0 beyond 12 from it.
inline CaseField hill(const CaseSurface& s, double p, double x, double y) {
  CaseField f;
  for (const Vector3d& v : s.vertices)
    f.pressure.push_back(static_cast<float>(std::max(0.0, p * (1 - std::hypot(v[0] - x, v[1] - y) / 12))));
  return f;
}

inline ContactStatistics numbers(double p) {
  ContactStatistics c;
  c.headline = {0.1, p, 0.5 * p, 300 + 10 * p, 1.2 * p};
  c.force = {0, 0, 150 * p};
  c.facet_contact_area = 400;
  return c;
}

inline CaseState state(double time, double p) {
  CaseState s;
  s.time = time;
  s.outcome = Outcome::Balanced;
  s.statistics = {numbers(p)};
  return s;
}

inline CaseResult solved(std::size_t number, const std::string& contact) {
  CaseResult r;
  r.number = number;
  r.outcome = CaseResult::Outcome::Solved;
  r.contacts = {{contact, "pelvis", "femur", {}}};
  r.seconds = 0.1;
  return r;
}

inline Plan grid(const std::vector<std::string>& factors) {
  PlanRequest request;
  request.models = {"hip.feb"};
  for (const std::string& f : factors) {
    request.factors.push_back(parse_factor(f));
    request.options.push_back({request.factors.back().option, "", static_cast<int>(request.factors.size()) - 1});
  }
  return make_plan(std::move(request));
}

inline void write_grid(const std::string& path, const Plan& plan, bool fields) {
  const StudyIdentity identity{"0.1 (made up)", {"--vary ..."}, {{"hip.feb", "crc32:1:2"}}, 1, 1};
  StudyWriter writer(path, plan, identity);
  const CaseSurface on = surface();
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    CaseResult r = solved(i + 1, "hip");
    const double a = parse_number(plan.cases[i].values[0]), b = parse_number(plan.cases[i].values[1]);
    const double c = parse_number(plan.cases[i].values[2]);
    for (int k = 0; k < 13; ++k) {
      const double p = (4 + 0.01 * a * a + 0.05 * b + 0.1 * c) * (1 + std::sin(kPi * k / 12));
      r.states.push_back(state(k / 12.0, p));
      if (fields) r.states.back().fields = {hill(on, p, 0.5 * a, 0.4 * b)};
    }
    if (fields && i == 0) r.surfaces = {on};
    writer.add(std::move(r));
  }
  writer.finish();
}

/// Four cases of each of two models; the last ones failed and refused.
inline void write_awkward(const std::string& path) {
  const std::string bad = "</script><b>&\"'\xc3\xa9\xff<img src=x onerror=alert(1)>";
  Plan plan;
  plan.models = {"/a/" + bad + ".feb", "/b/two.feb"};
  Factor tilt = parse_factor("tilt: rotate pelvis=0,1,0,{0|1|2}"), law = parse_factor("law: law={linear|layer}");
  tilt.name = bad;
  law.name = "__proto__";
  law.values = {"</script><i>x</i>", "constructor"};
  plan.factors = {tilt, law};
  for (int m = 0; m < 2; ++m)
    for (const std::string& a : tilt.values)
      for (const std::string& b : law.values) plan.cases.push_back({m, {a, b}});
  StudyWriter writer(path, plan, {bad, {"--vary " + bad}, {{plan.models[0], bad}}, 1, 1});
  const CaseSurface on = surface();
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    CaseResult r = solved(i + 1, bad);
    r.contacts[0].parts = {bad, "back"};
    r.warnings = {bad + fmt::format(" at {}", i)};
    for (int k = 0; k < 3; ++k) {
      r.states.push_back(state(k, 3.0 + static_cast<double>(i)));
      r.states.back().statistics[0].compartments.resize(2);
      r.states.back().fields = {hill(on, 3.0 + static_cast<double>(i), 0, 2.0 * k)};
    }
    if (i % 6 == 0) r.surfaces = {on};
    if (i == 10) {
      r.outcome = CaseResult::Outcome::Failed;
      r.message = bad;
      r.states.back().outcome = Outcome::NotConverged;
      r.states.back().statistics[0] = numbers(1e6);  // what no figure may show
    }
    if (i == 11) r = {};
    if (i == 11) {
      r.number = 12;
      r.message = bad;
    }
    writer.add(std::move(r));
  }
  writer.finish();
}

/// Ishigami and Homma 1990: a = 7, b = 0.1.
inline void write_sample(const std::string& path) {
  PlanRequest request;
  request.models = {"hip.feb"};
  for (int i = 0; i < 3; ++i) {
    request.factors.push_back(
        parse_factor(fmt::format("x{}: E={{uniform(-3.141592653589793,3.141592653589793)}}", i + 1)));
    request.options.push_back({"E", "", i});
  }
  request.sampling = Sampling{Design::Saltelli, 512, 1};
  const Plan plan = make_plan(std::move(request));
  StudyWriter writer(path, plan, {"0.1 (made up)", {"--sample saltelli", "--count 512"}, {}, 1, 1});
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    double x[3];
    for (std::size_t k = 0; k < 3; ++k) x[k] = parse_number(plan.cases[i].values[k]);
    CaseResult r = solved(i + 1, "hip");
    r.states = {state(1, std::sin(x[0]) + 7 * std::pow(std::sin(x[1]), 2) + 0.1 * std::pow(x[2], 4) * std::sin(x[0]))};
    writer.add(std::move(r));
  }
  writer.finish();
}

}  // namespace dea::test
