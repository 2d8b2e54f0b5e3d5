// io/run/spring_memory.h – will the springs fit in this machine's memory?
#pragma once
#include <string>

#include "io/settings/settings_xml.h"
#include "src/run/recognise.h"

namespace dea {

/// What springs divided by --refine cost, as a note; empty: they are few. Throws UsageError where they need more memory
/// than is free.
std::string spring_cost_note(const Recognition& recognition, const Wording& wording = command_line_wording());

}  // namespace dea
