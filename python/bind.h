// febiodea/python/bind.h – the parts of the module, one file each.
#pragma once
#include <pybind11/pybind11.h>

#include <memory>

#include <febiodea/python/stages.h>

namespace dea::python {

namespace py = pybind11;

void bind_stages(py::module_& m);     ///< Model, Settings, Recognition, analyse
void bind_results(py::module_& m);    ///< Result, State, Contact and their numbers
void bind_prepared(py::module_& m);   ///< Prepared, Pressed
void bind_plot_file(py::module_& m);  ///< PlotFile, numbers of maps
void bind_study(py::module_& m);      ///< studies: planned, solved, their files
void bind_statistics(py::module_& m);  ///< numbers of many cases, the page of a study
void bind_map(py::module_& m);        ///< pictures

/// Settings laid over others, as febiodea/_settings.py makes them. Throws UsageError.
Settings with_values(Settings settings, const SaidValues& values);

}  // namespace dea::python
