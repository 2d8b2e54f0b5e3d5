// febiodea/views/study_shards.h – one of several parts of a study, as it was said or as a cluster says.
#pragma once
#include <string>

namespace dea {

struct Shard {
  int number = 1, of = 1;
};

/// "I/N"; "auto": of Slurm's, Open MPI's or PMI's variables; "": the whole. Throws UsageError.
Shard shard_of(const std::string& text);

/// "plan.db" as "plan.2-of-4.db".
std::string shard_path(const std::string& path, const Shard& shard);

}  // namespace dea
