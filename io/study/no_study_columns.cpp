// io/study/study_columns.h where there is no HDF5.
#include "io/study/study_columns.h"
#include "src/base/error.h"

namespace dea {

void check_columns_possible() {
  throw UsageError(
      "--hdf5: this dea was made without HDF5. --csv writes the numbers of contacts; in Python "
      "read_study(\"plan.db\").to_xarray() has them as columns");
}

void write_study_columns(const std::string&, const std::string&) { check_columns_possible(); }

}  // namespace dea
