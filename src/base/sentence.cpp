#include "src/base/sentence.h"

#include <charconv>

namespace dea {

namespace {

std::string with_doubled_braces(const std::string& plain) {
  std::string text;
  for (const char c : plain) text += c == '{' || c == '}' ? std::string(2, c) : std::string(1, c);
  return text;
}

std::string plain_words(const NamedSetting& s) {
  return s.setting + (s.of.empty() ? "" : " of \"" + s.of + "\"") + (s.value.empty() ? "" : " = " + s.value);
}

}  // namespace

Sentence::Sentence(const std::string& plain) : text(with_doubled_braces(plain)) {}
Sentence::Sentence(const char* plain) : text(with_doubled_braces(plain)) {}

Wording plain_wording() { return plain_words; }

std::string worded(const Sentence& words, const Wording& wording) {
  const std::string& text = words.text;
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool brace = text[i] == '{' || text[i] == '}';
    if (!brace || (i + 1 < text.size() && text[i + 1] == text[i])) {
      out += text[i];
      i += brace;
      continue;
    }
    std::size_t number = 0;
    const char* end = std::from_chars(text.data() + i + 1, text.data() + text.size(), number).ptr;
    out += wording(words.settings.at(number));
    i = static_cast<std::size_t>(end - text.data());
  }
  return out;
}

}  // namespace dea
