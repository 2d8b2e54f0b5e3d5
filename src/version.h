// src/version.h – the one place where the program learns its version.
#pragma once
namespace dea {

extern const char* const kVersion;  ///< that of project() in CMakeLists.txt
extern const char* const kCommit;   ///< abbreviated git commit; "unknown": not built from a clone

}  // namespace dea
