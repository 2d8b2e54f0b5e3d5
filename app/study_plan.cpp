#include "app/study_plan.h"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "app/interrupt.h"

namespace dea {

namespace {

/// Names and texts in the order of the line.
std::vector<CaseOption> options_of_line(const SettingsArguments& given) {
  std::vector<CaseOption> options;
  std::map<std::string, std::size_t> seen;
  for (const std::string& name : given.order) {
    const std::vector<std::string>& texts = given.values.at(name);
    const std::size_t i = seen[name]++;
    if (i < texts.size()) options.push_back({name, texts[i]});
  }
  return options;
}

}  // namespace

Study study_of(const StudyArguments& a, Progress& progress) {
  StudyRequest request;
  request.models = a.files;
  request.options = options_of_line(a.settings);
  request.cases = a.cases;
  request.sample = a.sample;
  request.count = a.count;
  request.seed = a.seed;
  request.states = a.states;
  request.settings_file = a.settings.file;
  Study study = plan_study(request);
  if (!a.threads.empty()) study.options.workers = count_argument("threads", a.threads, 1, 1024);
  study.options.stop = stop_flag();
  const std::size_t models = study.plan.models.size();
  progress.now(models == 1 ? "reading the model" : fmt::format("reading {} models", models), "", "");
  take_digests(study);
  return study;
}

}  // namespace dea
