// tests/io/resident.h – what the kernel counts as this process's memory.
#pragma once
#include <malloc.h>
#include <unistd.h>

#include <fstream>

namespace dea::test {

/// Pages that this process holds [bytes], without those that the allocator could give back.
inline double resident() {
  ::malloc_trim(0);
  std::ifstream in("/proc/self/statm");
  double all = 0, resident = 0;
  in >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace dea::test
