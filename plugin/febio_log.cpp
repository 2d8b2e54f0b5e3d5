#include "plugin/febio_log.h"

#include <FEBioLib/FEBioModel.h>
#include <FECore/log.h>
#include <FECore/version.h>
#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <vector>

#include "plugin/febio_wording.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/version.h"

namespace dea {

namespace {

/// FEBio's logging takes a finished message for a printf format `times` more times.
std::string escaped(const std::string& text, int times) {
  std::string result;
  for (const char c : text) result += c == '%' ? std::string(std::size_t{1} << times, '%') : std::string(1, c);
  return result;
}

/// Lines that FEBio's box takes as they are: it drops a letter of longer words and has room for ten lines.
std::string box(const std::string& text) {
  constexpr std::size_t kWidth = 66, kMost = 10;
  std::vector<std::string> lines(1);
  std::istringstream words(message_line(text));
  for (std::string word; words >> word;) {
    while (!word.empty()) {
      if (!lines.back().empty() && lines.back().size() + 1 + word.size() > kWidth) lines.emplace_back();
      const std::string part = word.substr(0, kWidth);
      lines.back() += (lines.back().empty() ? "" : " ") + part;
      word.erase(0, part.size());
    }
  }
  if (lines.size() > kMost) {
    lines.resize(kMost);
    lines.back() = "...";
  }
  return escaped(fmt::format("{}", fmt::join(lines, "\n")), 2);
}

}  // namespace

std::string version_line() {
  return fmt::format("dea {}, SDK {}.{}.{}", kVersion, FE_SDK_MAJOR_VERSION, FE_SDK_SUB_VERSION, FE_SDK_SUBSUB_VERSION);
}

std::string untested_line() {
  return untested_line(DEA_TESTED_FEBIO, fmt::format("{}.{}", FE_SDK_MAJOR_VERSION, FE_SDK_SUB_VERSION));
}

void open_log_file(FEModel& fem) {
  auto* model = dynamic_cast<FEBioModel*>(&fem);
  if (model == nullptr || model->GetLogFile().is_valid()) return;
  const FEParam* level = model->GetParameter("log_level");
  if (level != nullptr && level->value<int>() == 0) return;
  if (model->GetLogfileName().empty())
    model->SetLogFilename(std::filesystem::path(model->GetInputFileName()).replace_extension(".log").string());
  const std::string name = model->GetLogfileName();
  if (!model->GetLogFile().open(name.c_str())) {
    model->GetLogFile().close();
    throw WriteError(fmt::format("{}: FEBio's log file", name));
  }
}

void log_text(FEModel& fem, const std::string& text) {
  constexpr std::size_t kMost = 900;  // characters of one call
  std::istringstream lines(printable(text));
  for (std::string line; std::getline(lines, line);) {
    for (std::size_t begin = 0; begin == 0 || begin < line.size(); begin += kMost)
      feLogEx(&fem, "%s", escaped(line.substr(begin, kMost), 1).c_str());
    feLogEx(&fem, "\n");
  }
}

void log_warning(FEModel& fem, const std::string& text) { feLogWarningEx((&fem), "%s", box(text).c_str()); }

void log_error(FEModel& fem, const std::string& text) { feLogErrorEx((&fem), "%s", box(text).c_str()); }

}  // namespace dea
