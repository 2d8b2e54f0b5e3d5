// io/convert/edit_feb.h – a converted joint as the model's own text with a few elements changed.
#pragma once
#include <optional>
#include <string>

#include "io/convert/conversion_plan.h"

namespace dea {

/// `text`: of the model, version 4.0. Nothing when an element to be changed is not in it (it is in an included file, or
/// the text is not as expected); `why` then says which. Adds its own changes (solver, plot file) to `plan.changes`.
std::optional<std::string> edit_feb(const JointModel& model, ConversionPlan& plan, const std::string& text,
                                    std::string& why);

}  // namespace dea
