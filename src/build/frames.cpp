#include "src/build/frames.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/say.h"

namespace dea {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Landmarks that are known; `sided`: R or L may stand before the name.
struct Known {
  const char* name;
  bool sided;
};
constexpr Known kKnown[] = {{"RASIS", false}, {"LASIS", false}, {"RPSIS", false}, {"LPSIS", false},
                            {"HJC", true},    {"MFE", true},    {"LFE", true},    {"MC", true},
                            {"LC", true},     {"MM", true},     {"LM", true}};

/// "R.ASIS " is RASIS.
std::string bare(const std::string& name) {
  std::string letters;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return letters;
}

/// Which landmark a name means.
struct Meaning {
  const Known* known = nullptr;
  std::optional<BodySide> side;
};
Meaning meaning_of(const std::string& name) {
  const std::string word = bare(name);
  for (const Known& k : kKnown)
    if (word == k.name) return {&k, {}};
  if (word.empty() || (word[0] != 'R' && word[0] != 'L')) return {};
  for (const Known& k : kKnown)
    if (k.sided && word.substr(1) == k.name) return {&k, word[0] == 'R' ? BodySide::Right : BodySide::Left};
  return {};
}

/// The landmark of this name: that of the side, or the one without a side.
std::optional<Vector3d> find(const std::vector<Landmark>& landmarks, const std::string& name,
                             std::optional<BodySide> side = {}) {
  std::optional<Vector3d> found;
  for (const Landmark& l : landmarks) {
    const Meaning m = meaning_of(l.name);
    if (m.known == nullptr || name != m.known->name) continue;
    if (m.side && side && *m.side != *side) continue;
    if (!found || m.side) found = l.point;
  }
  return found;
}

/// Landmarks with one of these names and R or L before it, as their file has them; `of`: of this side.
std::vector<std::string> names_of_sides(const std::vector<Landmark>& landmarks, const std::vector<std::string>& names,
                                        BodySide of) {
  std::vector<std::string> found;
  for (const Landmark& l : landmarks) {
    const Meaning m = meaning_of(l.name);
    if (m.known != nullptr && m.side == of && std::find(names.begin(), names.end(), m.known->name) != names.end())
      found.push_back(l.name);
  }
  return found;
}

/// All of these, or none of them.
std::vector<Vector3d> all_or_none(const std::vector<Landmark>& landmarks, const char* bone,
                                  const std::vector<std::string>& names, std::optional<BodySide> side) {
  std::vector<Vector3d> points;
  std::vector<std::string> there, missing;
  for (const std::string& name : names) {
    const std::optional<Vector3d> point = find(landmarks, name, side);
    (point ? there : missing).push_back(name);
    if (point) points.push_back(*point);
  }
  if (there.empty()) return points;
  const std::vector<std::string> right = names_of_sides(landmarks, names, BodySide::Right),
                                 left = names_of_sides(landmarks, names, BodySide::Left);
  if (!right.empty() && !left.empty() && (!missing.empty() || !side))
    throw InputError(
        Fault{.found = say("landmarks of the {}: found {} of the right and {} of the left,", bone,
                           fmt::format("{}", fmt::join(right, ", ")), fmt::format("{}", fmt::join(left, ", "))),
              .expected = missing.empty() && right.size() == names.size() && left.size() == names.size()
                              ? say("expected the joint's side too: {}", NamedSetting{"side", "", "left|right"})
                              : say("expected {} of one side", fmt::format("{}", fmt::join(names, ", ")))});
  if (missing.empty()) return points;
  throw InputError(fmt::format("landmarks of the {}: found {} without {}, expected all of {}, or none of them", bone,
                               fmt::join(there, ", "), fmt::join(missing, ", "), fmt::join(names, ", ")));
}

/// Unit; what is too short to be a direction is refused. `size`: of the landmarks.
Vector3d direction(const Vector3d& v, double size, const char* bone, const char* what) {
  constexpr double kLeast = 0.02;  // two degrees between the lines: a slip of the mouse turns the frame as far
  if (!(v.norm() > kLeast * size))
    throw InputError(
        fmt::format("landmarks of the {}: found {} on one line, or at one place, expected a triangle", bone, what));
  return v.normalized();
}

Matrix3d columns(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  Matrix3d axes;
  axes << x, y, z;
  return axes;
}

/// y along `up`, z across it and towards the right of the body, in the plane of both.
Matrix3d axes_of_limb(const Vector3d& up, const Vector3d& medial, const Vector3d& lateral, BodySide side,
                      const char* bone, const char* what) {
  const Vector3d y = up.normalized();
  const Vector3d right = lateral_sign(side) * (lateral - medial);
  const Vector3d z = direction(right - right.dot(y) * y, right.norm(), bone, what);
  return columns(y.cross(z), y, z);
}

void refuse_twice(const std::vector<Landmark>& landmarks) {
  std::set<std::pair<std::string, int>> seen;
  for (const Landmark& l : landmarks) {
    const Meaning m = meaning_of(l.name);
    if (m.known == nullptr) continue;
    if (!seen.insert({m.known->name, m.side ? static_cast<int>(*m.side) : -1}).second)
      throw InputError(fmt::format("landmarks: found \"{}\" twice, expected it once", l.name));
  }
}

void tell_unused(const std::vector<Landmark>& landmarks, FramesFound& found) {
  std::vector<std::string> known;
  for (const Known& k : kKnown) known.push_back(k.name);
  std::string unused;
  for (const Landmark& l : landmarks)
    if (meaning_of(l.name).known == nullptr)
      unused += fmt::format("{}\"{}\"{}", unused.empty() ? "" : ", ", l.name, did_you_mean(bare(l.name), known));
  if (!unused.empty())
    found.findings.push_back(fmt::format(
        "landmarks that no frame needs: {}; known are {}, all but the first four also with R or L before them", unused,
        fmt::join(known, ", ")));
}

/// Landmarks of a limb of which nobody says the side.
InputError no_side(const char* found) {
  return InputError(Fault{.found = say("landmarks of the {},", found),
                          .expected = say("expected their side too: R or L before a name, as in RMFE, or {}",
                                          NamedSetting{"side", "", "left|right"})});
}

void add_pelvis(const FramesRequest& request, FramesFound& found) {
  const std::optional<Matrix3d> axes = pelvis_axes(request.landmarks);
  if (!axes) return;
  const Vector3d middle = (*find(request.landmarks, "RASIS") + *find(request.landmarks, "LASIS")) / 2;
  if (request.hip_center) {
    const Vector3d hip = axes->transpose() * (*request.hip_center - middle);
    if (hip.y() > 0)
      throw InputError(fmt::format(
          "landmarks of the pelvis: found the hip's centre {:.3g} above the front spines, expected it below "
          "them; are right and left, or front and back, exchanged?",
          hip.y()));
    if (request.side && hip.z() * lateral_sign(*request.side) < 0)
      throw InputError(
          fmt::format("landmarks of the pelvis: found the hip's centre on the {} of the middle of RASIS and LASIS, "
                      "expected it on the {}, the joint's side; are the landmarks in the bones' axes?",
                      hip.z() > 0 ? "right" : "left", name(*request.side)));
  }
  found.frames.push_back(
      {"pelvis", request.hip_center.value_or(middle), *axes,
       fmt::format("RASIS, LASIS, RPSIS, LPSIS; origin: {}",
                   request.hip_center ? request.hip_center_words : "the middle of RASIS and LASIS")});
}

void add_femur(const FramesRequest& request, FramesFound& found) {
  const std::vector<Vector3d> ends = all_or_none(request.landmarks, "femur", {"MFE", "LFE"}, request.side);
  if (ends.empty()) {
    if (request.has_femur)
      found.findings.push_back("no frame of the femur: found no landmarks MFE and LFE, its epicondyles");
    return;
  }
  if (!request.hip_center) {
    found.findings.push_back(
        "no frame of the femur: found neither a landmark HJC, the hip's centre, nor a ball in a socket to find it by");
    return;
  }
  if (!request.side) throw no_side("femur: found MFE and LFE");
  const Matrix3d axes = axes_of_limb(*request.hip_center - (ends[0] + ends[1]) / 2, ends[0], ends[1], *request.side,
                                     "femur", "MFE, LFE and the hip's centre");
  found.frames.push_back(
      {"femur", *request.hip_center, axes, fmt::format("MFE, LFE; origin: {}", request.hip_center_words)});
}

void add_tibia(const FramesRequest& request, FramesFound& found) {
  const std::vector<Vector3d> p = all_or_none(request.landmarks, "tibia", {"MC", "LC", "MM", "LM"}, request.side);
  if (p.empty()) return;
  if (!request.side) throw no_side("tibia: found MC, LC, MM and LM");
  const Vector3d knee = (p[0] + p[1]) / 2, ankle = (p[2] + p[3]) / 2;
  const Matrix3d axes = axes_of_limb(knee - ankle, p[0], p[1], *request.side, "tibia", "MC, LC and the ankle's middle");
  found.frames.push_back({"tibia", knee, axes, "MC, LC, MM, LM; origin: the middle of MC and LC"});
}

/// Bones of one body that stand: their right is on the same side.
void refuse_opposite(const FramesFound& found) {
  for (const AnatomicalFrame& a : found.frames)
    for (const AnatomicalFrame& b : found.frames)
      if (&a < &b && a.axes.col(2).dot(b.axes.col(2)) < 0)
        throw InputError(
            fmt::format("landmarks: found the right of the {} opposite to that of the {}, expected them alike; are "
                        "medial and lateral, or right and left, exchanged?",
                        b.name, a.name));
}

}  // namespace

double lateral_sign(BodySide side) { return side == BodySide::Right ? 1.0 : -1.0; }

std::optional<Matrix3d> pelvis_axes(const std::vector<Landmark>& landmarks) {
  const std::vector<Vector3d> p = all_or_none(landmarks, "pelvis", {"RASIS", "LASIS", "RPSIS", "LPSIS"}, {});
  if (p.empty()) return std::nullopt;
  const Vector3d across = p[0] - p[1], forward = (p[0] + p[1] - p[2] - p[3]) / 2;
  const double size = std::max(across.norm(), forward.norm());
  const char* what = "RASIS, LASIS and the middle of RPSIS and LPSIS";
  const Vector3d z = direction(across, size, "pelvis", what);
  const Vector3d x = direction(forward - forward.dot(z) * z, size, "pelvis", what);
  return columns(x, z.cross(x), z);
}

std::vector<Landmark> front_spines(const std::vector<Landmark>& landmarks) {
  const std::optional<Vector3d> right = find(landmarks, "RASIS"), left = find(landmarks, "LASIS");
  if (!right || !left) return {};
  return {{"RASIS", *right}, {"LASIS", *left}};
}

std::optional<BodySide> side_of(const std::vector<Landmark>& landmarks) {
  std::optional<BodySide> side;
  for (const Landmark& l : landmarks) {
    const Meaning m = meaning_of(l.name);
    if (!m.side) continue;
    if (side && *side != *m.side) return std::nullopt;  // of both
    side = m.side;
  }
  return side;
}

std::string sided_names(const std::vector<Landmark>& landmarks) {
  std::vector<std::string> names;
  for (const Landmark& l : landmarks)
    if (meaning_of(l.name).side) names.push_back(l.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::optional<Vector3d> hip_center(const std::vector<Landmark>& landmarks, std::optional<BodySide> side) {
  if (!side && find(landmarks, "HJC", BodySide::Right) != find(landmarks, "HJC", BodySide::Left)) return std::nullopt;
  return find(landmarks, "HJC", side);
}

FramesFound make_frames(const FramesRequest& request) {
  refuse_twice(request.landmarks);
  FramesFound found;
  tell_unused(request.landmarks, found);
  add_pelvis(request, found);
  add_femur(request, found);
  add_tibia(request, found);
  refuse_opposite(found);
  return found;
}

}  // namespace dea
