// io/report/write_report.h – a report as one HTML file that needs nothing else, no network either.
#pragma once
#include <string>

#include "report_data.h"

namespace dea {

/// The page: scripts, styles and data inside. No name or text of `data` is taken for markup. UTF-8; bytes that are not
/// become U+FFFD. The same data give the same bytes.
std::string report_html(const ReportData& data);

/// By way of a temporary file. Throws WriteError.
void write_report(const std::string& path, const ReportData& data);

}  // namespace dea
