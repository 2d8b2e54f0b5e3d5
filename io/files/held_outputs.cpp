#include <febiodea/io/files/held_outputs.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <system_error>

#include <febiodea/base/error.h>

namespace dea {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestName = 240;  // bytes: file systems have room for 255

/// The files of the locks, for remove_held; nullptr: a free place. What finds none is not taken away by a signal.
std::array<std::atomic<const char*>, 32> lock_files = {};

void note_lock_file(const char* path) {
  for (std::atomic<const char*>& place : lock_files) {
    const char* nothing = nullptr;
    if (place.compare_exchange_strong(nothing, path)) return;
  }
}

void forget_lock_file(const char* path) {
  for (std::atomic<const char*>& place : lock_files) {
    const char* own = path;
    if (place.compare_exchange_strong(own, nullptr)) return;
  }
}

/// Where an output's lock lies; empty: it needs none.
fs::path lock_path(const std::string& output) {
  std::error_code error;
  fs::path target = output;
  if (fs::is_symlink(fs::symlink_status(target, error))) target = fs::weakly_canonical(target, error);
  if (target.empty()) return {};  // a link to what has no name, such as /dev/stdout into a pipe
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return {};  // /dev/null
  if (!target.has_filename()) target = target.parent_path();                                       // "results/"
  std::string name = target.filename().string();
  if (name.empty() || name == "." || name == "..") return {};
  name.resize(std::min(name.size(), kLongestName));
  return target.parent_path() / fmt::format(".{}.lock", name);
}

/// Written by who holds it; empty: not yet.
std::string holder_of(int file) {
  char text[32] = {};
  const ssize_t n = ::pread(file, text, sizeof text - 1, 0);
  int process = 0;
  const auto end = std::from_chars(text, text + (n > 0 ? n : 0), process);
  return end.ec == std::errc() && process > 0 ? fmt::format(" (process {})", process) : std::string();
}

/// Is the open file still the one of this name? Its holder takes the name away when it ends.
bool still_named(int file, const fs::path& path) {
  struct stat opened = {}, named = {};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

/// The open file, locked; -1: there are no locks here.
int take_lock(const fs::path& path, const NamedPath& output) {
  for (;;) {
    int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0 && errno == EACCES) file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);  // somebody else left it behind
    if (file < 0) {
      const int why = errno;
      const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
      if (::access(folder.c_str(), W_OK | X_OK) == 0) return -1;
      throw WriteError(fmt::format("{}: {}", output.path, std::generic_category().message(why)));
    }
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
      const int why = errno;
      const std::string holder = why == EWOULDBLOCK ? holder_of(file) : "";
      ::close(file);
      if (why == EINTR) continue;
      if (why != EWOULDBLOCK) return -1;
      throw WriteError(fmt::format("{}: another run{} is at work on it; wait for its end, or give {} another name",
                                   output.path, holder, output.option));
    }
    if (still_named(file, path)) return file;
    ::close(file);
  }
}

}  // namespace

HeldOutputs::~HeldOutputs() {
  for (const Held& h : held_) {
    ::unlink(h.path.c_str());  // before it is let go: nobody waits for a file without a name
    forget_lock_file(h.path.c_str());
    ::close(h.file);
  }
}

HeldOutputs hold_outputs(const std::vector<NamedPath>& outputs) {
  HeldOutputs all;
  all.held_.reserve(outputs.size());  // signal handlers know the texts by their addresses
  for (const NamedPath& output : outputs) {
    if (output.path == "-") continue;
    const fs::path path = lock_path(output.path);
    if (path.empty()) continue;
    const int file = take_lock(path, output);
    if (file < 0) continue;
    all.held_.push_back({file, path.string()});
    note_lock_file(all.held_.back().path.c_str());
    const std::string process = fmt::format("{}\n", ::getpid());
    if (::ftruncate(file, 0) != 0 || ::pwrite(file, process.data(), process.size(), 0) < 0)
      continue;  // told without it
  }
  return all;
}

HeldOutputs claim_outputs(const std::vector<NamedPath>& inputs, const std::vector<NamedPath>& outputs) {
  check_outputs(inputs, outputs);
  return hold_outputs(outputs);
}

void remove_held() {
  for (const std::atomic<const char*>& place : lock_files)
    if (const char* path = place) ::unlink(path);
}

}  // namespace dea
