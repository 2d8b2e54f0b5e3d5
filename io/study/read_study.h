// io/study/read_study.h – a study's file as others left it, also while another program adds cases to it: what it says
// of itself, and its numbers in a few passes, which statistics and pages are made of.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/study/study_file.h"

namespace dea {

/// What a study's file says of itself.
struct StudyHead {
  std::string path;
  StudyIdentity identity;
  std::vector<std::string> models;
  std::vector<Factor> factors;  ///< without their values
  std::size_t planned = 0;      ///< cases of the whole study, all shards
};

/// Is it a SQLite file, whatever is in it?
bool is_database(const std::string& path);

/// Throws InputError: it cannot be read, is no study, is of another version than this program's, or rows are missing to
/// which others belong.
StudyHead read_study_head(const std::string& path);

/// What differs, in words that follow on "PATH: "; empty: it is the same study.
std::string study_difference(const StudyHead& there, const StudyIdentity& wanted);

struct StudyCounts {
  std::size_t solved = 0, failed = 0, refused = 0;
  std::size_t all() const { return solved + failed + refused; }
};
StudyCounts count_cases(const std::string& path);

/// Cases with warnings, solved or not, and the first warning of the first of them. Warnings of the codes `without` do
/// not count.
struct StudyWarned {
  std::size_t cases = 0, first = 0;  ///< first: its number; 0: there is none
  std::string text;
};
StudyWarned count_warned(const std::string& path, const std::vector<std::string>& without = {});
/// The codes of all warnings, and "warning" if there is one.
std::vector<std::string> warned_codes(const std::string& path);

/// A case as the file has it.
struct StudyCase {
  std::size_t number = 0;
  int model = 0;  ///< index
  CaseResult::Outcome outcome = CaseResult::Outcome::Refused;
  std::string message;
  double seconds = 0.0;
  std::vector<std::string> values;  ///< one per factor
};
/// In their order.
std::vector<StudyCase> read_cases(const std::string& path);
/// The first that is not solved.
std::optional<StudyCase> first_failed(const std::string& path);

/// All rows of the view `results` in the order of cases, states and contacts; the names of its columns first. A cell
/// that is NULL is empty, a number is the shortest text that reads back as the same.
void read_results(const std::string& path, const std::function<void(const std::vector<std::string>& cells)>& row);

/// The surfaces of a model.
struct StudySurface {
  std::string contact, source;
  CaseSurface surface;
};
std::vector<StudySurface> read_surfaces(const std::string& path, int model);

/// One state of a case.
struct StudyState {
  std::int64_t case_id = 0;  ///< from 1
  int state = 0;             ///< from 1
  double time = 0.0;         ///< the model's
  std::string outcome, message;
};
/// In the order of cases and states.
std::vector<StudyState> read_states(const std::string& path);

/// Where a number was measured: a contact, or one compartment of it.
struct StudyPlace {
  int contact_id = 0;
  std::string contact;
  std::string part;  ///< empty: the whole contact
};
/// Columns that contacts and compartments share ("headline_p99", "force_x", ...), a row per case, state and place.
struct StudyRows {
  std::vector<StudyPlace> places;  ///< each contact, its compartments behind it
  std::vector<std::int64_t> case_id;
  std::vector<int> state;                    ///< from 1
  std::vector<int> place;                    ///< index
  std::vector<std::vector<double>> numbers;  ///< one per name, those of the inside last; NaN: NULL
};
/// `of_inside`: columns of the table `inside`, of whole contacts. Throws InputError.
StudyRows read_rows(const std::string& path, const std::vector<std::string>& names,
                    const std::vector<std::string>& of_inside = {});

/// The two bodies of a contact: the one with springs, and the other.
struct StudyContact {
  std::string contact, source, target;
};
/// Each once; of models that name them otherwise, each time.
std::vector<StudyContact> read_contacts(const std::string& path);

struct StudyWarning {
  std::int64_t case_id = 0;
  std::string code, contact, surface, body, text;
};
std::vector<StudyWarning> read_warnings(const std::string& path);

/// A row of `fields`.
struct StudyFieldKey {
  std::int64_t case_id = 0;
  int state = 0, contact_id = 0;
};
/// The same without its pressures, and what belongs to it.
struct StudyFieldRow {
  StudyFieldKey key;
  int model = 0;  ///< index
  std::string outcome, contact, source;
  double contact_area = 0.0;  ///< facet_contact_area: what the edge of contact of its map encloses
};
/// In the order of cases, states and contacts.
std::vector<StudyFieldRow> list_fields(const std::string& path);
/// Pressures at vertices of some fields, in the order of `keys`, by index; not of those that are not there any more.
void read_fields(const std::string& path, const std::vector<StudyFieldKey>& keys,
                 const std::function<void(std::size_t key, std::vector<float>&&)>& each);

}  // namespace dea
