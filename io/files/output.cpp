#include <febiodea/io/files/output.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <system_error>

#include <febiodea/base/error.h>
#include <febiodea/base/parse.h>

namespace dea {

namespace fs = std::filesystem;

namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// All bytes to an open file. 0 or the error.
int write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n > 0)
      done += static_cast<std::size_t>(n);
    else if (n < 0 && errno != EINTR)
      return errno;
  }
  return 0;
}

using Pieces = std::function<void(const std::function<void(const std::string& piece)>& put)>;

/// An open file is written, then closed. `path`: as the user calls it.
void write_and_close(int file, const std::string& path, const std::function<void(int file)>& write) {
  try {
    write(file);
  } catch (...) {
    ::close(file);
    throw;
  }
  if (::close(file) != 0) throw WriteError(fmt::format("{}: {}", path, reason(errno)));
}

/// The same of all pieces.
void put_and_close(int file, const std::string& path, const Pieces& write) {
  write_and_close(file, path, [&](int open) {
    write([&](const std::string& piece) {
      const int why = write_all(open, piece);
      if (why != 0) throw WriteError(fmt::format("{}: {}", path, reason(why)));
    });
  });
}

/// The temporary file of write_text, the temporary folder of write_folder and its files, for remove_unfinished;
/// nullptr: none.
std::atomic<const char*> unfinished = nullptr;
struct FileOfFolder {
  std::string path;
  const FileOfFolder* before;
};
std::atomic<const char*> unfinished_folder = nullptr;
std::atomic<const FileOfFolder*> files_of_folder = nullptr;

/// Where a path leads: links stay, what they lead to is written.
fs::path target_of(const std::string& path) {
  std::error_code error;
  const fs::path target = path;
  return fs::is_symlink(fs::symlink_status(target, error)) ? fs::weakly_canonical(target, error) : target;
}

/// A new file beside the target becomes the target when it is complete. `write` closes it.
void write_beside(const std::string& path, const fs::path& target, const std::function<void(int file)>& write) {
  std::error_code error;
  const fs::path temporary = target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid());
  const int file = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) throw WriteError(fmt::format("{}: {}", path, reason(errno)));
  unfinished = temporary.c_str();
  try {
    write(file);
    fs::rename(temporary, target, error);
    if (error) throw WriteError(fmt::format("{}: {}", path, reason(error.value())));
  } catch (...) {
    fs::remove(temporary, error);
    unfinished = nullptr;
    throw;
  }
  unfinished = nullptr;
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error) return fs::is_regular_file(a, error);  // a device may take several
  return fs::absolute(a, error).lexically_normal() == fs::absolute(b, error).lexically_normal() &&
         !fs::is_character_file(a, error);
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
    if (output.folder && fs::exists(status) && !fs::is_directory(status))
      throw WriteError(fmt::format("{}: is a file, expected a folder or a new name", output.path));
    if (output.folder && fs::is_directory(status) && ::access(path.c_str(), W_OK | X_OK) != 0)
      throw WriteError(fmt::format("{}: {}", output.path, reason(errno)));
  }
}

void write_text(const std::string& path, const std::string& text) {
  write_pieces(path, [&](const std::function<void(const std::string&)>& put) { put(text); });
}

void write_pieces(const std::string& path, const Pieces& write) {
  if (path == "-") {
    write(print);
    return;
  }
  std::error_code error;
  const fs::path target = target_of(path);
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {  // a device or a pipe cannot be replaced by renaming
    const int file = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) throw WriteError(fmt::format("{}: {}", path, reason(errno)));
    put_and_close(file, path, write);
    return;
  }
  write_beside(path, target, [&](int file) { put_and_close(file, path, write); });
}

void write_open_file(const std::string& path, const std::function<void(int file)>& write) {
  std::error_code error;
  const fs::path target = target_of(path);
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw WriteError(fmt::format("{}: is no file, expected one or a new name", path));
  write_beside(path, target, [&](int file) { write_and_close(file, path, write); });
}

void write_folder(
    const std::string& path, const std::function<bool(const std::string& name)>& old,
    const std::function<void(const std::function<void(const std::string& name, const std::string& text)>& put)>&
        write) {
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
  const fs::path temporary = target.parent_path() / fmt::format(".{}.{}.tmp", name, ::getpid());
  const fs::path aside = target.parent_path() / fmt::format(".{}.{}.old", name, ::getpid());
  if (!fs::create_directory(temporary, error)) throw WriteError(fmt::format("{}: {}", path, reason(error.value())));
  std::deque<FileOfFolder> files;
  const auto finish = [&](const fs::path& left) {
    files_of_folder = nullptr;
    unfinished_folder = nullptr;
    fs::remove_all(left, error);
  };
  unfinished_folder = temporary.c_str();
  try {
    write([&](const std::string& file_name, const std::string& text) {
      files.push_back({(temporary / file_name).string(), files.empty() ? nullptr : &files.back()});
      files_of_folder = &files.back();
      const std::string shown = fmt::format("{}/{}", path, file_name);
      const int file = ::open(files.back().path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (file < 0) throw WriteError(fmt::format("{}: {}", shown, reason(errno)));
      put_and_close(file, shown, [&](const std::function<void(const std::string&)>& put) { put(text); });
    });
    if (there) fs::rename(target, aside, error);
    if (!error) fs::rename(temporary, target, error);
    if (error) {
      const std::error_code why = error;
      if (fs::exists(aside, error)) fs::rename(aside, target, error);
      throw WriteError(fmt::format("{}: {}", path, why.message()));
    }
  } catch (...) {
    finish(temporary);
    throw;
  }
  finish(aside);
}

void remove_unfinished() {
  if (const char* path = unfinished) ::unlink(path);
  for (const FileOfFolder* file = files_of_folder; file != nullptr; file = file->before) ::unlink(file->path.c_str());
  if (const char* path = unfinished_folder) ::rmdir(path);
}

void print(const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw WriteError(fmt::format("standard output: {}", reason(errno)));
}

void log(const std::string& line) { std::fputs((line + "\n").c_str(), stderr); }

std::string default_output(const std::string& model, const std::string& extension) {
  const fs::path path = model;
  return (path.parent_path() / (path.stem().string() + "_dea" + extension)).string();
}

std::string without_slash(const std::string& folder) {
  const fs::path path = folder;
  return path.has_filename() ? folder : path.parent_path().string();
}

std::string extension_of(const std::string& path) { return lower_case(fs::path(path).extension().string()); }

bool stderr_is_terminal() { return ::isatty(STDERR_FILENO) != 0; }

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace dea
