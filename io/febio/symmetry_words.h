// io/febio/symmetry_words.h – planes of symmetry as a contact of type "dea" states them: "x=0, y=-12.5".
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "src/model/joint_model.h"

namespace dea::febio {

/// What is wrong with a text that is no list of planes.
inline constexpr const char* kPlanesExpected = "expected planes across axes, as in \"x=0, y=-12.5\"";

/// Empty: no plane. Nothing: the text is no such list.
std::optional<std::vector<SymmetryPlane>> planes_of_text(std::string_view text);

/// The numbers read back the same.
std::string text_of_planes(const std::vector<SymmetryPlane>& planes);

}  // namespace dea::febio
