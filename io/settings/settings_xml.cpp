#include <febiodea/io/settings/settings_xml.h>

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <febiodea/base/error.h>
#include <febiodea/base/names.h>
#include <febiodea/model/joint_model.h>

namespace dea {

namespace {

constexpr const char* kSpace = " \t\r\n";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t comma = text.find(',', begin);
    words.push_back(trimmed(text.substr(begin, comma == std::string::npos ? comma : comma - begin)));
    if (comma == std::string::npos) return words;
    begin = comma + 1;
  }
}

BadValue bad(const std::string& found, const std::string& expected) {
  return BadValue(fmt::format("found \"{}\", expected {}", found, expected));
}

Eigen::Vector3d parse_vector(const std::string& text) {
  std::vector<double> numbers;
  try {
    numbers = parse_numbers(text);
  } catch (const BadValue&) {
  }
  if (numbers.size() != 3) throw bad(text, "three numbers x,y,z");
  return {numbers[0], numbers[1], numbers[2]};
}

std::array<bool, 6> parse_dofs(const std::string& text) {
  std::array<bool, 6> free = {};
  if (lower(text) == "none") return free;
  for (const std::string& word : split(text)) {
    const auto found = std::find(std::begin(kDofNames), std::end(kDofNames), word);
    if (found == std::end(kDofNames)) throw bad(text, "some of x,y,z,Ru,Rv,Rw, or none");
    free[static_cast<std::size_t>(found - std::begin(kDofNames))] = true;
  }
  return free;
}

/// Values that hold per surface: a stronger one for all surfaces silences weaker ones for single surfaces.
std::map<std::string, double>* surface_numbers(Settings& s, const std::string& option) {
  if (option == "thickness") return &s.thickness;
  if (option == "E") return &s.E;
  if (option == "nu") return &s.nu;
  return nullptr;
}

/// All places in a settings file where something is wrong look like this.
InputError fault(const std::string& path, int line, const std::string& text) {
  return InputError(path, std::max(line, 1), text);
}

/// Elements of a settings file that are no Settings.
std::string* output_setting(OutputSettings& outputs, const std::string& name) {
  if (name == "output") return &outputs.output;
  if (name == "json") return &outputs.json;
  if (name == "csv") return &outputs.csv;
  if (name == "facets-csv") return &outputs.facets_csv;
  if (name == "report") return &outputs.report;
  if (name == "vtu") return &outputs.vtu;
  if (name == "states") return &outputs.states;
  return nullptr;
}

std::vector<std::string> option_names() {
  std::vector<std::string> names = {"output", "json", "csv", "facets-csv", "report", "vtu", "states"};
  for (const SettingOption& o : setting_options()) names.push_back(o.name);
  return names;
}

std::string names_of_options() {
  std::string names;
  for (const SettingOption& o : setting_options()) names += fmt::format("<{}>, ", o.name);
  return names + "<output>, <json>, <csv>, <facets-csv>, <report>, <vtu>, <states>";
}

/// An element that is one text: no children, no attributes.
std::string read_text_element(const std::string& path, const tinyxml2::XMLElement& e, const char* expected) {
  if (e.FirstAttribute())
    throw fault(path, e.GetLineNum(),
                fmt::format("<{}>: found attribute \"{}\", expected none", e.Name(), e.FirstAttribute()->Name()));
  if (e.FirstChildElement())
    throw fault(path, e.FirstChildElement()->GetLineNum(),
                fmt::format("<{}>: found <{}>, expected {}", e.Name(), e.FirstChildElement()->Name(), expected));
  const std::string text = trimmed(e.GetText() ? e.GetText() : "");
  if (text.empty())
    throw fault(path, e.GetLineNum(), fmt::format("<{}>: found nothing, expected {}", e.Name(), expected));
  return text;
}

void check_states(const std::string& path, int line, const std::string& states) {
  if (states == "all" || states == "last") return;
  try {
    parse_numbers(states);
  } catch (const BadValue&) {
    throw fault(path, line, fmt::format("<states>: found \"{}\", expected all, last or times t1,t2,...", states));
  }
}

SettingValue read_element(const std::string& path, const tinyxml2::XMLElement& e) {
  SettingValue v;
  v.option = find_setting_option(e.Name());
  const int line = e.GetLineNum();
  if (!v.option)
    throw fault(path, line,
                fmt::format("found <{}>{}, expected one of {}", e.Name(), did_you_mean(e.Name(), option_names()),
                            names_of_options()));
  v.where = fmt::format("<{}>", e.Name());
  if (e.FirstChildElement())
    throw fault(path, e.FirstChildElement()->GetLineNum(),
                fmt::format("<{}>: found <{}>, expected {}", e.Name(), e.FirstChildElement()->Name(), v.option->value));
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
    if (!v.option->key || std::string(a->Name()) != v.option->key)
      throw fault(path, line,
                  fmt::format("<{}>: found attribute \"{}\", expected {}", e.Name(), a->Name(),
                              v.option->key ? fmt::format("\"{}\"", v.option->key) : std::string("none")));
    v.key = a->Value();
  }
  if (v.option->key && v.key.empty() && !v.option->key_optional)
    throw fault(
        path, line,
        fmt::format("<{}>: found no attribute \"{}\", expected {}=\"NAME\"", e.Name(), v.option->key, v.option->key));
  v.value = trimmed(e.GetText() ? e.GetText() : "");
  return v;
}

}  // namespace

const std::vector<SettingOption>& setting_options() {
  static const std::vector<SettingOption> options = {
      {"contact", nullptr, false, false, "NAME"},
      {"source", nullptr, false, false, "BODY"},
      {"springs-at", nullptr, false, false, "articular|bone"},
      {"law", nullptr, false, false, "linear|logarithmic|neo-Hookean|layer"},
      {"layer-terms", nullptr, false, false, "1|2"},
      {"interface-stiffness", nullptr, false, false, "NUMBER"},
      {"facets", nullptr, false, false, "curved|flat"},
      {"refine", nullptr, false, false, "N"},
      {"rigid", nullptr, false, true, "MATERIAL"},
      {"attach", "surface", false, false, "BODY"},
      {"bone", "surface", false, false, "SURFACE"},
      {"keep-facets", nullptr, false, true, "SURFACE"},
      {"thickness", "surface", true, false, "NUMBER"},
      {"E", "surface", true, false, "NUMBER"},
      {"nu", "surface", true, false, "NUMBER"},
      {"free", "body", false, false, "x,y,z,Ru,Rv,Rw"},
      {"force", "body", false, false, "x,y,z"},
      {"load-at", "body", false, false, "x,y,z|sphere-center"},
      {"squash", nullptr, false, false, "true|false"},
  };
  return options;
}

const SettingOption* find_setting_option(const std::string& name) {
  for (const SettingOption& o : setting_options())
    if (name == o.name) return &o;
  return nullptr;
}

double parse_number(const std::string& text) {
  const std::string word = trimmed(text);
  const char* begin = word.data();
  const char* end = begin + word.size();
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') ++begin;  // from_chars knows no plus sign
  double number = 0.0;
  const auto result = std::from_chars(begin, end, number);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(number)) throw bad(text, "a number");
  return number;
}

std::vector<double> parse_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& word : split(text)) {
    try {
      numbers.push_back(parse_number(word));
    } catch (const BadValue&) {
      throw bad(text, "numbers separated by commas");
    }
  }
  return numbers;
}

int parse_count(const std::string& text, int least, int most) {
  const std::string word = trimmed(text);
  int number = 0;
  const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
  if (result.ec != std::errc() || result.ptr != word.data() + word.size() || number < least || number > most)
    throw bad(text, fmt::format("a whole number from {} to {}", least, most));
  return number;
}

SettingValue split_key(const SettingOption& option, const std::string& text) {
  SettingValue v;
  v.option = &option;
  v.value = text;
  v.where = fmt::format("--{} {}", option.name, text);
  if (!option.key) return v;
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) {
    if (option.key_optional) return v;
    throw BadValue(fmt::format("{}: found no '=', expected {}={}", v.where,
                               lower(option.key) == "body" ? "BODY" : "SURFACE", option.value));
  }
  v.key = text.substr(0, equals);
  v.value = text.substr(equals + 1);
  if (v.key.empty())
    throw BadValue(fmt::format("{}: found no name before '=', expected that of a {}", v.where, option.key));
  return v;
}

void set_value(Settings& s, const SettingValue& v) {
  const std::string name = v.option->name;
  const std::string& text = v.value;
  if (trimmed(text).empty()) throw BadValue(fmt::format("found nothing, expected {}", v.option->value));
  if (name == "contact") {
    s.contact = text;
  } else if (name == "source") {
    s.source = text;
  } else if (name == "springs-at") {
    if (lower(text) == "articular")
      s.springs_at = SpringsAt::Articular;
    else if (lower(text) == "bone")
      s.springs_at = SpringsAt::Bone;
    else
      throw bad(text, "articular or bone");
  } else if (name == "law") {
    if (lower(text) == "linear")
      s.law = Law::Linear;
    else if (lower(text) == "logarithmic")
      s.law = Law::Logarithmic;
    else if (lower(text) == "neo-hookean")
      s.law = Law::NeoHookean;
    else if (lower(text) == "layer")
      s.law = Law::Layer;
    else
      throw bad(text, "linear, logarithmic, neo-Hookean or layer");
  } else if (name == "layer-terms") {
    s.layer_fit = parse_count(text, 1, 2) == 1 ? LayerFit::OneTerm : LayerFit::TwoTerms;
  } else if (name == "interface-stiffness") {
    s.interface_stiffness = parse_number(text);
    if (!(*s.interface_stiffness > 0)) throw bad(text, "a number > 0");
  } else if (name == "facets") {
    if (lower(text) == "curved")
      s.facets = Facets::Curved;
    else if (lower(text) == "flat")
      s.facets = Facets::Flat;
    else
      throw bad(text, "curved or flat");
  } else if (name == "refine") {
    s.refine = parse_count(text, 1, 1000);
  } else if (name == "rigid") {
    if (std::find(s.rigid.begin(), s.rigid.end(), text) == s.rigid.end()) s.rigid.push_back(text);
  } else if (name == "attach") {
    s.attach[v.key] = text;
  } else if (name == "bone") {
    s.bone[v.key] = text;
  } else if (name == "keep-facets") {
    if (std::find(s.keep_facets.begin(), s.keep_facets.end(), text) == s.keep_facets.end())
      s.keep_facets.push_back(text);
  } else if (name == "thickness") {
    const double t = parse_number(text);
    if (t < 0) throw bad(text, "a number >= 0");
    s.thickness[v.key] = t;
  } else if (name == "E") {
    const double E = parse_number(text);
    if (E <= 0) throw bad(text, "a number > 0");
    s.E[v.key] = E;
  } else if (name == "nu") {
    const double nu = parse_number(text);
    if (nu <= -1 || nu >= 0.5) throw bad(text, "a number with -1 < nu < 0.5");
    s.nu[v.key] = nu;
  } else if (name == "free") {
    s.free[v.key] = parse_dofs(text);
  } else if (name == "force") {
    s.force[v.key] = parse_vector(text);
  } else if (name == "load-at") {
    LoadPoint point;
    point.sphere_center = lower(text) == "sphere-center";
    if (!point.sphere_center) {
      try {
        point.point = parse_vector(text);
      } catch (const BadValue&) {
        throw bad(text, "three numbers x,y,z, or sphere-center");
      }
    }
    s.load_at[v.key] = point;
  } else if (name == "squash") {
    if (lower(text) != "true" && lower(text) != "false") throw bad(text, "true or false");
    s.squash = lower(text) == "true";
  }
}

void lay_over(Settings& settings, const std::vector<SettingValue>& values) {
  std::set<std::pair<std::string, std::string>> given;
  for (const SettingValue& v : values) {
    if (!v.option->repeatable && !given.insert({v.option->name, v.key}).second)
      throw BadValue(fmt::format("{}: given twice{}", v.where, v.key.empty() ? "" : fmt::format(" for \"{}\"", v.key)));
    std::map<std::string, double>* numbers = surface_numbers(settings, v.option->name);
    if (numbers && v.key.empty()) numbers->clear();
  }
  for (const SettingValue& v : values) {
    try {
      set_value(settings, v);
    } catch (const BadValue& e) {
      throw BadValue(fmt::format("{}: {}", v.where, e.what()));
    }
  }
}

SettingsFile read_settings_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  std::error_code error;
  const bool readable = in && !std::filesystem::is_directory(path, error);
  if (readable) bytes << in.rdbuf();  // fails on an empty file, which is no XML either
  if (!readable || in.bad())
    throw InputError(fmt::format("{}: found no readable file, expected a settings file", path));
  const std::string text = bytes.str();

  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw fault(path, document.ErrorLineNum(), "found no well-formed XML, expected <febiodea_settings version=\"1\">");
  const tinyxml2::XMLElement* root = document.RootElement();
  if (!root || std::string(root->Name()) != "febiodea_settings")
    throw fault(path, root ? root->GetLineNum() : 1,
                fmt::format("found {}, expected <febiodea_settings version=\"1\">",
                            root ? fmt::format("<{}>", root->Name()) : std::string("nothing")));
  const char* version = root->Attribute("version");
  if (!version || std::string(version) != "1")
    throw fault(path, root->GetLineNum(), fmt::format("found version \"{}\", expected \"1\"", version ? version : ""));

  // One element after the other, so that a fault is reported with its own line.
  SettingsFile file;
  std::set<std::pair<std::string, std::string>> given;
  for (const tinyxml2::XMLElement* e = root->FirstChildElement(); e; e = e->NextSiblingElement()) {
    if (std::string* output = output_setting(file.outputs, e->Name())) {
      if (!output->empty())
        throw fault(path, e->GetLineNum(), fmt::format("<{}>: found a second one, expected it once", e->Name()));
      const bool states = output == &file.outputs.states;
      *output = read_text_element(path, *e,
                                  states                        ? "all, last or times t1,t2,..."
                                  : output == &file.outputs.vtu ? "the name of a folder"
                                                                : "a file name");
      if (states) check_states(path, e->GetLineNum(), *output);
      continue;
    }
    const SettingValue v = read_element(path, *e);
    if (!v.option->repeatable && !given.insert({v.option->name, v.key}).second)
      throw fault(path, e->GetLineNum(),
                  fmt::format("{}: found a second one, expected it once{}", v.where,
                              v.key.empty() ? "" : fmt::format(" for \"{}\"", v.key)));
    try {
      set_value(file.settings, v);
    } catch (const BadValue& bad_value) {
      throw fault(path, e->GetLineNum(), fmt::format("{}: {}", v.where, bad_value.what()));
    }
  }
  return file;
}

Settings read_settings(const std::string& path) { return read_settings_file(path).settings; }

}  // namespace dea
