// io/study/open_study.h – a study's file, open to be read.
#pragma once
#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "io/files/encoded_text.h"
#include "io/study/study_schema.h"
#include "src/base/error.h"

namespace dea {

/// `read` of a study; that another program keeps writing is a fault here. What is not as this program makes it is told
/// by SQLite as a fault of the file.
template <class Read>
auto reading(const std::string& path, Read read) {
  if (!std::ifstream(path)) throw InputError(fmt::format("{}: found no readable file, expected a study's", path));
  try {
    const Database database(path, Database::For::Reading);
    check_study(database);
    return read(database);
  } catch (const DatabaseBusy& busy) {
    throw StudyBusy(fmt::format("{}; try again", busy.what()));
  }
}

/// The array in a blob.
template <class T>
std::vector<T> unpacked(const Database& d, const std::string& blob) {
  const std::optional<std::string> bytes = unpacked_bytes(blob);
  if (!bytes || bytes->size() % sizeof(T) != 0) throw InputError(fmt::format("{}: found a damaged array", d.path()));
  std::vector<T> values(bytes->size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes->data(), bytes->size());
  return values;
}

}  // namespace dea
