// io/settings/output_options.h – the files a run writes and the states in them: what command line, settings
// file and FEBio's task may say of them. A new file is a member of OutputSettings, a row of output_options and what
// run_model (views/run_model.h) writes.
#pragma once
#include <string>
#include <vector>

#include "io/files/output.h"

namespace dea {

/// Empty: nothing is said.
struct OutputSettings {
  std::string output;  ///< plot file
  std::string json, csv, compartments_csv, facets_csv;
  std::string report;        ///< a page
  std::string vtu;           ///< a folder
  std::string no_xplt;       ///< "true": no plot file, also where one is named
  std::string states;        ///< all, last, times t1,t2,... or ranges t1:t2
  std::string states_given;  ///< where: "s.xml:3: <states>", "--states last"; no option
};

/// One of them. On the command line `--NAME TEXT` (the plot file: -o), in the settings file `<NAME>TEXT</NAME>`.
struct OutputOption {
  enum class Kind { File, Folder, Switch, States };
  const char* name;
  std::string OutputSettings::*text;
  Kind kind;
  const char* expected;  ///< "a file name"
  const char* type;      ///< the same in help: "FILE.html"
  const char* help;
};
const std::vector<OutputOption>& output_options();

/// How the command line spells it: "-o", "--json".
std::string command_line_name(const OutputOption& option);

/// What the stronger source says, and where it says nothing what the weaker one says.
OutputSettings over(const OutputSettings& stronger, const OutputSettings& weaker);

/// Where `text` was given, if it was not typed in the settings file: "--report", "<report>".
std::string given_as(std::string OutputSettings::*text, const OutputSettings& typed);

/// The files and folders of over(typed, file), each with its name where it was given.
std::vector<NamedPath> named_outputs(const OutputSettings& typed, const OutputSettings& file);

}  // namespace dea
