// src/base/say.h – sentences made by fmt, with settings among the arguments.
#pragma once
#include <fmt/format.h>

#include <string>
#include <tuple>
#include <type_traits>

#include "src/base/sentence.h"

namespace dea {

namespace say_detail {

/// Appended to `words`: its settings are counted on.
inline std::string argument(Sentence& words, const Sentence& part) {
  std::string text;
  for (std::size_t i = 0; i < part.text.size(); ++i) {
    const char c = part.text[i];
    const bool doubled = i + 1 < part.text.size() && part.text[i + 1] == c;
    text += c;
    if (c != '{' && c != '}') continue;
    if (doubled) {
      text += part.text[++i];
    } else if (c == '{') {
      const std::size_t end = part.text.find('}', i);
      text += std::to_string(words.settings.size() + std::stoul(part.text.substr(i + 1, end - i - 1)));
      i = end - 1;
    }
  }
  words.settings.insert(words.settings.end(), part.settings.begin(), part.settings.end());
  return text;
}
inline std::string argument(Sentence& words, const NamedSetting& setting) {
  words.settings.push_back(setting);
  return fmt::format("{{{}}}", words.settings.size() - 1);
}
inline std::string argument(Sentence&, const std::string& text) { return Sentence(text).text; }
inline std::string argument(Sentence&, const char* text) { return Sentence(text).text; }
template <class Number>
requires std::is_arithmetic_v<Number> Number argument(Sentence&, Number number) { return number; }

template <class T>
using Argument = decltype(argument(std::declval<Sentence&>(), std::declval<const T&>()));

}  // namespace say_detail

/// As fmt::format; arguments: texts, numbers, NamedSetting, Sentence.
template <class... Args>
Sentence say(fmt::format_string<say_detail::Argument<Args>...> text, const Args&... args) {
  Sentence words;
  // in braces: one after the other, for settings are counted
  const std::tuple<say_detail::Argument<Args>...> values{say_detail::argument(words, args)...};
  words.text = std::apply(
      [&](const auto&... value) { return fmt::vformat(fmt::string_view(text), fmt::make_format_args(value...)); },
      values);
  return words;
}

}  // namespace dea
