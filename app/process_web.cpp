// The twin of process.cpp for WebAssembly, in a page or in node: there are no other programs, and no signals.
#include "app/process.h"
#include "src/base/error.h"

namespace dea {

void need_programs(const std::string& command) {
  throw UsageError(command + ": not in dea for browsers; take dea for Linux");
}

bool on_path(const std::string&) { return false; }
std::filesystem::path own_path() { return {}; }
void become_program(std::vector<std::string>) {}
bool open_pipe(int&, int&) { return false; }
int start_program(std::vector<std::string>, std::vector<int>, bool) { return -1; }
int wait_for(int, const StopFlag*) { return kNotFound; }
void kill_group() {}
void kill_program(int) {}
std::shared_ptr<void> ignore_broken_pipe() { return nullptr; }
void handle_interrupts(void (*)(int)) {}
void outlive_file_size_limit() {}

}  // namespace dea
