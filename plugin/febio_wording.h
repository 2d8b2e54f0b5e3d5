// plugin/febio_wording.h – words of the plugin that need no FEBio: settings as its user types them, versions.
#pragma once
#include <string>

#include "src/base/sentence.h"

namespace dea {

/// The parameter of a contact of type dea where there is one, <primary_thickness>1.8</primary_thickness>; else the
/// element of the task's settings file (docs/settings.md).
Wording febio_wording();

/// A line for FEBio's log, with its end, where the plugin is compiled for a version ("4.12") that is not among the
/// verified ones ("4.11 4.13"); empty: it is.
std::string untested_line(const std::string& verified, const std::string& compiled);

}  // namespace dea
