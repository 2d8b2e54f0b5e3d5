// febiodea/base/names.h – names in messages: those there are, and the one that was meant.
#pragma once
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace dea {

/// Letters to change, add, leave out or swap with their neighbour to make `b` of `a`; capitals are small letters.
int edit_distance(std::string_view a, std::string_view b);

/// The name nearest to `word`; empty: none is so near that it could be a slip of the keyboard.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names);

/// " (did you mean "hip"?)": the nearest name, else the only one that holds the word (of three letters or more) as a
/// part of it; or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

/// "a", "b", ... in quotes, at most `most` of them: of more those nearest to `word`; "none".
std::string name_list(std::vector<std::string> names, std::string_view word = {}, std::size_t most = 8);

/// `wanted`, with a number if it is among `names` already ("part_2"); it is among them then.
std::string take_free_name(const std::string& wanted, std::set<std::string>& names);

}  // namespace dea
