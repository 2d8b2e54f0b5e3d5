// python/findings.h – findings as Python has them.
#pragma once
#include <pybind11/pybind11.h>

#include "src/base/finding.h"

namespace dea::python {

/// Of febiodea.Finding: lines, each with its code, severity, subject and values.
pybind11::list findings_list(const Findings& findings);

}  // namespace dea::python
