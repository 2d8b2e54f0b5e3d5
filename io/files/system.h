// io/files/system.h – what the operating system is asked for: files, their locks, this process: of POSIX in system.cpp,
// of Windows in system_windows.cpp. Other sources include no header of either, but app/process.cpp and its twin
// (tests/includes.py). All names of files are UTF-8.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace dea {

/// "No space left on device". `error`: errno; 0: "write error".
std::string reason_of(int error);
/// The same of what std::filesystem says.
std::string reason_of(const std::error_code& error);
/// Does errno say that a write found no room, or failed?
bool failed_to_write(int error);

enum class OpenAs {
  New,      ///< to read and write; fails where it is there
  Reading,  ///< is there
  Writing,  ///< is there
  Log       ///< to write at its end; made where it is missing
};
/// An open file, which programs that are started do not have; -1 and errno: there is none.
int open_file(const std::string& path, OpenAs as);
/// The same, without a name, among the system's temporary files.
int open_nameless();
/// False and errno: not all that was written has arrived.
bool close_file(int file);

/// All bytes; 0 or the error. Signal handlers may call it.
int write_all(int file, std::string_view bytes);
inline constexpr int kStandardOutput = 1, kStandardError = 2;

/// At most so many bytes from there on; none: it ends before, errno 0, or cannot be read.
std::string read_at(int file, std::uint64_t place, std::size_t most);

/// Signal handlers may call them.
void remove_file(const char* path);
void remove_empty_folder(const char* path);

/// A new folder, for this user alone. `name` ends in XXXXXX, in place of which it gets letters. False: there is none.
bool make_own_folder(std::string& name);

bool may_read(const std::string& path);
/// May files be made in it? False and errno: no.
bool may_fill(const std::string& folder);
/// May replace_file put another file in the place of this one? False and errno: no.
bool may_replace(const std::string& path);
/// The file `from` becomes `to`, at once and whole. 0 or the error.
int replace_file(const std::string& from, const std::string& to);

/// A lock on a name, advisory, for as long as the file is open: it is made where it is missing.
enum class Lock { Taken, OfAnother, Impossible };
struct LockedFile {
  Lock lock;
  int file;  ///< Taken: open to write. OfAnother: to read. -1: none, and errno
};
LockedFile lock_file(const std::string& path);

int process_id();

/// Is somebody watching standard error where a line can be written again?
bool stderr_is_terminal();

/// Bytes that the system would still give this process; infinity: it sets no limit.
double memory_left();

}  // namespace dea
