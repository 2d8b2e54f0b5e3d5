#include "io/feb/read_feb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "io/feb/feb_reading.h"
#include "src/base/error.h"

namespace dea {
namespace feb {
namespace {

namespace fs = std::filesystem;

/// Files that include each other often, not in a circle, could still be without end.
constexpr int kMostIncludes = 1000;

void read_section(Reading& reading, const XMLElement& section);

const XMLElement& need_root(const XMLDocument& document, const std::string& name) {
  const XMLElement* root = document.RootElement();
  if (root == nullptr) throw InputError(name, 1, "no element at all, expected <febio_spec>: this is no FEBio model");
  if (std::strcmp(root->Name(), "febio_spec") != 0) {
    throw InputError(name, root->GetLineNum(),
                     fmt::format("the root is {}, expected <febio_spec>: this is no FEBio model", quote(root->Name())));
  }
  return *root;
}

const Rules* need_rules(const XMLElement& root, const std::string& name) {
  const std::string version = attribute(root, "version");
  for (const Rules* rules : {&kRules12, &kRules20, &kRules25, &kRules30, &kRules40}) {
    if (version == rules->version) return rules;
  }
  throw InputError(
      name, root.GetLineNum(),
      fmt::format("version {}, expected 1.2, 2.0, 2.5, 3.0 or 4.0: open it in FEBio Studio and save as 4.0",
                  quote(version)));
}

/// First of the candidates that is a file; the first one if none is.
std::string first_file(const std::vector<fs::path>& candidates) {
  std::error_code error;
  for (const fs::path& path : candidates) {
    if (fs::is_regular_file(path, error)) return path.string();
  }
  return candidates.front().string();
}

/// The document of an include; remembers the file while `read` runs, so that circles are found.
template <class Read>
void read_other_file(Reading& reading, const XMLElement& place, const std::string& path, Read read) {
  std::error_code error;
  if (!fs::exists(path, error)) fail(reading, place, fmt::format("no such file: {}: check the path", quote(path)));
  const std::string canonical = fs::weakly_canonical(path, error).string();
  if (std::find(reading.open_files.begin(), reading.open_files.end(), canonical) != reading.open_files.end()) {
    fail(reading, place, fmt::format("{} includes itself: remove one include", quote(path)));
  }
  if (++reading.files_read > kMostIncludes)
    fail(reading, place, fmt::format("more than {} includes: does a file include others without end?", kMostIncludes));
  std::unique_ptr<XMLDocument> document = load_xml(path);
  const XMLElement& root = need_root(*document, path);

  const std::size_t parts = reading.parts.size();
  const int outer_file = reading.file;
  const Rules* outer_rules = reading.rules;
  auto& files = reading.model.files;
  const auto known = std::find(files.begin(), files.end(), path);
  reading.file = static_cast<int>(known - files.begin());
  if (known == files.end()) files.push_back(path);
  reading.open_files.push_back(canonical);
  read(root);
  if (reading.parts.size() > parts) reading.documents.push_back(std::move(document));  // instances read them again
  reading.open_files.pop_back();
  reading.file = outer_file;
  reading.rules = outer_rules;
}

fs::path folder_of_current(const Reading& reading) {
  return fs::path(reading.model.files[at(reading.file)]).parent_path();
}

/// <Include>: a bare name lies beside the model, a path is taken as written; then beside the including file.
void read_include(Reading& reading, const XMLElement& element) {
  const std::string name(trim(text_of(element)));
  if (name.empty()) fail(reading, element, "<Include> without a file name: give one, or take it out");
  const bool bare = name.find_first_of("/\\") == name.npos;
  const fs::path first = bare ? fs::path(reading.main_folder) / name : fs::path(name);
  read_other_file(reading, element, first_file({first, folder_of_current(reading) / name}),
                  [&](const XMLElement& root) {
                    reading.rules = need_rules(root, reading.model.files[at(reading.file)]);
                    for (const XMLElement& section : children(root)) {
                      read_section(reading, section);
                    }
                  });
}

/// <Geometry from="file"/>: the section of that name, by the rules of the including file.
void read_from(Reading& reading, const XMLElement& element) {
  const std::string name = attribute(element, "from");
  const std::string path = first_file({fs::path(name), folder_of_current(reading) / name});
  read_other_file(reading, element, path, [&](const XMLElement& root) {
    const XMLElement* section = root.FirstChildElement(element.Name());
    if (section == nullptr)
      throw InputError(path, root.GetLineNum(),
                       fmt::format("no <{}> here, which {} takes from this file: add it, or take out its from",
                                   element.Name(), quote(reading.model.files[0])));
    read_section(reading, *section);
  });
}

}  // namespace

const Part& find_part_in_file(Reading& reading, const XMLElement& element, const std::string& name) {
  const std::string from = attribute(element, "from");
  const std::string path = first_file({fs::path(from), folder_of_current(reading) / from});
  const Part* part = nullptr;
  read_other_file(reading, element, path, [&](const XMLElement& root) {
    const XMLElement* geometry = root.FirstChildElement("Geometry");
    const XMLElement* child = geometry == nullptr ? nullptr : geometry->FirstChildElement("Part");
    while (child != nullptr && attribute(*child, "name") != name) child = child->NextSiblingElement("Part");
    if (child == nullptr) {
      throw InputError(path, root.GetLineNum(),
                       fmt::format("no Part {} in its Geometry, which {} takes from this file", quote(name),
                                   quote(reading.model.files[0])));
    }
    part = &add_named(reading, *child, reading.parts, name, Part{child, reading.file}, "part");
  });
  return *part;
}

namespace {

void read_module(Reading& reading, const XMLElement& section) {
  JointModel& model = reading.model;
  const std::string type = attribute(section, "type");
  if (reading.step >= 0 && !model.module.empty()) {  // 1.2 and 2.0 have one in each step
    if (!febio::known_module(type))
      unsupported_word(reading, section, fmt::format("module {}", quote(type)), febio::WordOf::Module, type);
    return;
  }
  model.module = type;
  const std::string units = child_text(section, "units");
  if (!units.empty()) model.units = trim(units);
  if (!febio::known_module(model.module))
    unsupported_word(reading, section, fmt::format("module {}", quote(type)), febio::WordOf::Module, type);
}

/// One step: sections read from now on belong to it, even those after its end tag, as in FEBio.
void read_step(Reading& reading, const XMLElement& section) {
  reading.controls.push_back(reading.controls.empty() ? reading.top_control : Control());
  reading.step = static_cast<int>(reading.controls.size()) - 1;
  reading.control().name = attribute(section, "name");
  reading.control().origin = origin_of(reading, section);
  for (const XMLElement& child : children(section)) {
    const std::string_view tag = child.Name();
    if (tag == "Step" || tag == "step")
      fail(reading, child, "a step inside a step, expected steps one after the other: move it out");
    read_section(reading, child);
  }
}

void read_steps(Reading& reading, const XMLElement& section) {
  const bool one_step = section.FirstChildElement("step") == nullptr;
  if (one_step && (reading.rules->up_to_25 || !is_leaf(section))) read_step(reading, section);
  if (one_step) return;
  for (const XMLElement& child : children(section)) {
    if (std::strcmp(child.Name(), "step") == 0)
      read_step(reading, child);
    else
      ignore(reading, child, fmt::format("<{}> in Step", child.Name()));
  }
}

void pass_over_section(Reading& reading, const XMLElement& section) {
  ignore(reading, section, fmt::format("section <{}>", section.Name()));
}

void read_rigid_section(Reading& reading, const XMLElement& section) {
  if (!reading.rules->up_to_25) return read_each<read_rigid>(reading, section);
  unsupported(reading, section, "section <Rigid> in a version without one", "save it as 4.0");
}

/// A section whose meaning depends on the version.
template <SectionRules Rules::*Section>
void by_version(Reading& reading, const XMLElement& section) {
  const SectionRules& rules = reading.rules->*Section;
  read_children(reading, section, rules.readers, rules.others);
}

void read_mesh_section(Reading& reading, const XMLElement& section) { reading.rules->mesh(reading, section); }

/// What the section Discrete adds is no part of a step: it acts in all.
void read_discrete_section(Reading& reading, const XMLElement& section) {
  const int step = reading.step;
  reading.step = -1;
  reading.rules->discrete(reading, section);
  reading.step = step;
}

constexpr SectionReader kInSilence = [](Reading&, const XMLElement&) {};

constexpr TagReader kSections[] = {{"Module", read_module},
                                   {"Control", read_control},
                                   {"Material", read_materials},
                                   {"Geometry", read_mesh_section},
                                   {"Mesh", read_mesh_section},
                                   {"MeshDomains", read_mesh_domains},
                                   {"MeshData", read_each<read_mesh_data>},
                                   {"Boundary", by_version<&Rules::boundary>},
                                   {"Rigid", read_rigid_section},
                                   {"Loads", by_version<&Rules::loads>},
                                   {"Contact", by_version<&Rules::contact>},
                                   {"Constraints", by_version<&Rules::constraints>},
                                   {"Discrete", read_discrete_section},
                                   {"Initial", read_each<read_initial>},
                                   {"LoadData", read_each<read_load_data>},
                                   {"Include", read_include},
                                   {"Step", read_steps},
                                   {"Globals", kInSilence},
                                   {"Output", kInSilence},
                                   // FEBio's own, of no use here
                                   {"MeshAdaptor", pass_over_section},
                                   {"Environment", pass_over_section},
                                   {"Code", pass_over_section},
                                   {"Parameters", pass_over_section}};

void read_section(Reading& reading, const XMLElement& section) {
  if (section.Attribute("from") != nullptr) return read_from(reading, section);
  if (read_child(reading, section, kSections)) return;
  // A slip of the keyboard would leave out a whole section.
  std::vector<std::string> names;
  for (const TagReader& known : kSections)
    if (known.read != kInSilence && known.read != pass_over_section) names.push_back(known.tag);
  const std::string meant = nearest_name(section.Name(), names);
  if (!meant.empty())
    fail(reading, section, fmt::format("section <{}> is unknown: did you mean <{}>?", section.Name(), meant));
  pass_over_section(reading, section);
}

JointModel read_document(const XMLDocument& document, const std::string& path) {
  const XMLElement& root = need_root(document, path);
  Reading reading;
  reading.rules = need_rules(root, path);
  reading.model.files = {path};
  reading.model.version = reading.rules->version;
  std::error_code error;
  reading.open_files = {fs::weakly_canonical(path, error).string()};
  reading.main_folder = fs::path(path).parent_path().string();
  for (const XMLElement& section : children(root)) {
    read_section(reading, section);
  }
  complete_model(reading);
  return std::move(reading.model);
}

}  // namespace
}  // namespace feb

JointModel read_feb(const std::string& path) { return feb::read_document(*feb::load_xml(path), path); }

JointModel read_feb_text(const std::string& text, const std::string& path) {
  feb::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(path, std::max(1, document.ErrorLineNum()),
                     fmt::format("broken XML ({})", feb::XMLDocument::ErrorIDToName(document.ErrorID())));
  return feb::read_document(document, path);
}

}  // namespace dea
