// views/text/words.h – lists within a sentence.
#pragma once
#include <string>
#include <vector>

namespace dea {

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words);

}  // namespace dea
