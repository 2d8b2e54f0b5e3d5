// The twin of process.cpp for Windows. dea starts no other program there: the compiler that the plugin needs, dea-build
// and ffmpeg with its files by number are Linux's.
#include <windows.h>

#include <csignal>

#include "app/process.h"
#include "src/base/error.h"

namespace dea {

namespace {

constexpr int kHangUp = 1;  // SIGHUP

void (*on_event)(int signal) = nullptr;

/// Windows calls it in a thread of its own.
BOOL WINAPI take_event(DWORD event) {
  const bool of_key = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT;
  on_event(event == CTRL_C_EVENT ? SIGINT : event == CTRL_BREAK_EVENT ? SIGTERM : kHangUp);
  if (!of_key) {  // the program is ended when this returns, and five seconds later if it does not
    Sleep(4000);
    on_event(kHangUp);
  }
  return TRUE;
}

}  // namespace

void need_programs(const std::string& command) {
  throw UsageError(command + ": not in dea for Windows; take dea for Linux, in WSL or on another machine");
}

std::filesystem::path own_path() {
  std::wstring path(1 << 15, L'\0');  // longer than any
  path.resize(GetModuleFileNameW(nullptr, path.data(), static_cast<DWORD>(path.size())));
  return path;
}

void handle_interrupts(void (*handler)(int signal)) {
  on_event = handler;
  SetConsoleCtrlHandler(take_event, TRUE);
}

}  // namespace dea
