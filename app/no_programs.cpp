// What app/process.h has of other programs, for the twins of process.cpp: there dea starts none.
#include "app/process.h"

namespace dea {

bool on_path(const std::string&) { return false; }
void become_program(std::vector<std::string>) {}
bool open_pipe(int&, int&) { return false; }
int start_program(std::vector<std::string>, std::vector<int>, bool) { return -1; }
int wait_for(int, const StopFlag*) { return kNotFound; }
void kill_group() {}
void kill_program(int) {}
std::shared_ptr<void> ignore_broken_pipe() { return nullptr; }
void outlive_file_size_limit() {}

}  // namespace dea
