#include "src/model/settings_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <utility>

#include "src/model/joint_model.h"

namespace dea {

namespace {

using Text = const std::string&;

constexpr const char* kJoint = "Joint (names are the model's own)";
constexpr const char* kCartilage = "Cartilage and springs";
constexpr const char* kPlacing = "Placing, in the order of the line";
constexpr const char* kLoads = "Motion and loads";
constexpr const char* kTables = "Tables of loads and motion";
constexpr const char* kOutput = "Output";
constexpr const char* kFrames = "Frames";

/// One of the words that name(Word) has, in small or capital letters.
template <class Word>
Word parse_word(Text text, std::initializer_list<Word> words) {
  std::string expected;
  std::vector<std::string> all;
  for (const Word* word = words.begin(); word != words.end(); ++word) {
    if (lower_case(text) == lower_case(name(*word))) return *word;
    all.push_back(name(*word));
    expected += fmt::format("{}{}", word == words.begin() ? "" : word + 1 == words.end() ? " or " : ", ", name(*word));
  }
  throw bad_value(text, expected, all);
}

bool parse_switch(Text text) {
  const std::string word = lower_case(text);
  if (word != "true" && word != "false") throw bad_value(text, "true or false", {"true", "false"});
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

/// NAME.PARAMETER; a name may hold dots itself.
Text need_parameter(Text key) {
  const std::size_t dot = key.rfind('.');
  if (dot == key.npos || dot == 0 || dot + 1 == key.size())
    throw bad_value(key, "NAME.PARAMETER, the parameter being stiffness, slack-length or force");
  return key;
}

/// `expected`: of the whole text, of which `numbers` is the part that is to be a vector.
Eigen::Vector3d parse_vector_of(Text text, Text numbers, const char* expected,
                                const std::vector<std::string>& words = {}) {
  try {
    return parse_vector(numbers);
  } catch (const BadValue&) {
    throw bad_value(text, expected, words);
  }
}

LoadPoint parse_load_point(Text text) {
  if (lower_case(text) == "sphere-center") return {true};
  return {false, parse_vector_of(text, text, "three numbers x,y,z, or sphere-center", {"sphere-center"})};
}

TurnPoint parse_turn_point(Text text) {
  const std::string word = lower_case(text);
  if (word == "sphere-center") return {TurnPoint::Kind::SphereCenter};
  if (word == "com") return {TurnPoint::Kind::CenterOfMass};
  return {TurnPoint::Kind::Point,
          parse_vector_of(text, text, "three numbers x,y,z, sphere-center or com", {"sphere-center", "com"})};
}

/// "frame:pelvis,z,10" as "frame:pelvis,0,0,1,10".
std::string with_axis_in_numbers(Text axis_and_angle) {
  const std::size_t comma = axis_and_angle.find(',');
  const std::string axis = lower_case(trimmed(axis_and_angle.substr(0, comma)));
  for (const auto& [letter, numbers] : {std::pair{"x", "1,0,0"}, std::pair{"y", "0,1,0"}, std::pair{"z", "0,0,1"}})
    if (axis == letter && comma != std::string::npos) return numbers + axis_and_angle.substr(comma);
  return axis_and_angle;
}

Placement parse_turn(Text body, Text text) {
  const FramedText framed = split_frame(text);
  const char* expected = framed.frame.empty() ? "an axis and an angle: x,y,z,DEGREES"
                                              : "an axis and an angle: frame:NAME,AXIS,DEGREES, AXIS being x, y, z or "
                                                "three numbers";
  try {
    const std::vector<double> n = parse_numbers(framed.frame.empty() ? framed.rest : with_axis_in_numbers(framed.rest));
    if (n.size() != 4) throw bad_value(text, expected);
    const Placement turn{Placement::Kind::Rotate, body, {n[0], n[1], n[2]}, n[3], framed.frame};
    if (turn.vector.isZero(0.0)) throw bad_value(text, "an axis that is not 0,0,0");
    return turn;
  } catch (const BadValue& bad) {
    if (std::string(bad.what()).find("axis") != std::string::npos) throw;
    throw bad_value(text, expected);
  }
}

/// Three numbers, along a frame's axes where one is named.
struct FramedVector {
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  std::string frame;
};
FramedVector parse_framed(Text text) {
  const FramedText framed = split_frame(text);
  const char* expected = framed.frame.empty() ? "three numbers x,y,z" : "three numbers: frame:NAME,x,y,z";
  return {parse_vector_of(text, framed.rest, expected), framed.frame};
}

/// "frame:pelvis", or "frame:femur,femur": axes that turn with a body.
TableFrame parse_named_frame(Text text) {
  TableFrame frame;
  frame.kind = TableFrame::Kind::Named;
  const bool turns = text.find(',') != std::string::npos;
  const FramedText framed = split_frame(turns ? text : text + ",");
  frame.frame = framed.frame;
  frame.body = trimmed(framed.rest);
  if (turns && frame.body.empty()) throw bad_value(text, "a body after the comma: frame:NAME,BODY");
  return frame;
}

TableFrame parse_frame(Text text) {
  TableFrame frame;
  if (lower_case(text) == "global") return frame;
  if (lower_case(text).rfind("frame:", 0) == 0) return parse_named_frame(text);
  if (text.find('/') == std::string::npos) {
    frame.kind = TableFrame::Kind::Body;
    frame.body = text;
    return frame;
  }
  const char* expected = "three axes at right angles, right-handed, each in global directions: x,y,z/x,y,z/x,y,z";
  frame.kind = TableFrame::Kind::Axes;
  const std::vector<std::string> axes = split(text, '/');
  if (axes.size() != 3) throw bad_value(text, expected);
  for (int k = 0; k < 3; ++k) frame.axes.col(k) = parse_vector_of(text, axes[at(k)], expected).normalized();
  const double skew = (frame.axes.transpose() * frame.axes - Eigen::Matrix3d::Identity()).norm();
  // typed to a few digits: made exact below
  if (!(skew < 1e-3) || !(frame.axes.col(0).cross(frame.axes.col(1)).dot(frame.axes.col(2)) > 0))
    throw bad_value(text, expected);
  frame.axes.col(2) = frame.axes.col(0).cross(frame.axes.col(1)).normalized();
  frame.axes.col(1) = frame.axes.col(2).cross(frame.axes.col(0));
  return frame;
}

std::string parse_rotation(Text text) {
  const std::string word = lower_case(text);
  if (word == "vector") return word;
  std::string axes = word;
  std::sort(axes.begin(), axes.end());
  if (axes != "xyz")
    throw bad_value(text, "vector, or the order in which the angles about x, y and z are taken, such as zxy",
                    {"vector"});
  return word;
}

/// "own-frame", "TIME", "TIME,ground"
std::string parse_start(Text text) {
  const std::string word = lower_case(text);
  if (word == kOwnFrame) return word;
  const std::vector<std::string> parts = split_at_commas(word);
  try {
    parse_number(parts[0]);
    if (parts.size() == 1) return parts[0];
    if (parts.size() == 2 && parts[1] == "ground") return parts[0] + ",ground";
  } catch (const BadValue&) {
  }
  throw bad_value(text, "own-frame, the time of a row, or TIME,ground", {kOwnFrame});
}

std::array<bool, 6> parse_dofs(Text text) {
  std::array<bool, 6> free = {};
  if (lower_case(text) == "none") return free;
  for (Text word : split_at_commas(text)) {
    const auto found = std::find(std::begin(kDofNames), std::end(kDofNames), word);
    if (found == std::end(kDofNames)) {
      std::string meant = did_you_mean(word, {std::begin(kDofNames), std::end(kDofNames)}, kDofAliases);
      const std::string small = lower_case(word);
      if (small == "rx" || small == "ry" || small == "rz")  // in FEBio a way along x, elsewhere often a turn about it
        meant = fmt::format(" ({0} is the way along {0}, {1} the turn about it)", small[1],
                            kDofNames[3 + (small[1] - 'x')]);
      throw BadValue(fmt::format("found \"{}\"{}, expected some of x,y,z,Ru,Rv,Rw, or none", text, meant));
    }
    free[static_cast<std::size_t>(found - std::begin(kDofNames))] = true;
  }
  return free;
}

void add_once(std::vector<std::string>& names, Text name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

SettingContent one(SettingItem item) { return item; }

SettingContent word_or_nothing(Text word) { return word.empty() ? SettingItem() : SettingItem(word); }

template <class Word>
SettingContent word_or_nothing(const std::optional<Word>& word) {
  return word_or_nothing(word ? std::string(name(*word)) : std::string());
}

template <class Number>
SettingContent number_or_nothing(const std::optional<Number>& number) {
  return number ? SettingItem(*number) : SettingItem();
}

std::string axes_text(const Eigen::Matrix3d& axes) {
  std::string text;
  for (int k = 0; k < 3; ++k) text += fmt::format("{}{},{},{}", k ? "/" : "", axes(0, k), axes(1, k), axes(2, k));
  return text;
}

SettingItem item_of(Text word) { return word; }
SettingItem item_of(double number) { return number; }
SettingItem item_of(const Eigen::Matrix3d& axes) { return axes_text(axes); }
SettingItem item_of(const NodeThickness& thickness) { return thickness.file; }
SettingItem item_of(const LoadPoint& load_at) {
  if (load_at.sphere_center) return std::string("sphere-center");
  return load_at.point;
}
SettingItem item_of(const TurnPoint& about) {
  if (about.kind == TurnPoint::Kind::Point) return about.point;
  return std::string(about.kind == TurnPoint::Kind::SphereCenter ? "sphere-center" : "com");
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

/// Frames by themselves: three axes.
Eigen::Matrix3d parse_axes(Text text) {
  const TableFrame frame = text.find('/') == std::string::npos ? TableFrame{} : parse_frame(text);
  if (frame.kind != TableFrame::Kind::Axes)
    throw bad_value(text, "three axes at right angles, right-handed, each in global directions: x,y,z/x,y,z/x,y,z");
  return frame.axes;
}

/// "femur=0,1,0,10", in their order.
SettingContent placements_of(const Settings& settings, Placement::Kind kind) {
  std::vector<std::string> all;
  for (const Placement& p : settings.placements)
    if (p.kind == kind) all.push_back(placement_text(p));
  return one(all);
}

SettingContent frame_of(const TableFrame& frame) {
  if (frame.kind == TableFrame::Kind::Global) return one(std::string("global"));
  if (frame.kind == TableFrame::Kind::Body) return one(frame.body);
  if (frame.kind == TableFrame::Kind::Named)
    return one(fmt::format("frame:{}{}", frame.frame, frame.body.empty() ? "" : "," + frame.body));
  return one(axes_text(frame.axes));
}

/// Numbers; along a frame's axes: "frame:pelvis,1,2,3".
SettingContent forces_of(const Settings& settings) {
  std::map<std::string, SettingItem> items;
  for (const auto& entry : settings.force) {
    const auto frame = settings.force_frame.find(entry.first);
    const Eigen::Vector3d& f = entry.second;
    if (frame == settings.force_frame.end())
      items[entry.first] = f;
    else
      items[entry.first] = fmt::format("frame:{},{},{},{}", frame->second, f.x(), f.y(), f.z());
  }
  return items;
}

std::vector<SettingOption> all_options() {
  using S = Settings;
  return {
      {"contact", nullptr, false, "NAME", nullptr, kJoint, "Analyse only this contact [all that join two bodies]",
       [](S& s, Text, Text text) { s.contact = text; }, [](const S& s) { return word_or_nothing(s.contact); }},
      {"source", nullptr, false, "BODY", nullptr, kJoint,
       "Body whose cartilage carries the springs [each contact's primary side]",
       [](S& s, Text, Text text) { s.source = text; }, [](const S& s) { return word_or_nothing(s.source); }},
      {"springs-at", nullptr, false, "articular|bone", nullptr, kCartilage,
       "Where the springs stand: on the articular surface or on the bone [articular]",
       [](S& s, Text, Text text) {
         s.springs_at = parse_word(text, {SpringsAt::Articular, SpringsAt::Bone});
       },
       [](const S& s) { return one(std::string(name(s.springs_at))); }},
      {"law", nullptr, false, "linear|logarithmic|neo-Hookean|layer", nullptr, kCartilage,
       "Pressure law; layer: springs share the cartilage's sideways flow; the others: each spring for itself [layer; "
       "with springs at the bone: linear]",
       [](S& s, Text, Text text) {
         s.law = parse_word(text, {Law::Linear, Law::Logarithmic, Law::NeoHookean, Law::Layer});
       },
       [](const S& s) { return word_or_nothing(s.law); }},
      {"layer-terms", nullptr, false, "1|2", nullptr, kCartilage,
       "Terms of law layer; 1 is faster, but makes the contact too wide at its edge [2]",
       [](S& s, Text, Text text) {
         s.layer_fit = parse_count(text, 1, 2) == 1 ? LayerFit::OneTerm : LayerFit::TwoTerms;
       },
       [](const S& s) { return one(s.layer_fit == LayerFit::OneTerm ? 1 : 2); }},
      {"interface-stiffness", nullptr, false, "NUMBER", "STIFFNESS", kCartilage,
       "Stiffness per area (MPa/mm) between the surfaces, in series with the cartilage, as of FEBio's contact penalty "
       "[none]",
       [](S& s, Text, Text text) { s.interface_stiffness = parse_positive(text); },
       [](const S& s) { return number_or_nothing(s.interface_stiffness); }},
      {"facets", nullptr, false, "curved|flat", nullptr, kCartilage,
       "Treat facets as a smooth curved surface, or use them as meshed (flat) [curved]",
       [](S& s, Text, Text text) {
         s.facets = parse_word(text, {Facets::Curved, Facets::Flat});
       },
       [](const S& s) { return word_or_nothing(s.facets); }},
      {"refine", nullptr, false, "N", nullptr, kCartilage,
       "Divide every triangle into N*N springs; with law layer also the meshes of both layers [1]",
       [](S& s, Text, Text text) { s.refine = parse_count(text, 1, 1000); },
       [](const S& s) { return number_or_nothing(s.refine); }},
      {"rigid", nullptr, true, "MATERIAL", nullptr, kJoint, "Take a deformable material as rigid bone; may be repeated",
       [](S& s, Text, Text text) { add_once(s.rigid, text); }, [](const S& s) { return one(s.rigid); }},
      {"part", nullptr, true, "MATERIAL", nullptr, kJoint,
       "Take what is of this deformable material as a part that gives way as its elements do; may be repeated [what "
       "contacts press and nothing holds]",
       [](S& s, Text, Text text) { add_once(s.part, text); }, [](const S& s) { return one(s.part); }},
      {"leave-out", nullptr, true, "MATERIAL", nullptr, kJoint,
       "Take the elements of this deformable material, and the springs and contacts on them, out of the model; may be "
       "repeated",
       [](S& s, Text, Text text) { add_once(s.leave_out, text); }, [](const S& s) { return one(s.leave_out); }},
      {"fibre-strain", nullptr, false, "STRAIN", nullptr, kJoint,
       "Strain at which the fibres of parts that give way have their stiffness: they are taken as linear [0]",
       [](S& s, Text, Text text) { s.fibre_strain = parse_length(text); },
       [](const S& s) { return number_or_nothing(s.fibre_strain); }},
      {"instant", nullptr, false, "true|false", nullptr, kJoint,
       "Take parts with fluid in them (biphasic, ...) as incompressible, for loads too fast for it to get away",
       [](S& s, Text, Text text) { s.instant = parse_switch(text); }, [](const S& s) { return one(s.instant); },
       nullptr, "Take parts with fluid in them as their drained solid [default]"},
      {"attach", "surface", false, "BODY", nullptr, kJoint,
       "Body a contact surface belongs to (\"ground\" for none that moves); may be repeated [found from the mesh]",
       [](S& s, Text key, Text text) { s.attach[key] = text; }, [](const S& s) { return by_name(s.attach); }},
      {"bone", "surface", false, "SURFACE", nullptr, kJoint,
       "Bone surface under a contact surface; may be repeated [faces held by the body]",
       [](S& s, Text key, Text text) { s.bone[key] = text; }, [](const S& s) { return by_name(s.bone); }},
      {"keep-facets", nullptr, true, "SURFACE", nullptr, kJoint,
       "Keep facets of this contact surface that look like a side wall or are bonded to bone; may be repeated [left "
       "out]",
       [](S& s, Text, Text text) { add_once(s.keep_facets, text); }, [](const S& s) { return one(s.keep_facets); }},
      {"thickness", "surface", false, "NUMBER", "LENGTH", kCartilage,
       "Constant cartilage thickness, in the model's unit of length (mm); may be repeated [measured]",
       [](S& s, Text key, Text text) { s.thickness[key] = parse_length(text); },
       [](const S& s) { return by_name(s.thickness); }, &S::thickness},
      {"thickness-from", "surface", false, "FILE", nullptr, kCartilage,
       "Cartilage thickness at each node of a contact surface: CSV with columns node (its number in the model) and "
       "thickness; may be repeated [measured]",
       [](S& s, Text key, Text text) {
         s.thickness_from[key] = {text, {}};
       },
       [](const S& s) { return by_name(s.thickness_from); }},
      {"thickness-scale", "surface", false, "NUMBER", "FACTOR", kCartilage,
       "Factor on the cartilage thickness, measured or given; articular surfaces stay in place; may be repeated [1]",
       [](S& s, Text key, Text text) { s.thickness_scale[key] = parse_positive(text); },
       [](const S& s) { return by_name(s.thickness_scale); }, &S::thickness_scale},
      {"E", "surface", false, "NUMBER", "MODULUS", kCartilage,
       "Young's modulus, in the model's unit of pressure (MPa); may be repeated [the material's]",
       [](S& s, Text key, Text text) { s.E[key] = parse_positive(text); }, [](const S& s) { return by_name(s.E); },
       &S::E},
      {"nu", "surface", false, "NUMBER", "RATIO", kCartilage,
       "Poisson's ratio, -1 < nu < 0.5; may be repeated [the material's]",
       [](S& s, Text key, Text text) { s.nu[key] = parse_poisson_ratio(text); },
       [](const S& s) { return by_name(s.nu); }, &S::nu},
      {"rotate", "body", true, "x,y,z,DEGREES", nullptr, kPlacing,
       "Turn a body, and all that is attached to it, before anything moves or loads it: axis in global directions, "
       "right-handed; or frame:NAME,AXIS,DEGREES, AXIS being x, y, z or three numbers; may be repeated",
       [](S& s, Text key, Text text) { s.placements.push_back(parse_turn(key, text)); },
       [](const S& s) { return placements_of(s, Placement::Kind::Rotate); }, nullptr, nullptr, true},
      {"rotate-about", "body", false, "sphere-center|com|x,y,z", nullptr, kPlacing,
       "Point about which the body is turned, in its reference position; it goes along with earlier moves of the body "
       "[sphere-center: centre of the least-squares sphere through its articular surface]",
       [](S& s, Text key, Text text) { s.rotate_about[key] = parse_turn_point(text); },
       [](const S& s) { return by_name(s.rotate_about); }},
      {"move", "body", true, "x,y,z", nullptr, kPlacing,
       "Move a body, and all that is attached to it, before anything else moves or loads it; frame:NAME,x,y,z: along "
       "the frame's axes; may be repeated",
       [](S& s, Text key, Text text) {
         const FramedVector shift = parse_framed(text);
         s.placements.push_back({Placement::Kind::Move, key, shift.vector, 0.0, shift.frame});
       },
       [](const S& s) { return placements_of(s, Placement::Kind::Move); }, nullptr, nullptr, true},
      {"free", "body", false, "x,y,z,Ru,Rv,Rw", nullptr, kLoads,
       "Motions to solve for (\"none\": no motion). All others are fixed unless the model prescribes them; may be "
       "repeated [the model's]",
       [](S& s, Text key, Text text) { s.free[key] = parse_dofs(text); }, [](const S& s) { return by_name(s.free); }},
      {"force", "body", false, "x,y,z", nullptr, kLoads,
       "Force that replaces the model's, growing from 0 over the last step, in the model's unit of force (N); "
       "frame:NAME,x,y,z: along the frame's axes; may be repeated",
       [](S& s, Text key, Text text) {
         const FramedVector force = parse_framed(text);
         s.force[key] = force.vector;
         s.force_frame.erase(key);
         if (!force.frame.empty()) s.force_frame[key] = force.frame;
       },
       forces_of},
      {"load-at", "body", false, "x,y,z|sphere-center", nullptr, kLoads,
       "Where the force acts: a point of the reference configuration, or the centre of the articular surface's sphere; "
       "may be repeated [centre of mass]",
       [](S& s, Text key, Text text) { s.load_at[key] = parse_load_point(text); },
       [](const S& s) { return by_name(s.load_at); }},
      {"set", "name", false, "NUMBER", "VALUE", kLoads,
       "New stiffness, slack-length or force of the spring, ligament, cable, muscle or rigid force NAME; a load "
       "controller still scales it; may be repeated [the model's]",
       [](S& s, Text key, Text text) { s.set_values[need_parameter(key)] = parse_number(text); },
       [](const S& s) { return by_name(s.set_values); }},
      {"skip-steps", nullptr, false, "true|false", nullptr, kLoads,
       "Do not solve the model's steps one after the other: apply what holds at the end of the last one to the "
       "starting poses",
       [](S& s, Text, Text text) { s.skip_steps = parse_switch(text); }, [](const S& s) { return one(s.skip_steps); },
       nullptr, "Solve the model's steps one after the other [default]"},
      {"units", nullptr, false, "SYSTEM", nullptr, kLoads,
       "The model's system of units, if it names none: FEBio's SI, mm-N-s, CGS, ...",
       [](S& s, Text, Text text) { s.units = text; }, [](const S& s) { return word_or_nothing(s.units); }},
      {"squash", nullptr, false, "true|false", nullptr, kOutput, "Show cartilage compressed [default]",
       [](S& s, Text, Text text) { s.squash = parse_switch(text); }, [](const S& s) { return one(s.squash); }, nullptr,
       "Show cartilage rigid with its bone, not compressed"},
      {"inside", nullptr, false, "true|false", nullptr, kOutput,
       "Also stress and strain inside the cartilage: of its elements, at the bone, at the surface (law layer only); up "
       "to half as long again",
       [](S& s, Text, Text text) { s.inside = parse_switch(text); }, [](const S& s) { return one(s.inside); }, nullptr,
       "Only pressures on the surfaces [default]"},
      {"loads", nullptr, false, "FILE", nullptr, kTables,
       "Forces and moments on one body, one state per row: CSV with a line of names, or OpenSim's .sto, .mot; they "
       "replace all that the model puts on that body at the end of its last step",
       [](S& s, Text, Text text) { s.loads.file = text; }, [](const S& s) { return word_or_nothing(s.loads.file); }},
      {"load-body", nullptr, false, "BODY", nullptr, kTables,
       "The body on which the loads act; at which point: see {load-at}",
       [](S& s, Text, Text text) { s.loads.body = text; }, [](const S& s) { return word_or_nothing(s.loads.body); }},
      {"load-columns", nullptr, false, "FX,FY,FZ[,MX,MY,MZ]", nullptr, kTables,
       "Names of the columns [found by name: fx, force_x, ..._fx, mx, moment_x, ...]",
       [](S& s, Text, Text text) { s.loads.columns = text; },
       [](const S& s) { return word_or_nothing(s.loads.columns); }},
      {"load-frame", nullptr, false, "global|BODY|frame:NAME[,BODY]|x,y,z/x,y,z/x,y,z", nullptr, kTables,
       "Axes of the table: global; BODY: the global ones in its reference position, which turn with it; a frame's, "
       "which turn with BODY if it is named; or three axes in global directions [global]",
       [](S& s, Text, Text text) { s.loads.frame = parse_frame(text); },
       [](const S& s) { return frame_of(s.loads.frame); }},
      {"load-units", nullptr, false, "FORCE-LENGTH", nullptr, kTables,
       "Units of the table: N-m, N-mm, kN-m, ... [the model's; OpenSim's: N-m]",
       [](S& s, Text, Text text) { s.loads.units = text; }, [](const S& s) { return word_or_nothing(s.loads.units); }},
      {"body-weight", nullptr, false, "NUMBER", "FORCE", kTables,
       "Columns are in % of this body weight (a force, in the model's unit)",
       [](S& s, Text, Text text) { s.loads.body_weight = parse_positive(text); },
       [](const S& s) { return number_or_nothing(s.loads.body_weight); }},
      {"motion", nullptr, false, "FILE", nullptr, kTables,
       "Poses of one body, one state per row: columns tx, ty, tz and, if it turns, rx, ry, rz, from its starting pose, "
       "in global axes; or 4x4 matrices, NAME_T11 to NAME_T44; these motions are prescribed",
       [](S& s, Text, Text text) { s.motion.file = text; }, [](const S& s) { return word_or_nothing(s.motion.file); }},
      {"motion-body", nullptr, false, "BODY", nullptr, kTables,
       "The body that the motion moves; it turns about its centre of mass or the point of {rotate-about}",
       [](S& s, Text, Text text) { s.motion.body = text; }, [](const S& s) { return word_or_nothing(s.motion.body); }},
      {"motion-columns", nullptr, false, "TX,TY,TZ[,RX,RY,RZ]|NAME_T[,OTHER_T]", nullptr, kTables,
       "Names of the columns; NAME_T: of 4x4 matrices, NAME_T11 to NAME_T44; NAME_T,OTHER_T: the body relative to the "
       "other one, which is held [found by name]",
       [](S& s, Text, Text text) { s.motion.columns = text; },
       [](const S& s) { return word_or_nothing(s.motion.columns); }},
      {"motion-rotation", nullptr, false, "vector|xyz|zxy|...", nullptr, kTables,
       "What rx, ry, rz are: a rotation vector, or angles about x, y and z, applied in the order given (zxy: z first), "
       "each about the body's axis as turned so far",
       [](S& s, Text, Text text) { s.motion.rotation = parse_rotation(text); },
       [](const S& s) { return word_or_nothing(s.motion.rotation); }},
      {"motion-units", nullptr, false, "ANGLE-LENGTH", nullptr, kTables,
       "Units of the table: deg-mm, rad-m, ...; of matrices the length alone: m [must be given if the body turns by "
       "angles; OpenSim files say degrees or radians, m]",
       [](S& s, Text, Text text) { s.motion.units = text; },
       [](const S& s) { return word_or_nothing(s.motion.units); }},
      {"motion-start", nullptr, false, "own-frame|TIME[,ground]", nullptr, kTables,
       "Of matrices: what the model's coordinates of the body are before it moves. own-frame: those of its own frame; "
       "TIME: where the row at this time has it, relative to the other body if two are named; TIME,ground: where that "
       "row has both bodies [own-frame]",
       [](S& s, Text, Text text) { s.motion.start = parse_start(text); },
       [](const S& s) { return word_or_nothing(s.motion.start); }},
      {"frame", "name", false, "x,y,z/x,y,z/x,y,z", nullptr, kFrames,
       "Axes x, y, z of a frame in global directions, for frame:NAME in {rotate}, {move}, {force} and {load-frame}; "
       "`dea "
       "build` makes frames from landmarks; may be repeated",
       [](S& s, Text key, Text text) {
         if (key.find(',') != std::string::npos) throw bad_value(key, "a frame's name without a comma");
         s.frames[key] = parse_axes(text);
       },
       [](const S& s) { return by_name(s.frames); }},
  };
}

/// Of a surface's thickness what the weaker source says the other way: as one number, or by a file.
void leave_thickness_to(Settings& settings, const SettingValue& v) {
  const std::string name = v.option->name;
  if (name == "thickness" && v.key.empty()) settings.thickness_from.clear();
  if (name == "thickness") settings.thickness_from.erase(v.key);
  if (name == "thickness-from") settings.thickness.erase(v.key);
}

}  // namespace

const std::vector<SettingOption>& setting_options() {
  static const std::vector<SettingOption> options = all_options();
  return options;
}

const SettingOption* find_setting_option(const std::string& name) {
  for (const SettingOption& o : setting_options())
    if (name == o.name) return &o;
  return nullptr;
}

Aliases setting_aliases() {
  static constexpr Alias kAliases[] = {
      {"modulus", "E"},      {"young", "E"},           {"youngs-modulus", "E"},      {"elastic-modulus", "E"},
      {"poisson", "nu"},     {"poissons-ratio", "nu"}, {"poisson-ratio", "nu"},      {"v", "nu"},
      {"translate", "move"}, {"turn", "rotate"},       {"ligament-stiffness", "set"}};
  return kAliases;
}

std::string key_form(const SettingOption& option) {
  const std::string key = option.key;
  if (key == "body") return "BODY";
  if (key == "surface") return "SURFACE";
  return std::string(option.name) == "set" ? "NAME.PARAMETER" : "NAME";
}

std::string setting_keyword(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::string value_form(const SettingOption& option) {
  const std::string value = option.help_value != nullptr ? option.help_value : option.value;
  if (option.key == nullptr) return value;
  const std::string key = key_form(option) + "=";
  return (option.per_surface != nullptr ? fmt::format("[{}]", key) : key) + value;
}

std::string placement_text(const Placement& p) {
  return fmt::format("{}={}{},{},{}{}", p.body, p.frame.empty() ? "" : fmt::format("frame:{},", p.frame), p.vector.x(),
                     p.vector.y(), p.vector.z(),
                     p.kind == Placement::Kind::Rotate ? fmt::format(",{}", p.degrees) : "");
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
    leave_thickness_to(settings, v);
    if (v.option->places)  // the body's placements of the weaker source
      std::erase_if(settings.placements, [&](const Placement& p) { return p.body == v.key; });
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
