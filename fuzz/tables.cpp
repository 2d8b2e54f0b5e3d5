// A table of loads, motion, thickness, cases, landmarks or ligaments, or a pose. The first byte chooses what it is.
#include "fuzz/fuzz.h"
#include "io/build/landmarks.h"
#include "io/build/ligaments.h"
#include "io/build/placement.h"
#include "io/tables/read_tables.h"
#include "io/tables/table.h"
#include "src/model/joint_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const int kind = data[0] % 11;
  const char* ending = kind == 1 ? ".sto" : kind == 6 ? ".fcsv" : kind == 7 ? ".mrk.json" : ".csv";
  const std::string path = dea::fuzz::file_of(data + 1, size - 1, ending);
  dea::fuzz::answer_or_refusal([&] {
    if (kind == 4) {
      dea::read_case_table(path);
      return;
    }
    if (kind == 9) {
      dea::read_pose(path);
      return;
    }
    if (kind == 10) {
      dea::read_ligaments(path, "mm");
      return;
    }
    if (kind > 4 && kind < 8) {
      dea::read_landmarks(path);
      return;
    }
    dea::JointModel model;
    model.units = "mm-N-s";
    dea::Settings settings;
    if (kind <= 1) {
      settings.loads.file = path;
      settings.loads.body = "femur";
    } else if (kind == 8) {  // matrices
      settings.motion.file = path;
      settings.motion.body = "femur";
      settings.motion.start = "1";
    } else if (kind == 2) {
      settings.motion.file = path;
      settings.motion.body = "femur";
      settings.motion.rotation = "zxy";
      settings.motion.units = "deg-mm";
    } else {
      settings.thickness_from["socket"] = {path, {}};
    }
    dea::read_tables(model, settings);
  });
  return 0;
}
