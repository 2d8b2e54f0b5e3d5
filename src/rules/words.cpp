#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <functional>

#include "src/base/names.h"
#include "src/base/time_text.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

/// "a", "b" and "c"; `format`: "plain", without quotation marks; "comma", without the "and".
std::string listed(const std::vector<std::string>& names, const std::string& format) {
  std::string text;
  const char* mark = format == "plain" ? "" : "\"";
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format("{}{}{}{}",
                        i == 0                                       ? ""
                        : i + 1 == names.size() && format != "comma" ? " and "
                                                                     : ", ",
                        mark, shown(names[i]), mark);
  return text;
}

/// What stands between braces: a name, then ":" and how it is written, or "?" and the words for one and for many.
struct Slot {
  std::string name, format, one, many;
  bool counts() const { return !one.empty() || !many.empty(); }
};

Slot slot_of(const std::string& text) {
  Slot slot;
  const std::size_t mark = text.find_first_of(":?");
  slot.name = text.substr(0, mark);
  if (mark == std::string::npos) return slot;
  const std::string rest = text.substr(mark + 1);
  if (text[mark] == ':') {
    slot.format = rest;
  } else {
    slot.one = rest.substr(0, rest.find('|'));
    slot.many = rest.substr(rest.find('|') + 1);
  }
  return slot;
}

/// The text with what `fill` puts into its slots.
std::string filled(const Words& words, const std::function<std::string(const Slot&)>& fill) {
  const std::string text = words.text;
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '{') {
      out += text[i];
      continue;
    }
    const std::size_t end = text.find('}', i);
    out += fill(slot_of(text.substr(i + 1, end - i - 1)));
    i = end;
  }
  return out;
}

/// A value as its slot wants it.
struct ValueText {
  const Slot& slot;
  const Wording& wording;
  std::string of_count(bool one) const { return one ? slot.one : slot.many; }
  std::string operator()(double number) const {
    return slot.counts() ? of_count(number == 1) : fmt::format(fmt::runtime("{:" + slot.format + "}"), number);
  }
  std::string operator()(const std::string& name) const { return name; }
  std::string operator()(const std::vector<std::string>& names) const {
    if (slot.format == "count") return std::to_string(names.size());
    return slot.counts() ? of_count(names.size() == 1) : listed(names, slot.format);
  }
  std::string operator()(const std::vector<int>& numbers) const {
    if (slot.format == "count") return std::to_string(numbers.size());
    return slot.counts() ? of_count(numbers.size() == 1) : number_list(numbers);
  }
  std::string operator()(const NamedSetting& setting) const { return wording(setting); }
  std::string operator()(const Sentence& words) const { return worded(words, wording); }
};

std::string text_of(const Finding& finding, const Slot& slot, const Wording& wording) {
  for (const NamedValue& v : finding.values)
    if (v.name == slot.name) return std::visit(ValueText{slot, wording}, v.value.is);
  const Subject& s = finding.subject;
  if (slot.name == "contact") return shown(s.contact);
  if (slot.name == "surface") return shown(s.surface);
  if (slot.name == "body") return shown(s.body);
  if (slot.name == "time" && s.time) return time_text(*s.time);
  assert(!"a rule's words name what its finding has not");
  return "";
}

const Words& words_of(const Finding& finding) {
  const Rule* rule = find_rule(finding.code);
  assert(rule != nullptr && static_cast<std::size_t>(finding.form) < rule->words.size());
  return rule->words[static_cast<std::size_t>(finding.form)];
}

}  // namespace

const char* name(Severity severity) { return word_of(severity, {"ignored", "note", "warning"}); }

Severity severity(const Finding& finding) { return words_of(finding).severity; }

std::string worded(const Finding& finding, const Wording& wording) {
  return filled(words_of(finding), [&](const Slot& slot) { return text_of(finding, slot, wording); });
}

std::string template_text(const Words& words) {
  return filled(words, [](const Slot& slot) { return slot.counts() ? slot.many : "<" + slot.name + ">"; });
}

namespace {

/// Behind "file:line: ", if it has a place.
std::string placed_words(const Finding& finding, const Wording& wording) {
  return fmt::format("{}{}{}", finding.place, finding.place.empty() ? "" : ": ", worded(finding, wording));
}

}  // namespace

std::string line(const Finding& finding, const Wording& wording) {
  return fmt::format("{}: {}", name(severity(finding)), placed_words(finding, wording));
}

std::vector<std::string> lines(const Findings& findings, const Wording& wording) {
  std::vector<std::string> all;
  for (const Finding& finding : findings) all.push_back(line(finding, wording));
  return all;
}

std::vector<std::string> coded_words(const Findings& findings, const Wording& wording) {
  std::vector<std::string> all;
  for (const Finding& f : findings) all.push_back(fmt::format("{} [{}]", placed_words(f, wording), f.code));
  return all;
}

std::vector<std::string> coded_lines(const Findings& findings, const Wording& wording) {
  std::vector<std::string> all;
  for (const Finding& finding : findings) all.push_back(fmt::format("{} [{}]", line(finding, wording), finding.code));
  return all;
}

}  // namespace dea
