// python/stages.h – what Python holds of each stage. Each keeps what it was made from alive, and never
// changes.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "io/tables/read_tables.h"
#include "src/run/analysis.h"
#include "src/run/prepared.h"
#include "views/data/run_json.h"

namespace dea::python {

/// A file as it was when it was read.
struct FileThen {
  std::string path;                     ///< absolute
  std::int64_t bytes = 0, written = 0;  ///< size, and time of the last change [ns]
};

/// A model that was read.
struct ReadModel {
  JointModel model;
  std::vector<FileThen> files;
  double seconds = 0.0;  ///< spent on it
};

/// Settings that were said together: keyword, key, text.
using SaidValues = std::vector<std::tuple<std::string, std::string, std::string>>;

/// Settings, and how they were said: enough to say them again.
struct SaidSettings {
  Settings settings;
  std::string file;                ///< settings file; empty: none
  std::vector<SaidValues> layers;  ///< over it, each over those before
  GivenTables tables;              ///< that `settings` name in place of files
};

struct Recognised {
  std::shared_ptr<const ReadModel> read;
  SaidSettings said;
  Settings given;           ///< the same with the rows of their tables
  Recognition recognition;  ///< its settings have the names that were found
};

struct Analysed {
  std::shared_ptr<const Recognised> recognised;
  Analysis analysis;
  std::vector<std::vector<SpringStates>> springs;  ///< per state that was kept, one per contact
  Timings timings;
};

struct PreparedJoint {
  std::shared_ptr<const Recognised> recognised;
  Prepared prepared;
  FieldMaps maps;
  std::optional<InsideMaps> inside;  ///< where the settings ask for it
};

/// A load case that was solved.
struct SolvedLoad {
  std::shared_ptr<const PreparedJoint> joint;
  StateResult state;
};

/// All contacts at given poses.
struct PressedJoint {
  std::shared_ptr<const PreparedJoint> joint;
  std::vector<Pose> poses;
  Pressed pressed;
};

/// UsageError: a load of the settings acts on a body that is not free to follow it at all. Whoever calls wants its
/// effect.
void refuse_idle_loads(const Recognition& recognition);

}  // namespace dea::python
