// febiodea/io/study/study_file.h – a study's results in one SQLite file (docs/studies.md says what is in it).
#pragma once
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <febiodea/study/case.h>
#include <febiodea/study/plan.h>

namespace dea {

/// What makes two runs the same study.
struct StudyIdentity {
  std::string version;                        ///< of the program, with its commit
  std::vector<std::string> options;           ///< what the cases depend on, one text each, as the user would write it
  std::vector<std::array<std::string, 2>> inputs;  ///< path as given, digest of its content
  int shard = 1, shards = 1;
};

class StudyFile;  // see the functions below; closes its file at its end
