// io/convert/convert_feb.h – a FEBio model of a joint becomes one for the contact type dea of the plugin.
//
// The cartilage becomes rigid with its bone; its modulus and thickness, and all that make_joint found, become those of
// the contact (docs/convert.md).
#pragma once
#include <string>
#include <vector>

#include "src/joint/joint.h"

namespace dea {

struct Conversion {
  std::string text;               ///< of the new file, version 4.0
  bool edited = true;             ///< the model's own text with a few elements changed; false: written anew
  std::vector<Sentence> changes;  ///< a line each
  std::vector<Sentence> notes;    ///< what the user should know
  Joint joint;                    ///< of the model as it is
};

/// `output`: where the text will be written, for what the model includes from its own folder. `linear_solver`: FEBio's
/// (linear_solver.h) for all steps; "": those that the model names. Throws UsageError when a setting cannot be said in
/// the file, InputError when the model cannot be converted.
Conversion convert_feb(const JointModel& model, const Settings& settings, const std::string& output,
                       const std::string& linear_solver = "");

}  // namespace dea
