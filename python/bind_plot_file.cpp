#include <febiodea/python/bind.h>

namespace dea::python {

void bind_plot_file(py::module_&) {}

}  // namespace dea::python
