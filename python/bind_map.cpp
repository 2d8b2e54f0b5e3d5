#include <febiodea/python/bind.h>

namespace dea::python {

void bind_map(py::module_&) {}

}  // namespace dea::python
