#include "io/files/spool.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "io/files/output.h"
#include "io/files/system.h"

namespace dea {

namespace {

namespace fs = std::filesystem;

/// A file, a folder or a new name: what lies where there is room for results. No device, pipe or standard output.
bool lies_on_disk(const std::string& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  return path != "-" &&
         (type == fs::file_type::regular || type == fs::file_type::directory || type == fs::file_type::not_found);
}

int nameless_file(const std::string& beside) {
  fs::path name;
  const int file = lies_on_disk(beside) ? create_temporary(fs::path(beside).parent_path(), name) : -1;
  if (file < 0) return open_nameless();
  std::error_code error;
  fs::remove(name, error);
  return file;
}

}  // namespace

Spool::Spool(std::string path) : path_(std::move(path)) {
  file_ = nameless_file(path_);
  if (file_ < 0) cannot_write(path_, errno);
}

Spool::Spool(Spool&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)), size_(other.size_) {}

Spool::~Spool() {
  if (file_ >= 0) close_file(file_);
}

void Spool::add(const std::string& bytes) {
  if (const int why = write_all(file_, bytes)) cannot_write(path_, why);
  size_ += bytes.size();
}

void Spool::read(std::uint64_t begin, std::uint64_t count, const std::function<void(const std::string&)>& put) const {
  while (count > 0) {
    const std::string piece = read_at(file_, begin, std::min<std::uint64_t>(count, std::uint64_t{1} << 20));
    if (piece.empty()) cannot_write(path_, errno);
    put(piece);
    begin += piece.size();
    count -= piece.size();
  }
}

}  // namespace dea
