// made_study.h – files of studies with made-up results, through io/study: nothing is solved.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "io/study/study_file.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"

namespace dea::test {

inline constexpr int kSide = 15;  // nodes of the surface along an edge

/// A shallow socket over a square: part of a sphere about the origin, `side` nodes along an edge.
inline CaseSurface surface(int side = kSide, double radius = 35.0) {
  CaseSurface s;
  s.name = "socket";
  const double half = 20.0 / 35.0 * radius;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double x = half * (2.0 * i / (side - 1) - 1), y = half * (2.0 * j / (side - 1) - 1);
      s.vertices.emplace_back(x, y, -std::sqrt(radius * radius - x * x - y * y));
    }
  for (int i = 0; i + 1 < side; ++i)
    for (int j = 0; j + 1 < side; ++j) {
      const int a = i * side + j, b = a + side;
      s.triangles.push_back({a, b, b + 1});
      s.triangles.push_back({a, b + 1, a + 1});
    }
  return s;
}

/// A hill of height p about (x, y), 0 beyond 12 from it.
inline std::vector<float> hill(const CaseSurface& s, double p, double x, double y) {
  std::vector<float> f;
  for (const Vector3d& v : s.vertices)
    f.push_back(static_cast<float>(std::max(0.0, p * (1 - std::hypot(v[0] - x, v[1] - y) / 12))));
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
    r.warnings = {{"passed-through", {.contact = bad, .time = static_cast<double>(i)}}};
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

inline constexpr int kSubjects = 6;
/// p99 of subject k (from 1), before and after.
inline double before(int k) { return 10.0 + k; }
inline double after(int k) { return 8.0 + 1.5 * k; }
/// Two models of each of some subjects, whose files have the same name in two folders, on meshes of their own; with
/// numbers of the inside of the source's layer. Pressure at a node is p99 times 1 + x / radius.
inline void write_subjects(const std::string& path) {
  Plan plan;
  for (const char* stage : {"before", "after"})
    for (int k = 1; k <= kSubjects; ++k) {
      plan.cases.push_back({static_cast<int>(plan.models.size()), {}});
      plan.models.push_back(fmt::format("/data/{}/S{}.feb", stage, k));
    }
  StudyIdentity identity{"0.1 (made up)", {"--inside"}, {}, 1, 1};
  identity.inside = true;
  StudyWriter writer(path, plan, identity);
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    const int k = static_cast<int>(i) % kSubjects + 1;
    const double p = i < kSubjects ? before(k) : after(k), radius = 30.0 + k;
    CaseResult r = solved(i + 1, "hip");
    r.surfaces = {surface(kSide + k, radius)};
    for (int state_number = 1; state_number <= 2; ++state_number) {
      r.states.push_back(state(state_number - 1, p * state_number / 2));
      std::vector<float> field;
      for (const Vector3d& v : r.surfaces[0].vertices)
        field.push_back(static_cast<float>(p * state_number / 2 * (1 + v[0] / radius)));
      r.states.back().fields = {field};
      InsideEnds inside;
      inside.bone.max_shear.p99 = 0.3 * p * state_number / 2;
      inside.bone.third_strain.p99 = -0.01 * p * state_number;
      r.states.back().statistics[0].inside[0] = inside;
    }
    writer.add(std::move(r));
  }
  writer.finish();
}
/// What is told of them: those of even number are women.
inline std::string subjects_table() {
  std::string text = "model,subject,sex,stage,angle\n";
  for (const char* stage : {"before", "after"})
    for (int k = 1; k <= kSubjects; ++k)
      text += fmt::format("{0}/S{1}.feb,S{1},{2},{0},{3}\n", stage, k, k % 2 == 0 ? "F" : "M",
                          20 + k + (stage[0] == 'a' ? 10 : 0));
  return text;
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
