// The twin of system.cpp for Windows. A file that is open can be taken away and replaced there only if each who has it
// open shares that: ours do.
#include "io/files/system.h"

#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include <algorithm>
#include <cerrno>
#include <cwchar>
#include <iterator>
#include <random>
#include <utility>

namespace dea {

namespace {

constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
constexpr int kTries = 25;  // for half a second: others, such as those that look for viruses, hold a file for a moment
constexpr DWORD kPause = 20;            // ms
constexpr DWORD kQuotaExceeded = 1295;  // ERROR_DISK_QUOTA_EXCEEDED, which MinGW does not name

std::wstring wide(std::string_view text) {
  const int bytes = static_cast<int>(text.size());
  std::wstring result(text.size(), L'\0');  // never more than bytes
  result.resize(static_cast<std::size_t>(MultiByteToWideChar(CP_UTF8, 0, text.data(), bytes, result.data(), bytes)));
  return result;
}

HANDLE handle_of(int file) { return reinterpret_cast<HANDLE>(_get_osfhandle(file)); }

/// POSIX's number of Windows' error.
int errno_of(DWORD error) {
  static constexpr std::pair<DWORD, int> kNumbers[] = {
      {ERROR_SUCCESS, 0},
      {ERROR_FILE_NOT_FOUND, ENOENT},
      {ERROR_PATH_NOT_FOUND, ENOENT},
      {ERROR_INVALID_DRIVE, ENOENT},
      {ERROR_INVALID_NAME, ENOENT},
      {ERROR_BAD_NETPATH, ENOENT},
      {ERROR_BAD_NET_NAME, ENOENT},
      {ERROR_DIRECTORY, ENOTDIR},
      {ERROR_ACCESS_DENIED, EACCES},
      {ERROR_WRITE_PROTECT, EACCES},
      {ERROR_SHARING_VIOLATION, EBUSY},
      {ERROR_LOCK_VIOLATION, EBUSY},
      {ERROR_USER_MAPPED_FILE, EBUSY},
      {ERROR_FILE_EXISTS, EEXIST},
      {ERROR_ALREADY_EXISTS, EEXIST},
      {ERROR_DIR_NOT_EMPTY, ENOTEMPTY},
      {ERROR_DISK_FULL, ENOSPC},
      {ERROR_HANDLE_DISK_FULL, ENOSPC},
      {kQuotaExceeded, ENOSPC},
      {ERROR_FILE_TOO_LARGE, EFBIG},
      {ERROR_FILENAME_EXCED_RANGE, ENAMETOOLONG},
      {ERROR_TOO_MANY_OPEN_FILES, EMFILE},
      {ERROR_BROKEN_PIPE, EPIPE},
      {ERROR_NO_DATA, EPIPE},
      {ERROR_INVALID_HANDLE, EBADF},
      {ERROR_NOT_ENOUGH_MEMORY, ENOMEM},
  };
  const auto* known =
      std::find_if(std::begin(kNumbers), std::end(kNumbers), [&](const auto& pair) { return pair.first == error; });
  return known != std::end(kNumbers) ? known->second : EIO;
}

/// False, and errno.
bool failed() {
  errno = errno_of(GetLastError());
  return false;
}

/// Of a handle; -1 and errno: there is none.
int file_of(HANDLE handle, int how) {
  if (handle == INVALID_HANDLE_VALUE) {
    failed();
    return -1;
  }
  const int file = _open_osfhandle(reinterpret_cast<std::intptr_t>(handle), how | _O_BINARY | _O_NOINHERIT);
  if (file < 0) CloseHandle(handle);
  return file;
}

/// For a file that others have open: some let it be renamed. 0 or the error.
int replace_open_file(const std::wstring& from, const std::wstring& to) {
  const std::wstring aside = from + L".old";
  if (!MoveFileExW(to.c_str(), aside.c_str(), 0)) return errno_of(GetLastError());
  if (MoveFileExW(from.c_str(), to.c_str(), 0)) {
    DeleteFileW(aside.c_str());  // it goes when they close it
    return 0;
  }
  const int why = errno_of(GetLastError());
  MoveFileExW(aside.c_str(), to.c_str(), 0);
  return why;
}

/// What a console shows are letters, whatever its code page.
bool write_letters(HANDLE console, std::string_view bytes) {
  const std::wstring text = wide(bytes);
  for (std::size_t at = 0; at < text.size();) {
    constexpr std::size_t kMost = 8192;
    DWORD n = 0;
    if (!WriteConsoleW(console, text.data() + at, static_cast<DWORD>(std::min(kMost, text.size() - at)), &n, nullptr) ||
        n == 0)
      return false;
    at += n;
  }
  return true;
}

}  // namespace

std::string reason_of(int error) {
  return error == 0       ? "write error"
         : error == EBUSY ? "another program has it open"
                          : std::generic_category().message(error);
}

std::string reason_of(const std::error_code& error) {
  return reason_of(error.category() == std::system_category() ? errno_of(static_cast<DWORD>(error.value()))
                                                              : error.value());
}

bool failed_to_write(int error) { return error == EFBIG || error == ENOSPC || error == EIO; }

int open_file(const std::string& path, OpenAs as) {
  const DWORD access = as == OpenAs::New       ? GENERIC_READ | GENERIC_WRITE
                       : as == OpenAs::Reading ? GENERIC_READ
                       : as == OpenAs::Writing ? GENERIC_WRITE
                                               : FILE_APPEND_DATA | SYNCHRONIZE;
  const DWORD there = as == OpenAs::New ? CREATE_NEW : as == OpenAs::Log ? OPEN_ALWAYS : OPEN_EXISTING;
  return file_of(CreateFileW(wide(path).c_str(), access, kShared, nullptr, there, FILE_ATTRIBUTE_NORMAL, nullptr),
                 as == OpenAs::Reading ? _O_RDONLY : 0);
}

int open_nameless() {
  wchar_t folder[MAX_PATH + 1], name[MAX_PATH];
  if (GetTempPathW(MAX_PATH + 1, folder) == 0 || GetTempFileNameW(folder, L"dea", 0, name) == 0) {
    failed();
    return -1;
  }
  const int file = file_of(CreateFileW(name, GENERIC_READ | GENERIC_WRITE, kShared, nullptr, CREATE_ALWAYS,
                                       FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr),
                           0);
  if (file < 0) {
    const int why = errno;
    DeleteFileW(name);  // the name was made as a file
    errno = why;
  }
  return file;
}

bool close_file(int file) { return _close(file) == 0; }

int write_all(int file, std::string_view bytes) {
  const HANDLE handle = handle_of(file);
  DWORD mode = 0;
  if (GetConsoleMode(handle, &mode)) return write_letters(handle, bytes) ? 0 : errno_of(GetLastError());
  while (!bytes.empty()) {
    constexpr std::size_t kMost = std::size_t{1} << 24;
    DWORD n = 0;
    if (!WriteFile(handle, bytes.data(), static_cast<DWORD>(std::min(kMost, bytes.size())), &n, nullptr))
      return errno_of(GetLastError());
    bytes.remove_prefix(n);
  }
  return 0;
}

std::string read_at(int file, std::uint64_t place, std::size_t most) {
  const HANDLE handle = handle_of(file);
  LARGE_INTEGER here = {}, start = {};
  SetFilePointerEx(handle, {}, &here, FILE_CURRENT);
  start.QuadPart = static_cast<LONGLONG>(place);
  std::string bytes(most, '\0');
  DWORD n = 0;
  const bool read = SetFilePointerEx(handle, start, nullptr, FILE_BEGIN) &&
                    ReadFile(handle, bytes.data(), static_cast<DWORD>(most), &n, nullptr);
  errno = read ? 0 : errno_of(GetLastError());
  SetFilePointerEx(handle, here, nullptr, FILE_BEGIN);  // where the next bytes are written
  bytes.resize(n);
  return bytes;
}

void remove_file(const char* path) { DeleteFileW(wide(path).c_str()); }
void remove_empty_folder(const char* path) { RemoveDirectoryW(wide(path).c_str()); }

bool make_own_folder(std::string& name) {  // the temporary folder is the user's own
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  for (int i = 0; i < kTries; ++i) {
    for (std::size_t k = name.size() - 6; k < name.size(); ++k) name[k] = kLetters[random() % kLetters.size()];
    if (CreateDirectoryW(wide(name).c_str(), nullptr)) return true;
    if (GetLastError() != ERROR_ALREADY_EXISTS) break;
  }
  return failed();
}

bool may_read(const std::string& path) {
  const int file = open_file(path, OpenAs::Reading);
  return file >= 0 && close_file(file);
}

bool may_fill(const std::string& folder) {
  const HANDLE handle = CreateFileW(wide(folder).c_str(), FILE_ADD_FILE, kShared, nullptr, OPEN_EXISTING,
                                    FILE_FLAG_BACKUP_SEMANTICS, nullptr);
  return handle != INVALID_HANDLE_VALUE ? CloseHandle(handle) != 0 : failed();
}

bool may_replace(const std::string& path) {
  for (int i = 0;; ++i) {
    const HANDLE handle = CreateFileW(wide(path).c_str(), DELETE, kShared, nullptr, OPEN_EXISTING, 0, nullptr);
    if (handle != INVALID_HANDLE_VALUE) return CloseHandle(handle) != 0;
    failed();
    if (errno != EBUSY || i == kTries) return false;
    Sleep(kPause);
  }
}

int replace_file(const std::string& from, const std::string& to) {
  const std::wstring source = wide(from), target = wide(to);
  for (int i = 0;; ++i) {
    if (MoveFileExW(source.c_str(), target.c_str(), MOVEFILE_REPLACE_EXISTING)) return 0;
    const int why = errno_of(GetLastError());
    if (why != EACCES && why != EBUSY) return why;
    const int open = replace_open_file(source, target);
    if (open == 0) return 0;
    if (i == kTries) return open == EBUSY ? open : why;
    Sleep(kPause);
  }
}

LockedFile lock_file(const std::string& path) {
  // The file itself is the lock: its holder lets nobody else write it, and it goes with the holder, killed or not.
  const std::wstring name = wide(path);
  for (int i = 0;; ++i) {
    const HANDLE handle =
        CreateFileW(name.c_str(), GENERIC_READ | GENERIC_WRITE | DELETE, FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr,
                    OPEN_ALWAYS, FILE_ATTRIBUTE_HIDDEN | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
    if (handle != INVALID_HANDLE_VALUE) {
      const int file = file_of(handle, 0);
      return {file < 0 ? Lock::Impossible : Lock::Taken, file};
    }
    failed();
    if (errno == EBUSY) {
      // a run lets others read who it is; one that lets nobody is no run, and goes in a moment
      const int file = open_file(path, OpenAs::Reading);
      if (file >= 0 || i == kTries) return {Lock::OfAnother, file};
    } else if (errno != EACCES || i == kTries) {  // one that is going away, as its holder ends, cannot be opened or made
      return {Lock::Impossible, -1};
    }
    Sleep(kPause);
  }
}

int process_id() { return static_cast<int>(GetCurrentProcessId()); }

bool stderr_is_terminal() {
  const HANDLE handle = handle_of(kStandardError);
  DWORD mode = 0;
  return GetConsoleMode(handle, &mode) &&
         SetConsoleMode(handle, mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

double memory_left() {
  MEMORYSTATUSEX status = {};
  status.dwLength = sizeof status;
  if (!GlobalMemoryStatusEx(&status)) return 0.0;
  return static_cast<double>(std::min(status.ullAvailPhys, status.ullAvailVirtual));
}

}  // namespace dea

/// std::filesystem takes each byte of a name for a letter, whatever the code page: it asks the runtime library, to
/// which the linker gives this in place of its own (--wrap). UTF-8; a letter beyond 16 bits comes in two calls, its
/// first half with three bytes, its second with the last. What is no UTF-8 becomes U+FFFD, byte by byte.
extern "C" std::size_t __wrap_mbrtowc(wchar_t* to, const char* from, std::size_t count, std::mbstate_t* half) {
  if (from == nullptr || count == 0) return from == nullptr ? 0 : static_cast<std::size_t>(-2);
  wchar_t ignored = 0;
  wchar_t& letter = to != nullptr ? *to : ignored;
  if (half != nullptr && *half != 0) {
    letter = static_cast<wchar_t>(*half);
    *half = 0;
    return 1;
  }
  const auto first = static_cast<unsigned char>(*from);
  const std::size_t size = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  wchar_t halves[2] = {};
  const bool whole =
      size <= count && MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, from, static_cast<int>(size), halves, 2) != 0;
  letter = whole ? halves[0] : L'\xFFFD';
  if (whole && size == 4 && half != nullptr) *half = static_cast<std::mbstate_t>(halves[1]);
  return !whole ? 1 : size == 4 ? 3 : letter != L'\0' ? size : 0;
}
