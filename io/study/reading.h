// io/study/reading.h – a study's file opened to be read, its faults as InputError, other programs as
// StudyBusy. For the sources of this folder.
#pragma once
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/files/packed_bytes.h"
#include "io/study/database.h"
#include "io/study/study_busy.h"
#include "src/base/error.h"

namespace dea {

/// Throws InputError: not a study, or one of another version.
void check_study(const Database& database);

/// A study, opened to be read. What is not as this program makes it is told by SQLite as a fault of the file.
struct StudyDatabase : Database {
  explicit StudyDatabase(const std::string& path) : Database(path, For::Reading) { check_study(*this); }
};

/// `read` of a study; that another program keeps writing is a fault here.
template <class Read>
auto reading(const std::string& path, Read read) {
  if (!std::ifstream(path)) throw InputError(fmt::format("{}: found no readable file, expected a study's", path));
  try {
    const StudyDatabase database(path);
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
