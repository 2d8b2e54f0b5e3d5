// python/bind.h – the parts of the module, one file each.
#pragma once
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "python/stages.h"
#include "src/study/plan.h"

namespace dea::python {

namespace py = pybind11;

void bind_stages(py::module_& m);      ///< Model, Settings, Recognition, analyse
void bind_results(py::module_& m);     ///< Result, State, Contact and their numbers
void bind_prepared(py::module_& m);    ///< Prepared, Pressed
void bind_plot_file(py::module_& m);   ///< PlotFile, numbers of maps
void bind_study(py::module_& m);       ///< studies: planned, solved, their files
void bind_statistics(py::module_& m);  ///< numbers of many cases, the page of a study
void bind_map(py::module_& m);         ///< pictures

/// Names and rows of a table in memory (febiodea/_study_tables.py) as if it were a file, lines from 1.
using Cells = std::pair<std::vector<std::string>, std::vector<std::vector<std::string>>>;
CaseTable table_of(const Cells& cells, const char* name);

/// Settings laid over others, as febiodea/_settings.py makes them. Throws UsageError.
Settings with_values(Settings settings, const SaidValues& values);

}  // namespace dea::python
