// views/study_page/study_thinning.h – which cases of a study are left where not all fit.
#pragma once
#include <functional>
#include <vector>

#include "views/study_page/study_numbers.h"

namespace dea {

/// Flags of cases, of those that `may` be taken, such that `fits`. Of a grid every second level goes, of the factor
/// that has most of them, its ends stay, again and again: what is left is a grid. Of other studies, and where that is
/// not enough, one case in 2, 4, ... is left.
std::vector<char> thinned_cases(const StudyNumbers& numbers, const std::vector<char>& may,
                                const std::function<bool(const std::vector<char>& kept)>& fits);

}  // namespace dea
