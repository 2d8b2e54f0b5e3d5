// io/study/study_request.h – from what is asked of a study, by whatever front end, to what is solved.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/files/output.h"
#include "io/study/run_study.h"
#include "io/study/study_file.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/study/plan.h"

namespace dea {

/// A study as it was asked for, nothing read yet.
struct StudyRequest {
  std::vector<std::string> models;  ///< paths; empty: the table of cases names them
  std::vector<CaseOption> options;  ///< in the order in which they act: settings by their names, and "vary" or "factor"
                                    ///< with "NAME: OPTION VALUE"
  std::string cases;                ///< file with a row a case; empty: none
  std::optional<CaseTable> table;   ///< the same from memory, in place of `cases`
  std::string sample, count, seed;  ///< of points that are drawn, as texts; empty: not said
  std::string states;               ///< as --states; empty: of the settings file, else all
  std::string settings_file;        ///< empty: none
};

/// Everything that is solved, and what it depends on.
struct Study {
  Plan plan;
  StudyIdentity identity;
  std::vector<NamedPath> inputs;  ///< files that must not be written over
  StudyOptions options;           ///< all cores, half of the free memory for joints; nobody can stop it
};

/// All but identity.inputs. Whatever can be wrong with the request is found here, before anything is solved; of the
/// models nothing is read. Throws UsageError, InputError.
Study plan_study(const StudyRequest& request);

/// Fills identity.inputs: the models with all that they include, tables, settings, each with its digest. Throws
/// InputError: one cannot be read.
void take_digests(Study& study);

/// A study that another process has begun: takes its identity in place of take_digests. Throws InputError: this program
/// is another version, or an input is not the same file here.
void take_identity(Study& study, const StudyIdentity& of_other);

/// An option or argument and its text: a place for faults, worded by each front end.
NamedSetting said(const std::string& option, const std::string& text);
/// `parse` of an option's text; the BadValue that it throws becomes a UsageError of this option.
template <class Parse>
auto parsed(const std::string& option, const std::string& text, Parse parse) {
  try {
    return parse(text);
  } catch (const BadValue& why) {
    throw UsageError(Fault{.given = said(option, text), .found = std::string(why.what())});
  }
}

}  // namespace dea
