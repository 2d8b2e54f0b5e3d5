// src/base/names.h – names in messages: how they are shown, those there are, the one that was meant, and words for
// enumerators.
//
// A name is data: it stays as its file has it, whatever is in it. Only what a terminal, a log or an exception shows is
// made fit for that, where it leaves.
#pragma once
#include <cassert>
#include <initializer_list>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dea {

/// Text for a terminal: what would steer it (control characters, marks that turn the direction of writing) and bytes
/// that are no UTF-8 become "\x1b", "\u202e". Line breaks and tabs stay.
std::string printable(std::string_view text);
/// The same on one line.
std::string one_line(std::string_view text);

/// A name within a message: on one line; of one longer than 80 bytes the first 60 and the last 20.
std::string shown(std::string_view name);
/// The same in quotes.
std::string in_quotes(std::string_view name);

/// A whole message: on one line, and no longer than a few thousand bytes, whatever names it quotes.
std::string message_line(std::string_view message);

/// Letters to change, add, leave out or swap with their neighbour to make `b` of `a`; capitals are small letters.
int edit_distance(std::string_view a, std::string_view b);

/// A word that is usual elsewhere, and its name here: no slip of the keyboard.
struct Alias {
  std::string_view word, name;
};
using Aliases = std::span<const Alias>;

/// The name that `word` is an alias of, else the nearest one; empty: none is so near that it could be a slip of the
/// keyboard. Capitals are small letters; - and _ do not count.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names, Aliases aliases = {});

/// " (did you mean "hip"?)": the nearest name, else the only one that holds the word (of three letters or more) as a
/// part of it; or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names, Aliases aliases = {});

/// "a", "b", ... in quotes, at most `most` of them: of more those nearest to `word`; "none".
std::string name_list(std::vector<std::string> names, std::string_view word = {}, std::size_t most = 8);

/// "a, b and c": the words as they are.
std::string and_list(const std::vector<std::string>& words);

/// The names of bodies, surfaces and whatever else has one.
template <class Things>
std::vector<std::string> every_name(const Things& things) {
  std::vector<std::string> names;
  for (const auto& thing : things) names.emplace_back(thing.name);
  return names;
}

/// "3, 7, ...": the first `most` of them.
std::string number_list(const std::vector<int>& numbers, std::size_t most = 5);

/// "the model has no surface of this name (did you mean "top"?); it has "top", "under"".
std::string no_such_name(const char* what, std::string_view word, const std::vector<std::string>& names);

/// `wanted`, with a number if it is among `names` already ("part_2"); it is among them then.
std::string take_free_name(const std::string& wanted, std::set<std::string>& names);

/// The word for an enumerator; `words` are those of its enumeration, from 0 on and in their order.
template <class Enum>
const char* word_of(Enum enumerator, std::initializer_list<const char*> words) {
  const auto place = static_cast<std::size_t>(enumerator);
  assert(place < words.size());
  return words.begin()[place];
}

}  // namespace dea
