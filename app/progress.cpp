#include "app/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>
#include <utility>

#include "io/files/output.h"
#include "io/files/system.h"
#include "src/base/names.h"

namespace dea {

namespace {

constexpr const char* kClearLine = "\r\033[K";
constexpr std::size_t kBarLength = 24, kLine = 79;
constexpr double kCounted = 3.0;    ///< what takes longer has its seconds counted [s]
constexpr double kPatience = 15.0;  ///< between lines that say the same but for the seconds [s]

void write_error(const std::string& text) { write_all(kStandardError, text); }

}  // namespace

std::string duration(double s) {
  if (s < 60) return fmt::format("{:.0f} s", std::max(1.0, std::ceil(s)));
  const int minutes = static_cast<int>(std::ceil(s / 60));
  return minutes < 60 ? fmt::format("{} min", minutes) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

ProgressStyle progress_style(bool quiet, bool verbose) {
  if (quiet) return ProgressStyle::Quiet;
  if (verbose) return ProgressStyle::Every;
  return stderr_is_terminal() ? ProgressStyle::Bar : ProgressStyle::Lines;
}

Progress::Progress(ProgressStyle style) : Progress(style, write_error, seconds) {
  if (style != ProgressStyle::Bar && style != ProgressStyle::Lines) return;
  try {
    ticker_ = std::thread([this] {
      std::unique_lock<std::mutex> lock(mutex_);
      while (!ended_) {
        wake_.wait_for(lock, std::chrono::milliseconds(500));
        if (!ended_) show();
      }
    });
  } catch (const std::system_error&) {  // no thread is to be had: seconds are counted at each step alone
  }
}

Progress::Progress(ProgressStyle style, std::function<void(const std::string&)> write, std::function<double()> clock)
    : style_(style), write_(std::move(write)), clock_(std::move(clock)), start_(clock_()), last_(start_) {}

Progress::~Progress() {
  clear();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    wake_.notify_all();
  }
  if (ticker_.joinable()) ticker_.join();
}

void Progress::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (shown_) write_(kClearLine);
  shown_ = false;
  what_.clear();
}

void Progress::tick() {
  const std::lock_guard<std::mutex> lock(mutex_);
  show();
}

void Progress::set(const std::string& what, const std::string& within, std::size_t done, std::size_t total) {
  if (what != what_ || within != within_) begun_ = clock_();
  what_ = what;
  within_ = within;
  done_ = done;
  total_ = total;
}

void Progress::now(const std::string& what, const std::string& within, const std::string& details, std::size_t done,
                   std::size_t total) {
  if (style_ == ProgressStyle::Quiet) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (style_ == ProgressStyle::Every) {
    if (!details.empty()) write_(message_line(details) + "\n");
    return;
  }
  if (total > 0 && !first_step_) first_step_ = clock_();
  set(what, within, done, total);
  show();
}

void Progress::step(const std::string& what, const std::string& details, std::size_t done, std::size_t total) {
  if (style_ == ProgressStyle::Quiet) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (style_ == ProgressStyle::Every) {
    if (!details.empty()) write_(message_line(details) + "\n");
    return;
  }
  if (!first_step_) first_step_ = start_;
  steps_ended_ = clock_();
  set(what, "", done, total);
  show();
}

std::string Progress::text(double now) const {
  // What has been done took this long; what is left will take as long per step.
  const double left =
      total_ > done_ && done_ > 0 && first_step_
          ? (steps_ended_ - *first_step_) / static_cast<double>(done_) * static_cast<double>(total_ - done_) -
                (now - steps_ended_)
          : 0.0;
  const std::string what = message_line(what_), within = within_.empty() ? "" : ": " + message_line(within_),
                    remaining = left > 0 ? fmt::format(", about {} left", duration(left)) : "",
                    counted = now - begun_ >= kCounted ? fmt::format(" ({:.0f} s)", std::floor(now - begun_)) : "";
  if (style_ == ProgressStyle::Lines) return what + within + remaining + counted;
  std::string bar;
  if (total_ > 0) {
    const std::size_t full = std::min(kBarLength, kBarLength * done_ / total_);
    bar = fmt::format("[{}{}] ", std::string(full, '#'), std::string(kBarLength - full, '.'));
  }
  const std::size_t room = kLine - bar.size();
  for (const std::string& shown : {what + within + remaining + counted, what + within + counted, what + counted})
    if (shown.size() <= room) return bar + shown;
  return bar + what.substr(0, room - std::min(room, counted.size())) + counted;
}

void Progress::show() {
  if (what_.empty()) return;
  const double now = clock_();
  const std::string same = what_ + ":" + within_;
  const bool lines = style_ == ProgressStyle::Lines;
  if (now - last_ < (lines ? (same == written_ ? kPatience : 2.0) : shown_ ? 0.1 : 0.5)) return;
  last_ = now;
  written_ = same;
  write_(lines ? text(now) + "\n" : kClearLine + text(now));
  shown_ = !lines;
}

}  // namespace dea
