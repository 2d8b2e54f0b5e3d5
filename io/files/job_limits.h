// io/files/job_limits.h – what control groups and batch systems leave a process.
#pragma once
#include <string>

namespace dea {

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
