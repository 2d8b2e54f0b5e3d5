// io/files/free_memory.h – the memory that is free, files read whole within it, and what control groups and batch
// systems leave a process.
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

/// The number behind a word at the start of a line of a file, as the kernel writes them. Infinity: there is none, or no
/// number ("max": no limit).
double number_after(const std::string& path, const std::string& word);

/// Bytes that the control groups of a process may still take, the least of all levels. Infinity: none has a limit.
/// `memberships`: a file as /proc/self/cgroup; `root`: where the groups are mounted, as /sys/fs/cgroup.
double free_of_groups(const std::string& memberships, const std::string& root);

/// Bytes that Slurm gives the job on this node (SLURM_MEM_PER_NODE, SLURM_MEM_PER_CPU). Infinity: it does not say.
double memory_of_job();

/// How many tasks of one srun or mpirun run on this node at a time; 1: nobody says.
int tasks_on_node();

/// Processors that Slurm gives each of them; 0: it does not say.
int processors_of_task();

}  // namespace dea
