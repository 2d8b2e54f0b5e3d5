// python/errors.h – faults of the user as exceptions of Python, in Python's words.
#pragma once
#include <pybind11/pybind11.h>

#include <vector>

#include "src/base/error.h"
#include "src/base/sentence.h"

namespace dea::python {

namespace py = pybind11;

/// thickness={"knee": 1.8}, law="layer", rotate=[("pelvis", (0, 1, 0), 10)]
Wording python_wording();

/// InputError, UsageError and WriteError become those of febiodea/_errors.py, with place, found, expected, remedy.
void register_errors();

/// A recognition's faults as exceptions that were not raised.
py::list faults_as_errors(const std::vector<Fault>& faults);

}  // namespace dea::python
