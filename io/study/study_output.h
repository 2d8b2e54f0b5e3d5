// io/study/study_output.h – a study's file, or one of several parts of it as it was said or as a cluster says: opened,
// gone on with, and filled with the cases it lacks.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/files/output.h"
#include "io/study/study_request.h"

namespace dea {

struct Shard {
  int number = 1, of = 1;
  bool automatic = false;  ///< as a cluster says
};

/// "I/N"; "auto": of Slurm's, Open MPI's or PMI's variables; "": the whole. Throws UsageError.
Shard shard_of(const std::string& text);

/// Where results go, as it was asked for.
struct StudyOutput {
  std::string option = "-o";      ///< how faults call `path`
  std::string path;               ///< of the whole study; a shard's is made from it
  std::vector<std::string> keep;  ///< "fields", "xplt"
  Shard shard;
  bool overwrite = false;         ///< begins anew
  bool again = false;             ///< solves cases that are no solution again
  std::vector<NamedPath> others;  ///< files that are written at the end
  std::string remedy;             ///< words: what to do where the file is another study's
};

/// A file that takes results; held against other processes for as long as it lives. The study outlives it.
struct OpenStudy {
  std::string path;  ///< of this shard
  std::unique_ptr<HeldOutputs> held;
  StudyOptions options;  ///< the study's, and what is kept
  std::unique_ptr<StudyWriter> writer;
  ShardCases cases;               ///< of this shard
  std::vector<std::size_t> todo;  ///< indices of the cases that are to be solved
};

/// Throws UsageError, WriteError; InputError: the file that is there is of another study.
OpenStudy open_study(const Study& study, const StudyOutput& output);

/// No name for a study's file: UsageError.
void check_study_name(const std::string& option, const std::string& path);

/// A case that ended, for whoever watches.
struct CaseEnd {
  std::size_t number = 0;
  CaseResult::Outcome outcome = CaseResult::Outcome::Refused;
  std::string message;
  double seconds = 0.0;
};

/// Solves open.todo into the file. Stopped: what was done is in it. `on_case`: after each case, by one thread at a
/// time.
void solve_study(const Study& study, OpenStudy& open, const std::function<void(const CaseEnd&)>& on_case);

}  // namespace dea
