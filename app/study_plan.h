// app/study_plan.h – from the line of `dea study` to what is solved.
#pragma once
#include "app/commands.h"
#include "app/progress.h"
#include "io/study/study_request.h"

namespace dea {

/// All of the line but its shard and what is kept. Whatever can be wrong with it is found here, before anything is
/// solved. Throws UsageError, InputError.
Study study_of(const StudyArguments& arguments, Progress& progress);

}  // namespace dea
