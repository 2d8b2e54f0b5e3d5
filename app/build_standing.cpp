#include "app/build_standing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/build_names.h"
#include "io/build/ligaments.h"
#include "io/build/placement.h"
#include "io/tables/read_tables.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/rotations.h"
#include "src/base/time_text.h"
#include "src/equilibrium/rows.h"
#include "src/model/settings_table.h"
#include "views/text/table.h"

namespace dea {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// As dea run reads --free.
DofFlags dofs_argument(const char* option, const std::string& text, const std::string& dofs) {
  return argument(option, text, [&](const std::string&) {
    Settings settings;
    find_setting_option("free")->set(settings, "", dofs);
    return settings.free[""];
  });
}

// ---- free, held, moved ---------------------------------------------------------------------------------------------

void add_free(const BuildArguments& a, BuildRequest& request) {
  for (const std::string& text : a.frees) {
    const Named n = named("free", text, "BODY=x,y,z,Ru,Rv,Rw");
    BoneRequest& bone = request.bones[at(bone_of(request, "free", n.name))];
    refuse_second("free", text, bone.dofs_given);
    const DofFlags free = dofs_argument("free", text, n.value);
    bone.dofs_given = true;
    for (std::size_t k = 0; k < kDofs; ++k) {
      bone.held[k] = !free[k];
      if (free[k]) bone.fixed = false;
    }
  }
}

/// What a word of a table of poses says, as dea run reads it. `option`: under which it was typed.
MotionTable motion_word(const char* setting, const char* option, const std::string& given, const std::string& word) {
  Settings settings;
  if (!word.empty())
    argument(option, given, [&](const std::string&) {
      find_setting_option(setting)->set(settings, "", word);
      return 0;
    });
  return settings.motion;
}

void add_motion(const BuildArguments& a, BuildInputs& inputs) {
  MotionTable& motion = inputs.sources.motion;
  motion.columns = a.motion_columns;
  motion.units = a.motion_units;
  const auto word = [](const char* option, const std::string& given) {
    return motion_word(option, option, given, given);
  };
  motion.rotation = word("motion-rotation", a.motion_rotation).rotation;
  motion.start = word("motion-start", a.motion_start).start;
  if (a.motions.empty()) return;
  if (a.motions.size() > 1)
    throw wrong("motion", a.motions[1], fmt::format("a second table of poses beside {}", a.motions[0]),
                "one, for one bone; give its poses relative to the other bone (--motion-columns NAME_T,OTHER_T), or "
                "leave the other free (--free)");
  const Named n = named("motion", a.motions.front(), "BODY=FILE");
  BoneRequest& bone = inputs.request.bones[at(bone_of(inputs.request, "motion", n.name))];
  motion.file = n.value;
  motion.body = n.name;
  bone.fixed = false;
  if (!bone.dofs_given) bone.held.fill(true);  // read_loads says which the table moves
  bone.dofs_given = true;
  inputs.files.push_back({"--motion", n.value});
}

void add_holds(const BuildArguments& a, BuildRequest& request) {
  for (const std::string& text : a.holds) {
    const Named n = named("hold", text, "BODY=x,y");
    BoneRequest& bone = request.bones[at(bone_of(request, "hold", n.name))];
    if (bone.fixed) throw wrong("hold", text, "a bone without a force, which is held as a whole", "a loaded one");
    if (bone.dofs_given) {
      const auto names_it = [&](const char* option, const std::vector<std::string>& given) {
        return std::any_of(given.begin(), given.end(),
                           [&](const std::string& word) { return named(option, word, "BODY=").name == n.name; });
      };
      const bool free = names_it("free", a.frees), moved = names_it("motion", a.motions);
      throw wrong("hold", text,
                  fmt::format("{} for this bone too, which {} what is held",
                              free && moved ? "--free and --motion"
                              : free        ? "--free"
                                            : "--motion",
                              free && moved ? "say" : "says"),
                  free && moved ? "no --hold" : "one of them");
    }
    const DofFlags held = dofs_argument("hold", text, n.value);
    for (std::size_t k = 0; k < kDofs; ++k) bone.hold[k] = bone.hold[k] || held[k];
    if (bone.hold[0] && bone.hold[1] && bone.hold[2])
      throw wrong("hold", text, "all three directions", "one that is left to the force");
  }
}

void refuse_what_moves_nothing(const BuildArguments& a, const BuildInputs& inputs) {
  const auto& bones = inputs.request.bones;
  const auto pressed = [](const BoneRequest& b) { return !b.force.isZero(0); };
  const auto pulled = [&](const BoneRequest& b) {
    bool free = false;
    for (std::size_t k = 0; k < kDofs; ++k) free = free || b.free(k);
    return free && !a.ligaments.empty();
  };
  if (a.loads.empty() && a.motions.empty() && std::none_of(bones.begin(), bones.end(), pressed) &&
      std::none_of(bones.begin(), bones.end(), pulled))
    throw UsageError(fmt::format(
        "{}, expected --force BODY=x,y,z or --loads BODY=FILE: it presses one bone against the others, which are held; "
        "or --motion BODY=FILE, which moves one",
        a.forces.empty() ? "no force is given" : fmt::format("--force {}: found a force of zero", a.forces.front())));
  const auto rests = [&](const BoneRequest& b) { return b.fixed || b.name == inputs.sources.motion.body; };
  if (std::none_of(bones.begin(), bones.end(), rests))
    throw UsageError(fmt::format("--{}: found a load for every bone, expected one bone without, which is held",
                                 !a.forces.empty()  ? "force"
                                 : !a.loads.empty() ? "loads"
                                                    : "free"));
}

// ---- where they stand ----------------------------------------------------------------------------------------------

/// What follows "NAME=" of --place.
struct PlaceText {
  bool inverse = false;
  std::string file;        ///< empty: numbers
  std::optional<int> row;  ///< of a table, from 1 on
  std::vector<double> numbers;
};

PlaceText place_text(const std::string& text, std::string value) {
  PlaceText place;
  const std::string inverse = "inverse:";
  if (value.starts_with(inverse)) {
    place.inverse = true;
    value = value.substr(inverse.size());
  }
  if (!value.empty() && value.find_first_not_of("0123456789+-.eE, ") == value.npos) {
    place.numbers = argument("place", text, [&](const std::string&) { return parse_numbers(value); });
    if (place.numbers.size() != 3 && place.numbers.size() != 16)
      throw wrong("place", text, fmt::format("{} numbers", place.numbers.size()),
                  "a translation x,y,z [mm], the 16 numbers of a 4x4 matrix row by row, or a file");
    return place;
  }
  const std::size_t colon = value.rfind(':');
  if (colon != value.npos && colon + 1 < value.size() &&
      value.find_first_not_of("0123456789", colon + 1) == value.npos) {
    place.row = argument("place", text,
                         [&](const std::string&) { return parse_count(value.substr(colon + 1), 1, 1000000000); });
    value = value.substr(0, colon);
  }
  if (value.empty()) throw wrong("place", text, "no file", "NAME=FILE, NAME=FILE:ROW or NAME=x,y,z");
  place.file = value;
  return place;
}

/// The table's settings without the table are refused.
void refuse_idle_motion(const BuildArguments& a) {
  if (!a.motions.empty()) return;
  for (const auto& [option, text] :
       {std::pair{"motion-columns", &a.motion_columns}, std::pair{"motion-rotation", &a.motion_rotation},
        std::pair{"motion-units", &a.motion_units}, std::pair{"motion-start", &a.motion_start}})
    if (!text->empty()) throw wrong(option, *text, "no table", "--motion BODY=FILE too");
}

/// How the tables are read of which --place takes a row.
void add_place_tables(const BuildArguments& a, BuildInputs& inputs) {
  const auto each = [&](const char* option, const std::vector<std::string>& texts, const auto& take) {
    std::vector<char> seen(inputs.request.bones.size(), 0);
    for (const std::string& text : texts) {
      const Named n = named(option, text, "NAME=VALUE");
      const std::size_t bone = at(bone_of(inputs.request, option, n.name));
      refuse_second(option, text, seen[bone] != 0);
      seen[bone] = 1;
      MotionTable& table = inputs.sources.place_tables[bone];
      if (table.file.empty())
        throw wrong(option, text, "no table for this bone", fmt::format("--place {}=FILE:ROW too", n.name));
      take(table, text, n.value);
    }
  };
  using Text = const std::string&;
  each("place-columns", a.place_columns, [](MotionTable& table, Text, Text value) { table.columns = value; });
  each("place-units", a.place_units, [](MotionTable& table, Text, Text value) { table.units = value; });
  each("place-rotation", a.place_rotations, [](MotionTable& table, Text text, Text value) {
    table.rotation = motion_word("motion-rotation", "place-rotation", text, value).rotation;
  });
}

/// A setting of the table under the name that it has for a placed bone: --place-units ball=m for --motion-units m.
NamedSetting of_place(NamedSetting setting, const std::string& bone, const std::string& row) {
  const std::string motion = "motion";
  if (!setting.setting.starts_with(motion)) return setting;
  if (setting.setting == motion) setting.value += row;
  setting.setting = "place" + setting.setting.substr(motion.size());
  setting.of = bone;
  return setting;
}

Fault of_place(Fault fault, const std::string& bone, const std::string& row) {
  if (fault.given) {
    fault.given = of_place(*fault.given, bone, row);
    fault.given->bare = true;
  }
  for (Sentence* words : {&fault.found, &fault.expected})
    for (NamedSetting& setting : words->settings) setting = of_place(setting, bone, row);
  return fault;
}

/// A row of a table of poses as dea run --motion reads it; about the origin of the bone's own axes.
Isometry3d row_pose(const std::string& text, const std::string& bone, int given_row, MotionTable& table,
                    const BuildInputs& inputs) {
  Settings settings;
  settings.motion = table;
  settings.motion.body = bone;
  JointModel units;
  units.units = inputs.model.units;
  const std::string row_text = fmt::format(":{}", given_row);
  try {
    read_tables(units, settings);
  } catch (const UsageError& e) {
    throw UsageError(of_place(e.fault, bone, row_text));
  } catch (const InputError& e) {
    throw InputError(of_place(e.fault, bone, row_text));
  }
  table = settings.motion;
  const std::size_t rows = table.motion.size(), row = static_cast<std::size_t>(given_row);
  if (row > rows) throw wrong("place", text, fmt::format("row {} of a table with {}", row, rows), "one that it has");
  const auto& numbers = table.motion[row - 1];
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation(numbers.tail<3>());
  pose.translation() = numbers.head<3>();
  return pose;
}

/// An ITK transform says where a point of the joint's axes comes from; in LPS axes.
Isometry3d from_itk(const Isometry3d& itk, ScanAxes axes) {
  if (axes == ScanAxes::LPS) return itk.inverse();
  const Eigen::DiagonalMatrix<double, 3> turned_over(-1, -1, 1);
  Isometry3d ras = Isometry3d::Identity();
  ras.linear() = turned_over * itk.linear() * turned_over;
  ras.translation() = turned_over * itk.translation();
  return ras.inverse();
}

std::string pose_words(const Isometry3d& pose) {
  const Vector3d turn = rotation_vector(pose.linear());
  const double angle = turn.norm();
  return fmt::format("{}moved by {} mm",
                     angle < 1e-12 ? ""
                                   : fmt::format("turned by {:.4g} degrees about {} through the origin, then ",
                                                 angle * kDegreesPerRadian, vector_text(turn / angle)),
                     vector_text(pose.translation()));
}

Isometry3d read_place(const std::string& text, const Named& named, BuildInputs& inputs, std::string& how) {
  const PlaceText place = place_text(text, named.value);
  Isometry3d pose = Isometry3d::Identity();
  double corrected = 0;
  if (place.row) {
    MotionTable& table = inputs.sources.place_tables[at(bone_of(inputs.request, "place", named.name))];
    pose = row_pose(text, named.name, *place.row, table, inputs);
    how = fmt::format("row {} of {}", *place.row, table.words);
  } else if (place.numbers.size() == 3) {
    pose.translation() = Vector3d(place.numbers[0], place.numbers[1], place.numbers[2]);
    how = "as given";
  } else {
    const FilePose read = place.file.empty()
                              ? argument("place", text, [&](const std::string&) { return pose_of(place.numbers); })
                              : read_pose(place.file);
    pose = read.pose;
    corrected = read.corrected;
    how = place.file.empty() ? "as given" : place.file;
    if (read.itk) {
      const ScanAxes axes = inputs.anatomy.scan_axes.value_or(ScanAxes::LPS);
      pose = from_itk(pose, axes);
      how += fmt::format(
          ", a transform of ITK or Slicer, which says where points come from, and so was turned round; "
          "the bones' axes taken as {} (--scan-axes)",
          name(axes));
    } else if (!place.file.empty()) {
      pose.translation() *= inputs.sources.scale;
    }
  }
  if (place.inverse) {
    pose = pose.inverse();
    how += "; the other way round (inverse:)";
  }
  constexpr double kTold = 1e-9;
  if (corrected > kTold) how += fmt::format("; its rotation was off by up to {:.1g} and made exact", corrected);
  return pose;
}

/// The ligaments with their ends where the bones stand.
void add_ligaments(const BuildArguments& a, BuildInputs& inputs, std::vector<std::string>& findings) {
  if (a.ligaments.empty()) return;
  const std::string length = !a.scale.empty() ? "" : a.units.empty() ? "mm" : a.units;
  const BuildSources& sources = inputs.sources;
  int by_strain = 0, toes = 0;
  for (const LigamentRow& row : read_ligaments(a.ligaments, length)) {
    const auto refuse = [&](const std::string& what) {
      throw InputError(a.ligaments, row.line, row.name + ": " + what);
    };
    const std::vector<std::string> names = bone_names(inputs.request);
    const auto bone = [&](const char* column, const std::string& name) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        refuse(fmt::format("{}: no bone has the name \"{}\"{}; bones are {}", column, name, did_you_mean(name, names),
                           name_list(names)));
      return static_cast<int>(found - names.begin());
    };
    BuiltLigament l;
    l.name = row.name;
    l.bone_a = bone("body_a", row.bone_a);
    l.bone_b = bone("body_b", row.bone_b);
    if (l.bone_a == l.bone_b) refuse("found one bone at both ends, expected two");
    l.point_a = sources.poses[at(l.bone_a)] * (sources.scale * row.point_a);
    l.point_b = sources.poses[at(l.bone_b)] * (sources.scale * row.point_b);
    if (!(length_of(l) > 0)) refuse("found both ends at one place, expected them apart");
    l.stiffness = row.stiffness;
    l.toe_strain = row.toe_strain;
    l.slack_length =
        row.slack_length ? sources.scale * *row.slack_length : slack_length(length_of(l), *row.reference_strain);
    by_strain += row.reference_strain.has_value();
    toes += row.toe_strain > 0;
    inputs.request.ligaments.push_back(l);
  }
  const std::size_t count = inputs.request.ligaments.size();
  findings.push_back(fmt::format(
      "ligaments: {}: {}{}; they only pull, along straight lines{}{}", a.ligaments, count,
      count == 1 ? " bundle" : " bundles", toes > 0 ? fmt::format("; {} by Blankevoort's curve, with a toe", toes) : "",
      by_strain > 0 ? fmt::format("; slack lengths of {} from their strain where the bones stand (slack_length gives "
                                  "it for another position)",
                                  by_strain)
                    : ""));
}

// ---- tables --------------------------------------------------------------------------------------------------------

void refuse_other_times(const std::string& motion, const LoadTable& loads, const MotionTable& poses) {
  const auto &a = loads.time, &b = poses.time;
  bool same = a.size() == b.size();
  for (std::size_t r = 0; same && r < a.size(); ++r)
    same = std::abs(a[r] - b[r]) <= 1e-6 * std::max({std::abs(a.front()), std::abs(a.back()), 1e-300});
  if (!same)
    throw wrong("motion", motion,
                fmt::format("{} rows, {} to {}, and {} rows of loads, {} to {}", b.size(), time_text(b.front()),
                            time_text(b.back()), a.size(), time_text(a.front()), time_text(a.back())),
                "both tables with the same times");
}

/// Where the rows are in the model, and how dea run leaves out what is before them.
std::string row_words(std::size_t rows) {
  return fmt::format(
      "the model has row i, counted from 1, at time 1 + i; dea run --states {} has {} alone, without the step that "
      "seats "
      "the bones",
      rows == 1 ? "2" : fmt::format("2:{}", rows + 1), rows == 1 ? "it" : "these");
}

void take_loads(const LoadTable& loads, BuildInputs& inputs, std::vector<std::string>& findings) {
  BoneRequest& bone = inputs.request.bones[at(bone_of(inputs.request, "loads", loads.body))];
  findings.push_back(fmt::format("{}: loads of {}; {}", loads.body, loads.words, row_words(loads.time.size())));
  if (!loads.doubt.empty()) findings.push_back(fmt::format("{}: body weight: {}", loads.body, loads.doubt));
  bool moments = false;
  for (const auto& load : loads.load) {
    bone.forces.push_back(load.head<3>());
    bone.moments.push_back(load.tail<3>());
    moments = moments || !load.tail<3>().isZero(0);
  }
  if (!moments) bone.moments.clear();
  bone.force = bone.forces.front();
  inputs.load_times = loads.time;
}

void take_motion(const MotionTable& motion, BuildInputs& inputs, std::vector<std::string>& findings) {
  BoneRequest& bone = inputs.request.bones[at(bone_of(inputs.request, "motion", motion.body))];
  const std::string given = fmt::format("{}={}", motion.body, motion.file);
  DofFlags free;
  std::string passed_over;
  for (std::size_t k = 0; k < kDofs; ++k) {
    free[k] = bone.free(k);
    const bool in_table = k < 3 || motion.turns;
    if (in_table && free[k]) passed_over += fmt::format("{}{}", passed_over.empty() ? "" : ", ", kDofNames[k]);
    bone.moved[k] = in_table && !free[k];
    if (bone.moved[k]) bone.held[k] = false;
  }
  if ((free[3] || free[4] || free[5]) && (bone.moved[3] || bone.moved[4] || bone.moved[5]))
    throw wrong("motion", given,
                "some rotations of the table and others free (--free), which FEBio cannot say of one body",
                "all three free or none; free those of the other bone");
  bone.motion = motion.motion;
  bone.about_origin = motion.about_origin;
  inputs.load_times = motion.time;
  findings.push_back(
      fmt::format("{}: motion of {}, from where it stands{}; {}{}", motion.body, motion.words,
                  motion.about_origin ? "" : ", about its centre", row_words(motion.time.size()),
                  passed_over.empty() ? "" : fmt::format("; its {} not used, which --free leaves free", passed_over)));
}

}  // namespace

void add_standing(const BuildArguments& a, BuildInputs& inputs) {
  BuildRequest& request = inputs.request;
  inputs.sources.placed.assign(request.bones.size(), 0);
  inputs.sources.poses.assign(request.bones.size(), Isometry3d::Identity());
  inputs.sources.place_tables.resize(request.bones.size());
  for (const std::string& text : a.places) {
    const Named n = named("place", text, "NAME=FILE, NAME=FILE:ROW or NAME=x,y,z");
    const std::size_t bone = at(bone_of(request, "place", n.name));
    refuse_second("place", text, inputs.sources.placed[bone] != 0);
    inputs.sources.placed[bone] = 1;
    const PlaceText place = place_text(text, n.value);
    if (place.row) inputs.sources.place_tables[bone].file = place.file;
    if (!place.file.empty()) inputs.files.push_back({"--place", place.file});
  }
  if (!a.places.empty() && !a.mirror.empty())
    throw UsageError("--place and --mirror: found both, expected one of them; place the whole joint's files");
  add_free(a, request);
  add_place_tables(a, inputs);
  refuse_idle_motion(a);
  add_motion(a, inputs);
  add_holds(a, request);
  if (!a.ligaments.empty()) inputs.files.push_back({"--ligaments", a.ligaments});
  refuse_what_moves_nothing(a, inputs);
}

std::vector<std::string> read_placements(const BuildArguments& a, BuildInputs& inputs) {
  std::vector<std::string> findings;
  for (const std::string& text : a.places) {
    const Named n = named("place", text, "NAME=FILE");
    Isometry3d& pose = inputs.sources.poses[at(bone_of(inputs.request, "place", n.name))];
    std::string how;
    pose = read_place(text, n, inputs, how);
    findings.push_back(fmt::format("{}: placed: {} ({})", n.name, pose_words(pose), how));
  }
  add_ligaments(a, inputs, findings);
  return findings;
}

std::vector<std::string> read_loads(BuildInputs& inputs) {
  std::vector<std::string> findings;
  Settings settings;
  settings.loads = inputs.sources.loads;
  if (!inputs.sources.motion.file.empty()) settings.motion = inputs.sources.motion;
  JointModel units;
  units.units = inputs.model.units;
  read_tables(units, settings);
  const bool loads = !settings.loads.file.empty(), motion = !settings.motion.file.empty();
  if (loads && motion)
    refuse_other_times(settings.motion.body + "=" + settings.motion.file, settings.loads, settings.motion);
  inputs.sources.motion = settings.motion;
  if (loads) take_loads(settings.loads, inputs, findings);
  if (motion) take_motion(settings.motion, inputs, findings);
  return findings;
}

Findings doubtful_matrices(const BuildInputs& inputs) {
  const double size = size_of_bones(inputs.request.bones);
  Findings found;
  const auto look = [&](MotionTable table, const NamedSetting& give) {
    table.doubt = matrices_in_doubt(table, size);
    add_once(found, matrix_units(table, give));
  };
  for (std::size_t b = 0; b < inputs.sources.place_tables.size(); ++b)
    look(inputs.sources.place_tables[b], {"place-units", inputs.request.bones[b].name, "m"});
  look(inputs.sources.motion, {"motion-units", "", "m"});
  return found;
}

std::vector<std::string> held_forces(const BuildRequest& request) {
  std::vector<std::string> findings;
  for (const BoneRequest& bone : request.bones) {
    const std::vector<Vector3d> forces = bone.forces.empty() ? std::vector<Vector3d>{bone.force} : bone.forces;
    for (const Vector3d& force : forces) {
      if (bone.fixed || force.isZero(0)) continue;
      Vector3d held = Vector3d::Zero();
      for (int c = 0; c < 3; ++c)
        if (bone.dofs_given ? !bone.free(at(c)) : bone.hold[at(c)]) held[c] = force[c];
      if (held.isZero(0)) continue;
      const char* option = !bone.motion.empty() ? "motion" : bone.dofs_given ? "free" : "hold";
      if (held == force && !bone.turns_freely())
        throw UsageError(fmt::format("--{} {}: found a force {} that is held altogether, expected one that presses",
                                     option, bone.name, vector_text(force)));
      findings.push_back(fmt::format("{}: {} of the force {} goes into what holds the bone (--{}), not into the joint",
                                     bone.name, vector_text(held), vector_text(force), option));
    }
  }
  return findings;
}

}  // namespace dea
