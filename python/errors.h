// python/errors.h – faults of the user as exceptions of Python, and findings, in Python's words.
#pragma once
#include <pybind11/pybind11.h>

#include <vector>

#include "src/base/error.h"
#include "src/base/finding.h"
#include "src/base/sentence.h"

namespace dea::python {

namespace py = pybind11;

/// thickness={"knee": 1.8}, law="layer", rotate=[("pelvis", (0, 1, 0), 10)]
Wording python_wording();

/// InputError, UsageError and WriteError become those of febiodea/_errors.py, with place, found, expected, remedy.
void register_errors();

/// A recognition's faults as exceptions that were not raised.
py::list faults_as_errors(const std::vector<Fault>& faults);

/// Of febiodea.Finding: lines, each with its code, severity, subject and values.
py::list findings_list(const Findings& findings);

}  // namespace dea::python
