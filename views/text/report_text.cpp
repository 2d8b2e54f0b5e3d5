#include <febiodea/views/text/report_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>

namespace dea {

namespace {

/// Characters on the screen: bytes that do not continue a UTF-8 character.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string four_digits(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "-"; }
std::string residual_number(double x) { return std::isfinite(x) ? fmt::format("{:.1e}", x) : "-"; }
std::string share_in_percent(double x) { return std::isfinite(x) ? fmt::format("{:.2f}%", 100.0 * x) : "-"; }

/// For people: what is nothing but rounding beside `scale` is 0.
Vector3d without_rounding(const Vector3d& v, double scale) {
  Vector3d shown = v;
  for (int k = 0; k < 3; ++k)
    if (std::abs(shown[k]) < 1e-12 * scale) shown[k] = 0.0;
  return shown;
}

void add_once(std::vector<std::string>& lines, const std::string& line) {
  if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
}

/// Neighbouring states about which the same is to be said; what they differ in is told of the last one.
struct StateRun {
  std::string what, detail;
  std::size_t first = 0, last = 0;  ///< indices of states
};

void add_state(std::vector<StateRun>& runs, const std::string& what, std::size_t index, const std::string& detail) {
  if (!runs.empty() && runs.back().what == what && runs.back().last + 1 == index) {
    runs.back().last = index;
    runs.back().detail = detail;
  } else {
    runs.push_back({what, detail, index, index});
  }
}

std::string run_line(const Analysis& analysis, const StateRun& run) {
  const auto time = [&](std::size_t i) { return number_text(analysis.states[i].when.time); };
  if (run.first == run.last) return fmt::format("warning: time {}: {}: {}", time(run.last), run.what, run.detail);
  return fmt::format("warning: times {} to {} ({} states): {}; at time {}: {}", time(run.first), time(run.last),
                     run.last - run.first + 1, run.what, time(run.last), run.detail);
}

/// Who prescribes a rotation wants bodies to turn, those that follow too: the sum of all that is prescribed [degrees].
double prescribed_turn(const JointModel& model, const Joint& joint, const Equilibrium& last) {
  constexpr double kDegrees = 57.295779513082323;
  double sum = 0.0;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const bool prescribed =
        std::any_of(model.rigid_prescribed.begin(), model.rigid_prescribed.end(), [&](const RigidPrescribed& p) {
          const auto& own = joint.bodies[b].materials;
          return p.dof >= 3 && std::find(own.begin(), own.end(), p.material) != own.end();
        });
    if (prescribed) sum += Eigen::AngleAxisd(last.poses[b].rotation).angle() * kDegrees;
  }
  for (std::size_t c = 0; c < joint.connectors.size() && c < last.connector_motion.size(); ++c)
    for (int k = 3; k < kDofs; ++k)
      if (joint.connectors[c].motion[at(k)] == RigidJoint::Motion::Prescribed)
        sum += std::abs(last.connector_motion[c][k]) * kDegrees;
  return sum;
}

}  // namespace

std::string number_text(double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x == 0.0 ? 0.0 : x) : "-"; }

std::string vector_text(const Vector3d& v) {
  return fmt::format("({}, {}, {})", number_text(v[0]), number_text(v[1]), number_text(v[2]));
}

std::string units_text(const JointModel& model) {
  return model.units.empty() ? "units: the model's own (it names none); rotations in radians"
                             : fmt::format("units: the model's, {}; rotations in radians", model.units);
}

std::string table_text(const Table& table) {
  std::vector<std::size_t> widths;
  for (const std::string& h : table.headings) widths.push_back(width(h));
  for (const auto& row : table.rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width(row[c]));
  std::string text;
  const auto add_row = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - width(row[c]), ' ');
      if (c > 0) line += "  ";
      line += table.left[c] == 'l' ? row[c] + space : space + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  add_row(table.headings);
  for (const auto& row : table.rows) add_row(row);
  return text;
}

std::string tables_text(const std::vector<TitledTable>& tables) {
  std::string text;
  for (const TitledTable& t : tables) {
    text += "\n";
    if (!t.title.empty()) text += t.title + "\n";
    if (!t.table.headings.empty()) text += table_text(t.table);
  }
  return text;
}

std::vector<std::string> spring_names(const Joint& joint) {
  std::vector<std::string> names;
  std::map<std::string, int> times;
  const auto add = [&](const std::string& own) {
    const std::string name = own.empty() ? "(unnamed)" : own;
    const int number = ++times[name];
    names.push_back(number > 1 ? fmt::format("{} ({})", name, number) : name);
  };
  for (const Ligament& l : joint.ligaments) add(l.name);
  for (const Cable& c : joint.cables) add(c.name);
  return names;
}

std::vector<int> reported_bodies(const Joint& joint) {
  std::vector<int> bodies;
  for (int b = 0; b < static_cast<int>(joint.bodies.size()); ++b) {
    bool used = !joint.bodies[at(b)].ground;
    for (const ContactPair& pair : joint.contacts) used = used || pair.layers[0].body == b || pair.layers[1].body == b;
    for (const Ligament& l : joint.ligaments) used = used || l.body_a == b || l.body_b == b;
    for (const Connector& c : joint.connectors) used = used || c.body_a == b || c.body_b == b;
    for (const Cable& c : joint.cables)
      for (const Cable::Point& p : c.points) used = used || p.body == b;
    if (used) bodies.push_back(b);
  }
  return bodies;
}

std::string law_text(const ContactPair& pair) {
  return fmt::format("law {}{}, springs at the {}", name(pair.law),
                     pair.law == Law::Layer && pair.layer_fit == LayerFit::OneTerm ? " of one term" : "",
                     pair.source_layer().springs_at == SpringsAt::Bone ? "bone" : "articular surface");
}

/// One line if all contacts are alike, else one each.
std::string laws_text(const Joint& joint) {
  std::set<std::string> different;
  for (const ContactPair& pair : joint.contacts) different.insert(law_text(pair));
  if (different.size() == 1) return *different.begin() + "\n";
  std::string text;
  for (const ContactPair& pair : joint.contacts) text += fmt::format("{}: {}\n", pair.name, law_text(pair));
  return text;
}

std::vector<TitledTable> run_tables(const JointModel&, const Analysis& analysis) {
  const Joint& joint = analysis.joint;
  std::vector<TitledTable> tables;
  Table contacts;
  contacts.headings = {"time", "contact", "outcome", "springs", "of",         "peak",    "p99",
                       "mean", "median",  "area",    "force",   "iterations", "residual"};
  contacts.left = "rllrrrrrrrrrr";
  for (const StateResult& state : analysis.states) {
    for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
      const ContactStatistics& s = state.statistics[c];
      contacts.rows.push_back(
          {number_text(state.when.time), joint.contacts[c].name, name(state.equilibrium.outcome),
           fmt::format("{}", s.springs_active), fmt::format("{}", s.springs), four_digits(s.peak), four_digits(s.p99),
           four_digits(s.mean), four_digits(s.median), four_digits(s.contact_area), four_digits(s.force.norm()),
           fmt::format("{}", state.equilibrium.iterations), residual_number(state.equilibrium.residual_force)});
    }
  }
  tables.push_back({"", std::move(contacts)});
  if (analysis.states.empty()) return tables;

  const StateResult& last = analysis.states.back();
  Table bodies;
  bodies.headings = {"body", "translation", "rotation", "force", "moment"};
  bodies.left = "lllll";
  double farthest = 0.0, strongest = 0.0, turning = 0.0;
  for (int b : reported_bodies(joint)) {
    farthest = std::max(farthest, (last.equilibrium.poses[at(b)].center - joint.bodies[at(b)].center_of_mass).norm());
    strongest = std::max(strongest, last.equilibrium.reaction[at(b)].head<3>().norm());
    turning = std::max(turning, last.equilibrium.reaction[at(b)].tail<3>().norm());
  }
  for (int b : reported_bodies(joint)) {
    const Pose& pose = last.equilibrium.poses[at(b)];
    const Eigen::AngleAxisd turn(pose.rotation);
    const Vector6& reaction = last.equilibrium.reaction[at(b)];
    bodies.rows.push_back({joint.bodies[at(b)].name,
                           vector_text(without_rounding(pose.center - joint.bodies[at(b)].center_of_mass, farthest)),
                           vector_text(without_rounding(turn.angle() * turn.axis(), 1.0)),
                           vector_text(without_rounding(reaction.head<3>(), strongest)),
                           vector_text(without_rounding(reaction.tail<3>(), std::max(strongest, turning)))});
  }
  tables.push_back(
      {fmt::format("bodies at time {}: motion of the centre of mass, rotation vector, force and moment on the body by "
                   "what loads and holds it",
                   number_text(last.when.time)),
       std::move(bodies)});
  if (!joint.ligaments.empty() || !joint.cables.empty()) {
    Table ligaments;
    ligaments.headings = {joint.cables.empty() ? "spring between bodies" : "spring or cable between bodies", "tension"};
    ligaments.left = "lr";
    const std::vector<std::string> names = spring_names(joint);
    for (std::size_t l = 0; l < joint.ligaments.size() && l < last.equilibrium.ligament_force.size(); ++l)
      ligaments.rows.push_back({names[l], number_text(last.equilibrium.ligament_force[l])});
    for (std::size_t c = 0; c < joint.cables.size() && c < last.equilibrium.cable_force.size(); ++c)
      ligaments.rows.push_back({names[joint.ligaments.size() + c], number_text(last.equilibrium.cable_force[c])});
    tables.push_back({"", std::move(ligaments)});
  }
  if (!last.equilibrium.connector_force.empty()) {
    Table joints;
    joints.headings = {"joint", "bodies", "force", "moment", "translation", "rotation"};
    joints.left = "llllll";
    double largest = 0.0, reach = 0.0;
    for (const Vector6& f : last.equilibrium.connector_force)
      if (f.allFinite()) largest = std::max({largest, f.head<3>().norm(), f.tail<3>().norm()});
    for (const Pose& pose : last.equilibrium.poses) reach = std::max(reach, pose.center.norm());
    for (std::size_t c = 0; c < joint.connectors.size() && c < last.equilibrium.connector_force.size(); ++c) {
      const Connector& connector = joint.connectors[c];
      const Vector6 &force = last.equilibrium.connector_force[c], &motion = last.equilibrium.connector_motion[c];
      const auto cell = [&](const Vector3d& v) {
        return v.allFinite() ? vector_text(without_rounding(v, largest)) : std::string("-");
      };
      joints.rows.push_back({connector.name.empty() ? "(unnamed)" : connector.name,
                             joint.bodies[at(connector.body_a)].name + " - " + joint.bodies[at(connector.body_b)].name,
                             cell(force.head<3>()), cell(force.tail<3>()),
                             vector_text(without_rounding(motion.head<3>(), std::max(reach, 1.0))),
                             vector_text(without_rounding(motion.tail<3>(), 1.0))});
    }
    tables.push_back(
        {"joints: force and moment on the second body at the joint, motion along and about the joint's axes",
         std::move(joints)});
  }
  return tables;
}

std::string run_text(const JointModel& model, const Analysis& analysis) {
  return units_text(model) + "\n" + laws_text(analysis.joint) + tables_text(run_tables(model, analysis));
}

namespace {

/// Law layer follows what flows within the size of the facets. Measured on a sphere (docs/layer_law.md, section 6):
/// facets of half the thickness or less are within 2 % where contact is 8 of them wide, facets as long as the cartilage
/// is thick 7 % and 17 % off in force and peak. Empty: they are fine.
std::string coarse_facets(const JointModel& model, const ContactPair& pair, const Wording& wording) {
  constexpr double kFine = 0.3, kCoarse = 1.05;  // thicknesses
  if (pair.law != Law::Layer) return "";
  double worst = 0.0;
  std::string sizes;
  for (const Layer& layer : pair.layers) {
    const double size = layer.facet_size() / pair.refine;
    if (!(size > kFine)) continue;
    worst = std::max(worst, size);
    sizes += fmt::format("{}{:.2g} on \"{}\"", sizes.empty() ? "" : ", ", size, model.surfaces[at(layer.surface)].name);
  }
  if (worst == 0) return "";
  const int refine = pair.refine * static_cast<int>(std::ceil(worst / 0.5));
  const std::string text =
      fmt::format("contact \"{}\": facets are long against the cartilage's thickness ({})", pair.name, sizes);
  if (worst > kCoarse)
    return fmt::format("warning: {}: force and peak may be 20% off; type {} ({} times the springs)", text,
                       wording({"refine", "", std::to_string(refine)}), refine * refine / (pair.refine * pair.refine));
  return fmt::format(
      "note: {}: right to about 3% where contact is 8 facets wide, less where it is narrower; "
      "dea converge or {} tell",
      text, wording({"refine", "", std::to_string(2 * pair.refine)}));
}

}  // namespace

namespace {

/// Vertices whose thickness is the closest point's for want of a better one. On a plane of symmetry the closest point
/// is the better one: of a curved surface the normal is known from one side only there.
int doubtful_vertices(const Layer& layer) {
  const bool planes = layer.springs_at == SpringsAt::Articular && layer.mirror.size() == layer.missed.size();
  int count = 0;
  for (std::size_t v = 0; v < layer.missed.size(); ++v) count += layer.missed[v] && !(planes && layer.mirror[v]);
  return count;
}

}  // namespace

std::vector<std::string> model_remarks(const JointModel& model, const Joint& joint, const Wording& wording) {
  std::vector<std::string> lines;
  for (const Remark& r : model.ignored)
    add_once(lines, fmt::format("ignored: {}{}{}", where(model, r.origin), r.what,
                                r.count > 1 ? fmt::format(" ({} times)", r.count) : ""));
  for (const ContactPair& pair : joint.contacts) {
    const Contact& contact = model.contacts[at(pair.contact)];
    for (const std::string& what : contact.ignored)
      add_once(lines, fmt::format("ignored: {}contact \"{}\": {}", where(model, contact.origin), contact.name, what));
  }
  for (const Sentence& finding : joint.findings) add_once(lines, "note: " + worded(finding, wording));
  for (const ContactPair& pair : joint.contacts) {
    const std::string coarse = coarse_facets(model, pair, wording);
    if (!coarse.empty()) add_once(lines, coarse);
  }
  for (const ContactPair& pair : joint.contacts) {
    for (const Layer& layer : pair.layers) {
      const int doubtful = doubtful_vertices(layer);
      if (doubtful == 0) continue;
      add_once(lines, fmt::format("warning: surface \"{}\": at {} of {} vertices the thickness is the distance to the "
                                  "nearest point of the bone, "
                                  "for their normals meet no bone (usual at rims; `dea info -o` shows where)",
                                  model.surfaces[at(layer.surface)].name, doubtful, layer.missed.size()));
    }
  }
  return lines;
}

std::string outcome_text(const Equilibrium& e, const Wording& wording) {
  return e.message + (e.advice.empty() ? "" : " " + worded(e.advice, wording));
}

std::vector<std::string> result_remarks(const JointModel& model, const Analysis& analysis, const Wording& wording) {
  const Joint& joint = analysis.joint;
  std::vector<std::string> lines;
  std::vector<StateRun> runs;
  int states_held = 0;  // the axes turn a little from state to state: those of the last one stand for all
  const StateResult* last_held = nullptr;
  for (const StateResult& state : analysis.states) {
    const Equilibrium& e = state.equilibrium;
    if (!e.held.empty()) {
      ++states_held;
      last_held = &state;
    }
    const std::size_t index = static_cast<std::size_t>(&state - analysis.states.data());
    if (!solved(e.outcome)) add_state(runs, fmt::format("{}", name(e.outcome)), index, outcome_text(e, wording));
    if (solved(e.outcome) && e.least_stiffness < 0)
      add_state(runs, "the balance is unstable", index, fmt::format("least stiffness {:.3g}", e.least_stiffness));
  }
  for (const StateRun& run : runs) lines.push_back(run_line(analysis, run));
  if (analysis.states.empty()) return lines;
  if (last_held) {
    std::string directions;
    for (const std::string& held : last_held->equilibrium.held) directions += (directions.empty() ? "" : ", ") + held;
    add_once(lines,
             fmt::format("note: in {} of {} states motions were held that nothing resists or loads; at time {}: {}",
                         states_held, analysis.states.size(), number_text(last_held->when.time), directions));
  }
  // The last state stands for all: the factor changes slowly.
  const StateResult& last = analysis.states.back();
  const double wanted = prescribed_turn(model, joint, last.equilibrium);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const Eigen::AngleAxisd turn(last.equilibrium.poses[b].rotation);
    const double degrees = turn.angle() * 57.295779513082323;
    if (solved(last.equilibrium.outcome) && last.equilibrium.outcome != Outcome::Prescribed && degrees > 20.0 + wanted)
      add_once(
          lines,
          fmt::format(
              "warning: \"{}\" has turned by {:.0f} degrees about ({:.2f}, {:.2f}, {:.2f}): its rotations are hardly "
              "resisted; to hold them type {}",
              joint.bodies[b].name, degrees, turn.axis().x(), turn.axis().y(), turn.axis().z(),
              wording({"free", joint.bodies[b].name, "x,y,z"})));
  }
  int touching = 0;
  for (const ContactStatistics& s : last.statistics) touching += s.springs_active;
  if (touching == 0 && last.equilibrium.outcome == Outcome::Balanced && last.equilibrium.load == 0.0)
    add_once(
        lines,
        fmt::format(
            "warning: at time {} nothing loads a free body and nothing touches: there is no contact to look at; "
            "give a load with {}",
            number_text(last.when.time), wording({.setting = "force", .of = "BODY", .value = "x,y,z", .bare = true})));
  const bool ever = std::any_of(analysis.states.begin(), analysis.states.end(), [](const StateResult& state) {
    return std::any_of(state.statistics.begin(), state.statistics.end(),
                       [](const ContactStatistics& s) { return s.springs_active > 0; });
  });
  if (!ever && last.equilibrium.outcome == Outcome::Prescribed)
    add_once(lines,
             "warning: the surfaces touch in no state: the motions that are prescribed bring them nowhere together");
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const int active = last.statistics[c].springs_active;
    if (active < 20 && last.fields[c].sides[1 - joint.contacts[c].source].contact_area > 0)
      add_once(lines, fmt::format("warning: contact \"{}\": only {} springs carry at time {}, too few for a pressure "
                                  "map; divide them with {}, or let the other "
                                  "body's finer surface carry them with {}",
                                  joint.contacts[c].name, active, number_text(last.when.time), wording({"refine"}),
                                  wording({"source"})));
    else if (active < 60 && active > 0 && joint.contacts[c].law == Law::Layer)
      add_once(lines, fmt::format(
                          "warning: contact \"{}\": at time {} only {} springs carry, too few to follow how the layers "
                          "flow: force and peak may be 10% too high; divide them with "
                          "{}",
                          joint.contacts[c].name, number_text(last.when.time), active,
                          wording({"refine", "", std::to_string(2 * joint.contacts[c].refine)})));
    for (const Layer& layer : joint.contacts[c].layers) {
      const double factor = last.fields[c].sides[&layer - joint.contacts[c].layers].resultant_factor;
      if (!(std::abs(factor - 1.0) > 0.02)) continue;
      add_once(
          lines,
          fmt::format("note: surface \"{}\": its pressure map is interpolated and carries {:.1f}% of the contact force",
                      model.surfaces[at(layer.surface)].name, 100.0 * factor));
    }
  }
  return lines;
}

std::string converge_text(const JointModel& model, const std::vector<Convergence>& studies, int max_springs) {
  std::string text = units_text(model) + "\n";
  for (const Convergence& study : studies) {
    text += fmt::format("\ncontact \"{}\", last state; changes against the row above\n", study.contact);
    Table table;
    table.headings = {"refine", "springs",      "active",       "peak",         "mean",
                      "area",   "peak changes", "mean changes", "area changes", "outcome"};
    table.left = "rrrrrrrrrl";
    for (const ConvergenceRow& r : study.rows)
      table.rows.push_back({fmt::format("{}", r.refine), fmt::format("{}", r.springs),
                            fmt::format("{}", r.springs_active), four_digits(r.peak), four_digits(r.mean),
                            four_digits(r.area), share_in_percent(r.change_peak), share_in_percent(r.change_mean),
                            share_in_percent(r.change_area), name(r.outcome)});
    text += table_text(table);
    const auto needed = [&](int springs, const char* limit) {
      return springs < 0
                 ? fmt::format("changes below {}: not reached (at most {} springs allowed)\n", limit, max_springs)
                 : fmt::format("changes below {}: from {} springs on\n", limit, springs);
    };
    text += needed(study.springs_5_percent, "5%");
    text += needed(study.springs_1_percent, "1%");
  }
  return text;
}

}  // namespace dea
