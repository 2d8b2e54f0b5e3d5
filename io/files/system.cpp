#include "io/files/system.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __EMSCRIPTEN__
#include <emscripten/heap.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "src/base/numbers.h"

namespace dea {

namespace {

/// Is the open file the one of this name?
bool is_named(int file, const std::string& path) {
  struct stat opened = {}, named = {};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

}  // namespace

std::string reason_of(int error) { return error == 0 ? "write error" : std::generic_category().message(error); }
std::string reason_of(const std::error_code& error) { return reason_of(error.value()); }
bool failed_to_write(int error) { return error == EFBIG || error == ENOSPC || error == EDQUOT || error == EIO; }

int open_file(const std::string& path, OpenAs as) {
  const int how = as == OpenAs::New       ? O_RDWR | O_CREAT | O_EXCL
                  : as == OpenAs::Reading ? O_RDONLY
                  : as == OpenAs::Writing ? O_WRONLY
                                          : O_WRONLY | O_CREAT | O_APPEND;
  return ::open(path.c_str(), how | O_CLOEXEC, 0666);
}

int open_nameless() {
  std::FILE* stream = std::tmpfile();
  if (stream == nullptr) return -1;
  const int file = ::fcntl(::fileno(stream), F_DUPFD_CLOEXEC, 0);
  std::fclose(stream);
  return file;
}

bool close_file(int file) { return ::close(file) == 0; }

int write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n > 0)
      bytes.remove_prefix(static_cast<std::size_t>(n));
    else if (n < 0 && errno != EINTR)
      return errno;
  }
  return 0;
}

std::string read_at(int file, std::uint64_t place, std::size_t most) {
  std::string bytes(most, '\0');
  ssize_t n = -1;
  do {
    errno = 0;
    n = ::pread(file, bytes.data(), most, static_cast<off_t>(place));
  } while (n < 0 && errno == EINTR);
  bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return bytes;
}

void remove_file(const char* path) { ::unlink(path); }
void remove_empty_folder(const char* path) { ::rmdir(path); }

bool make_own_folder(std::string& name) { return ::mkdtemp(name.data()) != nullptr; }

bool may_read(const std::string& path) { return ::access(path.c_str(), R_OK) == 0; }
bool may_fill(const std::string& folder) { return ::access(folder.c_str(), W_OK | X_OK) == 0; }

bool may_replace(const std::string&) { return true; }  // whoever has it open keeps the old one
int replace_file(const std::string& from, const std::string& to) {
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

LockedFile lock_file(const std::string& path) {
  for (;;) {
    int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0 && errno == EACCES) {
      file = open_file(path, OpenAs::Reading);  // somebody else left it behind
      if (file < 0) errno = EACCES;
    }
    if (file < 0) return {Lock::Impossible, -1};
    int why = 0;
    do why = ::flock(file, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    while (why == EINTR);
    if (why == EWOULDBLOCK) return {Lock::OfAnother, file};
    if (why == 0 && is_named(file, path)) return {Lock::Taken, file};  // its holder takes the name away at its end
    ::close(file);
    errno = why;
    if (why != 0) return {Lock::Impossible, -1};
  }
}

int process_id() { return ::getpid(); }

bool stderr_is_terminal() {
  const char* terminal = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

double memory_left() {
#ifdef __EMSCRIPTEN__  // a page's memory has an end, and the machine's is not told
  return static_cast<double>(emscripten_get_heap_max()) - static_cast<double>(emscripten_get_heap_size());
#endif
  rlimit limit = {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kInfinity;
  double pages = 0.0;  // of all addresses, the first number there
  std::ifstream("/proc/self/statm") >> pages;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(::sysconf(_SC_PAGESIZE)));
}

}  // namespace dea
