// plugin/febio_wording.h – settings as a user of the plugin types them.
#pragma once
#include "src/base/sentence.h"

namespace dea {

/// The parameter of a contact of type dea where there is one, <primary_thickness>1.8</primary_thickness>; else the
/// element of the task's settings file (docs/settings.md).
Wording febio_wording();

}  // namespace dea
