// io/study/study_columns.h where there is no HDF5.
#include "io/study/study_columns.h"
#include "src/base/error.h"

namespace dea {

void check_columns_possible() {
  throw UsageError(
      "--hdf5: this dea is made without HDF5; --csv writes the same numbers, and read_study(\"plan.db\").to_xarray() of "
      "the Python module has them as columns");
}

void write_study_columns(const std::string&, const std::string&) { check_columns_possible(); }

}  // namespace dea
