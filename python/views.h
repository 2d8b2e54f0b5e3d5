// python/views.h – places within results, for Python: each looks into memory that its owner keeps alive.
#pragma once
#include <string>
#include <vector>

#include "io/files/encoded_text.h"
#include "python/plain.h"
#include "python/stages.h"

namespace dea::python {

struct StateView {
  Owner owner;
  const Recognised* recognised = nullptr;
  const Joint* joint = nullptr;
  const FieldMaps* maps = nullptr;
  const StateResult* state = nullptr;
  const std::vector<SpringStates>* springs = nullptr;  ///< one per contact
  const JointModel& model() const { return recognised->recognition.model; }
};
StateView view_of(const std::shared_ptr<const Analysed>& analysed, std::size_t state);
StateView view_of(const std::shared_ptr<const SolvedLoad>& solved);

struct ContactView {
  StateView in;
  std::size_t index = 0;
  const ContactPair& pair() const { return in.joint->contacts[index]; }
  const ContactStatistics& statistics() const { return in.state->statistics[index]; }
};

/// One side of a contact in a state.
struct SideView {
  ContactView of;
  int side = 0;  ///< 0 primary, 1 secondary
  const Layer& layer() const { return of.pair().layers[side]; }
  const SideFields& fields() const { return of.in.state->fields[of.index].sides[side]; }
  const FieldMaps::LayerMap& map() const { return of.in.maps->contacts[of.index].layers[side]; }
};
struct FacetsView : SideView {};
struct NodesView : SideView {};

/// A part that gives way.
struct PartView {
  StateView in;
  std::size_t index = 0;
  const SoftPart& part() const { return in.joint->parts[index]; }
  const PartStress& stress() const { return in.state->parts[index]; }
};

/// Springs of a contact, of a state or of a press.
struct SpringsView {
  Owner owner;
  const SpringStates* states = nullptr;
};

/// A part of a contact's surface.
struct CompartmentView {
  ContactView of;
  std::size_t index = 0;
  const CompartmentLoad& load() const { return of.statistics().compartments[index]; }
};

/// Of bodies, contacts, surfaces and whatever else has a name.
template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& item : list) names.push_back(utf8(item.name));
  return names;
}

/// Place of a name; an empty one: the only place there is. Throws UsageError with `what` for its place, and the names
/// there are.
std::size_t find_name(const char* what, const std::string& name, const std::vector<std::string>& names);

}  // namespace dea::python
