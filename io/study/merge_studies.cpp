// Shards become one file.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "io/files/output.h"
#include "io/files/system.h"
#include "io/study/read_study.h"
#include "io/study/study_schema.h"
#include "src/base/error.h"

namespace dea {

namespace {

/// The same study but for the shard; and no shard twice.
void check_heads(const std::vector<StudyHead>& heads) {
  std::map<int, std::string> shards;
  for (const StudyHead& head : heads) {
    StudyIdentity first = heads.front().identity;
    first.shard = head.identity.shard;
    const std::string difference = study_difference(head, first);
    if (!difference.empty())
      throw InputError(fmt::format("{}: is of another study than {}: {}", head.path, heads.front().path, difference));
    const auto [other, is_new] = shards.insert({head.identity.shard, head.path});
    if (!is_new)
      throw InputError(fmt::format("{}: is shard {} of {}, as {} is; expected each shard once", head.path,
                                   head.identity.shard, head.identity.shards, other->second));
  }
}

void copy_all(const std::vector<StudyHead>& heads, Database& to) {
  to.execute("BEGIN IMMEDIATE");
  make_study_tables(to, heads.front().factors, heads.front().identity.inside);
  for (const StudyHead& head : heads) {
    Database from(head.path, Database::For::Reading);
    from.execute("BEGIN");  // one state of it, though somebody may be writing
    for (const std::string& table : study_tables(to))
      if (&head == &heads.front() || !describes_study(table)) copy_table(from, to, table);
  }
  to.execute("UPDATE study SET value = '1' WHERE key IN ('shard', 'shards'); COMMIT");
}

/// Numbers from 1 to `last` that `next` (rising; 0: no more) leaves out: "120, 340-399".
template <class Next>
std::string missing_numbers(std::size_t last, Next next) {
  std::string text;
  std::size_t expected = 1;
  for (;;) {
    const std::size_t number = next(), found = number == 0 ? last + 1 : number;
    if (found > expected)
      text += (text.empty() ? "" : ", ") +
              (found - expected == 1 ? std::to_string(expected) : fmt::format("{}-{}", expected, found - 1));
    expected = found + 1;
    if (number == 0) break;
  }
  constexpr std::size_t kMost = 200;
  if (text.size() > kMost) text = text.substr(0, text.rfind(',', kMost)) + ", ...";
  return text;
}

std::string missing_cases(const std::string& path, std::size_t planned) {
  const Database d(path, Database::For::Reading);
  Statement rows(d, "SELECT case_id FROM cases ORDER BY case_id");
  return missing_numbers(planned, [&] { return rows.step() ? static_cast<std::size_t>(rows.integer(0)) : 0; });
}

std::string missing_shards(const std::vector<StudyHead>& heads) {
  std::size_t next = 0;
  return missing_numbers(static_cast<std::size_t>(heads.front().identity.shards), [&] {
    return next < heads.size() ? static_cast<std::size_t>(heads[next++].identity.shard) : 0;
  });
}

}  // namespace

MergedStudies merge_studies(const std::vector<std::string>& paths, const std::string& output) {
  std::vector<StudyHead> heads;
  for (const std::string& path : paths) heads.push_back(read_study_head(path));
  check_heads(heads);
  std::sort(heads.begin(), heads.end(),
            [](const StudyHead& a, const StudyHead& b) { return a.identity.shard < b.identity.shard; });
  // the old file goes when the new one is whole
  const std::string part = output + ".part";
  std::error_code error;
  std::filesystem::remove(part, error);
  try {
    {
      Database to(part, Database::For::Writing);
      copy_all(heads, to);
    }
    std::filesystem::remove(output + "-journal", error);
    if (const int why = replace_file(part, output)) cannot_write(output, why);
  } catch (const std::exception& fault) {
    for (const char* end : {"", "-journal"}) std::filesystem::remove(part + end, error);
    if (dynamic_cast<const DatabaseBusy*>(&fault) != nullptr)
      throw InputError(fmt::format("{}; try again when it has ended", fault.what()));
    throw;
  }
  const StudyCounts counts = count_cases(output);
  return {counts.all(), counts.failed + counts.refused, missing_cases(output, heads.front().planned),
          missing_shards(heads)};
}

}  // namespace dea
