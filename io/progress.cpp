#include "progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "output.h"

namespace dea {

namespace {

constexpr const char* kClearLine = "\r\033[K";
constexpr std::size_t kBarLength = 24, kLongestText = 48;  // a line of at most 79 characters

void write_error(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

std::string duration(double s) {
  if (s < 60) return fmt::format("{:.0f} s", std::max(1.0, std::ceil(s)));
  const int minutes = static_cast<int>(std::ceil(s / 60));
  return minutes < 60 ? fmt::format("{} min", minutes) : fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

}  // namespace

ProgressStyle progress_style(bool quiet, bool verbose) {
  if (quiet) return ProgressStyle::Quiet;
  if (verbose) return ProgressStyle::Every;
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
  return stderr_is_terminal() && !dumb ? ProgressStyle::Bar : ProgressStyle::Lines;
}

Progress::Progress(ProgressStyle style) : Progress(style, write_error, seconds) {}

Progress::Progress(ProgressStyle style, std::function<void(const std::string&)> write, std::function<double()> clock)
    : style_(style), write_(std::move(write)), clock_(std::move(clock)), start_(clock_()), last_(start_) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
  if (shown_) write_(kClearLine);
  shown_ = false;
}

void Progress::step(const std::string& what, const std::string& details, std::size_t done, std::size_t total) {
  if (style_ == ProgressStyle::Quiet) return;
  if (style_ == ProgressStyle::Every) {
    write_(details + "\n");
    return;
  }
  const double now = clock_(), wait = style_ == ProgressStyle::Lines ? 2.0 : shown_ ? 0.1 : 0.5;
  if (now - last_ < wait) return;
  last_ = now;
  // What has been done took this long; what is left will take as long per step.
  const double left =
      total > done && done > 0 ? (now - start_) / static_cast<double>(done) * static_cast<double>(total - done) : 0.0;
  std::string text = what;
  if (left > 0) text += fmt::format(", about {} left", duration(left));
  if (style_ == ProgressStyle::Lines) {
    write_(text + "\n");
    return;
  }
  std::string bar;
  if (total > 0) {
    const std::size_t full = std::min(kBarLength, kBarLength * done / total);
    bar = fmt::format("[{}{}] ", std::string(full, '#'), std::string(kBarLength - full, '.'));
  }
  write_(kClearLine + bar + text.substr(0, kLongestText));
  shown_ = true;
}

}  // namespace dea
