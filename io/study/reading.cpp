#include "io/study/reading.h"

#include <cstdint>

#include "io/study/study_schema.h"

namespace dea {

namespace {

std::int64_t one_number(const Database& d, const std::string& sql) {
  Statement statement(d, sql);
  return statement.step() ? statement.integer(0) : 0;
}

}  // namespace

void check_study(const Database& d) {
  if (one_number(d, "PRAGMA application_id") != kStudyApplication)
    throw InputError(fmt::format(
        "{}: found a database of another program, expected a study's file (dea study -o FILE.db)", d.path()));
  const std::int64_t version = one_number(d, "PRAGMA user_version");
  if (version != kStudyVersion)
    throw InputError(fmt::format("{}: found dea.study/{}, expected dea.study/{}: the program that made it reads it",
                                 d.path(), version, kStudyVersion));
}

}  // namespace dea
