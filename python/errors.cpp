#include "python/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "python/plain.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/model/settings_table.h"
#include "src/rules/rules.h"
#include "views/data/json.h"

namespace dea::python {

namespace {

/// A name, or what stands for one: BODY, SURFACE, VALUE.
std::string quoted(const std::string& name) {
  const bool stands_for = name.size() > 1 && std::all_of(name.begin(), name.end(), [](char c) {
                            return (c >= 'A' && c <= 'Z') || c == '_' || c == '|';
                          });
  if (stands_for) return name;
  std::string words = "\"";
  for (const char c : name) words += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return words + "\"";
}

bool is_numbers(const std::string& value) {
  try {
    return !parse_numbers(value).empty();
  } catch (const BadValue&) {
    return value == "x,y,z";
  }
}

std::string value_words(const std::string& value) {
  if (value == "true" || value == "false") return value == "true" ? "True" : "False";
  if (!is_numbers(value)) return quoted(value);
  const std::vector<std::string> numbers = split_at_commas(value);
  if (numbers.size() == 1) return value;
  return fmt::format("({})", fmt::join(numbers, ", "));
}

/// ("pelvis", (0, 1, 0), 10)
std::string placement_words(const NamedSetting& s) {
  const std::size_t angle = s.setting == "rotate" ? s.value.rfind(',') : s.value.npos;
  const std::string vector = s.value.substr(0, angle);
  return fmt::format("[({}, {}{})]", s.of.empty() ? "BODY" : quoted(s.of), vector.empty() ? "..." : value_words(vector),
                     angle == s.value.npos ? "" : ", " + s.value.substr(angle + 1));
}

/// ["x", "y", "z"]
std::string axes_words(const std::string& axes) {
  std::string words;
  for (const std::string& axis : split_at_commas(axes)) words += (words.empty() ? "" : ", ") + quoted(axis);
  return "[" + words + "]";
}

std::string keyword_words(const NamedSetting& s) {
  std::string keyword = s.setting;
  std::replace(keyword.begin(), keyword.end(), '-', '_');
  const SettingOption* option = find_setting_option(s.setting);
  if (option != nullptr && option->places) return keyword + "=" + placement_words(s);
  if (s.setting == "free" && !s.of.empty() && !s.value.empty())
    return fmt::format("{}={{{}: {}}}", keyword, quoted(s.of), axes_words(s.value));
  if (!s.of.empty())
    return fmt::format("{}={{{}: {}}}", keyword, quoted(s.of), s.value.empty() ? "..." : value_words(s.value));
  if (s.value.empty()) return keyword;
  const bool list = option != nullptr && option->repeatable && option->key == nullptr;
  return list ? fmt::format("{}=[{}]", keyword, value_words(s.value)) : keyword + "=" + value_words(s.value);
}

/// What a fault is in parts. Texts that came in one piece are cut where their file or setting ends, and where they go
/// on to what is expected.
struct FaultParts {
  std::string place, found, expected;
  std::vector<std::string> remedy;
};

FaultParts parts_of(const Fault& fault) {
  FaultParts parts;
  const Wording wording = python_wording();
  parts.place = fault.given ? wording(*fault.given) : fault.place;
  parts.found = worded(fault.found, wording);
  parts.expected = worded(fault.expected, wording);
  for (const NamedSetting& s : fault.expected.settings) parts.remedy.push_back(wording(s));
  if (parts.place.empty()) {
    std::size_t end = parts.found.find(": found ");
    if (end == std::string::npos) end = parts.found.find(": ");
    // a file, or a setting: not the first words of a sentence
    if (end != std::string::npos && parts.found.substr(0, end).find_first_of("./=") != std::string::npos) {
      parts.place = parts.found.substr(0, end);
      parts.found.erase(0, end + 2);
    }
  }
  for (const char* mark : {", expected ", "; ", ": "}) {
    const std::size_t end = parts.expected.empty() ? parts.found.find(mark) : std::string::npos;
    if (end == std::string::npos) continue;
    parts.expected = parts.found.substr(parts.found.find(' ', end) + 1);
    parts.found.erase(end);
  }
  while (!parts.found.empty() && std::string(",;:").find(parts.found.back()) != std::string::npos)
    parts.found.pop_back();
  return parts;
}

py::object error_of(const char* type, const Fault& fault, const std::vector<Fault>& others = {}) {
  FaultParts parts = parts_of(fault);
  const std::string writing = "cannot write ";
  if (parts.place.rfind(writing, 0) == 0) parts.place.erase(0, writing.size());
  std::string message = line(fault, python_wording());
  if (!others.empty())
    message += fmt::format(" (and {} more reason{}: see others)", others.size(), others.size() > 1 ? "s" : "");
  return py::module_::import("febiodea._errors")
      .attr(type)(text(message_line(message)), text(parts.place), text(parts.found), text(parts.expected),
                  py::tuple(texts(parts.remedy)), py::tuple(faults_as_errors(others)));
}

void raise(const py::object& error) { PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr()); }

// By value, as pybind11 calls it.
void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param)
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const UsageError& e) {
    raise(error_of("UsageError", e.fault));
  } catch (const InputError& e) {
    raise(error_of("InputError", e.fault, e.others));
  } catch (const WriteError& e) {
    raise(error_of("WriteError", Fault{.found = std::string("cannot write ") + e.what()}));
  } catch (const BadValue& e) {
    raise(error_of("UsageError", Fault{.found = std::string(e.what())}));
  }
}

}  // namespace

Wording python_wording() { return keyword_words; }

void register_errors() { py::register_local_exception_translator(translate); }

py::list faults_as_errors(const std::vector<Fault>& faults) {
  return list_of(faults.size(), [&](std::size_t i) { return error_of("InputError", faults[i]); });
}

py::list findings_list(const Findings& findings) {
  const py::object make = py::module_::import("febiodea._findings").attr("Finding");
  const py::list values = plain(findings_json(findings));
  return list_of(findings.size(),
                 [&](std::size_t i) { return make(text(line(findings[i], python_wording())), **py::dict(values[i])); });
}

}  // namespace dea::python
