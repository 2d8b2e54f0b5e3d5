// src/base/sentence.h – sentences for the user that name settings, before a front end words these.
//
// How a setting is written differs: `--thickness "knee=1.8"` on the command line, `<thickness surface="knee">` in a
// settings file, `<primary_thickness>` in a contact of FEBio. So a sentence keeps its settings apart from its text.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace dea {

/// A setting that a sentence names: one that was given, or one that would help.
struct NamedSetting {
  std::string setting = {};    ///< its name in a settings file: "thickness"
  std::string of = {};         ///< surface or body it holds for, or SURFACE, BODY; empty: it has none, or is not said
  std::string value = {};      ///< a name, a word, a number, or what stands for them: "VALUE"; empty: not said
  std::string parameter = {};  ///< of a contact of type dea, says the same: "primary_thickness"; empty: there is none
  bool bare = false;           ///< without quotation marks, as before a fault
  bool operator==(const NamedSetting&) const = default;
};

/// A sentence, or part of one. Made by say (base/say.h), or of a plain text.
struct Sentence {
  std::string text;                    ///< "{0}" stands for settings[0]; a brace of the text itself is doubled
  std::vector<NamedSetting> settings;  ///< in the order of the text
  Sentence() = default;
  Sentence(const std::string& plain);
  Sentence(const char* plain);
  bool empty() const { return text.empty(); }
  bool operator==(const Sentence&) const = default;
};

/// How a front end writes a setting.
using Wording = std::function<std::string(const NamedSetting&)>;
/// Of no front end: `thickness of "knee" = 1.8`.
Wording plain_wording();

std::string worded(const Sentence& words, const Wording& wording);

}  // namespace dea
