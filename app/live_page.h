// app/live_page.h – the joint of a run as a page that solves.
#pragma once
#include <string>

#include "app/options.h"
#include "src/model/joint_model.h"

namespace dea {

/// Where dea.html is: beside the program, or installed with it. Throws UsageError: nowhere.
std::string live_program();

/// The page. `settings`: effective ones; `states`: as typed. Throws UsageError: files that a page without folders
/// cannot have; InputError.
std::string live_page_of(const std::string& program, const ModelArguments& a, const JointModel& model,
                         const Settings& settings, const std::string& states);

}  // namespace dea
