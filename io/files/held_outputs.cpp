#include "io/files/held_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "io/files/system.h"
#include "src/base/error.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestFileName = 240;  // bytes: file systems have room for 255

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
  name.resize(std::min(name.size(), kLongestFileName));
  return target.parent_path() / fmt::format(".{}.lock", name);
}

/// Written by who holds it; empty: not yet.
std::string holder_of(int file) {
  const std::string text = read_at(file, 0, 31);
  int process = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), process);
  return end.ec == std::errc() && process > 0 ? fmt::format(" (process {})", process) : std::string();
}

/// The open file, locked; -1: there are no locks here.
int take_lock(const fs::path& path, const NamedPath& output) {
  for (;;) {
    int file = open_file(path.string(), OpenAs::Shared);
    if (file < 0 && errno == EACCES) file = open_file(path.string(), OpenAs::Reading);  // somebody else left it behind
    if (file < 0) {
      const int why = errno;
      const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
      if (may_fill(folder.string())) return -1;
      cannot_write(output.path, why);
    }
    const Lock lock = lock_file(file);
    if (lock == Lock::Taken && is_named(file, path.string())) return file;  // its holder takes the name away at its end
    const std::string holder = lock == Lock::OfAnother ? holder_of(file) : "";
    close_file(file);
    if (lock == Lock::Impossible) return -1;
    if (lock == Lock::OfAnother)
      throw WriteError(fmt::format("{}: another run{} is at work on it; wait for its end, or give {} another name",
                                   output.path, holder, output.option));
  }
}

}  // namespace

HeldOutputs::~HeldOutputs() {
  for (Held& h : held_) {
    h.name.reset();  // before it is let go: nobody waits for a file without a name
    close_file(h.file);
  }
}

HeldOutputs claim_outputs(const std::vector<NamedPath>& inputs, std::vector<NamedPath> outputs) {
  std::erase_if(outputs, [](const NamedPath& output) { return output.path.empty(); });
  check_outputs(inputs, outputs);
  HeldOutputs all;
  for (const NamedPath& output : outputs) {
    if (output.path == "-") continue;
    const fs::path path = lock_path(output.path);
    if (path.empty()) continue;
    const int file = take_lock(path, output);
    if (file < 0) continue;
    all.held_.push_back({file, std::make_unique<Temporary>(path)});
    std::error_code error;  // where it cannot be written, others are told without the number
    fs::resize_file(path, 0, error);
    write_all(file, fmt::format("{}\n", process_id()));
  }
  return all;
}

}  // namespace dea
