#include <febiodea/io/feb/feb_reading.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include <febiodea/base/error.h>

namespace dea::feb {
bool IdTable::add(int id) {
  if (index_.empty() && (ids_.empty() || id > ids_.back())) {
    ids_.push_back(id);
    largest_ = id;
    return true;
  }
  if (index_.empty()) {  // the first id out of order: from now on by a hash table
    for (int i = 0; i < size(); ++i) index_.emplace(ids_[static_cast<std::size_t>(i)], i);
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
  ignore(reading, origin_of(reading, element), what);
}

void ignore(Reading& reading, Origin origin, const std::string& what) {
  febio::list_once(reading.model.ignored, reading.ignored_index, what, origin);
}

void unsupported(Reading& reading, const XMLElement& element, const std::string& what, const std::string& advice) {
  unsupported(reading, origin_of(reading, element), what, advice);
}

void unsupported(Reading& reading, Origin origin, const std::string& what, const std::string& advice) {
  febio::list_once(reading.model.unsupported, reading.unsupported_index, what, origin, advice);
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
    if (!read_child(reading, child, readers)) others(reading, child);
  }
}

void read_children(Reading& reading, const XMLElement& section, std::span<const TagReader> readers) {
  for (const XMLElement& child : children(section)) {
    if (!read_child(reading, child, readers))
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
  const std::string text = text_of(element);
  const auto value = whole_double(text);
  if (!value)
    fail(reading, element,
         fmt::format("{} = {}, expected a number of at most 1e30", element.Name(), quote(trim(text))));
  return *value;
}

int read_int(const Reading& reading, const XMLElement& element) {
  const std::string text = text_of(element);
  const auto value = whole_int(text);
  if (!value)
    fail(reading, element, fmt::format("{} = {}, expected a whole number", element.Name(), quote(trim(text))));
  return *value;
}

bool read_bool(const Reading& reading, const XMLElement& element) {
  const std::string text = text_of(element);
  const auto value = whole_int(text);
  // FEBio reads the word "true" as 0: rather refuse than follow it or guess.
  if (!value) fail(reading, element, fmt::format("{} = {}, expected 0 or 1", element.Name(), quote(trim(text))));
  return *value != 0;
}

Vector3d read_vector(const Reading& reading, const XMLElement& element) {
  const std::string text = text_of(element);
  std::string_view rest = text;
  Vector3d vector;
  bool good = true;
  for (int i = 0; i < 3 && good; ++i) {
    good = (i == 0 || take_comma(rest)) && take_double(rest, vector[i]) == Number::Ok;
  }
  if (!good || !trim(rest).empty()) {
    fail(reading, element,
         fmt::format("{} = {}, expected three numbers x,y,z of at most 1e30", element.Name(), quote(trim(text))));
  }
  return vector;
}

int read_lc(const Reading& reading, const XMLElement& element) {
  const char* lc = element.Attribute("lc");
  if (lc == nullptr) return 0;
  const auto id = whole_int(lc);
  if (!id || *id < 1) {
    fail(reading, element,
         fmt::format("{} has lc = {}, expected the id of a load controller", element.Name(), quote(lc)));
  }
  return *id;
}

Scaled read_scaled(const Reading& reading, const XMLElement& element) {
  return {read_double(reading, element), read_lc(reading, element)};
}

int read_word(const XMLElement& element, std::initializer_list<const char*> words) {
  const std::string text = text_of(element);
  const std::string_view word = trim(text);
  int i = 0;
  for (const char* candidate : words) {
    if (same_word(word, candidate)) return i;
    ++i;
  }
  const auto position = whole_int(word);
  return position && *position >= 0 && *position < i ? *position : -1;
}

double child_double(const Reading& reading, const XMLElement& parent, const char* name, double fallback) {
  const XMLElement* child = parent.FirstChildElement(name);
  return child == nullptr ? fallback : read_double(reading, *child);
}

bool child_bool(const Reading& reading, const XMLElement& parent, const char* name, bool fallback) {
  const XMLElement* child = parent.FirstChildElement(name);
  return child == nullptr ? fallback : read_bool(reading, *child);
}

std::string child_text(const XMLElement& parent, const char* name) {
  const XMLElement* child = parent.FirstChildElement(name);
  return child == nullptr ? std::string() : text_of(*child);
}

Vector3d child_vector(Reading& reading, const XMLElement& parent, const char* name, const Vector3d& fallback) {
  const XMLElement* child = parent.FirstChildElement(name);
  if (child == nullptr) return fallback;
  if (child->Attribute("lc") != nullptr)
    unsupported(reading, *child, fmt::format("{} that follows a load controller", name));
  return read_vector(reading, *child);
}

int child_body(const Reading& reading, const XMLElement& element, const char* tag) {
  const XMLElement* child = element.FirstChildElement(tag);
  if (child == nullptr)
    fail(reading, element,
         fmt::format("<{}> without <{}>: add it, with the name of a rigid material", element.Name(), tag));
  return need_rigid(reading, *child, text_of(*child));
}

int find_material(const Reading& reading, const XMLElement& element, const std::string& name) {
  const auto place = reading.material_index.find(name);
  if (reading.ambiguous_materials.count(name) > 0)
    fail(reading, element, fmt::format("several materials are called {}: name it by its id", quote(name)));
  return place == reading.material_index.end() ? -1 : place->second;
}

int need_rigid(const Reading& reading, const XMLElement& element, const std::string& id_or_name) {
  const JointModel& model = reading.model;
  int index = -1;
  if (const auto id = whole_int(id_or_name)) {  // a text that is a number is an id first
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
      if (model.materials[i].id == *id) index = static_cast<int>(i);
    }
  }
  for (const std::string& name : {id_or_name, std::string(trim(id_or_name))}) {
    if (index < 0) index = find_material(reading, element, name);
  }
  const auto bodies = [&] {
    std::vector<std::string> names;
    for (const Material& material : model.materials)
      if (material.rigid) names.push_back(material.name);
    return did_you_mean(trim(id_or_name), names) + "; rigid bodies: " + name_list(names, trim(id_or_name));
  };
  if (index < 0) {
    fail(reading, element,
         fmt::format("{} names no material, expected the id or name of a rigid body{}", quote(id_or_name), bodies()));
  }
  const Material& material = model.materials[static_cast<std::size_t>(index)];
  if (!material.rigid) {
    fail(reading, element,
         fmt::format("material {} is {}, expected a rigid body{}", quote(material.name), quote(material.type),
                     bodies()));
  }
  return index;
}

int find_name(const std::map<std::string, int, std::less<>>& index, const std::string& name) {
  const auto place = index.find(name);
  return place == index.end() ? -1 : place->second;
}

}  // namespace dea::feb
