// app/study_report.h – `dea study --report`: a study as a page.
#pragma once
#include "app/commands.h"
#include "views/study_page/study_page.h"

namespace dea {

/// --report, --group, --pair, --regions, --dose-above and what belongs to them.
void add_study_report_options(CLI::App& command, StudyArguments& arguments);

/// Throws UsageError: a value that is none, options that do not go together, one that belongs to --report without it.
StudyPageOptions study_page_options(const StudyArguments& arguments);

/// Throws UsageError: --group or --pair name no column that a study of these factors will have.
void check_study_columns(const StudyArguments& arguments, const Plan& plan);

/// Writes the page, if it is asked for, and tells what is thinned on it.
void write_study_report(const StudyArguments& arguments, const std::string& study);

}  // namespace dea
