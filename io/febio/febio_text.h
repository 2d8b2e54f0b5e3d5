// io/febio/febio_text.h – FEBio's way to write numbers, lists and words.
#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "src/base/names.h"

namespace dea::febio {

/// Without white space at its ends.
std::string_view trim(std::string_view text);

/// For messages.
inline std::string quote(std::string_view text) { return in_quotes(text); }

/// Compares FEBio's enumerated words: upper and lower case are equal.
bool same_word(std::string_view a, std::string_view b);
/// Is the word one of these, to the letter?
bool one_of(std::string_view word, std::initializer_list<const char*> words);
bool one_of(std::string_view word, const std::vector<std::string>& words);

/// Outcome of looking for one number at the start of a text.
enum class Number { Ok, None, NotFinite };

/// Reads a number at the front of `text` (C style: white space, '+', ".5") and removes it. NotFinite: NaN,
/// infinity or beyond 1e30, the largest number a model may have.
Number take_double(std::string_view& text, double& value);
/// Reads an integer at the front of `text` and removes it; None also for one beyond 32 bits.
Number take_int(std::string_view& text, int& value);
/// Removes white space and one comma; false if there is no comma.
bool take_comma(std::string_view& text);

/// The whole text as one number, if it is one.
std::optional<double> whole_double(std::string_view text);
std::optional<int> whole_int(std::string_view text);

/// Comma separated words, not trimmed.
std::vector<std::string> split_words(std::string_view text);

}  // namespace dea::febio
