#include "io/files/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <thread>
#include <utility>

#include "io/files/system.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

/// The paths of all Temporary. Places stay for ever, for a signal may come while others come and go.
struct Place {
  std::atomic<const char*> path;  ///< nullptr: free
  Place* before;
};
std::atomic<Place*> places = nullptr;
std::atomic<bool> ending = false;  ///< remove_unfinished has begun

/// Another thread ends the program: it may be reading this one's paths.
void wait_for_the_end() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void note(const char* path) {
  const auto into_free_place = [path] {
    for (Place* p = places; p != nullptr; p = p->before) {
      const char* nothing = nullptr;
      if (p->path.compare_exchange_strong(nothing, path)) return true;
    }
    return false;
  };
  if (!into_free_place()) {
    Place* added = new Place{path, places};
    while (!places.compare_exchange_weak(added->before, added)) {
    }
  }
  if (!ending) return;
  remove_file(path);
  remove_empty_folder(path);
  wait_for_the_end();
}

void forget(const char* path) {
  for (Place* p = places; p != nullptr; p = p->before)
    if (p->path == path) p->path = nullptr;
  if (ending) wait_for_the_end();
}

/// Where a path leads: links stay, what they lead to is written.
fs::path target_of(const std::string& path) {
  std::error_code error;
  const fs::path target = path;
  if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
  const fs::path last = fs::weakly_canonical(target, error);
  if (error) cannot_write(path, error);
  return last;
}

/// The same of what can be gone back in. Throws WriteError: a device or a pipe.
fs::path regular_target(const std::string& path) {
  std::error_code error;
  const fs::path target = target_of(path);
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw WriteError(fmt::format("{}: is no file, expected one or a new name", path));
  return target;
}

/// An open file is written, then closed. `path`: as the user calls it.
void write_and_close(int file, const std::string& path, const std::function<void(int file)>& write) {
  if (file < 0) cannot_write(path, errno);
  try {
    write(file);
  } catch (...) {
    close_file(file);
    throw;
  }
  if (!close_file(file)) cannot_write(path, errno);
}

/// A new file beside the target becomes the target when it is complete.
void write_beside(const std::string& path, const fs::path& target, const std::function<void(int file)>& write) {
  fs::path name;
  const int file = create_temporary(target.parent_path(), name);
  if (file < 0) cannot_write(path, errno);
  const Temporary temporary(name);
  write_and_close(file, path, write);
  if (const int why = replace_file(temporary.path, target.string())) cannot_write(path, why);
}

void write_stdout(const std::string& text) {
  if (const int why = write_all(kStandardOutput, text)) cannot_write("standard output", why);
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error) return fs::is_regular_file(a, error);  // a device may take several
  return fs::absolute(a, error).lexically_normal() == fs::absolute(b, error).lexically_normal() &&
         !fs::is_character_file(a, error);
}

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
  const LockedFile taken = lock_file(path.string());
  if (taken.lock == Lock::Taken) return taken.file;
  if (taken.lock == Lock::Impossible) {
    const int why = errno;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (may_fill(folder.string())) return -1;
    cannot_write(output.path, why);
  }
  const std::string holder = taken.file < 0 ? "" : holder_of(taken.file);
  if (taken.file >= 0) close_file(taken.file);
  throw WriteError(fmt::format("{}: another run{} is at work on it; wait for its end, or give {} another name",
                               output.path, holder, output.option));
}

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

void check_outputs(const std::vector<NamedPath>& inputs, const std::vector<NamedPath>& outputs) {
  const NamedPath* to_stdout = nullptr;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].path.empty()) throw UsageError(fmt::format("{}: found no file name", outputs[i].option));
    if (outputs[i].path == "-") {
      if (outputs[i].folder)
        throw UsageError(fmt::format("{} -: a folder cannot go to standard output, give it a name", outputs[i].option));
      if (to_stdout != nullptr)
        throw UsageError(
            fmt::format("only one of {} and {} can go to standard output", to_stdout->option, outputs[i].option));
      to_stdout = &outputs[i];
      continue;
    }
    for (const NamedPath& input : inputs)
      if (same_file(outputs[i].path, input.path))
        throw UsageError(fmt::format("{} {}: would overwrite {}", outputs[i].option, outputs[i].path, input.option));
    if (outputs[i].option != "-o" && !outputs[i].folder && extension_of(outputs[i].path) == ".feb")
      throw UsageError(fmt::format("{} {}: is a model's name, expected another", outputs[i].option, outputs[i].path));
    for (std::size_t k = 0; k < i; ++k)
      if (outputs[k].path != "-" && same_file(outputs[i].path, outputs[k].path))
        throw UsageError(
            fmt::format("{} {}: is the file of {} too", outputs[i].option, outputs[i].path, outputs[k].option));
  }
  for (const NamedPath& output : outputs) {
    if (output.path == "-") continue;
    std::error_code error;
    const fs::path path = output.folder ? without_slash(output.path) : output.path;
    const fs::path folder = path.parent_path();
    if (!folder.empty() && !fs::is_directory(folder, error))
      throw WriteError(fmt::format("{}: there is no folder {}", output.path, folder.string()));
    const fs::file_status status = fs::status(path, error);
    if (!output.folder && fs::is_directory(status)) throw WriteError(fmt::format("{}: is a folder", output.path));
    if (fs::is_regular_file(status) && !may_replace(path.string())) cannot_write(output.path, errno);
    if (output.folder && fs::exists(status) && !fs::is_directory(status))
      throw WriteError(fmt::format("{}: is a file, expected a folder or a new name", output.path));
    if (output.folder && fs::is_directory(status) && !may_fill(path.string())) cannot_write(output.path, errno);
  }
}

void write_text(const std::string& path, const std::string& text) {
  write_pieces(path, [&](const PutPiece& put) { put(text); });
}

void write_pieces(const std::string& path, const std::function<void(const PutPiece& put)>& write) {
  if (path == "-") {
    write(write_stdout);
    return;
  }
  const auto put_all = [&](int file) {
    write([&](const std::string& piece) {
      if (const int why = write_all(file, piece)) cannot_write(path, why);
    });
  };
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status))  // a device or a pipe cannot be replaced by renaming
    write_and_close(open_file(path, OpenAs::Writing), path, put_all);
  else
    write_beside(path, target_of(path), put_all);
}

void write_open_file(const std::string& path, const std::function<void(int file)>& write) {
  write_beside(path, regular_target(path), write);
}

void write_named_file(const std::string& path, const std::function<void(const std::string& name)>& write) {
  const fs::path target = regular_target(path);
  fs::path name;
  const int file = create_temporary(target.parent_path(), name);
  if (file < 0) cannot_write(path, errno);
  const Temporary temporary(name);
  close_file(file);
  write(temporary.path);
  if (const int why = replace_file(temporary.path, target.string())) cannot_write(path, why);
}

void write_folder(const std::string& path, const std::function<bool(const std::string& name)>& old,
                  const std::function<void(const PutFile& put)>& write) {
  std::error_code error;
  const fs::path target = fs::weakly_canonical(fs::absolute(without_slash(path), error), error);
  const bool there = fs::exists(target, error);
  if (there && !fs::is_directory(target, error))
    throw WriteError(fmt::format("{}: is a file, expected a folder", path));
  for (fs::directory_iterator entry(target, error), end; there && !error && entry != end; entry.increment(error))
    if (!entry->is_regular_file() || !old(entry->path().filename().string()))
      throw WriteError(fmt::format("{}: holds {}; expected a new name, an empty folder or one with earlier frames only",
                                   path, entry->path().filename().string()));
  const std::string name = target.filename().string();
  const fs::path folder = target.parent_path() / fmt::format(".{}.{}.tmp", name, process_id());
  const fs::path aside = target.parent_path() / fmt::format(".{}.{}.old", name, process_id());
  if (!fs::create_directory(folder, error)) cannot_write(path, error);
  const Temporary temporary(folder);
  std::deque<Temporary> files;
  write([&](const std::string& file_name, const std::string& text) {
    files.emplace_back(folder / file_name);
    const std::string shown = fmt::format("{}/{}", path, file_name);
    write_and_close(open_file(files.back().path, OpenAs::New), shown, [&](int file) {
      if (const int why = write_all(file, text)) cannot_write(shown, why);
    });
  });
  if (there) fs::rename(target, aside, error);
  if (!error) fs::rename(folder, target, error);
  if (error) {
    const std::error_code why = error;
    if (fs::exists(aside, error)) fs::rename(aside, target, error);
    cannot_write(path, why);
  }
  fs::remove_all(aside, error);
}

int create_temporary(const fs::path& folder, fs::path& name) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    const auto stamp = static_cast<unsigned long long>(fs::file_time_type::clock::now().time_since_epoch().count());
    name = folder / fmt::format(".dea-{:x}-{}.tmp", stamp, counter++);
    const int file = open_file(name.string(), OpenAs::New);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

Temporary::Temporary(const fs::path& name) : path(name.string()) { note(path.c_str()); }

Temporary::~Temporary() {
  std::error_code error;
  fs::remove_all(path, error);
  forget(path.c_str());
}

void remove_unfinished() {
  ending = true;
  for (const auto remove : {remove_file, remove_empty_folder})  // a folder goes after what is in it
    for (const Place* p = places; p != nullptr; p = p->before)
      if (const char* path = p->path) remove(path);
}

Spool::Spool(std::string path) : path_(std::move(path)) {
  file_ = nameless_file(path_);
  if (file_ < 0) cannot_write(path_, errno);
}

Spool::~Spool() { close_file(file_); }

void Spool::add(const std::string& bytes) {
  if (const int why = write_all(file_, bytes)) cannot_write(path_, why);
  size_ += bytes.size();
}

void Spool::read(std::uint64_t begin, std::uint64_t count, const PutPiece& put) const {
  while (count > 0) {
    const std::string piece = read_at(file_, begin, std::min<std::uint64_t>(count, std::uint64_t{1} << 20));
    if (piece.empty()) cannot_write(path_, errno);
    put(piece);
    begin += piece.size();
    count -= piece.size();
  }
}

HeldOutput::~HeldOutput() {
  name.reset();  // before it is let go: nobody waits for a file without a name
  close_file(file);
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
    all.emplace_back(file, path);
    std::error_code error;  // where it cannot be written, others are told without the number
    fs::resize_file(path, 0, error);
    write_all(file, fmt::format("{}\n", process_id()));
  }
  return all;
}

void cannot_write(const std::string& path, int error) {
  throw WriteError(fmt::format("{}: {}", path, reason_of(error)));
}

void cannot_write(const std::string& path, const std::error_code& error) {
  throw WriteError(fmt::format("{}: {}", path, reason_of(error)));
}

void print(const std::string& text) { write_stdout(printable(text)); }

void log(const std::string& line) { write_all(kStandardError, message_line(line) + "\n"); }

std::string default_output(const std::string& model, const std::string& extension) {
  const fs::path path = model;
  return (path.parent_path() / (path.stem().string() + "_dea" + extension)).string();
}

bool is_separator(char c) { return c == '/' || c == static_cast<char>(fs::path::preferred_separator); }

std::string without_slash(const std::string& folder) {
  const fs::path path = folder;
  return path.has_filename() ? folder : path.parent_path().string();
}

std::string extension_of(const std::string& path) { return lower_case(fs::path(path).extension().string()); }

std::string wrong_ending(const std::string& option, const std::string& path, const char* endings, const char* first) {
  const std::string extension = extension_of(path);
  if (extension.empty() || extension == ".")
    return fmt::format("{} {}: found no ending, expected a name that ends in {}: {}{}", option, path, endings,
                       extension.empty() ? path : path.substr(0, path.size() - 1), first);
  return fmt::format("{} {}: found \"{}\", expected a name that ends in {}", option, path, extension, endings);
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace dea
