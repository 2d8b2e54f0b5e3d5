#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "io/study/read_study.h"
#include "io/study/ready_joints.h"
#include "io/study/study_output.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/plain.h"
#include "python/work.h"
#include "src/base/error.h"

namespace dea::python {

namespace {

constexpr std::chrono::milliseconds kGrace{60000};  // what is done is written before Ctrl-C is answered

/// A study that Python holds, and the joints that are ready for its cases.
struct PlannedStudy {
  Study study;
  ReadyJoints joints;
  explicit PlannedStudy(Study s) : study(std::move(s)), joints(study.options.memory) {}
};
using Planned = std::shared_ptr<PlannedStudy>;

using Pairs = std::vector<std::pair<std::string, std::string>>;

/// As febiodea/_study.py has it: models, options, table of cases (names, rows) or None; texts: cases, sample, count,
/// seed, states, settings.
StudyRequest request_of(const std::vector<std::string>& models, const Pairs& options, const std::optional<Cells>& table,
                        const std::array<std::string, 6>& texts) {
  StudyRequest r;
  r.models = models;
  for (const auto& option : options) r.options.push_back({option.first, option.second});
  if (table) r.table = table_of(*table, "cases");
  r.cases = texts[0];
  r.sample = texts[1];
  r.count = texts[2];
  r.seed = texts[3];
  r.states = texts[4];
  r.settings_file = texts[5];
  return r;
}

/// Version, options, inputs: what other processes compare with.
using Identity = std::tuple<std::string, std::vector<std::string>, std::vector<std::array<std::string, 2>>>;

Identity identity_of(const PlannedStudy& planned) {
  const StudyIdentity& i = planned.study.identity;
  return {i.version, i.options, i.inputs};
}

/// `identity`: of a study that another process has begun; nothing: this one does. `memory`: bytes for joints that are
/// ready; 0: half of what is free.
Planned planned_study(const std::vector<std::string>& models, const Pairs& options, const std::optional<Cells>& table,
                      const std::array<std::string, 6>& texts, const std::optional<Identity>& identity, double memory) {
  const StudyRequest request = request_of(models, options, table, texts);
  return result_of([request, identity, memory](Work&) {
    Study study = plan_study(request);
    if (identity)
      take_identity(study, {std::get<0>(*identity), std::get<1>(*identity), std::get<2>(*identity), 1, 1});
    else
      take_digests(study);
    if (memory > 0) study.options.memory = memory;
    return std::make_shared<PlannedStudy>(std::move(study));
  });
}

/// A study's file that is being filled.
struct FilledStudy {
  Planned planned;
  OpenStudy open;
  std::atomic<bool> at_work = false;  ///< some thread solves into it
  FilledStudy(Planned p, OpenStudy o) : planned(std::move(p)), open(std::move(o)) {}
};
using Filled = std::shared_ptr<FilledStudy>;

Filled open_file(const Planned& planned, const std::string& path, const std::vector<std::string>& keep,
                 const std::string& shard, bool overwrite, bool again) {
  StudyOutput output;
  output.option = "path";
  output.path = path;
  output.keep = keep;
  output.shard = shard_of(shard);
  output.overwrite = overwrite;
  output.again = again;
  output.remedy = "overwrite=True begins anew, another path makes another file";
  return result_of(
      [planned, output](Work&) { return std::make_shared<FilledStudy>(planned, open_study(planned->study, output)); });
}

Progress case_progress(std::size_t done, std::size_t total, const std::string& outcome) {
  return {.stage = "case", .state = done, .states = total, .outcome = outcome};
}

/// Gives the file free, whoever still holds the object; a thread that was left to itself gives it free at its end.
void close_file(FilledStudy& file) {
  if (file.at_work) return;
  file.open.writer.reset();
  file.open.held.reset();
}

/// All that the file lacks, by this process.
void solve_here(const Filled& filled, int workers, const py::object& progress) {
  filled->at_work = true;
  run_work(
      [filled, workers](Work& work) {
        const std::shared_ptr<void> until_the_end(nullptr, [&](void*) { filled->at_work = false; });
        OpenStudy& open = filled->open;
        open.options.stop = &work.stop;
        if (workers > 0) open.options.workers = workers;
        const std::size_t total = open.cases.last - open.cases.first;
        std::size_t done = total - open.todo.size();
        solve_study(filled->planned->study, open,
                    [&](const CaseEnd& end) { work.tell(case_progress(++done, total, name(end.outcome))); });
      },
      progress, kGrace);
}

/// Some cases solved for somebody else's file.
struct Batch {
  std::string packed;
  std::vector<std::string> outcomes;
  std::vector<double> seconds;
};

std::shared_ptr<Batch> solved_batch(const PlannedStudy& planned, ReadyJoints& joints, bool keep_fields,
                                    const std::vector<std::size_t>& cases, Work& work) {
  const auto batch = std::make_shared<Batch>();
  StudyWriter writer(kInMemory, planned.study.plan, planned.study.identity);
  StudyOptions options = planned.study.options;
  options.workers = 1;
  options.keep_fields = keep_fields;
  options.joints = &joints;
  options.stop = &work.stop;
  options.done = [&](CaseResult&& result) {
    batch->outcomes.emplace_back(name(result.outcome));
    batch->seconds.push_back(result.seconds);
    writer.add(std::move(result));
  };
  run_study(planned.study.plan, cases, options);
  writer.finish();
  batch->packed = writer.packed();
  return batch;
}

py::tuple solve_batch(const Planned& planned, bool keep_fields, const std::vector<std::size_t>& cases) {
  for (const std::size_t i : cases)
    if (i >= planned->study.plan.cases.size()) throw UsageError("found a case that the study has not");
  const auto batch = result_of([planned, keep_fields, cases](Work& work) {
    return solved_batch(*planned, planned->joints, keep_fields, cases, work);
  });
  return py::make_tuple(py::bytes(batch->packed), batch->outcomes, batch->seconds);
}

py::tuple case_of(const PlannedStudy& planned, std::size_t index) {
  const PlannedCase& c = planned.study.plan.cases.at(index);
  return py::make_tuple(text(planned.study.plan.models[at(c.model)]), texts(c.values));
}

py::list factor_names(const std::vector<Factor>& factors) {
  std::vector<std::string> names;
  for (const Factor& f : factors) names.push_back(f.name);
  return texts(names);
}

py::tuple head_of(const std::string& path) {
  const StudyHead head = unlocked([&] { return read_study_head(path); });
  py::list inputs;
  for (const auto& input : head.identity.inputs) inputs.append(py::make_tuple(text(input[0]), text(input[1])));
  return py::make_tuple(text(head.identity.version), texts(head.identity.options), inputs, texts(head.models),
                        factor_names(head.factors), head.planned, head.identity.shard, head.identity.shards);
}

}  // namespace

CaseTable table_of(const Cells& cells, const char* name) {
  std::vector<int> lines(cells.second.size());
  std::iota(lines.begin(), lines.end(), 1);
  return {name, 0, cells.first, cells.second, lines};
}

void bind_study(py::module_& m) {
  py::class_<PlannedStudy, Planned>(m, "PlannedStudy")
      .def("__len__", [](const PlannedStudy& p) { return p.study.plan.cases.size(); })
      .def_property_readonly("factors", [](const PlannedStudy& p) { return factor_names(p.study.plan.factors); })
      .def_property_readonly("models", [](const PlannedStudy& p) { return texts(p.study.plan.models); })
      .def_property_readonly("identity", &identity_of)
      .def("case", &case_of)
      .def("solve", &solve_batch);
  py::class_<FilledStudy, Filled>(m, "FilledStudy")
      .def_property_readonly("path", [](const FilledStudy& f) { return py::bytes(f.open.path); })
      .def_property_readonly("count", [](const FilledStudy& f) { return f.open.cases.last - f.open.cases.first; })
      .def_property_readonly("todo", [](const FilledStudy& f) { return f.open.todo; })
      .def("solve", &solve_here)
      .def("add",
           [](const Filled& f, std::string packed) { unlocked([&] { f->open.writer->add(std::move(packed)); }); })
      .def("finish", [](const Filled& f) { unlocked([&] { f->open.writer->finish(); }); })
      .def("close", &close_file);
  m.def("plan_study", &planned_study);
  m.def("open_study", &open_file);
  m.def("study_head", &head_of);
  m.def("case_progress", &case_progress);
}

}  // namespace dea::python
