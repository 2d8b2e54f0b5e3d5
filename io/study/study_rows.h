// io/study/study_rows.h – the numbers of a whole study in a few passes over its file: what statistics and
// pages are made of.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dea {

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
