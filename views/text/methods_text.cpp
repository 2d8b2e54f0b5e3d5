#include "views/text/methods_text.h"

#include "src/version.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <set>

#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/facts/symmetry_planes.h"
#include "src/model/settings_table.h"
#include "views/text/info_text.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

struct Paper {
  const char* short_form;
  const char* full;
  const char* bibtex;
};
constexpr Paper kAbraham = {
    "Abraham et al., 2013",
    "Abraham CL, Maas SA, Weiss JA, Ellis BJ, Peters CL, Anderson AE (2013). A new discrete element analysis method "
    "for "
    "predicting hip joint contact stresses. J Biomech 46(6):1121-1127. doi:10.1016/j.jbiomech.2013.01.012",
    R"(@article{Abraham2013,
  author  = {Abraham, Christine L. and Maas, Steve A. and Weiss, Jeffrey A. and Ellis, Benjamin J. and Peters, Christopher L. and Anderson, Andrew E.},
  title   = {A new discrete element analysis method for predicting hip joint contact stresses},
  journal = {Journal of Biomechanics},
  year    = {2013},
  volume  = {46},
  number  = {6},
  pages   = {1121--1127},
  doi     = {10.1016/j.jbiomech.2013.01.012}
}
)"};
constexpr Paper kBlankevoort = {
    "Blankevoort et al., 1991",
    "Blankevoort L, Kuiper JH, Huiskes R, Grootenboer HJ (1991). Articular contact in a three-dimensional model of the "
    "knee. J Biomech 24(11):1019-1031.",
    R"(@article{Blankevoort1991,
  author  = {Blankevoort, L. and Kuiper, J. H. and Huiskes, R. and Grootenboer, H. J.},
  title   = {Articular contact in a three-dimensional model of the knee},
  journal = {Journal of Biomechanics},
  year    = {1991},
  volume  = {24},
  number  = {11},
  pages   = {1019--1031}
}
)"};
constexpr Paper kFebio = {
    "Maas et al., 2012",
    "Maas SA, Ellis BJ, Ateshian GA, Weiss JA (2012). FEBio: finite elements for biomechanics. J Biomech Eng "
    "134(1):011005. doi:10.1115/1.4005694",
    R"(@article{Maas2012,
  author  = {Maas, Steve A. and Ellis, Benjamin J. and Ateshian, Gerard A. and Weiss, Jeffrey A.},
  title   = {{FEBio}: finite elements for biomechanics},
  journal = {Journal of Biomechanical Engineering},
  year    = {2012},
  volume  = {134},
  number  = {1},
  pages   = {011005},
  doi     = {10.1115/1.4005694}
}
)"};
constexpr Paper kJohnson = {
    "Johnson, 1985", "Johnson KL (1985). Contact Mechanics. Cambridge University Press. Section 5.8: thin layers.",
    R"(@book{Johnson1985,
  author    = {Johnson, K. L.},
  title     = {Contact Mechanics},
  publisher = {Cambridge University Press},
  year      = {1985},
  note      = {Section 5.8: thin layers}
}
)"};
constexpr Paper kGuyan = {
    "Guyan, 1965", "Guyan RJ (1965). Reduction of stiffness and mass matrices. AIAA J 3(2):380. doi:10.2514/3.2874",
    R"(@article{Guyan1965,
  author  = {Guyan, Robert J.},
  title   = {Reduction of stiffness and mass matrices},
  journal = {AIAA Journal},
  year    = {1965},
  volume  = {3},
  number  = {2},
  pages   = {380},
  doi     = {10.2514/3.2874}
}
)"};
constexpr Paper kHughes = {
    "Hughes, 1980",
    "Hughes TJR (1980). Generalization of selective integration procedures to anisotropic and nonlinear media. Int J "
    "Numer Methods Eng 15(9):1413-1418. doi:10.1002/nme.1620150914",
    R"(@article{Hughes1980,
  author  = {Hughes, T. J. R.},
  title   = {Generalization of selective integration procedures to anisotropic and nonlinear media},
  journal = {International Journal for Numerical Methods in Engineering},
  year    = {1980},
  volume  = {15},
  number  = {9},
  pages   = {1413--1418},
  doi     = {10.1002/nme.1620150914}
}
)"};
constexpr Paper kBonet = {
    "Bonet and Burton, 1998",
    "Bonet J, Burton AJ (1998). A simple average nodal pressure tetrahedral element for incompressible and nearly "
    "incompressible dynamic explicit applications. Commun Numer Methods Eng 14(5):437-449.",
    R"(@article{Bonet1998,
  author  = {Bonet, J. and Burton, A. J.},
  title   = {A simple average nodal pressure tetrahedral element for incompressible and nearly incompressible dynamic explicit applications},
  journal = {Communications in Numerical Methods in Engineering},
  year    = {1998},
  volume  = {14},
  number  = {5},
  pages   = {437--449}
}
)"};
constexpr const char* kProgramBibtex = R"(@software{{FEBioDEA,
  author  = {{{{FEBioDEA developers}}}},
  title   = {{{{FEBioDEA}}: discrete element analysis of joint contact for {{FEBio}} models}},
  year    = {{2026}},
  version = {{{}}}
}}
)";

/// The paragraph as it grows, and the papers named in it.
struct Methods {
  std::vector<std::string> sentences;
  std::vector<const Paper*> papers;
  void say(std::string sentence) { sentences.push_back(std::move(sentence)); }
  std::string cite(const Paper& paper) {
    if (std::find(papers.begin(), papers.end(), &paper) == papers.end()) papers.push_back(&paper);
    return paper.short_form;
  }
};

/// "a", "a and b", "a, b and c".
std::string counted(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string value_text(std::monostate) { return ""; }
std::string value_text(const std::vector<std::string>& all) { return fmt::format("{}", fmt::join(all, "; ")); }
std::string value_text(const Eigen::Vector3d& v) { return fmt::format("{},{},{}", v.x(), v.y(), v.z()); }
template <class Value>
std::string value_text(const Value& value) {
  return fmt::format("{}", value);
}

std::string item_text(const SettingItem& item) {
  return std::visit([](const auto& value) { return value_text(value); }, item);
}

/// Every setting that is not as it is by itself: "law linear", "E socket=8".
std::vector<std::string> settings_given(const Settings& settings) {
  const Settings nothing;
  std::vector<std::string> given;
  for (const SettingOption& option : setting_options()) {
    const SettingContent content = option.content(settings);
    if (content == option.content(nothing)) continue;
    if (const auto* item = std::get_if<SettingItem>(&content)) {
      given.push_back(fmt::format("{} {}", option.name, item_text(*item)));
      continue;
    }
    for (const auto& [key, item] : std::get<std::map<std::string, SettingItem>>(content))
      given.push_back(fmt::format("{} {}{}", option.name, key.empty() ? "" : key + "=", item_text(item)));
  }
  return given;
}

/// Contacts as `dea convert` writes them, with law, springs and cartilage stated in the model.
bool stated(const JointModel& model, const ContactPair& pair) {
  return model.contacts[at(pair.contact)].dea.has_value();
}

bool any_stated(const JointModel& model, const Joint& joint) {
  return std::any_of(joint.contacts.begin(), joint.contacts.end(),
                     [&](const ContactPair& pair) { return stated(model, pair); });
}

void say_stated(Methods& m, const JointModel& model, const Joint& joint) {
  std::vector<std::string> names;
  for (const ContactPair& pair : joint.contacts)
    if (stated(model, pair)) names.push_back(in_quotes(pair.name));
  if (!names.empty())
    m.say(fmt::format(
        "Contact {} {} of type dea, as dea convert writes {}: law, springs, thickness, E and nu are stated in "
        "the model.",
        and_list(names), names.size() == 1 ? "was" : "were", names.size() == 1 ? "it" : "them"));
}

void say_model(Methods& m, const JointModel& model) {
  std::size_t elements = 0;
  for (const Domain& d : model.domains) elements += d.element_ids.size();
  const std::string file =
      model.files.empty() ? "" : " " + std::filesystem::path(model.files.front()).filename().string();
  m.say(fmt::format("Contact pressure was computed by discrete element analysis ({}) with FEBioDEA {} (commit {}).",
                    m.cite(kAbraham), kVersion, kCommit));
  m.say(fmt::format("The joint was that of the FEBio model{} ({}; format {}, {} nodes, {} elements).", file,
                    m.cite(kFebio), model.version, model.nodes.size(), elements));
}

void say_bodies(Methods& m, const Joint& joint) {
  std::vector<std::string> rigid, moved;
  for (int b : reported_bodies(joint)) {
    const Body& body = joint.bodies[at(b)];
    const bool of_part = std::any_of(joint.parts.begin(), joint.parts.end(),
                                     [&](const SoftPart& part) { return part.free() && part.body == b; });
    if (body.ground || of_part) continue;
    (body.moved_by.empty() ? rigid : moved).push_back(in_quotes(body.name));
  }
  if (!rigid.empty()) m.say(fmt::format("{} {} rigid.", and_list(rigid), rigid.size() == 1 ? "was" : "were"));
  if (!moved.empty())
    m.say(fmt::format("{} stood for bone that the model leaves out: nodes moved together, taken as rigid.",
                      and_list(moved)));
}

std::string thickness_words(const Layer& layer) {
  std::string text = !layer.thickness_from.empty() ? "given at its nodes"
                     : layer.thickness_given       ? "given"
                                             : "measured in the mesh as the distance to the bone along the normals";
  if (layer.missed_count() > 0 && !layer.thickness_given && layer.thickness_from.empty())
    text += fmt::format(" (at {} of {} vertices: to the nearest point of the bone)", layer.missed_count(),
                        layer.missed.size());
  if (layer.thickness_scale != 1.0) text += fmt::format(", times {}", number_text(layer.thickness_scale));
  return text;
}

void say_layers(Methods& m, const JointModel& model, const Settings& settings, const Joint& joint) {
  std::set<int> said;  // a surface may be in several contacts
  bool cartilage = false;
  for (const ContactPair& pair : joint.contacts) {
    for (const Layer& layer : pair.layers) {
      if (layer.part >= 0 || !said.insert(layer.surface).second) continue;
      const std::string surface = in_quotes(model.surfaces[at(layer.surface)].name);
      const std::string body = in_quotes(joint.bodies[at(layer.body)].name);
      if (layer.rigid) {
        m.say(fmt::format("Surface {} of {} was rigid, without cartilage.", surface, body));
        continue;
      }
      cartilage = true;
      m.say(fmt::format("Cartilage under {} on {} was {}{} thick (mean; {} to {}), {}; E = {}{}, nu = {}.", surface,
                        body, four_digits(layer.mean_thickness()), unit_behind(model, Dimension::Length),
                        four_digits(layer.min_thickness()), four_digits(layer.max_thickness()), thickness_words(layer),
                        four_digits(layer.elasticity.E), unit_behind(model, Dimension::Pressure),
                        four_digits(layer.elasticity.nu)));
    }
  }
  if (!cartilage) return;
  const char* own = any_stated(model, joint)
                        ? "those stated in the contact, or the small-strain constants of the model's materials"
                        : "the small-strain constants of the model's materials";
  m.say(settings.E.empty() && settings.nu.empty() ? fmt::format("E and nu were {}.", own)
                                                  : fmt::format("E and nu were those given, else {}.", own));
}

/// How elements are kept from locking.
std::string dilatation_words(Methods& m, const PartMesh& mesh) {
  const auto any = [&](std::initializer_list<ElementShape> shapes) {
    return std::find_first_of(mesh.shape.begin(), mesh.shape.end(), shapes.begin(), shapes.end()) != mesh.shape.end();
  };
  std::vector<std::string> words;
  if (any({ElementShape::Hex8, ElementShape::Penta6, ElementShape::Pyra5}))
    words.push_back(fmt::format("the mean dilatation of each element ({})", m.cite(kHughes)));
  if (any({ElementShape::Tet4}))
    words.push_back(fmt::format("the mean dilatation around each node ({})", m.cite(kBonet)));
  return words.empty() ? "" : fmt::format(", with {}", and_list(words));
}

void say_parts(Methods& m, const JointModel& model, const Settings& settings, const Joint& joint) {
  for (const SoftPart& part : joint.parts) {
    const auto held = std::count_if(part.holder.begin(), part.holder.end(), [](int body) { return body >= 0; });
    const bool fibres = std::any_of(part.mesh.fibre.begin(), part.mesh.fibre.end(),
                                    [](const Vector3d& along) { return !along.isZero(0); });
    m.say(fmt::format(
        "Part {} gave way as a mesh of {} elements and {} nodes, linear-elastic at small strain{}, reduced to the "
        "surfaces that are pressed by static condensation ({}); {}.",
        in_quotes(part.name), part.mesh.elements(), part.mesh.size(), dilatation_words(m, part.mesh), m.cite(kGuyan),
        held > 0 ? fmt::format("{} of its nodes moved with {}", held, in_quotes(joint.bodies[at(part.body)].name))
                 : "contacts and springs alone held it"));
    const Material& material =
        *std::find_if(model.materials.begin(), model.materials.end(),
                      [&](const Material& candidate) { return candidate.name == part.material; });
    m.say(fmt::format("Its material was {} ({}), with {} small-strain constants{}.", in_quotes(material.name),
                      material.type, settings.E.empty() && settings.nu.empty() ? "its" : "E and nu as given, else its",
                      fibres ? fmt::format("; its fibres were linear, with their modulus at a strain of {}%",
                                           number_text(100 * settings.fibre_strain.value_or(0.0)))
                             : ""));
  }
}

std::string law_words(Methods& m, const ContactPair& pair) {
  switch (pair.law) {
    case Law::Layer:
      return fmt::format(
          "The springs were coupled: each layer was taken as an elastic layer bonded to rigid bone, whose squeezed "
          "cartilage "
          "flows sideways (law layer of FEBioDEA with {}; compare {}), neo-Hookean at large strain",
          pair.layer_fit == LayerFit::OneTerm ? "one term" : "two terms", m.cite(kJohnson));
    case Law::Linear:
      return fmt::format(
          "Each spring acted for itself, its pressure being M e with strain e and confined modulus M = "
          "E(1-nu)/((1+nu)(1-2nu)) "
          "({})",
          m.cite(kAbraham));
    case Law::Logarithmic:
      return fmt::format(
          "Each spring acted for itself, its pressure being -M ln(1-e) with strain e and confined modulus M = "
          "E(1-nu)/((1+nu)(1-2nu)) ({})",
          m.cite(kBlankevoort));
    case Law::NeoHookean:
      return "Each spring acted for itself, as a compressible neo-Hookean column that cannot widen";
  }
  return "";
}

void say_planes(Methods& m, const Joint& joint) {
  if (joint.symmetry_planes.empty()) return;
  m.say(fmt::format(
      "The model was cut at planes of symmetry, or walls without friction ({}): its surfaces were "
      "continued behind them as their mirror images, and forces and areas are those of the part that was meshed.",
      in_words(joint.symmetry_planes)));
}

void say_contacts(Methods& m, const JointModel& model, const Settings& settings, const JointCheck& check) {
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    const ContactPair& pair = check.joint.contacts[c];
    const Layer &source = pair.source_layer(), &target = pair.target_layer();
    m.say(fmt::format(
        "In contact {}{} {} springs stood on the {} surface of {} ({}) against {} ({}){}.", in_quotes(pair.name),
        pair.step >= 0 ? fmt::format(", active in step {} only,", pair.step + 1) : "", check.contacts[c].springs,
        settings.springs_at == SpringsAt::Bone ? "bone" : "articular",
        in_quotes(model.surfaces[at(source.surface)].name), in_quotes(check.joint.bodies[at(source.body)].name),
        in_quotes(model.surfaces[at(target.surface)].name), in_quotes(check.joint.bodies[at(target.body)].name),
        pair.refine > 1 ? fmt::format(", each triangle divided into {0} x {0}", pair.refine) : ""));
  }
  for (const SharedLayer& layer : check.joint.shared_layers) {
    std::vector<std::string> names;
    for (const LayerUse& use : layer.uses) names.push_back(in_quotes(check.joint.contacts[at(use.contact)].name));
    if (check.joint.contacts[at(layer.uses.front().contact)].law == Law::Layer)
      m.say(fmt::format("Contacts {} pressed one layer of cartilage and were solved together.", and_list(names)));
  }
  // what contacts share is said once
  std::vector<std::string> laws;
  for (const ContactPair& pair : check.joint.contacts) {
    std::string text = law_words(m, pair);
    if (pair.law != Law::Layer && !pair.layers[0].rigid && !pair.layers[1].rigid)
      text += "; the two layers were in series";
    if (pair.interface_compliance > 0)
      text += fmt::format("; a stiffness per area of {} between the surfaces was in series with the cartilage",
                          number_text(1.0 / pair.interface_compliance));
    text += pair.facets == Facets::Flat ? "; gaps were measured between the facets as they are."
                                        : "; gaps were measured between the smooth surfaces that the facets stand for.";
    if (std::find(laws.begin(), laws.end(), text) == laws.end()) laws.push_back(text);
  }
  for (const std::string& law : laws) m.say(law);
  m.say("Contact was frictionless.");
  if (settings.inside) m.say("Stress and strain inside the cartilage followed from the same solution of law layer.");
}

/// How the states are reached that a table's rows are, or the model's last one.
std::string states_words(const Settings& settings, const JointCheck& check) {
  const std::string states = counted(check.times.size(), "state", "states");
  const char* skipped = settings.skip_steps ? ", without walking through the model's steps" : "";
  if (check.row)
    return fmt::format("{}, one for each row of the table{}", states,
                       settings.skip_steps ? skipped : ", after the ends of the model's steps");
  const std::string first = time_text(check.times.front().time), last = time_text(check.times.back().time);
  return fmt::format("{} (time {}{}){}", states, first, check.times.size() == 1 ? "" : " to " + last, skipped);
}

void say_loads(Methods& m, const JointModel& model, const Settings& settings, const JointCheck& check) {
  const Joint& joint = check.joint;
  std::vector<std::string> parts;
  if (!joint.ligaments.empty())
    parts.push_back(counted(joint.ligaments.size(), "spring or ligament", "springs or ligaments"));
  if (!joint.cables.empty()) parts.push_back(counted(joint.cables.size(), "cable", "cables"));
  if (!joint.connectors.empty()) parts.push_back(counted(joint.connectors.size(), "ideal joint", "ideal joints"));
  if (!parts.empty()) m.say(fmt::format("{} joined bodies.", and_list(parts)));
  for (const auto* words : {&settings.loads.words, &settings.motion.words})
    if (!words->empty()) m.say(fmt::format("Table: {}.", one_line(*words)));
  for (int b : reported_bodies(joint)) {
    if (joint.bodies[at(b)].ground) continue;
    m.say(fmt::format("{}, {}: {}.", check.row ? "In every row of the table" : "At the end of the last step",
                      in_quotes(joint.bodies[at(b)].name),
                      check.row ? row_conditions_text(model, settings, check, b, true)
                                : conditions_text(check.steps.back().load_case.bodies[at(b)], true)));
  }
  if (!check.times.empty())
    m.say(fmt::format("Static equilibrium of all free motions was sought in {}.", states_words(settings, check)));
}

}  // namespace

std::string methods_text(const JointModel& model, const Settings& settings, const JointCheck& check,
                         const std::string& febio, bool bibtex) {
  Methods m;
  say_model(m, model);
  say_stated(m, model, check.joint);
  say_bodies(m, check.joint);
  say_layers(m, model, settings, check.joint);
  say_parts(m, model, settings, check.joint);
  say_planes(m, check.joint);
  say_contacts(m, model, settings, check);
  say_loads(m, model, settings, check);
  m.say(
      "Pressures and areas are of what is above 5 % of the load's mean pressure: area and mean within the edge of "
      "contact, which runs through facets (linear pressure within a facet that keeps the facet's force), 99th "
      "percentile and peak of nodes, averages of the facets around each, weighted by area.");
  if (!febio.empty())
    m.say(fmt::format("Results were compared with those of {} ({}), by the same definitions for both.", febio,
                      m.cite(kFebio)));
  if (bibtex) {
    std::string entries = fmt::format(kProgramBibtex, kVersion);
    for (const Paper* paper : m.papers) entries += std::string("\n") + paper->bibtex;
    return entries;
  }
  const std::vector<std::string> given = settings_given(settings);
  const char* others = any_stated(model, check.joint)
                           ? "stated in the model, inferred from it or left at their defaults"
                           : "inferred from the model or left at their defaults";
  m.say(given.empty() ? fmt::format("All settings were {}.", others)
                      : fmt::format("Settings given: {}; all others were {}.", and_list(given), others));
  std::string text = fmt::format("{}\n\n{}\n\nReferences\n\n", fmt::join(m.sentences, " "), units_text(model));
  for (const Paper* paper : m.papers) text += fmt::format("* {}\n", paper->full);
  return text + fmt::format(
                    "* FEBioDEA developers (2026). FEBioDEA {}: discrete element analysis of joint contact for FEBio "
                    "models.\n",
                    kVersion);
}

}  // namespace dea
