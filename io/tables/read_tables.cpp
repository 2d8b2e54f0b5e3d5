#include "io/tables/read_tables.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "io/febio/febio_text.h"
#include "io/tables/pose_matrices.h"
#include "io/tables/table_columns.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/rotations.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/base/unit_names.h"

namespace dea {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// ---- units ---------------------------------------------------------------------------------------------------------

struct Unit {
  const char* name;
  double size;  // in N, m, rad
};
constexpr Unit kForces[] = {{"N", 1.0}, {"kN", 1e3}, {"mN", 1e-3}, {"nN", 1e-9}};
constexpr Unit kLengths[] = {{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}};
constexpr Unit kAngles[] = {{"rad", 1.0}, {"deg", kPi / 180.0}};

template <std::size_t n>
std::optional<double> size_of(const Unit (&units)[n], const std::string& name) {
  for (const Unit& u : units)
    if (name == u.name) return u.size;
  return std::nullopt;
}

/// The model's system; nullopt: nobody names one of FEBio's.
std::optional<UnitNames> model_system(const JointModel& model) {
  const UnitNames units = unit_names(model.units);
  return units.metres > 0 ? std::optional(units) : std::nullopt;
}

// What columns are taken in that name a unit, where the model names none.
constexpr const char* kUnnamed = "mm-N-s";
constexpr const char* kTakenUnnamed = " (it names none, its columns do: taken as in mm-N-s)";

/// How far the largest surface that slides reaches; where there is none, all nodes.
double size_of_joint(const JointModel& model) {
  double most = 0.0;
  for (const Contact& contact : model.contacts)
    for (const int surface : {contact.primary, contact.secondary}) {
      if (contact.kind != Contact::Kind::Sliding || surface < 0) continue;
      Eigen::AlignedBox3d box;
      for (const int node : model.surfaces[at(surface)].nodes) box.extend(model.nodes[at(node)]);
      if (!box.isEmpty()) most = std::max(most, box.diagonal().norm());
    }
  if (most > 0) return most;
  Eigen::AlignedBox3d box;
  for (const Vector3d& node : model.nodes) box.extend(node);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

/// A model that names no units and would be taken as in mm, but is hardly a millimetre large.
void refuse_metres(const JointModel& model, const std::string& table, const char* of_table) {
  constexpr double kLeast = 1.0;  // a joint is larger in mm, and smaller in m
  const double size = size_of_joint(model);
  if (!(size > 0) || size >= kLeast) return;
  throw InputError(Fault{
      .place = table,
      .found = fmt::format("the model names no units, and for this table would be taken as in mm: it "
                           "is too small for that, {:.3g} across;",
                           size),
      .expected = say("name its units with {} or {}; those of the columns ({}) then count against them",
                      NamedSetting{"units", "", "SI"}, NamedSetting{"units", "", "mm-N-s"}, NamedSetting{of_table})});
}

/// What a table's forces (angles) and lengths are multiplied by, and how that was decided.
struct Scale {
  double first = 1.0, length = 1.0;
  std::string words = "in the model's units";
  bool unsaid = false;  ///< that lengths are in mm, as the model's, nobody says
};

/// `units`: "N-m", "deg-mm". `first`: force or angle.
template <std::size_t n>
Scale scale_of(const char* setting, const std::string& units, const Unit (&first)[n], const char* expected,
               const std::optional<UnitNames>& model, bool is_force) {
  const std::size_t dash = units.find('-');
  const std::optional<double> a = size_of(first, units.substr(0, dash));
  const std::optional<double> b = dash == std::string::npos ? std::nullopt : size_of(kLengths, units.substr(dash + 1));
  if (!a || !b) throw wrong_setting(setting, units, "these are no units that are known;", expected);
  const UnitNames system = model.value_or(unit_names(kUnnamed));
  return {
      is_force ? *a / system.newtons : *a, *b / system.metres,
      fmt::format("in {}, the model {} {}", units, model ? "in" : "names no units and is taken as in", system.system)};
}

/// What to do about a column whose name says another unit than it is taken in.
Sentence unit_remedy(const std::optional<UnitNames>& model, const NamedSetting& of_table, const char* such_as) {
  return model ? say("say what they are in with {} ({} and the like), or convert the column and its name", of_table,
                     such_as)
               : say("the model names no units and is taken as in mm-N-s: name its own with {}, say what the columns "
                     "are in "
                     "with {} ({} and the like), or convert the column and its name",
                     NamedSetting{"units", "", "SYSTEM"}, of_table, such_as);
}

/// What a column of forces or moments is counted in: bodies' weights or masses.
enum class PerBody { No, Percent, Weight, Mass };

PerBody per_body(const std::string& unit) {
  if (unit.starts_with("%")) return PerBody::Percent;
  if (unit.find("bw") != unit.npos) return PerBody::Weight;
  return unit.find("/kg") != unit.npos ? PerBody::Mass : PerBody::No;
}

/// What to do about a column of loads whose name says another unit than it is taken in.
Sentence load_remedy(const std::string& unit, bool weight_given, const std::optional<UnitNames>& model) {
  const NamedSetting weight = {"body-weight", "", weight_given ? "" : "N"};
  const PerBody per = per_body(unit);
  const bool heights = unit.ends_with("ht") || unit.ends_with("bwh");
  if (per == PerBody::Mass)
    return say("multiply the column by the body's mass in kg, and take the \"/kg\" out of its name{}",
               weight_given ? say("; leave {} out", NamedSetting{"body-weight"}) : Sentence());
  if (heights)
    return say(
        "multiply the column by the body's height{}, name it as a moment in % of body weight times a length, and "
        "give the weight with {}",
        per == PerBody::Weight ? " and by 100" : "", NamedSetting{"body-weight", "", "N"});
  if (per == PerBody::Weight)
    return say("multiply the column by 100, name it in %BW, and give the body weight with {}",
               NamedSetting{"body-weight", "", "N"});
  if (weight_given)
    return say("with {} they are percent of it: leave that out, or convert the column and its name", weight);
  if (per == PerBody::Percent) return say("give the body weight with {}: the columns are percent of it then", weight);
  return unit_remedy(model, {"load-units", "", "FORCE-LENGTH"}, "N-m");
}

void need_body(const char* file_setting, const std::string& file, const char* body_setting, const std::string& body) {
  if (!file.empty() && body.empty())
    throw wrong_setting(file_setting, file, "no body is named on which its rows act;",
                        say("name it with {}", NamedSetting{body_setting, "", "BODY"}));
}

/// A table's settings without the table.
void refuse_idle(const Settings& s) {
  const auto refuse = [](const char* setting, const std::string& value, const char* file_setting) {
    if (!value.empty())
      throw wrong_setting(setting, value, "there is no table for it;",
                          say("name its file with {}", NamedSetting{file_setting}));
  };
  if (s.loads.file.empty() && s.loads.time.empty()) {
    refuse("load-body", s.loads.body, "loads");
    refuse("load-columns", s.loads.columns, "loads");
    refuse("load-units", s.loads.units, "loads");
    refuse("body-weight", s.loads.body_weight ? fmt::format("{:g}", *s.loads.body_weight) : "", "loads");
    refuse("load-frame",
           s.loads.frame.kind == TableFrame::Kind::Global  ? ""
           : s.loads.frame.kind == TableFrame::Kind::Body  ? s.loads.frame.body
           : s.loads.frame.kind == TableFrame::Kind::Named ? "frame:" + s.loads.frame.frame
                                                           : "three axes",
           "loads");
  }
  if (s.motion.file.empty() && s.motion.time.empty()) {
    refuse("motion-body", s.motion.body, "motion");
    refuse("motion-columns", s.motion.columns, "motion");
    refuse("motion-rotation", s.motion.rotation, "motion");
    refuse("motion-units", s.motion.units, "motion");
    refuse("motion-start", s.motion.start, "motion");
  }
}

/// OpenSim's tables have units of their own, so that the model's have to be known.
void need_model_units(const NumberTable& table, const std::optional<UnitNames>& model, const char* units,
                      const NamedSetting& of_table) {
  if (model) return;
  throw InputError(
      Fault{.place = table.path,
            .found = fmt::format("OpenSim's tables are in {}, and the model names no units;", units),
            .expected = say("name the model's with {}, or the table's with {} (the model is in mm and N then)",
                            NamedSetting{"units", "", "mm-N-s"}, of_table)});
}

// ---- loads ---------------------------------------------------------------------------------------------------------

/// Where the names gave the first half of the rows alone: what is said of the other columns, which may be the second.
std::string left_unread(const NumberTable& table, std::vector<int> known, const std::vector<int>& told,
                        const char* second) {
  constexpr std::size_t kNamed = 6;
  known.insert(known.end(), told.begin(), told.end());
  known.push_back(time_column(table));
  std::vector<int> others;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const int column = static_cast<int>(i);
    if (std::find(known.begin(), known.end(), column) == known.end()) others.push_back(column);
  }
  if (others.empty()) return "";
  const std::size_t more = others.size() - std::min(others.size(), kNamed);
  others.resize(others.size() - more);
  return fmt::format("; no {}: {}{} not read from it", second, column_names(table, others),
                     more > 0             ? fmt::format(" and {} more columns are", more)
                     : others.size() == 1 ? " is"
                                          : " are");
}

std::vector<int> load_columns(const NumberTable& table, const std::string& given) {
  if (!given.empty()) return given_columns(table, "load-columns", given);
  const auto words = [](const char* letter, const char* word, const char* other) {
    std::array<std::vector<std::string>, 3> all;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      all[k] = {letter + axis,
                std::string(letter) + "_" + axis,
                std::string(word) + "_" + axis,
                word + axis,
                std::string(other) + "_" + axis,
                other + axis,
                std::string(word) + "_v" + axis};
    }
    return all;
  };
  const std::array<int, 3> force = vector_columns(table, "load-columns", "force", words("f", "force", "force_v"));
  if (force[0] < 0)
    throw InputError(Fault{.place = table.path,
                           .found = say("found no columns fx, fy, fz among {};", named_columns(table)),
                           .expected = say("name the force's columns, and the moment's, with {}",
                                           NamedSetting{"load-columns", "", "FX,FY,FZ,MX,MY,MZ"})});
  const std::array<int, 3> moment = vector_columns(table, "load-columns", "moment", words("m", "moment", "torque"));
  const auto owner = [&](int column, const char* end) {  // "hip" of "hip_fx"
    const std::string name = bare_name(table.names[at(column)]);
    return name.ends_with(end) ? name.substr(0, name.size() - std::string(end).size()) : std::string();
  };
  if (moment[0] >= 0 && !owner(force[0], "_fx").empty() && !owner(moment[0], "_mx").empty() &&
      owner(force[0], "_fx") != owner(moment[0], "_mx"))
    throw InputError(Fault{.place = table.path,
                           .found = say("the force is that of {}, the moment that of {};", owner(force[0], "_fx"),
                                        owner(moment[0], "_mx")),
                           .expected = say("name the columns of one load with {}", NamedSetting{"load-columns"})});
  std::vector<int> columns(force.begin(), force.end());
  if (moment[0] >= 0) columns.insert(columns.end(), moment.begin(), moment.end());
  return columns;
}

NumberTable table_of(const std::string& file, const GivenTables& given) {
  const auto found = given.find(file);
  return found == given.end() ? read_table(file) : found->second;
}

/// Of a weight that may be meant in kg what it would be in newtons: "80 kg would be 784.8 N". Empty: it may not.
std::string weight_in_doubt(double weight, const std::optional<UnitNames>& system) {
  constexpr double kMostInKilograms = 150, kGravity = 9.81;
  const bool newtons = !system || system->newtons == 1.0;
  return newtons && weight < kMostInKilograms ? fmt::format("{:g} kg would be {:.4g} N", weight, kGravity * weight)
                                              : "";
}

void read_loads(const JointModel& model, const GivenTables& given, LoadTable& loads) {
  const NumberTable table = table_of(loads.file, given);
  const std::optional<UnitNames> system = model_system(model);
  std::string units = loads.units;
  if (units.empty() && table.opensim) {
    need_model_units(table, system, "N and N m", {"load-units", "", "N-m"});
    units = "N-m";
  }
  Scale scale;
  if (!units.empty())
    scale = scale_of("load-units", units, kForces, "FORCE-LENGTH of N, kN, mN, nN and m, cm, mm, um, such as N-m",
                     system, true);
  const std::vector<int> columns = load_columns(table, loads.columns);
  const UnitNames own = system.value_or(unit_names(kUnnamed));
  const std::array<std::string, 2> taken = units_taken(units, own.force, own.length);
  const auto remedy = [&](const std::string& unit) { return load_remedy(unit, loads.body_weight.has_value(), system); };
  const std::string force_unit = loads.body_weight ? "%bw" : taken[0];
  refuse_other_units(table, columns, 0, force_unit, force_words(), remedy);
  refuse_other_units(table, columns, 3, force_unit + taken[1], moment_words(), remedy);
  if (!system && units.empty() &&
      (name_says_unit(table, columns, 0, force_words()) || name_says_unit(table, columns, 3, moment_words())))
    scale.words += kTakenUnnamed;
  if (!system && columns.size() > 3 && (!units.empty() || name_says_unit(table, columns, 3, moment_words())))
    refuse_metres(model, table.path, "load-units");
  loads.time = times_of(table);
  loads.load = values_of(table, columns);
  const double share = loads.body_weight ? *loads.body_weight / 100.0 : 1.0;
  // a body weight is given in the model's force: only the lever of a moment has a unit of the table's
  const double force = loads.body_weight ? share : scale.first, moment = force * scale.length;
  for (Vector6& load : loads.load) {
    load.head<3>() *= force;
    load.tail<3>() *= moment;
  }
  loads.words = fmt::format("{} {}", table_in_words(table, "columns " + column_names(table, columns), loads.time),
                            loads.body_weight
                                ? fmt::format("in % of {:g}{}", *loads.body_weight,
                                              columns.size() <= 3 ? ""
                                              : units.empty()     ? ", moments times the model's length"
                                                              : fmt::format(", moments times length {}", scale.words))
                                : scale.words);
  if (loads.body_weight) loads.doubt = weight_in_doubt(*loads.body_weight, system);
  const std::vector<int> points = like(table, {"px", "py", "pz"});
  if (!points.empty())
    loads.words += fmt::format("; where the force acts ({}) is not read from it", column_names(table, points));
  if (columns.size() <= 3 && loads.columns.empty()) loads.words += left_unread(table, columns, points, "moments");
}

// ---- motion --------------------------------------------------------------------------------------------------------

/// Rotation vector of angles about x, y and z, taken in the order of `sequence`, each about the axis that the ones
/// before have turned.
Eigen::Vector3d vector_of_angles(const std::string& sequence, const Eigen::Vector3d& angles) {
  const auto turn_about = [&](int axis) { return Eigen::AngleAxisd(angles[axis], Eigen::Vector3d::Unit(axis)); };
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (int k = 0; k < 3; ++k) q = q * Eigen::Quaterniond(turn_about(sequence[at(k)] - 'x'));
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

/// What each row is: three or six columns, or the names of one or two matrices.
struct MotionColumns {
  std::vector<int> numbers;
  std::vector<std::string> matrices;
};

MotionColumns given_motion(const NumberTable& table, const std::string& given) {
  const std::vector<std::string> names = split_at_commas(given);
  const bool matrices = names.size() <= 2 && std::none_of(names.begin(), names.end(), [&](const std::string& name) {
                          return find_column(table, name) >= 0;
                        });
  if (!matrices) return {given_columns(table, "motion-columns", given), {}};
  for (const std::string& name : names) place_columns(table, name, "motion-columns", given);
  return {{}, names};
}

MotionColumns motion_columns(const NumberTable& table, const MotionTable& motion) {
  if (!motion.columns.empty()) return given_motion(table, motion.columns);
  const auto words = [](const std::vector<std::string>& before) {
    std::array<std::vector<std::string>, 3> all;
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::string& word : before) all[k].push_back(word + "xyz"[k]);
    return all;
  };
  const std::array<int, 3> translation =
      vector_columns(table, "motion-columns", "translation", words({"t", "translation_", "translation", "u"}));
  const std::array<int, 3> turn =
      vector_columns(table, "motion-columns", "rotation", words({"r", "rotation_", "rotation", "angle_"}));
  const std::vector<std::string> matrices = translation[0] < 0 ? matrix_names(table) : std::vector<std::string>();
  if (matrices.size() == 1) return {{}, matrices};
  if (matrices.size() > 1)
    throw InputError(Fault{.place = table.path,
                           .found = say("found {} matrices in each row, {};", matrices.size(), name_list(matrices)),
                           .expected = say("name the body's with {}, or the body's relative to another one's with {}",
                                           NamedSetting{"motion-columns", "", matrices[0]},
                                           NamedSetting{"motion-columns", "", matrices[0] + "," + matrices[1]})});
  if (translation[0] < 0)
    throw InputError(Fault{.place = table.path,
                           .found = say("found no columns tx, ty, tz among {};", named_columns(table)),
                           .expected = say("name the translation's columns, and the rotation's, with {}",
                                           NamedSetting{"motion-columns", "", "TX,TY,TZ,RX,RY,RZ"})});
  std::vector<int> columns(translation.begin(), translation.end());
  if (turn[0] >= 0) columns.insert(columns.end(), turn.begin(), turn.end());
  return {columns, {}};
}

/// "m", or ANGLE-LENGTH, of which the angle says nothing of matrices.
std::string length_of_matrices(const std::string& units) {
  const std::size_t dash = units.find('-');
  const std::string length = dash == std::string::npos ? units : units.substr(dash + 1);
  if (!size_of(kLengths, length) || (dash != std::string::npos && !size_of(kAngles, units.substr(0, dash))))
    throw wrong_setting("motion-units", units, "this is no unit of a matrix that is known;",
                        "name the length of its last column: m, cm, mm or um");
  return length;
}

/// Of "own-frame" or nothing, "TIME", "TIME,ground" (settings_table.cpp).
PoseStart pose_start(const NumberTable& table, const MotionTable& motion) {
  PoseStart start;
  if (motion.start.empty() || motion.start == kOwnFrame) return start;
  const std::size_t comma = motion.start.find(',');
  const double time = parse_number(motion.start.substr(0, comma));
  start.in_ground = comma != std::string::npos;
  const double span = std::max(std::abs(motion.time.front()), std::abs(motion.time.back()));
  for (std::size_t r = 0; r < motion.time.size(); ++r)
    if (std::abs(motion.time[r] - time) <= 1e-6 * span) start.row = static_cast<int>(r);
  if (start.row < 0)
    throw wrong_setting("motion-start", motion.start, say("{} has no row at this time;", table.path),
                        say("its {} rows are at times {} to {}", motion.time.size(), time_text(motion.time.front()),
                            time_text(motion.time.back())));
  return start;
}

/// Where the model is taken to have the body before it moves.
std::string start_in_words(const PoseStart& start, const MotionTable& motion, bool relative) {
  if (start.row < 0)
    return fmt::format("the model has {} in its own frame", relative ? "each of the two bodies" : "the body");
  const std::string row = fmt::format("as the row at time {}", time_text(motion.time[at(start.row)]));
  if (!relative) return "the model has the body " + row;
  return start.in_ground ? fmt::format("the model has both bodies {}, in the table's axes", row)
                         : fmt::format("the model has the body {}, in the other body's frame", row);
}

/// What the matrices' last columns are multiplied by. InputError: what their names say is another unit.
Scale scale_of_matrices(const JointModel& model, const NumberTable& table, const std::vector<std::string>& names,
                        const MotionTable& motion) {
  const std::optional<UnitNames> system = model_system(model);
  if (motion.units.empty() && table.opensim) need_model_units(table, system, "m", {"motion-units", "", "m"});
  std::string unit = motion.units.empty() ? "" : length_of_matrices(motion.units);
  if (unit.empty() && table.opensim) unit = "m";
  const UnitNames own = system.value_or(unit_names(kUnnamed));
  Scale scale;
  if (!unit.empty()) {
    scale.length = *size_of(kLengths, unit) / own.metres;
    scale.words =
        fmt::format("in {}, the model {} {}", unit, system ? "in" : "names no units and is taken as in", own.system);
  }
  bool says = false;
  for (const std::string& name : names) {
    const std::vector<int> columns = place_columns(table, name, "motion-columns", motion.columns);
    refuse_other_units(table, columns, 0, unit.empty() ? lower_case(own.length) : unit, length_words(),
                       [&](const std::string&) {
                         return unit_remedy(system, {"motion-units", "", "LENGTH"}, "m");
                       });
    says = says || name_says_unit(table, columns, 0, length_words());
  }
  if (!system && unit.empty() && says) scale.words += kTakenUnnamed;
  if (!system && (!unit.empty() || says)) refuse_metres(model, table.path, "motion-units");
  scale.unsaid = unit.empty() && !says && own.length == "mm";
  return scale;
}

/// `names`: of the body's matrix, and of the one it is relative to.
void read_matrices(const JointModel& model, const NumberTable& table, const std::vector<std::string>& names,
                   MotionTable& motion) {
  if (!motion.rotation.empty())
    throw wrong_setting("motion-rotation", motion.rotation,
                        say("the rows of {} are matrices, which say how the body turns;", table.path), "leave it out");
  const Scale scale = scale_of_matrices(model, table, names, motion);
  motion.time = times_of(table);
  const PoseStart start = pose_start(table, motion);
  const bool relative = names.size() == 2;
  const std::vector<Eigen::Isometry3d> body = poses_of(table, names[0], scale.length);
  std::vector<Eigen::Isometry3d> other;
  if (relative) other = poses_of(table, names[1], scale.length);
  motion.motion.clear();
  for (const Eigen::Isometry3d& move : moves_from(start, body, other)) {
    motion.motion.emplace_back();
    motion.motion.back() << move.translation(), rotation_vector(move.linear());
  }
  motion.turns = motion.about_origin = true;
  motion.farthest = 0.0;
  if (scale.unsaid)
    for (std::size_t r = 0; r < body.size(); ++r)
      motion.farthest =
          std::max(motion.farthest, (relative ? other[r].inverse() * body[r] : body[r]).translation().norm());
  motion.doubt = matrices_in_doubt(motion, size_of_joint(model));
  motion.words = fmt::format(
      "{} {} ({})",
      table_in_words(table, "matrices " + names[0] + (relative ? " relative to " + names[1] : ""), motion.time),
      scale.words, start_in_words(start, motion, relative));
}

/// Angles of more than a whole turn that are said to be in radians: these are degrees.
void refuse_degrees_as_radians(const NumberTable& table, const std::vector<int>& columns, const std::string& length) {
  constexpr double kWholeTurn = 2 * kPi * (1 + 1e-4);  // and digits of a table
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    for (std::size_t k = 3; k < columns.size(); ++k) {
      const double angle = table.rows[r][at(columns[k])];
      if (std::abs(angle) <= kWholeTurn) continue;
      throw InputError(
          Fault{.place = fmt::format("{}:{}", table.path, table.lines[r]),
                .found = say("column {}: found {:g} in radians, more than a whole turn;",
                             febio::quote(table.names[at(columns[k])]), angle),
                .expected = table.degrees ? say("if these are degrees, correct the header to inDegrees=yes and say {}",
                                                NamedSetting{"motion-units", "", "deg-" + length})
                                          : say("if these are degrees, say {}; else take whole turns out",
                                                NamedSetting{"motion-units", "", "deg-" + length})});
    }
}

void read_motion(const JointModel& model, const GivenTables& given, MotionTable& motion) {
  const NumberTable table = table_of(motion.file, given);
  const MotionColumns found = motion_columns(table, motion);
  if (!found.matrices.empty()) return read_matrices(model, table, found.matrices, motion);
  motion.about_origin = false;
  motion.farthest = 0.0;
  motion.doubt.clear();
  if (!motion.start.empty())
    throw wrong_setting("motion-start", motion.start,
                        say("the rows of {} are no matrices: they count from where the body starts;", table.path),
                        "leave it out");
  const std::optional<UnitNames> system = model_system(model);
  const std::vector<int>& columns = found.numbers;
  motion.turns = columns.size() == 6;
  if (!motion.turns && !motion.rotation.empty())
    throw wrong_setting("motion-rotation", motion.rotation, say("{} has no columns rx, ry, rz:", table.path),
                        say("it has {}; name the translation's and the rotation's with {}, or leave this out",
                            named_columns(table), NamedSetting{"motion-columns", "", "TX,TY,TZ,RX,RY,RZ"}));
  if (motion.turns && motion.rotation.empty())
    throw wrong_setting("motion", motion.file, "its rows have rotations, and nobody says what their three numbers are;",
                        say("say {} for a rotation vector, or the sequence of three angles: {}",
                            NamedSetting{"motion-rotation", "", "vector"}, NamedSetting{"motion-rotation", "", "zxy"}));
  std::string units = motion.units;
  if (units.empty() && table.opensim) {
    need_model_units(table, system, "m", {"motion-units", "", "deg-m"});
    units = table.degrees.value_or(false) ? "deg-m" : "rad-m";
  }
  if (units.empty() && motion.turns)
    throw wrong_setting("motion", motion.file,
                        "its rows have rotations, and nobody says whether in degrees or radians;",
                        say("say {}", NamedSetting{"motion-units", "", "deg-mm"}));
  Scale scale;
  if (!units.empty())
    scale = scale_of("motion-units", units, kAngles, "ANGLE-LENGTH of deg, rad and m, cm, mm, um, such as deg-mm",
                     system, false);
  const std::array<std::string, 2> taken = units_taken(units, "", system.value_or(unit_names(kUnnamed)).length);
  if (motion.turns && table.degrees && *table.degrees != (taken[0] == "deg"))
    throw wrong_setting("motion-units", units,
                        say("{} says inDegrees={} in its header;", table.path, *table.degrees ? "yes" : "no"),
                        "say the same, or correct the header");
  const auto remedy = [&](const std::string&) {
    return unit_remedy(system, {"motion-units", "", "ANGLE-LENGTH"}, "deg-m");
  };
  refuse_other_units(table, columns, 0, taken[1], length_words(), remedy);
  refuse_other_units(table, columns, 3, taken[0], angle_words(), remedy);
  const bool says = name_says_unit(table, columns, 0, length_words());
  if (!system && units.empty() && says) scale.words += kTakenUnnamed;
  if (!system && (!units.empty() || says)) refuse_metres(model, table.path, "motion-units");
  if (motion.turns && taken[0] == "rad") refuse_degrees_as_radians(table, columns, taken[1]);
  motion.time = times_of(table);
  motion.motion = values_of(table, columns);
  for (Vector6& row : motion.motion) {
    row.head<3>() *= scale.length;
    row.tail<3>() *= scale.first;
    if (motion.turns && motion.rotation != "vector") row.tail<3>() = vector_of_angles(motion.rotation, row.tail<3>());
  }
  motion.words =
      fmt::format("{} {}", table_in_words(table, "columns " + column_names(table, columns), motion.time), scale.words);
  if (columns.size() <= 3 && motion.columns.empty()) motion.words += left_unread(table, columns, {}, "rotations");
}

// ---- thickness -----------------------------------------------------------------------------------------------------

int column_called(const NumberTable& table, const char* name) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (bare_name(table.names[i]) == name) return static_cast<int>(i);
  throw InputError(Fault{.place = table.path,
                         .found = say("found no column {} among {};", febio::quote(name), named_columns(table)),
                         .expected = "name the columns node and thickness in the first line"});
}

void read_node_thickness(const JointModel& model, const GivenTables& given, NodeThickness& thickness) {
  const NumberTable table = table_of(thickness.file, given);
  const int node_column = column_called(table, "node"), column = column_called(table, "thickness");
  const std::optional<UnitNames> system = model_system(model);
  const std::string length = system.value_or(unit_names(kUnnamed)).length;
  refuse_other_units(table, {column}, 0, length, length_words(), [&](const std::string&) {
    return system ? Sentence("convert the column and its name")
                  : say("convert the column and its name, or name the model's units with {}",
                        NamedSetting{"units", "", "SYSTEM"});
  });
  if (!system && name_says_unit(table, {column}, 0, length_words())) refuse_metres(model, table.path, "thickness-from");
  std::map<int, int> line_of;  // by node
  thickness.at_node.clear();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const double number = table.rows[r][at(node_column)], value = table.rows[r][at(column)];
    const auto refuse = [&](const std::string& text) { throw InputError(table.path, table.lines[r], text); };
    if (!(number >= 1 && number <= std::numeric_limits<int>::max() && number == std::floor(number)))
      refuse(fmt::format("found node {:g}, expected a whole number > 0: the node's number in the model", number));
    if (value < 0) refuse(fmt::format("found thickness {:g}, expected a number >= 0", value));
    const int node = static_cast<int>(number);
    const auto [entry, is_new] = thickness.at_node.insert({node, value});
    if (!is_new && entry->second != value)
      refuse(fmt::format("found thickness {:g} of node {}, and {:g} in line {}, expected one for each node", value,
                         node, entry->second, line_of[node]));
    line_of.insert({node, table.lines[r]});
  }
}

void check_units(const JointModel& model, const Settings& settings) {
  if (settings.units.empty()) return;
  const std::vector<std::string> systems = unit_systems();
  if (std::find(systems.begin(), systems.end(), settings.units) == systems.end())
    throw wrong_setting("units", settings.units,
                        say("this is no system of units of FEBio's{};", did_you_mean(settings.units, systems)),
                        fmt::format("name one of {}", fmt::join(systems, ", ")));
  if (!model.units.empty() && settings.units != model.units)
    throw wrong_setting("units", settings.units, say("the model says that it is in {};", febio::quote(model.units)),
                        "leave it out");
}

}  // namespace

std::string matrices_in_doubt(const MotionTable& motion, double size) {
  // In mm a bone's place lies some mm to m from where its matrix counts from, in m some 0.001 to 1; a joint and its
  // bones are some cm to dm large.
  constexpr double kLeast = 1e-2;
  if (!(motion.farthest > 0) || !(motion.farthest < kLeast * size)) return "";
  return fmt::format("translations of at most {:.3g} mm beside surfaces that are {:.3g} mm large", motion.farthest,
                     size);
}

void read_thickness(const JointModel& model, Settings& settings, const GivenTables& given) {
  for (auto& entry : settings.thickness_from) read_node_thickness(model, given, entry.second);
}

std::string time_name(const std::string& table) {
  try {
    const NumberTable rows = read_table(table);
    if (const int column = time_column(rows); column >= 0) return rows.names[at(column)];
  } catch (const InputError&) {
  }
  return "time";
}

std::vector<NamedPath> table_files(const Settings& settings) {
  std::vector<NamedPath> files;
  const auto add = [&](const char* what, const std::string& path) {
    if (!path.empty()) files.push_back({what, path});
  };
  add("the table of loads", settings.loads.file);
  add("the table of motion", settings.motion.file);
  for (const auto& entry : settings.thickness_from) add("the table of thickness", entry.second.file);
  return files;
}

void settle_units(JointModel& model, const Settings& settings) {
  check_units(model, settings);
  if (model.units.empty()) model.units = settings.units;
}

void read_tables(const JointModel& model, Settings& settings, const GivenTables& given) {
  refuse_idle(settings);
  need_body("loads", settings.loads.file, "load-body", settings.loads.body);
  need_body("motion", settings.motion.file, "motion-body", settings.motion.body);
  if (!settings.loads.file.empty()) read_loads(model, given, settings.loads);
  if (!settings.motion.file.empty()) read_motion(model, given, settings.motion);
  read_thickness(model, settings, given);
}

}  // namespace dea
