// io/study/study_shards.h – one of several parts of a study, as it was said or as a cluster says.
#pragma once
#include <string>

namespace dea {

struct Shard {
  int number = 1, of = 1;
  bool automatic = false;  ///< as a cluster says
};

/// "I/N"; "auto": of Slurm's, Open MPI's or PMI's variables; "": the whole. Throws UsageError.
Shard shard_of(const std::string& text);

/// Beside `path` are shards of another number of parts alone: part of an array was submitted again, and would be
/// divided as if it were all. Throws UsageError; a shard that was said is left alone.
void refuse_other_division(const std::string& path, const Shard& shard);

/// "plan.db" as "plan.2-of-4.db".
std::string shard_path(const std::string& path, const Shard& shard);

}  // namespace dea
