// src/base/finding.h – what is to be known of a model or a result, as values. Its words are made by src/rules.
#pragma once
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "src/base/sentence.h"

namespace dea {

/// Who a finding is of. What does not apply is empty.
struct Subject {
  std::string contact = {}, surface = {}, body = {};
  std::optional<double> time = {};  ///< of the state
  bool operator==(const Subject&) const = default;
};

/// A number, a name, names, numbers of nodes, a setting that is meant or would help, a sentence that names settings.
struct Value {
  std::variant<double, std::string, std::vector<std::string>, std::vector<int>, NamedSetting, Sentence> is;
  template <class Number>
  requires std::is_arithmetic_v<Number> Value(Number number) : is(static_cast<double>(number)) {}
  Value(std::string name) : is(std::move(name)) {}
  Value(const char* name) : is(std::string(name)) {}
  Value(char letter) : is(std::string(1, letter)) {}
  Value(std::vector<std::string> names) : is(std::move(names)) {}
  Value(std::vector<int> numbers) : is(std::move(numbers)) {}
  Value(NamedSetting setting) : is(std::move(setting)) {}
  Value(Sentence words) : is(std::move(words)) {}
  bool operator==(const Value&) const = default;
};

struct NamedValue {
  std::string name;
  Value value;
  bool operator==(const NamedValue&) const = default;
};

struct Finding {
  std::string code;  ///< of its rule (rules/rules.h): "narrow-contact". Never renamed, never used for something else
  Subject subject = {};
  std::vector<NamedValue> values = {};  ///< what the rule's words name
  int form = 0;                         ///< which of the rule's words say it
  std::string place = {};               ///< file and line, "hip.feb:214"; empty: no one place
  bool operator==(const Finding&) const = default;
};

using Findings = std::vector<Finding>;

/// Adds those that are not there yet.
void add_once(Findings& findings, const Findings& more);

}  // namespace dea
