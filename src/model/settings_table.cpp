#include <febiodea/model/settings_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <utility>

#include <febiodea/model/joint_model.h>

namespace dea {

namespace {

using Text = const std::string&;

constexpr const char* kJoint = "Joint (names are the model's own)";
constexpr const char* kCartilage = "Cartilage and springs";
constexpr const char* kLoads = "Motion and loads";
constexpr const char* kOutput = "Output";

/// One of the words that name(Word) has, in small or capital letters.
template <class Word>
Word parse_word(Text text, std::initializer_list<Word> words) {
  std::string expected;
  for (const Word* word = words.begin(); word != words.end(); ++word) {
    if (lower_case(text) == lower_case(name(*word))) return *word;
    expected += fmt::format("{}{}", word == words.begin() ? "" : word + 1 == words.end() ? " or " : ", ", name(*word));
  }
  throw bad_value(text, expected);
}

bool parse_switch(Text text) {
  const std::string word = lower_case(text);
  if (word != "true" && word != "false") throw bad_value(text, "true or false");
  return word == "true";
}

double parse_positive(Text text) {
  const double number = parse_number(text);
  if (!(number > 0)) throw bad_value(text, "a number > 0");
  return number;
}

double parse_length(Text text) {
  const double length = parse_number(text);
  if (length < 0) throw bad_value(text, "a number >= 0");
  return length;
}

double parse_poisson_ratio(Text text) {
  const double nu = parse_number(text);
  if (nu <= -1 || nu >= 0.5) throw bad_value(text, "a number with -1 < nu < 0.5");
  return nu;
}

LoadPoint parse_load_point(Text text) {
  LoadPoint point;
  point.sphere_center = lower_case(text) == "sphere-center";
  if (point.sphere_center) return point;
  try {
    point.point = parse_vector(text);
  } catch (const BadValue&) {
    throw bad_value(text, "three numbers x,y,z, or sphere-center");
  }
  return point;
}

std::array<bool, 6> parse_dofs(Text text) {
  std::array<bool, 6> free = {};
  if (lower_case(text) == "none") return free;
  for (Text word : split_at_commas(text)) {
    const auto found = std::find(std::begin(kDofNames), std::end(kDofNames), word);
    if (found == std::end(kDofNames)) throw bad_value(text, "some of x,y,z,Ru,Rv,Rw, or none");
    free[static_cast<std::size_t>(found - std::begin(kDofNames))] = true;
  }
  return free;
}

void add_once(std::vector<std::string>& names, Text name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

SettingContent one(SettingItem item) { return item; }

SettingContent word_or_nothing(Text word) {
  SettingItem item;
  if (!word.empty()) item = word;
  return item;
}

template <class Word>
SettingContent word_or_nothing(const std::optional<Word>& word) {
  return word_or_nothing(word ? std::string(name(*word)) : std::string());
}

template <class Number>
SettingContent number_or_nothing(const std::optional<Number>& number) {
  SettingItem item;
  if (number) item = *number;
  return item;
}

SettingItem item_of(Text word) { return word; }
SettingItem item_of(double number) { return number; }
SettingItem item_of(const Eigen::Vector3d& vector) { return vector; }
SettingItem item_of(const LoadPoint& load_at) {
  if (load_at.sphere_center) return std::string("sphere-center");
  return load_at.point;
}
SettingItem item_of(const std::array<bool, 6>& free) {
  std::vector<std::string> dofs;
  for (std::size_t k = 0; k < free.size(); ++k)
    if (free[k]) dofs.push_back(kDofNames[k]);
  return dofs;
}

template <class Value>
SettingContent by_name(const std::map<std::string, Value>& values) {
  std::map<std::string, SettingItem> items;
  for (const auto& entry : values) items[entry.first] = item_of(entry.second);
  return items;
}

std::vector<SettingOption> joint_options() {
  using S = Settings;
  return {
      {"contact", nullptr, false, "NAME", nullptr, kJoint, "Analyse this contact only [all that join two bodies]",
       [](S& s, Text, Text text) { s.contact = text; }, [](const S& s) { return word_or_nothing(s.contact); }},
      {"source", nullptr, false, "BODY", nullptr, kJoint,
       "Body whose layer carries the springs [each contact's primary side]",
       [](S& s, Text, Text text) { s.source = text; }, [](const S& s) { return word_or_nothing(s.source); }},
  };
}

std::vector<SettingOption> spring_options() {
  using S = Settings;
  return {
      {"springs-at", nullptr, false, "articular|bone", nullptr, kCartilage,
       "Surface of the source's layer on which the springs stand [articular]",
       [](S& s, Text, Text text) {
         s.springs_at = parse_word(text, {SpringsAt::Articular, SpringsAt::Bone});
       },
       [](const S& s) { return one(std::string(name(s.springs_at))); }},
      {"law", nullptr, false, "linear|logarithmic|neo-Hookean|layer", nullptr, kCartilage,
       "Pressure as a function of strain; layer: springs that share the cartilage's sideways flow; the others: a "
       "spring "
       "bed [layer; springs at the bone: linear]",
       [](S& s, Text, Text text) {
         s.law = parse_word(text, {Law::Linear, Law::Logarithmic, Law::NeoHookean, Law::Layer});
       },
       [](const S& s) { return word_or_nothing(s.law); }},
      {"layer-terms", nullptr, false, "1|2", nullptr, kCartilage,
       "Law layer: terms of the law; one is faster, and too wide at the edge of contact [2]",
       [](S& s, Text, Text text) {
         s.layer_fit = parse_count(text, 1, 2) == 1 ? LayerFit::OneTerm : LayerFit::TwoTerms;
       },
       [](const S& s) { return one(s.layer_fit == LayerFit::OneTerm ? 1 : 2); }},
      {"interface-stiffness", nullptr, false, "NUMBER", "STIFFNESS", kCartilage,
       "Stiffness per area between the surfaces, in series with the cartilage, as a contact penalty has (MPa/mm) "
       "[none]",
       [](S& s, Text, Text text) { s.interface_stiffness = parse_positive(text); },
       [](const S& s) { return number_or_nothing(s.interface_stiffness); }},
      {"facets", nullptr, false, "curved|flat", nullptr, kCartilage,
       "Take facets as the smooth surface they stand for, or as they are [curved]",
       [](S& s, Text, Text text) {
         s.facets = parse_word(text, {Facets::Curved, Facets::Flat});
       },
       [](const S& s) { return word_or_nothing(s.facets); }},
      {"refine", nullptr, false, "N", nullptr, kCartilage,
       "Divide every facet of the springs and, with law layer, of both layers into N*N [1]",
       [](S& s, Text, Text text) { s.refine = parse_count(text, 1, 1000); },
       [](const S& s) { return number_or_nothing(s.refine); }},
  };
}

std::vector<SettingOption> recognition_options() {
  using S = Settings;
  return {
      {"rigid", nullptr, true, "MATERIAL", nullptr, kJoint, "Take a deformable material as rigid bone; may be repeated",
       [](S& s, Text, Text text) { add_once(s.rigid, text); }, [](const S& s) { return one(s.rigid); }},
      {"attach", "surface", false, "BODY", nullptr, kJoint,
       "Body a contact surface belongs to (\"ground\" for none that moves); may be repeated [found from the mesh]",
       [](S& s, Text key, Text text) { s.attach[key] = text; }, [](const S& s) { return by_name(s.attach); }},
      {"bone", "surface", false, "SURFACE", nullptr, kJoint,
       "Bone surface under a contact surface; may be repeated [faces held by the body]",
       [](S& s, Text key, Text text) { s.bone[key] = text; }, [](const S& s) { return by_name(s.bone); }},
      {"keep-facets", nullptr, true, "SURFACE", nullptr, kJoint,
       "Leave no facet of this contact surface out, though it looks like a side wall or is bonded to bone; may be "
       "repeated",
       [](S& s, Text, Text text) { add_once(s.keep_facets, text); }, [](const S& s) { return one(s.keep_facets); }},
  };
}

std::vector<SettingOption> cartilage_options() {
  using S = Settings;
  return {
      {"thickness", "surface", false, "NUMBER", "LENGTH", kCartilage,
       "Constant cartilage thickness, in the model's length (mm); may be repeated [measured]",
       [](S& s, Text key, Text text) { s.thickness[key] = parse_length(text); },
       [](const S& s) { return by_name(s.thickness); }, &S::thickness},
      {"E", "surface", false, "NUMBER", "MODULUS", kCartilage,
       "Young's modulus, in the model's pressure (MPa); may be repeated [the material's]",
       [](S& s, Text key, Text text) { s.E[key] = parse_positive(text); }, [](const S& s) { return by_name(s.E); },
       &S::E},
      {"nu", "surface", false, "NUMBER", "RATIO", kCartilage,
       "Poisson's ratio, -1 < nu < 0.5; may be repeated [the material's]",
       [](S& s, Text key, Text text) { s.nu[key] = parse_poisson_ratio(text); },
       [](const S& s) { return by_name(s.nu); }, &S::nu},
  };
}

std::vector<SettingOption> load_options() {
  using S = Settings;
  return {
      {"free", "body", false, "x,y,z,Ru,Rv,Rw", nullptr, kLoads,
       "Dofs left free, all others that are not prescribed are held (\"none\": all held); may be repeated [the "
       "model's]",
       [](S& s, Text key, Text text) { s.free[key] = parse_dofs(text); }, [](const S& s) { return by_name(s.free); }},
      {"force", "body", false, "x,y,z", nullptr, kLoads,
       "Force in place of the model's, growing from 0 over the last step, in the model's force (N); may be repeated",
       [](S& s, Text key, Text text) { s.force[key] = parse_vector(text); },
       [](const S& s) { return by_name(s.force); }},
      {"load-at", "body", false, "x,y,z|sphere-center", nullptr, kLoads,
       "Where the force acts: a point of the reference configuration, or the centre of the articular surface's sphere; "
       "may be repeated [centre of mass]",
       [](S& s, Text key, Text text) { s.load_at[key] = parse_load_point(text); },
       [](const S& s) { return by_name(s.load_at); }},
      {"squash", nullptr, false, "true|false", nullptr, kOutput, "Show cartilage compressed [default]",
       [](S& s, Text, Text text) { s.squash = parse_switch(text); }, [](const S& s) { return one(s.squash); }, nullptr,
       "Show cartilage rigid with its bone, not compressed"},
  };
}

}  // namespace

const std::vector<SettingOption>& setting_options() {
  static const std::vector<SettingOption> options = [] {
    std::vector<SettingOption> all;
    for (const auto& part :
         {joint_options(), spring_options(), recognition_options(), cartilage_options(), load_options()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return options;
}

const SettingOption* find_setting_option(const std::string& name) {
  for (const SettingOption& o : setting_options())
    if (name == o.name) return &o;
  return nullptr;
}

void set_value(Settings& settings, const SettingValue& v) {
  if (trimmed(v.value).empty()) throw BadValue(fmt::format("found nothing, expected {}", v.option->value));
  v.option->set(settings, v.key, v.value);
}

void lay_over(Settings& settings, const std::vector<SettingValue>& values) {
  std::set<std::pair<std::string, std::string>> given;
  for (const SettingValue& v : values) {
    if (!v.option->repeatable && !given.insert({v.option->name, v.key}).second)
      throw BadValue(fmt::format("{}: given twice{}", v.where, v.key.empty() ? "" : fmt::format(" for \"{}\"", v.key)));
    if (v.option->per_surface != nullptr && v.key.empty()) (settings.*v.option->per_surface).clear();
  }
  for (const SettingValue& v : values) {
    try {
      set_value(settings, v);
    } catch (const BadValue& e) {
      throw BadValue(fmt::format("{}: {}", v.where, e.what()));
    }
  }
}

}  // namespace dea
