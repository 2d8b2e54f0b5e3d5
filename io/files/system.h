// io/files/system.h – what the operating system is asked for: files, their locks, this process. Other sources
// include no header of POSIX, but app/process.cpp (tests/includes.py).
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace dea {

/// "No space left on device". `error`: errno; 0: "write error".
std::string reason_of(int error);

enum class OpenAs {
  New,      ///< to read and write; fails where it is there
  Shared,   ///< to read and write; made where it is missing
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
inline constexpr int kStandardError = 2;

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

/// An advisory lock for as long as the file is open.
enum class Lock { Taken, OfAnother, Impossible };
Lock lock_file(int file);

/// Is the open file the one of this name?
bool is_named(int file, const std::string& path);

int process_id();

/// Is somebody watching standard error?
bool stderr_is_terminal();

/// Bytes of addresses that this process may have; infinity: as many as there are.
double address_limit();

}  // namespace dea
