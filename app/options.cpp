#include <febiodea/app/options.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <febiodea/base/error.h>
#include <febiodea/io/settings/settings_xml.h>

namespace dea {

namespace {

struct OptionHelp {
  const char* name;
  const char* type;
  const char* group;
  const char* text;
};

constexpr const char* kJoint = "Joint (names are the model's own)";
constexpr const char* kCartilage = "Cartilage and springs";
constexpr const char* kLoads = "Motion and loads";

constexpr OptionHelp kOptions[] = {
    {"contact", "NAME", kJoint, "Analyse this contact only [all that join two bodies]"},
    {"source", "BODY", kJoint, "Body whose layer carries the springs [each contact's primary side]"},
    {"rigid", "MATERIAL", kJoint, "Take a deformable material as rigid bone; may be repeated"},
    {"attach", "SURFACE=BODY", kJoint,
     "Body a contact surface belongs to (\"ground\" for none that moves); may be repeated [found from the mesh]"},
    {"bone", "SURFACE=SURFACE", kJoint,
     "Bone surface under a contact surface; may be repeated [faces held by the body]"},
    {"keep-facets", "SURFACE", kJoint,
     "Leave no facet of this contact surface out, though it looks like a side wall or is bonded to bone; may be "
     "repeated"},
    {"springs-at", "articular|bone", kCartilage,
     "Surface of the source's layer on which the springs stand [articular]"},
    {"law", "linear|logarithmic|neo-Hookean|layer", kCartilage,
     "Pressure as a function of strain; layer: springs that share the cartilage's sideways flow; the others: a spring "
     "bed [layer; springs at the bone: linear]"},
    {"layer-terms", "1|2", kCartilage,
     "Law layer: terms of the law; one is faster, and too wide at the edge of contact [2]"},
    {"interface-stiffness", "STIFFNESS", kCartilage,
     "Stiffness per area between the surfaces, in series with the cartilage, as a contact penalty has (MPa/mm) [none]"},
    {"facets", "curved|flat", kCartilage, "Take facets as the smooth surface they stand for, or as they are [curved]"},
    {"refine", "N", kCartilage, "Divide every facet of the springs and, with law layer, of both layers into N*N [1]"},
    {"thickness", "[SURFACE=]LENGTH", kCartilage,
     "Constant cartilage thickness, in the model's length (mm); may be repeated [measured]"},
    {"E", "[SURFACE=]MODULUS", kCartilage,
     "Young's modulus, in the model's pressure (MPa); may be repeated [the material's]"},
    {"nu", "[SURFACE=]RATIO", kCartilage, "Poisson's ratio, -1 < nu < 0.5; may be repeated [the material's]"},
    {"free", "BODY=x,y,z,Ru,Rv,Rw", kLoads,
     "Dofs left free, all others that are not prescribed are held (\"none\": all held); may be repeated [the model's]"},
    {"force", "BODY=x,y,z", kLoads,
     "Force in place of the model's, growing from 0 over the last step, in the model's force (N); may be repeated"},
    {"load-at", "BODY=x,y,z|sphere-center", kLoads,
     "Where the force acts: a point of the reference configuration, or the centre of the articular surface's sphere; "
     "may be repeated [centre of mass]"},
};

}  // namespace

void add_settings_options(CLI::App& command, SettingsArguments& arguments, bool refine, bool squash) {
  for (const OptionHelp& help : kOptions) {
    const std::string name = help.name;
    if (name == "refine" && !refine) continue;
    std::vector<std::string>& values = arguments.values[name];
    const SettingOption& option = *find_setting_option(name);
    // One word per use, also when it begins with '-' or '[': the rest of the line is not ours to swallow.
    CLI::Option* added = command.add_option("--" + name, values, help.text)
                             ->type_name(help.type)
                             ->allow_extra_args(false)
                             ->group(help.group);
    if (option.key || option.repeatable)
      added->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    else
      added->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::Throw);
  }
  if (squash) {
    command
        .add_flag_callback(
            "--no-squash", [&arguments] { arguments.values["squash"] = {"false"}; },
            "Show cartilage rigid with its bone, not compressed")
        ->group("Output");
    command
        .add_flag_callback(
            "--squash", [&arguments] { arguments.values["squash"] = {"true"}; }, "Show cartilage compressed [default]")
        ->group("Output");
  }
  command
      .add_option("--settings", arguments.file,
                  "XML file with any of the options above (docs/settings.md); the command line comes first, then the "
                  "file, then the model")
      ->type_name("FILE")
      ->group("Settings file");
}

Settings effective_settings(const SettingsArguments& arguments, OutputSettings* outputs) {
  Settings settings;
  if (!arguments.file.empty()) {
    const SettingsFile file = read_settings_file(arguments.file);
    settings = file.settings;
    if (outputs != nullptr) *outputs = file.outputs;
  }
  try {
    std::vector<SettingValue> values;
    for (const auto& option : arguments.values)
      for (const std::string& text : option.second)
        values.push_back(split_key(*find_setting_option(option.first), text));
    lay_over(settings, values);
  } catch (const BadValue& e) {
    throw UsageError(e.what());
  }
  return settings;
}

void add_threads_option(CLI::App& command, std::string& threads) {
  command.add_option("--threads", threads, "Threads to use; results do not depend on it [all cores]")
      ->type_name("N")
      ->group("Computer");
}

std::unique_ptr<tbb::global_control> limit_threads(const std::string& threads) {
  if (threads.empty()) return nullptr;
  const int n = count_argument("threads", threads, 1, 1024);
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(n));
}

int count_argument(const char* option, const std::string& text, int least, int most) {
  try {
    return parse_count(text, least, most);
  } catch (const BadValue& e) {
    throw UsageError(fmt::format("--{} {}: {}", option, text, e.what()));
  }
}

double number_argument(const char* option, const std::string& text) {
  try {
    return parse_number(text);
  } catch (const BadValue& e) {
    throw UsageError(fmt::format("--{} {}: {}", option, text, e.what()));
  }
}

void show_activity(Progress& progress, const Activity& a) {
  if (a.stage != Activity::Stage::State) {
    const std::string what = a.stage == Activity::Stage::Joint ? "joint and thickness" : "springs and layers";
    progress.now(what, "", what);
    return;
  }
  std::string within, details;
  if (a.search.iterations > 0 && std::isfinite(a.search.residual)) {
    within = fmt::format("iteration {}, unbalanced {:.0e}", a.search.iterations, a.search.residual);
    details = fmt::format("  iteration {}, pose {}: unbalanced {:.1e} of the load before", a.search.iterations,
                          a.search.casts, a.search.residual);
  }
  progress.now(fmt::format("state {} of {}", a.index + 1, a.count), within, details, a.index, a.count);
}

std::string plot_name_note(const std::string& option, const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::error_code error;
  if (extension == ".feb")
    throw UsageError(
        fmt::format("{} {}: found the ending of a model file, which would be lost; expected .xplt", option, path));
  if (extension == ".xplt" || std::filesystem::is_character_file(path, error)) return "";  // /dev/null
  return fmt::format(
      "note: {} {}: PostView and FEBio Studio know plot files by the ending .xplt; written as it was asked", option,
      path);
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace dea
