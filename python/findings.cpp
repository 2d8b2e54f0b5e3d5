#include "python/findings.h"

#include "python/errors.h"
#include "python/plain.h"
#include "src/rules/rules.h"
#include "views/data/json.h"

namespace dea::python {

py::list findings_list(const Findings& findings) {
  const py::object make = py::module_::import("febiodea._findings").attr("Finding");
  const py::list values = plain(findings_json(findings));
  py::list all;
  for (std::size_t i = 0; i < findings.size(); ++i)
    all.append(make(text(line(findings[i], python_wording())), **py::dict(values[i])));
  return all;
}

}  // namespace dea::python
