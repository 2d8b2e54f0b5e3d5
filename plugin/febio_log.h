// plugin/febio_log.h – texts into FEBio's log: file and console.
#pragma once
#include <string>

class FEModel;

namespace dea {

/// Opens FEBio's log file if FEModel::Init, which would do so, has not been called; unless the user wants none. Throws
/// WriteError.
void open_log_file(FEModel& fem);

/// "dea 1.0.0, SDK 4.11.0": what is running here.
std::string version_line();

/// A line, with its end, if this SDK is not among those the plugin was verified with, else empty.
std::string untested_line();

/// Prints every line of `text`.
void log_text(FEModel& fem, const std::string& text);

/// One warning, one error in FEBio's box.
void log_warning(FEModel& fem, const std::string& text);
void log_error(FEModel& fem, const std::string& text);

}  // namespace dea
