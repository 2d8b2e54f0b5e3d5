// python/module.cpp – the compiled part of the Python module. What users import is febiodea/__init__.py.
#include "python/bind.h"
#include "python/errors.h"
#include "python/work.h"
#include "src/version.h"

PYBIND11_MODULE(_febiodea, m) {
  using namespace dea::python;
  register_errors();
  m.attr("__version__") = dea::kVersion;
  m.def("end_all_work", &end_all_work);
  bind_stages(m);
  bind_results(m);
  bind_prepared(m);
  bind_plot_file(m);
  bind_map(m);
  bind_study(m);
  bind_statistics(m);
}
