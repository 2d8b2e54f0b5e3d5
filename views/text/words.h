// views/text/words.h – names and lists within a sentence.
#pragma once
#include <string>
#include <vector>

namespace dea {

std::string in_quotes(const std::string& name);

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words);

}  // namespace dea
