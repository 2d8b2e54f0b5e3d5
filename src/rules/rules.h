// src/rules/rules.h – what the user is to know of a model and of its results: which rules there are, what each finds,
// and in which words it is told. A rule looks at facts and results and returns values; whoever speaks makes the words.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/joint/joint.h"
#include "src/results/solved_states.h"

namespace dea {

enum class Severity {
  Ignored,  ///< something of the model that does not change the joint
  Note,     ///< how something was taken
  Warning   ///< the numbers may be wrong, or are of another joint than was meant
};
const char* name(Severity severity);  ///< "ignored", "note", "warning"

/// One way to tell a finding. In the text {name} is a value of the finding, or contact, surface, body, time of its
/// subject; {name:.3g} a number as fmt writes it; {name?node|nodes} one of two words, the first for the number 1 or a
/// list of one; lists come as "a", "b" and "c", {name:plain} without quotation marks, {name:comma}
/// without the "and", {name:count} as their number.
struct Words {
  Severity severity;
  const char* text;
};

struct Rule {
  const char* code;          ///< as in Finding::code
  const char* acts;          ///< when a reader acts on it, and how; for the docs
  std::vector<Words> words;  ///< by Finding::form
  bool quiet = false;        ///< asks nobody to act: in files and in dea info, not on the terminal of a run
  Findings (*of_model)(const JointModel&, const Joint&) = nullptr;  ///< looks at the joint
  Findings (*of_result)(const JointModel&, const Joint&,
                        const SolvedStates&) = nullptr;  ///< looks at what was solved;
                                                         ///  neither: recognition (Joint::findings) or a rule
                                                         ///  above tells it
};

/// All rules, in the order in which they are told: first those that may cost most.
const std::vector<Rule>& rules();
/// The rule of this code; nullptr: there is none.
const Rule* find_rule(const std::string& code);
std::vector<std::string> rule_codes();

Severity severity(const Finding& finding);

/// The words of a rule without what only the program reads: {name:.3g} as `<name>`, {n?is|are} as "are".
std::string template_text(const Words& words);

/// "contact "hip": at time 1 ...", with the settings as `wording` has them.
std::string worded(const Finding& finding, const Wording& wording = plain_wording());
/// The same behind the severity and the place: "warning: contact "hip": ...", "ignored: hip.feb:12: ...".
std::string line(const Finding& finding, const Wording& wording = plain_wording());
/// Of all of them.
std::vector<std::string> lines(const Findings& findings, const Wording& wording = plain_wording());

/// The same with the code behind each: "... [narrow-contact]", for a terminal or a log.
std::vector<std::string> coded_lines(const Findings& findings, const Wording& wording = plain_wording());
/// The same without "warning: " or "note: ".
std::vector<std::string> coded_words(const Findings& findings, const Wording& wording = plain_wording());

/// Of a joint that was recognised; of what was solved of it; both. Each once, warnings first, in the order of the
/// rules.
Findings model_findings(const JointModel& model, const Joint& joint);
Findings result_findings(const JointModel& model, const Joint& joint, const SolvedStates& result);
Findings all_findings(const JointModel& model, const Joint& joint, const SolvedStates& result);

/// Those that are warnings, and those of one code.
Findings warnings(const Findings& findings);
Findings of_code(const Findings& findings, const std::string& code);

/// The sentence behind a state's outcome.
std::string outcome_text(const Equilibrium& e, const Wording& wording = plain_wording());

}  // namespace dea
