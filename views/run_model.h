// views/run_model.h – a model that has been read, to results in files: what `dea run` and FEBio's task share.
#pragma once
#include <functional>
#include <string>

#include "io/settings/output_options.h"
#include "io/xplt/xplt.h"
#include "src/base/finding.h"
#include "src/run/analysis.h"
#include "views/data/run_json.h"

namespace dea {

struct RunOptions {
  OutputSettings outputs;  ///< where to; the page is written by `with_plot`. States: empty: all, or about 1000 of them
                           ///< where there are very many
  std::string times_from;  ///< FEA result whose times to take; "" the model's
  bool compress = false;   ///< the plot file
  double seconds_reading = 0.0;                           ///< spent on the model before
  std::function<void(const std::string& line)> progress;  ///< a line per state; may be empty
  std::function<void(const StateResult&, std::size_t index, std::size_t count)> on_state;  ///< the same, as numbers
  std::function<void(const Activity&)> on_activity;  ///< what is being worked out; may be empty
  const StopFlag* stop = nullptr;                    ///< ends the search, or the writing between two files: Stopped
  std::function<void(const std::vector<double>& times)> on_times;  ///< before springs are placed: of the states that
                                                                   ///< will be written; may be empty, may throw
  std::function<void(const std::string& file)> on_writing;         ///< before a file is written; may be empty
  std::function<void(const Analysis&, XpltFile&&)> with_plot;      ///< what else to make of the plot file; may be empty
};

struct RunResult {
  Analysis analysis;
  Timings timings;
};

/// Solves every wanted state and writes plot file, VTK files, JSON and CSV. Throws UsageError, InputError, WriteError,
/// Stopped.
RunResult run_model(const Recognition& recognition, const RunOptions& options);

/// "hip_dea.xplt: 3 states in 0.20 s (read 0.05, ...)"; without a plot file: "3 states in ..."
std::string run_summary(const RunOptions& options, const RunResult& result);

}  // namespace dea
