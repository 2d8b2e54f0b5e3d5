// app/progress.h – how far a long command has come, for whoever watches standard error.
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace dea {

/// Quiet: nothing. Bar: one line that is written over, on a terminal. Lines: now and then a line, in files and pipes.
/// Every: each step's own line.
enum class ProgressStyle { Quiet, Bar, Lines, Every };
/// What -q and -v and the place of standard error ask for.
ProgressStyle progress_style(bool quiet, bool verbose);

/// "48 s", "2 min", "3 h 20 min".
std::string duration(double seconds);

/// Shows what is being done and how far it has come. Nothing in the first half second (Bar) or two seconds (Lines) of a
/// command, and no more often than every tenth of a second or two seconds after. What takes long gets its seconds
/// counted (by a thread), so that it can be told from what has died. clear() or the end of the object's life, whatever
/// ends the command, takes a bar away, so that no message is written behind half of one; the next step shows again.
class Progress {
 public:
  explicit Progress(ProgressStyle style);
  /// `write` and `clock` [s] stand for standard error and the computer's clock; no thread: tick() is yours.
  Progress(ProgressStyle style, std::function<void(const std::string&)> write, std::function<double()> clock);
  ~Progress();

  /// Begins: "reading hip.feb", or step `done` + 1 of `total` (0: nobody knows): "state 4 of 23", and within it
  /// "iteration 2". `details` stand on their own line in style Every, unless they are empty.
  void now(const std::string& what, const std::string& within, const std::string& details, std::size_t done = 0,
           std::size_t total = 0);
  /// Step `done` of `total` has been done. `what`: "state 3 of 23"; `details` stand on its own line in style Every,
  /// unless they are empty.
  void step(const std::string& what, const std::string& details, std::size_t done, std::size_t total);
  void clear();
  /// Time has passed.
  void tick();

 private:
  void set(const std::string& what, const std::string& within, std::size_t done, std::size_t total);
  void show();
  std::string text(double now) const;

  ProgressStyle style_;
  std::function<void(const std::string&)> write_;
  std::function<double()> clock_;
  double start_ = 0.0, last_ = 0.0;  ///< of all; when something was written
  std::string what_, within_, written_;
  std::size_t done_ = 0, total_ = 0;
  double begun_ = 0.0;                  ///< what is being done
  std::optional<double> first_step_;    ///< when the first step began; none: with the command
  double steps_ended_ = 0.0;            ///< when step `done_` was done
  bool shown_ = false, ended_ = false;  ///< a bar is there; the ticker is to end
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread ticker_;
};

}  // namespace dea
