// febiodea/app/study_plan.h – from the line of `dea study` to what is solved.
#pragma once
#include <string>
#include <vector>

#include <febiodea/app/commands.h>
#include <febiodea/app/progress.h>
#include <febiodea/io/files/output.h>
#include <febiodea/io/study/study_file.h>
#include <febiodea/study/plan.h>
#include <febiodea/views/run_study.h>

namespace dea {

/// Everything that is solved, and what it depends on.
struct Study {
  Plan plan;
  StudyIdentity identity;
  std::vector<NamedPath> inputs;
  StudyOptions options;
};

/// All of the line but its shard and what is kept. Whatever can be wrong with it is found here, before anything is
/// solved. Throws UsageError, InputError.
Study study_of(const StudyArguments& arguments, Progress& progress);

/// One of several parts of a study.
struct Shard {
  int number = 1, of = 1;
};

/// "I/N"; "auto": of Slurm's, Open MPI's or PMI's variables; "": the whole. Throws UsageError.
Shard shard_of(const std::string& text);

/// "plan.db" as "plan.2-of-4.db".
std::string shard_path(const std::string& path, const Shard& shard);

}  // namespace dea
