// app/process.h – other programs, and signals: with io/files/system.h all that dea asks of the operating system. The
// twin for Windows is process_windows.cpp, where dea starts no other program.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "src/base/stop.h"

namespace dea {

/// Throws UsageError where dea starts no other program: `command` cannot do without.
void need_programs(const std::string& command);

/// Is there such a program on the path, to be started?
bool on_path(const std::string& program);

/// The file that this program was started from; empty: unknown.
std::filesystem::path own_path();

/// Puts the program of these words, the first its path or its name on the path, in the place of this one; no shell
/// between. Returns only where there is none.
void become_program(std::vector<std::string> words);

/// What is written into `in` comes out of `out`. False: there is no pipe to be had.
bool open_pipe(int& out, int& in);

/// Starts a program of the path with these words, the first its name; no shell between. `files`: what it has as its
/// files 0 (standard input), 1 (output), 2 (errors), 3 and so on. Its process; -1: none can be had.
/// `own_group`: what it starts itself is ended with it by wait_for, and no key of the terminal reaches them; one such
/// at a time.
int start_program(std::vector<std::string> words, std::vector<int> files, bool own_group = false);
/// Waits for its end: its exit code, 128 + the signal that ended it, or kNotFound. Once `stop` is set, its whole group
/// is asked to end, and killed if the process is still there five seconds later, or any of the others when it has
/// ended; start it with `own_group` then.
int wait_for(int process, const StopFlag* stop = nullptr);
/// Kills a group that was started and has not ended. Signal handlers may call it.
void kill_group();
inline constexpr int kNotFound = 127;
void kill_program(int process);

/// A pipe that nobody reads any more does nothing to this program for as long as the result lives, but to what it
/// starts meanwhile: writing fails.
[[nodiscard]] std::shared_ptr<void> ignore_broken_pipe();

/// From here on SIGINT, SIGQUIT, SIGTERM and SIGHUP call it; one that the program was started without (nohup) stays
/// ignored. Windows has Ctrl-C as SIGINT, Ctrl-Break as SIGTERM, the end of the console or of the session as SIGHUP.
void handle_interrupts(void (*handler)(int signal));

/// From here on a limit on file size fails the write, like a full disk, and is reported.
void outlive_file_size_limit();

}  // namespace dea
