#include "io/convert/convert_feb.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "io/convert/conversion_plan.h"
#include "io/convert/write_feb.h"
#include "io/convert/xml_places.h"
#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/joint/placing.h"
#include "src/joint/surface_names.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

namespace fs = std::filesystem;

std::string file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path + ": cannot be read: check its permissions");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The encoding its first line names.
std::string encoding_of(const std::string& text) {
  const std::size_t end = text.find("?>"), begin = text.find("encoding=");
  if (begin == text.npos || begin > end || begin + 10 >= end) return "ISO-8859-1";
  const std::size_t close = text.find(text[begin + 9], begin + 10);
  return close < end ? text.substr(begin + 10, close - begin - 10) : "ISO-8859-1";
}

bool same_folder(const std::string& a, const std::string& b) {
  const auto folder = [](const std::string& path) {
    std::error_code error;
    return fs::weakly_canonical(fs::absolute(path, error).parent_path(), error);
  };
  return folder(a) == folder(b);
}

/// The first that the model names. Each step may have one; a new file has one for all.
LinearSolver linear_solver_of(const JointModel& model) {
  for (const std::string& path : model.files) {
    const std::optional<XmlPlaces> places = find_places(file_text(path));
    if (!places) continue;
    for (const XmlPlace& e : places->elements)
      if (e.name == "linear_solver" && e.attribute("type") != nullptr)
        return {e.value("type"), places->text.substr(e.open_end, e.close_begin - e.open_end)};
  }
  return {};
}

/// A line for the list of what a new file has.
std::string choose_linear_solver(const JointModel& model, ConversionPlan& plan) {
  const std::string line = "solver and plot file: new";
  if (!plan.linear_solver.type.empty()) return fmt::format("{}, linear_solver {}", line, plan.linear_solver.type);
  plan.linear_solver = linear_solver_of(model);
  const std::string type = plan.linear_solver.type;
  if (type.empty()) return line;
  if (known_linear_solver(type)) return fmt::format("{}, linear_solver {} as in the model", line, type);
  plan.linear_solver = {};
  return fmt::format("{}; the model's linear_solver \"{}\" is left out, FEBio 4.11 has none of this name", line, type);
}

}  // namespace

Conversion convert_feb(const JointModel& given, const Settings& given_settings, const std::string& output,
                       const std::string& linear_solver) {
  Findings naming, placements;
  Settings settings = name_surfaces(given, given_settings, naming);
  const bool moved = !settings.placements.empty();
  JointModel placed;
  if (moved) {
    const Joint joint = make_joint(given, settings);
    placed = placed_model(given, joint, settings);
    placements = placement_findings(given, joint, settings);
    settings.placements.clear();
    settings.rotate_about.clear();
  }
  const JointModel& model = moved ? placed : given;
  ConversionPlan plan = plan_conversion(model, settings);
  plan.linear_solver.type = linear_solver;
  const auto sentences = [](const Findings& findings) {
    std::vector<Sentence> words;
    for (const Finding& f : findings) words.emplace_back(worded(f, command_line_wording()));
    return words;
  };
  const std::vector<Sentence> named = sentences(naming), moves = sentences(placements);
  plan.notes.insert(plan.notes.begin(), named.begin(), named.end());
  plan.changes.insert(plan.changes.begin(), moves.begin(), moves.end());
  const std::string text = file_text(model.files.front());
  Conversion result;
  std::string why;
  std::optional<std::string> edited;
  if (model.version != "4.0")
    why = fmt::format("it is of version {}", model.version);
  else if (moved)
    why = "bodies are placed, and their nodes moved";
  else if (plan.split)
    why = "an Elements section holds cartilage of several bodies, or other parts too, and is divided";
  else if (model.files.size() > 1 && !same_folder(model.files.front(), output))
    why = "it includes files from its own folder, and the output is for another";
  else
    edited = edit_feb(model, plan, text, why);

  result.edited = edited.has_value();
  result.notes = plan.notes;
  if (edited) {
    result.text = std::move(*edited);
    result.changes.push_back("the model's own text, with these changes:");
    result.changes.insert(result.changes.end(), plan.changes.begin(), plan.changes.end());
    if (model.files.size() > 1) result.notes.push_back("the new file includes the same files as the model");
  } else if (!plan.left_to_febio.empty()) {
    const Remark& first = plan.left_to_febio.front();
    throw fault_at(model, first.origin,
                   fmt::format("{} cannot be carried over: the file would have to be written anew, for {}; open it in "
                               "FEBio Studio and save it as one file of version 4.0",
                               first.what, why));
  } else {
    std::vector<std::string> dropped;
    const std::string solver = choose_linear_solver(model, plan);
    result.text = write_feb(model, plan, encoding_of(text), dropped);
    result.changes.push_back(fmt::format("written anew as version 4.0, for {}; with these changes:", why));
    result.changes.insert(result.changes.end(), plan.changes.begin(), plan.changes.end());
    result.changes.push_back(solver);
    for (const std::string& what : dropped) result.changes.push_back("left out, no part of the joint: " + what);
  }
  result.joint = std::move(plan.joint);
  return result;
}

}  // namespace dea
