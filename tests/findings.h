// tests/findings.h – what tests ask of findings: their codes, subjects and values.
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

#include "src/rules/rules.h"
#include "src/run/analysis.h"

namespace dea::test {

/// One after the other, settings in plain words.
inline std::string words_of(const Findings& findings) {
  std::string text;
  for (const Finding& f : findings) text += worded(f) + "\n";
  return text;
}
/// Of what was solved alone.
inline Findings findings_of(const JointModel& model, const Analysis& analysis) {
  return result_findings(model, analysis.joint, analysis);
}
/// The value of this name. Throws where there is none, or of another kind.
template <class T>
T value_of(const Finding& finding, const std::string& name) {
  for (const NamedValue& v : finding.values)
    if (v.name == name) return std::get<T>(v.value.is);
  throw std::out_of_range(finding.code + " has no value " + name);
}
inline double number(const Finding& finding, const std::string& name) { return value_of<double>(finding, name); }
inline std::string text(const Finding& finding, const std::string& name) {
  return value_of<std::string>(finding, name);
}

}  // namespace dea::test
