// io/progress.h – how far a long command has come, for whoever watches standard error.
#pragma once
#include <functional>
#include <string>

namespace dea {

/// Quiet: nothing. Bar: one line that is written over, on a terminal. Lines: now and then a line, in files and pipes.
/// Every: each step's own line.
enum class ProgressStyle { Quiet, Bar, Lines, Every };
/// What -q and -v and the place of standard error ask for.
ProgressStyle progress_style(bool quiet, bool verbose);

/// Shows steps. Nothing in the first half second (Bar) or two seconds (Lines) of a command, and no more often than
/// every tenth of a second or two seconds after. Whatever ends the command, clear() or the end of the object's life
/// takes a bar away, so that no message is written behind half of one.
class Progress {
 public:
  explicit Progress(ProgressStyle style);
  /// `write` and `clock` [s] stand for standard error and the computer's clock.
  Progress(ProgressStyle style, std::function<void(const std::string&)> write, std::function<double()> clock);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Step `done` of `total` (0: nobody knows) has been done. `what`: "state 3 of 23"; `details` stand on its own line
  /// in style Every.
  void step(const std::string& what, const std::string& details, std::size_t done, std::size_t total);
  void clear();

 private:
  ProgressStyle style_;
  std::function<void(const std::string&)> write_;
  std::function<double()> clock_;
  double start_ = 0.0, last_ = 0.0;
  bool shown_ = false;
};

}  // namespace dea
