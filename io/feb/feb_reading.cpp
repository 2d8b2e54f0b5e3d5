#include "io/feb/feb_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "src/base/error.h"

namespace dea::feb {
bool IdTable::add(int id) {
  if (index_.empty() && (ids_.empty() || id > ids_.back())) {
    ids_.push_back(id);
    largest_ = id;
    return true;
  }
  if (index_.empty()) {  // the first id out of order: from now on by a hash table
    for (int i = 0; i < size(); ++i) index_.emplace(ids_[at(i)], i);
  }
  if (!index_.emplace(id, size()).second) return false;
  ids_.push_back(id);
  largest_ = std::max(largest_, id);
  return true;
}

int IdTable::find(int id) const {
  if (!index_.empty()) {
    const auto place = index_.find(id);
    return place == index_.end() ? -1 : place->second;
  }
  if (ids_.empty() || id < ids_.front() || id > ids_.back()) return -1;
  const std::size_t guess = static_cast<std::size_t>(static_cast<long long>(id) - ids_.front());  // no gaps: 1..N
  if (guess < ids_.size() && ids_[guess] == id) return static_cast<int>(guess);
  const auto place = std::lower_bound(ids_.begin(), ids_.end(), id);
  return place != ids_.end() && *place == id ? static_cast<int>(place - ids_.begin()) : -1;
}

Origin origin_of(const Reading& reading, const XMLElement& element) { return {reading.file, element.GetLineNum()}; }

void fail(const Reading& reading, const XMLElement& element, const std::string& fault) {
  throw fault_at(reading.model, origin_of(reading, element), fault);
}

void ignore(Reading& reading, const XMLElement& element, const std::string& what) {
  febio::ignore(reading, origin_of(reading, element), what);
}

void unsupported(Reading& reading, const XMLElement& element, const std::string& what, const Sentence& advice) {
  febio::unsupported(reading, origin_of(reading, element), what, advice);
}

void unsupported_word(Reading& reading, const XMLElement& element, const std::string& what, febio::WordOf place,
                      const std::string& word) {
  unsupported(reading, element, what, febio::word_advice(place, word));
}

bool read_child(Reading& reading, const XMLElement& child, std::span<const TagReader> readers) {
  const auto reader = std::find_if(readers.begin(), readers.end(),
                                   [&](const TagReader& r) { return std::strcmp(r.tag, child.Name()) == 0; });
  if (reader == readers.end()) return false;
  reader->read(reading, child);
  return true;
}

namespace {

/// "fix, prescribe or rigid"
std::string tags_of(std::span<const TagReader> readers) {
  std::string text;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    if (i > 0) text += i + 1 < readers.size() ? ", " : " or ";
    text += readers[i].tag;
  }
  return text;
}

}  // namespace

void read_children(Reading& reading, const XMLElement& section, std::span<const TagReader> readers,
                   SectionReader others) {
  for (const XMLElement& child : children(section)) {
    if (read_child(reading, child, readers)) continue;
    if (others != nullptr)
      others(reading, child);
    else
      unsupported(reading, child, fmt::format("<{}> in {}", child.Name(), section.Name()),
                  "expected " + tags_of(readers));
  }
}

void pass_over(Reading& reading, const XMLElement& child) {
  ignore(reading, child, fmt::format("<{}> in {}", child.Name(), child.Parent()->Value()));
}

std::string need_attribute(const Reading& reading, const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  if (text == nullptr || *text == '\0')
    fail(reading, element, fmt::format("<{}> without attribute {}: add {}=\"...\"", element.Name(), name, name));
  return text;
}

double read_double(const Reading& reading, const XMLElement& element) {
  return febio::to_number(reading, origin_of(reading, element), element.Name(), text_of(element));
}

int read_int(const Reading& reading, const XMLElement& element) {
  return febio::to_whole_number(reading, origin_of(reading, element), element.Name(), text_of(element));
}

Vector3d read_vector(const Reading& reading, const XMLElement& element) {
  return febio::to_vector(reading, origin_of(reading, element), element.Name(), text_of(element));
}

void check_attributes(const Reading& reading, const XMLElement& element) {
  static const std::vector<std::string> taken = {"lc", "type", "bc", "scale", "relative", "extend"};
  for (const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string word = a->Name();
    if (std::find(taken.begin(), taken.end(), word) != taken.end() ||
        one_of(word, {"name", "id", "sol", "rb", "mat", "set", "node_set", "surface", "ref"}))
      continue;
    if (word == "active" && one_of(a->Value(), {"0", "false"}))
      fail(reading, element,
           fmt::format("<{}> with active = {}, which FEBio does not know: take it out, or what it stands in",
                       element.Name(), quote(a->Value())));
    const std::string meant = nearest_name(word, taken);
    if (!meant.empty() && element.Attribute(meant.c_str()) == nullptr)
      fail(reading, element,
           fmt::format("<{}> with {} = {}: did you mean {}?", element.Name(), word, quote(a->Value()), meant));
  }
}

int read_lc(const Reading& reading, const XMLElement& element) {
  check_attributes(reading, element);
  const char* lc = element.Attribute("lc");
  return lc == nullptr ? 0 : febio::to_controller(reading, origin_of(reading, element), element.Name(), lc);
}

Scaled read_scaled(const Reading& reading, const XMLElement& element) {
  return {read_double(reading, element), read_lc(reading, element)};
}

febio::Component component_of(const Reading& reading, const XMLElement& element) {
  check_attributes(reading, element);
  febio::Component component;
  component.tag = element.Name();
  component.type = attribute(element, "type");
  component.name = attribute(element, "name");
  component.text = text_of(element);
  if (const char* lc = element.Attribute("lc")) component.lc = lc;
  component.origin = origin_of(reading, element);
  for (const XMLElement& child : children(element))
    if (component.tag == "points" || !one_of(child.Name(), {"node", "surface"}))
      component.parts.push_back(component_of(reading, child));
  return component;
}

febio::Component checked(Reading& reading, febio::Place place, const XMLElement& element) {
  febio::Component component = component_of(reading, element);
  febio::check_words(reading, place, component);
  return component;
}

febio::Steps steps_of(const Reading& reading) { return {reading.step}; }

std::string child_text(const XMLElement& parent, const char* name) {
  const XMLElement* child = parent.FirstChildElement(name);
  return child == nullptr ? std::string() : text_of(*child);
}

int need_rigid(const Reading& reading, const XMLElement& element, const std::string& id_or_name) {
  return febio::need_rigid(reading, origin_of(reading, element), id_or_name);
}

int find_name(const std::map<std::string, int, std::less<>>& index, const std::string& name) {
  const auto place = index.find(name);
  return place == index.end() ? -1 : place->second;
}

}  // namespace dea::feb
