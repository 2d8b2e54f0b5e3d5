#include "io/study/study_shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "io/study/study_request.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/say.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

/// A whole number that the environment has; -1: none.
int environment_number(const char* name) {
  const char* text = std::getenv(name);
  try {
    return text == nullptr ? -1 : parse_count(text, 0, std::numeric_limits<int>::max());
  } catch (const BadValue& bad) {
    throw UsageError(Fault{.given = said("shard", "auto"), .found = fmt::format("{}: {}", name, bad.what())});
  }
}

/// One task among several; none of these variables: {1, 1}.
Shard task_of_environment() {
  // SLURM_PROCID is there outside of srun too; the number of tasks of a step is not
  for (const auto& [rank, size] :
       {std::pair("SLURM_PROCID", "SLURM_STEP_NUM_TASKS"), std::pair("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
        std::pair("PMI_RANK", "PMI_SIZE")}) {
    const int i = environment_number(rank), n = environment_number(size);
    if (i >= 0 && n > 1 && i < n) return {i + 1, n, true};
  }
  return {};
}

Shard automatic_shard() {
  const Shard task = task_of_environment();
  const int id = environment_number("SLURM_ARRAY_TASK_ID"), first = environment_number("SLURM_ARRAY_TASK_MIN"),
            last = environment_number("SLURM_ARRAY_TASK_MAX"), given = environment_number("SLURM_ARRAY_TASK_STEP"),
            step = std::max(1, given);
  if (id < 0 && task.of == 1)
    throw UsageError(Fault{.given = said("shard", "auto"),
                           .found = "found none of SLURM_ARRAY_TASK_ID, SLURM_PROCID with SLURM_STEP_NUM_TASKS (srun), "
                                    "OMPI_COMM_WORLD_RANK, PMI_RANK with their sizes,",
                           .expected = say("expected {}", NamedSetting{"shard", "", "I/N"})});
  if (id < 0) return task;
  const int count = environment_number("SLURM_ARRAY_TASK_COUNT"), place = (id - std::max(0, first)) / step;
  // A task that is submitted again by itself is an array of one, which would be the whole study.
  const bool alone = count == 1 && id > 1;
  if (first < 0 || last < id || id < first || (id - first) % step != 0 || count != (last - first) / step + 1 || alone)
    throw UsageError(Fault{
        .given = said("shard", "auto"),
        .found = fmt::format("found task {} of Slurm's array of {} from {} to {},", id, count, first, last),
        .expected = say("expected an array without gaps, or the shard itself: {}", NamedSetting{"shard", "", "I/N"})});
  return {place * task.of + task.number, count * task.of, true};
}

}  // namespace

Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  if (lower_case(text) == "auto") return automatic_shard();
  const std::size_t slash = text.find('/');
  return parsed("shard", text, [&](const std::string&) {
    if (slash == text.npos) throw bad_value(text, "I/N, such as 2/4, or auto", {"auto"});
    const int of = parse_count(text.substr(slash + 1), 1, 1'000'000);
    return Shard{parse_count(text.substr(0, slash), 1, of), of};
  });
}

namespace {
/// M of a file named as shard N of M of `path` would be, as NAME.N-of-M.EXTENSION; empty: it is none.
std::string division_in(const std::string& file, const fs::path& path) {
  const std::string before = path.stem().string() + ".", after = path.extension().string(), between = "-of-";
  if (file.size() < before.size() + after.size() || !file.starts_with(before) || !file.ends_with(after)) return "";
  const std::string numbers = file.substr(before.size(), file.size() - before.size() - after.size());
  const std::size_t at = numbers.find(between);
  if (at == numbers.npos) return "";
  const auto digits = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
  };
  const std::string number = numbers.substr(0, at), of = numbers.substr(at + between.size());
  return digits(number) && digits(of) ? of : "";
}
}  // namespace

void refuse_other_division(const std::string& path, const Shard& shard) {
  if (!shard.automatic) return;
  const fs::path p = path, folder = p.has_parent_path() ? p.parent_path() : fs::path(".");
  std::error_code error;
  std::string found, division;
  for (const fs::directory_entry& file : fs::directory_iterator(folder, error)) {
    const std::string there = file.path().filename().string();
    const std::string of = division_in(there, p);
    if (of.empty()) continue;
    if (of == std::to_string(shard.of)) return;
    if (found.empty() || there < found) {
      found = there;
      division = of;
    }
  }
  if (!found.empty())
    throw UsageError(
        Fault{.given = said("shard", "auto"),
              .found = fmt::format("found {}, one of {} shards, where this is one of {},", found, division, shard.of),
              .expected = say("expected the shard of that division: {}, or another name",
                              NamedSetting{"shard", "", "I/" + division})});
}

std::string shard_path(const std::string& path, const Shard& shard) {
  if (shard.of == 1) return path;
  const fs::path p = path;
  return (p.parent_path() /
          fmt::format("{}.{}-of-{}{}", p.stem().string(), shard.number, shard.of, p.extension().string()))
      .string();
}

}  // namespace dea
