// io/files/free_memory.h – the memory that is free, and files read whole within it.
#pragma once
#include <optional>
#include <string>

namespace dea {

/// Bytes that this process may still take: of the machine, of its control groups, of Slurm's job, of its limit on
/// addresses. Infinity: nobody says.
double free_memory();

/// Bytes that no one is asked about.
inline constexpr double kLittleMemory = 256e6;

/// "1.2 GB".
std::string gigabytes(double bytes);

/// Throws InputError where what is read from `path` needs more memory than is free. `bytes`: about what it needs.
void need_memory(const std::string& path, double bytes);

/// All that a file or pipe holds; nothing: it cannot be read, or is a folder. `memory_per_byte`: what is made of it.
/// Throws InputError: more than the memory holds, or than kMostOfPipe of something that has no size.
std::optional<std::string> whole_file(const std::string& path, double memory_per_byte);
inline constexpr double kMostOfPipe = 1e9;

}  // namespace dea
