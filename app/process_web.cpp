// The twin of process.cpp for WebAssembly, in a page or in node: there are no other programs, and no signals.
#include "app/process.h"
#include "src/base/error.h"

namespace dea {

void need_programs(const std::string& command) {
  throw UsageError(command + ": not in dea for browsers; take dea for Linux");
}

std::filesystem::path own_path() { return {}; }
void handle_interrupts(void (*)(int)) {}

}  // namespace dea
