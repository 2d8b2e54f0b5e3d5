#include "app/process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

namespace dea {

namespace {

using Handler = void (*)(int);

std::atomic<int> group = 0;  // that was started and has not ended; 0: none

/// The handler there was; a signal that is ignored stays so.
Handler handle(int signal, Handler handler) {
  struct sigaction action = {}, before = {};
  if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) return SIG_IGN;
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
  return before.sa_handler;
}

/// As exec takes them.
std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  return argv;
}

}  // namespace

void need_programs(const std::string&) {}

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

bool open_pipe(int& out, int& in) {
  int ends[2];
  if (::pipe(ends) != 0) return false;
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);  // who reads and holds `in` too waits for ever
  out = ends[0];
  in = ends[1];
  return true;
}

std::filesystem::path own_path() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown);
}

void become_program(std::vector<std::string> words) {
  std::vector<char*> argv = pointers(words);
  ::execvp(argv[0], argv.data());
}

int start_program(std::vector<std::string> words, std::vector<int> files, bool own_group) {
  std::vector<char*> argv = pointers(words);
  std::signal(SIGCHLD, SIG_DFL);  // ignored by whoever started us, its exit code would be lost
  const pid_t child = ::fork();
  if (child != 0) {
    if (child > 0 && own_group) {
      ::setpgid(child, child);  // both of us: whoever comes first
      group = child;
    }
    return child;
  }
  if (own_group) {
    ::setpgid(0, 0);
    std::signal(SIGTTOU, SIG_IGN);  // it may write to the terminal all the same
  }
  // to numbers above those that are set, so that none is overwritten before it has been copied
  for (int& file : files) file = ::fcntl(file, F_DUPFD_CLOEXEC, 10);
  for (std::size_t i = 0; i < files.size(); ++i) ::dup2(files[i], static_cast<int>(i));
  ::execvp(argv[0], argv.data());
  ::_exit(kNotFound);
}

int wait_for(int process, const StopFlag* stop) {
  constexpr auto kPatience = std::chrono::seconds(5);
  using Clock = std::chrono::steady_clock;
  int status = 0;
  Clock::time_point asked;
  bool stopping = false;
  for (;;) {
    const pid_t ended = ::waitpid(process, &status, stop != nullptr ? WNOHANG : 0);
    if (ended == process) break;
    if (ended < 0 && errno != EINTR) return kNotFound;  // no child of ours
    if (ended != 0 || stop == nullptr) continue;
    if (*stop && !stopping) {
      stopping = true;
      asked = Clock::now();
      ::kill(-process, SIGTERM);
      ::kill(-process, SIGCONT);  // one that the terminal holds hears nothing
    }
    if (stopping && Clock::now() - asked > kPatience) ::kill(-process, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (group == process) {
    if (stopping) ::kill(-process, SIGKILL);  // whoever is left
    group = 0;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void kill_group() {
  const int now = group;
  if (now > 0) ::kill(-now, SIGKILL);
}

void kill_program(int process) { ::kill(process, SIGKILL); }

void handle_interrupts(void (*handler)(int signal)) {
  for (const int signal : {SIGINT, SIGQUIT, SIGTERM, SIGHUP}) handle(signal, handler);
}

std::shared_ptr<void> ignore_broken_pipe() {
  // by a handler that does nothing: other than SIG_IGN, it does not pass on to what is started
  return {nullptr, [before = handle(SIGPIPE, [](int) {})](void*) { handle(SIGPIPE, before); }};
}

void outlive_file_size_limit() { std::signal(SIGXFSZ, SIG_IGN); }

}  // namespace dea
