// io/study/study_busy.h – a study's file that another program holds.
#pragma once
#include "src/base/error.h"

namespace dea {

/// Another program keeps the file from being read; the same may be tried again.
struct StudyBusy : InputError {
  using InputError::InputError;
};

}  // namespace dea
