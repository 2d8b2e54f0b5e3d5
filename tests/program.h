// tests/program.h – runs a program of ours as users do, in a folder of its own.
#pragma once
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace dea::test {

namespace fs = std::filesystem;

inline std::string file_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A folder that vanishes with its contents.
struct TemporaryFolder {
  fs::path path;
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "dea_test_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path = name;
  }
  ~TemporaryFolder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

struct Finished {
  int code = -1;           ///< exit code; 128 + signal
  bool timed_out = false;  ///< and was ended
  double seconds = 0.0;
  std::string out, err;
};

/// Processor time in seconds that a running process, with all its threads, has taken so far.
inline double processor_seconds(pid_t process) {
  const std::string text = file_text("/proc/" + std::to_string(process) + "/stat");
  std::istringstream in(text.substr(std::min(text.size(), text.rfind(')') + 1)));  // a name may have spaces
  std::string word;
  for (int i = 0; i < 11; ++i) in >> word;  // up to the time in the program and in the kernel, proc(5)
  double program = 0.0, kernel = 0.0;
  in >> program >> kernel;
  return (program + kernel) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// The same of all programs that this one started, waited for and that have ended.
inline double processor_seconds_of_ended() {
  rusage used = {};
  ::getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/// Runs `words` (the program first) in `folder`, for at most `limit` seconds of processor time: a busy machine does not
/// make a program hang. One that waits for ever is ended after ten times as long.
inline Finished run_program(const fs::path& folder, std::vector<std::string> words, double limit) {
  const TemporaryFolder streams;
  const std::string out = (streams.path / "out").string(), err = (streams.path / "err").string();
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const pid_t child = ::fork();
  if (child == 0) {
    const int o = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600), e = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    const rlimit cpu = {static_cast<rlim_t>(limit), static_cast<rlim_t>(limit) + 1};
    if (o < 0 || e < 0 || ::setrlimit(RLIMIT_CPU, &cpu) != 0 || ::chdir(folder.c_str()) != 0) ::_exit(99);
    ::dup2(o, 1);
    ::dup2(e, 2);
    ::execv(argv[0], argv.data());
    ::_exit(99);
  }
  Finished f;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!f.timed_out && elapsed() > 10 * limit) {
      f.timed_out = true;
      ::kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  f.seconds = elapsed();
  f.timed_out = f.timed_out || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU);
  f.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  f.out = file_text(out);
  f.err = file_text(err);
  return f;
}

/// nan or inf as a word, not in quotes and not part of a longer one.
inline bool has_nan(const std::string& text) {
  const auto part_of_word = [&](std::size_t i) {
    return i < text.size() && (std::isalpha(static_cast<unsigned char>(text[i])) != 0 || text[i] == '"');
  };
  for (const char* word : {"nan", "inf"})
    for (std::size_t i = text.find(word); i != std::string::npos; i = text.find(word, i + 1))
      if ((i == 0 || !part_of_word(i - 1)) && !part_of_word(i + 3)) return true;
  return false;
}

}  // namespace dea::test
