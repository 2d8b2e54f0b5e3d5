// views/live/live_joint.h – a joint in the hand: recognised and factorised once, it answers for poses, loads and
// cartilage that change from moment to moment.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "io/settings/output_options.h"
#include "io/study/ready_joints.h"
#include "src/model/settings.h"
#include "src/results/comparison.h"
#include "views/data/json.h"
#include "views/map/map_geometry.h"

namespace dea {

/// A case as `dea run` has it, of which the last state is wanted.
struct LiveRequest {
  std::string model;  ///< path
  Settings settings;
  OutputSettings outputs;  ///< `states` alone counts
  bool quick = false;      ///< while the hand moves: balanced to a thousandth of the load
  /// `bodies` of an earlier answer, from where the balance is searched, and without states on the way that nothing
  /// counts from; null: as `dea run` does.
  Json from;
};

struct LiveAnswer {
  /// "dea.live/1": `quick`; `state`, as run_json has it; `bodies`: name, rotation (three rows) and center, a point x of
  /// the reference is at rotation (x - reference center) + center; `surfaces`, each once: name, body, edge (the level
  /// of nodal averages where contact ends, null: there is none), and where its facets' pressures stand in `pressure`;
  /// `findings`.
  Json text;
  std::vector<float> pressure;  ///< of facets, in the order of the model's surfaces
};

/// Joints that stay ready between answers.
struct LiveJoint {
  ReadyJoints joints{kBytes};
  /// Where the search for pressures of the last quick answer ended, and of which joint: model and joint_key.
  std::vector<PressMemory> memory;
  std::string memory_key;
  /// Surfaces as maps draw them, of one model, by their names.
  struct Drawn {
    ResultSurface surface;
    MapMesh map;
  };
  std::string drawn_model;
  std::map<std::string, Drawn> drawn;
  static constexpr double kBytes = 3e8;
};

/// An answer that is not quick and from nowhere has the numbers of `dea run` of the same settings, by the same search
/// from the same start. Throws UsageError and InputError as that does.
LiveAnswer live_answer(LiveJoint& live, const LiveRequest& request);

}  // namespace dea
