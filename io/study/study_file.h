// io/study/study_file.h – a study's results in one SQLite file (docs/studies.md says what is in it).
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/study/database.h"
#include "src/study/case.h"
#include "src/study/plan.h"

namespace dea {

/// What makes two runs the same study.
struct StudyIdentity {
  std::string version;               ///< of the program, with its commit
  std::vector<std::string> options;  ///< what the cases depend on, one text each, as the user would write it
  std::vector<std::array<std::string, 2>> inputs;  ///< path as given, digest of its content
  int shard = 1, shards = 1;
  bool inside = false;  ///< some case has the inside of its layers: results have its columns
};

/// The cases of one shard: `first` .. `last` - 1, indices in plan.cases. Neighbours stay together, for they share the
/// work on their joint.
struct ShardCases {
  std::size_t first = 0, last = 0;
};
ShardCases shard_cases(std::size_t cases, int shard, int shards);

/// "solved", "failed", "refused".
const char* name(CaseResult::Outcome outcome);
CaseResult::Outcome outcome_of(const std::string& word);

/// Size and CRC-32 of a file's bytes: they notice a file that was edited, which is all that is asked of them (nobody
/// forges the inputs of a study), and zlib is linked anyway. Throws InputError.
std::string file_digest(const std::string& path);

/// The same of bytes in memory.
std::string bytes_digest(const std::string& bytes);

/// Is there a file, with something in it?
bool has_content(const std::string& path);

/// Where a study's writer keeps its results for somebody else's file: nowhere on disk.
inline constexpr const char* kInMemory = ":memory:";

/// Per case of a plan: what a file has of it; none: it lacks the case.
using CasesThere = std::vector<std::optional<CaseResult::Outcome>>;

struct StudyInserts;

/// Writes the results of cases as they come. Each is in the file whole or not at all.
class StudyWriter {
 public:
  /// Goes on with a file that is there (study_difference has found none), else makes it. `plan` outlives the writer.
  /// Throws WriteError, InputError.
  StudyWriter(const std::string& path, const Plan& plan, const StudyIdentity& identity);
  ~StudyWriter();
  StudyWriter(StudyWriter&&) = delete;

  /// Called before each time of writing; what it throws ends the writing, and what waited is not written. May be empty.
  std::function<void()> before_writing;

  const CasesThere& there() const { return there_; }
  /// Takes a result; one that the file has of this case is replaced. Results are written together, every half second.
  /// Throws WriteError: what was written before stays.
  void add(CaseResult&& result);
  /// The same of all cases in another writer's packed(), of the same plan.
  void add(std::string&& packed);
  /// Writes what is left. To be called at the end, also of a study that was stopped.
  void finish();
  /// All that a writer kInMemory has taken, as bytes for another process: a small study's file as a zlib stream. After
  /// finish.
  std::string packed() const;

 private:
  static constexpr double kBatch = 0.5;  // between two times of writing [s]
  void write_if_due();
  bool write();  // all that waits, at once; false: another program reads the file
  void insert(const CaseResult& result);
  void insert(const Database& batch);
  void take_back();
  void wait_or_fail();

  Database database_;
  const Plan& plan_;
  std::unique_ptr<StudyInserts> inserts_;
  CasesThere there_;
  std::vector<CaseResult> waiting_;
  std::vector<std::unique_ptr<Database>> batches_;  // that wait
  double written_ = 0.0;                            // when something was written last [s]
  double pause_ = kBatch;    // until the next time: where writing is slow, it shall not take most of the time [s]
  double busy_since_ = 0.0;  // when somebody began to keep us from it; 0: nobody does
};

/// A new file with all that these files hold. What none of them has: cases as ranges, "120, 340-399", and shards;
/// empty: nothing. Throws InputError: they are not of one study, or two have the same case; WriteError.
struct MergedStudies {
  std::size_t cases = 0, failed = 0;  ///< in the new file; failed: also those that were refused
  std::string missing, missing_shards;
};
MergedStudies merge_studies(const std::vector<std::string>& paths, const std::string& output);

}  // namespace dea
