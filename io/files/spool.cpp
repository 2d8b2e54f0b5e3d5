#include <febiodea/io/files/spool.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include <febiodea/base/error.h>

namespace dea {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw WriteError(fmt::format("{}: {}", path, error == 0 ? "write error" : std::generic_category().message(error)));
}

/// A file, a folder or a new name: what lies where there is room for results. No device, pipe or standard output.
bool lies_on_disk(const std::string& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  return path != "-" &&
         (type == fs::file_type::regular || type == fs::file_type::directory || type == fs::file_type::not_found);
}

std::FILE* nameless_file(const std::string& beside) {
  if (!lies_on_disk(beside)) return std::tmpfile();
  fs::path temporary;
  std::FILE* stream = create_temporary(fs::path(beside).parent_path(), temporary);
  if (stream == nullptr) return std::tmpfile();
  std::error_code error;
  fs::remove(temporary, error);
  return stream;
}

}  // namespace

std::FILE* create_temporary(const fs::path& directory, fs::path& name) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    const auto stamp = static_cast<unsigned long long>(fs::file_time_type::clock::now().time_since_epoch().count());
    name = directory / fmt::format(".dea-{:x}-{}.tmp", stamp, counter++);
    errno = 0;
    if (std::FILE* stream = std::fopen(name.string().c_str(), "w+bx")) return stream;
    if (errno != EEXIST) break;
  }
  return nullptr;
}

Spool::Spool(std::string path) : path_(std::move(path)) {
  errno = 0;
  file_ = nameless_file(path_);
  if (file_ == nullptr) fail(path_, errno);
}

Spool::Spool(Spool&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, nullptr)), size_(other.size_) {}

Spool::~Spool() {
  if (file_ != nullptr) std::fclose(file_);
}

void Spool::add(const std::string& bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail(path_, errno);
  size_ += bytes.size();
}

void Spool::read(std::uint64_t begin, std::uint64_t count, const std::function<void(const std::string&)>& put) const {
  errno = 0;
  if (std::fflush(file_) != 0 || ::fseeko(file_, static_cast<off_t>(begin), SEEK_SET) != 0) fail(path_, errno);
  std::string piece;
  while (count > 0) {
    piece.resize(std::min<std::uint64_t>(count, std::uint64_t{1} << 20));
    const std::size_t n = std::fread(piece.data(), 1, piece.size(), file_);
    if (n == 0) fail(path_, errno);
    piece.resize(n);
    put(piece);
    count -= n;
  }
  if (::fseeko(file_, 0, SEEK_END) != 0) fail(path_, errno);
}

}  // namespace dea
