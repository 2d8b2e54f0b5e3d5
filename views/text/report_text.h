// febiodea/views/text/report_text.h – results as tables for people, and what they should know besides.
#pragma once
#include <string>
#include <vector>

#include <febiodea/io/settings/setting_words.h>
#include <febiodea/run/analysis.h>

namespace dea {

/// Cells under headings; columns as wide as they need, all but those of words aligned to the right.
struct Table {
  std::vector<std::string> headings;
  std::string left;  ///< per column: 'l' for words, 'r' for numbers
  std::vector<std::vector<std::string>> rows;
};
std::string table_text(const Table& table);

/// A table and what stands over it; no headings: only the title.
struct TitledTable {
  std::string title;
  Table table;
};
/// Each after an empty line.
std::string tables_text(const std::vector<TitledTable>& tables);

/// The states' contacts, then bodies and ligaments in the last state.
std::vector<TitledTable> run_tables(const JointModel& model, const Analysis& analysis);
/// Units and laws, then these tables.
std::string run_text(const JointModel& model, const Analysis& analysis);

/// What was concluded, left out or is doubtful, a line each, each once: "note: ...", "ignored: ...", "warning: ...".
/// Files (JSON, the page) have the words of the command line, whoever writes them.
std::vector<std::string> model_remarks(const JointModel& model, const Joint& joint,
                                       const Wording& wording = command_line_wording());
std::vector<std::string> result_remarks(const JointModel& model, const Analysis& analysis,
                                        const Wording& wording = command_line_wording());

/// The sentence behind a state's outcome.
std::string outcome_text(const Equilibrium& e, const Wording& wording = command_line_wording());

std::string converge_text(const JointModel& model, const std::vector<Convergence>& studies, int max_springs);

/// All bodies, without a ground that nothing is attached to.
std::vector<int> reported_bodies(const Joint& joint);
/// Of ligaments, then of cables; "(unnamed)", and numbered where there are several of one name: "acl", "acl (2)".
std::vector<std::string> spring_names(const Joint& joint);

/// "(1, 2, 3)" with six digits.
std::string vector_text(const Vector3d& v);
/// Number with six digits, "-" when undefined.
std::string number_text(double x);
/// "units: mm-N-s" or a sentence that they are the model's.
std::string units_text(const JointModel& model);

}  // namespace dea
