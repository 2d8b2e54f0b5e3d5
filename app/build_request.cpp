#include "app/build_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/build_names.h"
#include "app/build_standing.h"
#include "io/build/landmarks.h"
#include "io/settings/settings_xml.h"
#include "io/surfaces/read_surface.h"
#include "io/tables/table.h"
#include "src/base/names.h"
#include "src/build/mend_surface.h"

namespace dea {

namespace {

using Way = CartilageRequest::Way;

/// The model has parts of these names.
void refuse_names_of_parts(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (name == "cartilage") throw wrong("bone", name, "the name of the cartilage's material", "another");
    for (const std::string& other : names)
      for (const char* part : {"_cartilage", "_bone", "_ligament_ends"})
        if (name.rfind(other + part, 0) == 0)
          throw wrong("bone", name, fmt::format("a name that a part of \"{}\" has in the model", other), "another");
  }
}

double not_negative(const char* option, const std::string& text) {
  const double value = number_argument(option, text);
  if (!(value >= 0)) throw wrong_word(option, text, "0 or more");
  return value;
}

/// Its place among the request's.
std::size_t add_cartilage(BuildRequest& request, const char* option, const std::string& name, Way way) {
  const int bone = bone_of(request, option, name);
  for (const CartilageRequest& c : request.cartilages)
    if (c.bone == bone)
      throw wrong(option, name, "a second cartilage of this bone", "one (--cartilage, --uniform, --thickness-at)");
  CartilageRequest c;
  c.bone = bone;
  c.way = way;
  request.cartilages.push_back(c);
  return request.cartilages.size() - 1;
}

/// "max=2,min=0.5" for all bones that have no cartilage yet.
void add_half_gap(const std::string& text, BuildRequest& request) {
  double most = 0, least = -1;
  for (const std::string& part : split_at_commas(text)) {
    const Named n = named("half-gap", part, "max=A,min=B");
    if (n.name != "max" && n.name != "min") throw wrong("half-gap", text, fmt::format("\"{}\"", n.name), "max=A,min=B");
    (n.name == "max" ? most : least) = positive_argument("half-gap", n.value);
  }
  if (!(most > 0) || !(least > 0) || least > most) throw wrong_word("half-gap", text, "max=A,min=B with A above B");
  bool any = false;
  for (std::size_t b = 0; b < request.bones.size(); ++b) {
    const auto own = [&](const CartilageRequest& c) { return c.bone == static_cast<int>(b); };
    if (std::any_of(request.cartilages.begin(), request.cartilages.end(), own)) continue;
    CartilageRequest& c = request.cartilages[add_cartilage(request, "half-gap", request.bones[b].name, Way::HalfGap)];
    c.most = most;
    c.least = least;
    any = true;
  }
  if (!any)
    throw UsageError(fmt::format("--half-gap {}: every bone has its cartilage already, expected one without", text));
}

/// `text`: the whole option; `value`: without the bone's name.
GivenRegion region_of(const std::string& text, const std::string& value) {
  GivenRegion region;
  const bool sphere = value.rfind("sphere:", 0) == 0, plane = value.rfind("plane:", 0) == 0;
  if (!sphere && !plane) {
    region.kind = GivenRegion::Kind::Surface;
    return region;
  }
  const FramedText framed = argument("region", value.substr(value.find(':') + 1), split_frame);
  region.frame = framed.frame;
  const std::vector<double> v = argument("region", framed.rest, parse_numbers);
  if (v.size() != (sphere ? 4U : 6U))
    throw wrong("region", text, fmt::format("{} numbers", v.size()),
                sphere ? "sphere:x,y,z,r or sphere:frame:NAME,x,y,z,r"
                       : "plane:x,y,z,nx,ny,nz or plane:frame:NAME,x,y,z,nx,ny,nz");
  region.kind = sphere ? GivenRegion::Kind::Sphere : GivenRegion::Kind::Plane;
  region.point = {v[0], v[1], v[2]};
  if (sphere) {
    region.radius = v[3];
    if (!(v[3] > 0)) throw wrong("region", text, fmt::format("a radius of {}", v[3]), "one above 0");
  } else {
    region.normal = {v[3], v[4], v[5]};
    if (!(region.normal.norm() > 0)) throw wrong("region", text, "a normal of no length", "a direction");
    region.normal.normalize();
  }
  return region;
}

void add_loads(const BuildArguments& a, BuildInputs& inputs) {
  BuildRequest& request = inputs.request;
  for (const std::string& text : a.forces) {
    const Named n = named("force", text, "BODY=x,y,z");
    BoneRequest& bone = request.bones[at(bone_of(request, "force", n.name))];
    const FramedText framed = argument("force", n.value, split_frame);
    refuse_second("force", text, !bone.fixed);
    bone.fixed = false;
    bone.force = vector_argument("force", framed.rest);
    bone.force_frame = framed.frame;
  }
  if (!a.loads.empty()) {
    const Named n = named("loads", a.loads, "BODY=FILE");
    BoneRequest& bone = request.bones[at(bone_of(request, "loads", n.name))];
    if (!bone.fixed) throw wrong("loads", a.loads, "--force for this bone too", "one of them");
    bone.fixed = false;
    inputs.files.push_back({"--loads", n.value});
    LoadTable& loads = inputs.sources.loads;
    loads.file = n.value;
    loads.body = n.name;
    loads.columns = a.load_columns;
    loads.units = a.load_units;
    if (!a.body_weight.empty()) loads.body_weight = positive_argument("body-weight", a.body_weight);
  } else {
    for (const auto& [option, text] :
         {std::pair{"load-columns", &a.load_columns}, std::pair{"load-units", &a.load_units},
          std::pair{"body-weight", &a.body_weight}})
      if (!text->empty()) throw wrong(option, *text, "no table", "--loads BODY=FILE too");
  }
  for (const std::string& text : a.centers) {
    const Named n = named("center", text, "BODY=x,y,z");
    BoneRequest& bone = request.bones[at(bone_of(request, "center", n.name))];
    refuse_second("center", text, bone.center.has_value());
    bone.center = vector_argument("center", n.value);
  }
}

void set_mesh(const BuildArguments& a, BuildRequest& request) {
  if (!a.reach.empty()) request.reach = positive_argument("reach", a.reach);
  if (!a.rim.empty()) request.rim_length = not_negative("rim", a.rim);
  if (!a.fade.empty()) request.fade = not_negative("fade", a.fade);
  if (!a.edge.empty()) request.edge = positive_argument("edge", a.edge);
  if (!a.least.empty()) request.least_thickness = positive_argument("least", a.least);
  if (!a.layers.empty()) request.elements_through = count_argument("layers", a.layers, 1, 50);
  request.fill_holes = !a.keep_holes;
  request.whole_bones = a.bone_shells != "none";
  if (!a.bone_shells.empty() && a.bone_shells != "none" && a.bone_shells != "shell")
    request.most_bone_triangles = static_cast<std::size_t>(count_argument("bones", a.bone_shells, 100, 100000000));
  if (!a.primary.empty()) {
    bone_of(request, "primary", a.primary);
    request.primary = a.primary;
  }
}

/// Side, axes and bones of a hip as they are said.
void set_anatomy(const BuildArguments& a, const BuildRequest& request, AnatomyRequest& anatomy) {
  if (!a.side.empty()) {
    if (a.side != "left" && a.side != "right") throw wrong_word("side", a.side, "left or right", {"left", "right"});
    anatomy.side = a.side == "left" ? BodySide::Left : BodySide::Right;
  }
  if (!a.scan_axes.empty()) {
    const std::string word = lower_case(a.scan_axes);
    if (word != "lps" && word != "ras") throw wrong_word("scan-axes", a.scan_axes, "LPS or RAS", {"LPS", "RAS"});
    anatomy.scan_axes = word == "lps" ? ScanAxes::LPS : ScanAxes::RAS;
  }
  anatomy.hip = a.hip != "none";
  if (!a.hip.empty() && anatomy.hip) {
    const std::vector<std::string> names = split_at_commas(a.hip);
    if (names.size() != 2) throw wrong_word("hip", a.hip, "two bones, SOCKET,HEAD, or none");
    anatomy.socket = bone_of(request, "hip", names[0]);
    anatomy.head = bone_of(request, "hip", names[1]);
    if (anatomy.socket == anatomy.head) throw wrong("hip", a.hip, "one bone twice", "two bones, SOCKET,HEAD");
  }
  if (!anatomy.hip && !a.hip_figure.empty())
    throw UsageError("--hip-figure and --hip none: found both, expected one of them");
  if (a.landmarks.empty() && !a.frames.empty())
    throw wrong("frames", a.frames, "no landmarks to make frames of", "--landmarks FILE");
  if (a.landmarks.empty() && a.flip_landmarks)
    throw UsageError("--flip-landmarks: found no landmarks, expected --landmarks FILE");
  if (a.landmarks.empty() && !a.landmark_units.empty())
    throw wrong("landmark-units", a.landmark_units, "no landmarks", "--landmarks FILE");
}

double millimetres(const char* option, const std::string& unit) {
  if (unit == "m") return 1000;
  if (unit == "cm") return 10;
  if (unit == "mm") return 1;
  throw wrong_word(option, unit, "mm, cm or m", {"mm", "cm", "m"});
}

double scale_of(const BuildArguments& a) {
  if (!a.scale.empty() && !a.units.empty()) throw UsageError("--scale and --units: found both, expected one of them");
  if (!a.scale.empty()) return positive_argument("scale", a.scale);
  return a.units.empty() ? 1 : millimetres("units", a.units);
}

/// Bones of a joint are some cm to some dm long. What was taken for granted; empty: nothing.
std::string refuse_size(const BuildArguments& a, const BuildRequest& request) {
  const double size = size_of_bones(request.bones);
  if (!a.units.empty() || !a.scale.empty()) {
    constexpr double kLeast = 0.5, kMost = 10000;  // a finger's joint of a mouse, a whale's jaw
    if (size >= kLeast && size <= kMost) return "";
    throw InputError(
        fmt::format("found bones {:.3g} mm large in the unit that was given, expected {:g} to {:g}: is it "
                    "the files' unit? ({})",
                    size, kLeast, kMost, a.units.empty() ? "--scale" : "--units"));
  }
  if (size >= 10 && size <= 2000)
    return fmt::format("units: mm, by the size of the largest bone, {:.4g} (--units)", size);
  const char* looks = size < 1.5 ? "m" : size < 10 ? "cm" : "micrometres";
  throw InputError(
      fmt::format("found bones no larger than {:.4g}, expected mm, 10 to 2000: these look like {}; {} says what they "
                  "are, --units mm that "
                  "they are mm",
                  size, looks, size < 10 ? fmt::format("--units {}", looks) : std::string("--scale 0.001")));
}

std::vector<MirrorPlane> mirrors_of(const BuildArguments& a) {
  std::vector<MirrorPlane> mirrors;
  if (a.mirror.empty()) return mirrors;
  for (const std::string& part : split_at_commas(a.mirror)) {
    const Named n = named("mirror", part, "x=0, y=0 or z=0, with commas");
    const std::size_t axis = std::string("xyz").find(n.name);
    if (n.name.size() != 1 || axis == std::string::npos)
      throw wrong("mirror", a.mirror, fmt::format("\"{}\"", n.name), "x, y or z");
    mirrors.push_back({static_cast<int>(axis), argument("mirror", n.value, parse_number)});
  }
  return mirrors;
}

/// A sphere or a plane must be its own mirror image: surfaces are completed, these are not.
void refuse_lopsided(const std::string& text, const GivenRegion& region, const std::vector<MirrorPlane>& mirrors) {
  if (region.kind == GivenRegion::Kind::Surface) return;
  for (const MirrorPlane& mirror : mirrors) {
    constexpr double kOff = 1e-6;  // typed numbers
    const bool own = region.kind == GivenRegion::Kind::Sphere
                         ? std::abs(region.point[mirror.axis] - mirror.at) <= kOff * region.radius
                         : std::abs(region.normal[mirror.axis]) <= kOff;
    if (!own || !region.frame.empty())
      throw wrong("region", text,
                  fmt::format("a region on one side of {}={:g} (--mirror)", "xyz"[mirror.axis], mirror.at),
                  "one that is its own mirror image, or a surface, which is completed");
  }
}

/// The surface and its image. Points by the plane go onto it, so that both sides join there.
void add_image(const std::string& path, const MirrorPlane& mirror, TriangleSurface& s) {
  const Eigen::AlignedBox3d box = box_of(s);
  const double tolerance = 1e-4 * box.diagonal().norm(), low = box.min()[mirror.axis] - mirror.at,
               high = box.max()[mirror.axis] - mirror.at;
  if (low < -tolerance && high > tolerance)
    throw InputError(path, 0,
                     fmt::format("found points on both sides of {}={:g}, from {:.4g} to {:.4g}, expected one side of "
                                 "the plane that --mirror names",
                                 "xyz"[mirror.axis], mirror.at, box.min()[mirror.axis], box.max()[mirror.axis]));
  for (Eigen::Vector3d& x : s.points)
    if (std::abs(x[mirror.axis] - mirror.at) <= tolerance) x[mirror.axis] = mirror.at;
  TriangleSurface image = s;
  for (Eigen::Vector3d& x : image.points) x[mirror.axis] = 2 * mirror.at - x[mirror.axis];
  for (auto& t : image.triangles) std::swap(t[1], t[2]);
  s.append(image);
}

/// `bone`: with which it is placed.
MendedSurface read_mended(const std::string& path, const BuildSources& sources, std::size_t bone,
                          const std::string& what, std::vector<std::string>& findings) {
  TriangleSurface surface = read_surface(path);
  for (Eigen::Vector3d& x : surface.points) x *= sources.scale;
  if (sources.placed[bone])
    for (Eigen::Vector3d& x : surface.points) x = sources.poses[bone] * x;
  for (const MirrorPlane& mirror : sources.mirrors) add_image(path, mirror, surface);
  MendedSurface mended = mend_surface(surface);
  const std::size_t triangles = mended.surface.triangles.size();
  if (triangles == 0 && mended.faults.islands > 0)
    throw InputError(path, 0,
                     fmt::format("found {} loose parts, none of them 1 % of the whole area, expected a surface whose "
                                 "triangles share their corners; merge its points where it was made",
                                 mended.faults.islands));
  if (triangles < 4)
    throw InputError(path, 0,
                     fmt::format("found {} triangle{} with area, expected a surface of four or more", triangles,
                                 triangles == 1 ? "" : "s"));
  const std::vector<std::string> faults = fault_words(mended.faults);
  findings.push_back(fmt::format("{}: {}: {} triangles{}{}", what, path, triangles, faults.empty() ? "" : "; ",
                                 fmt::join(faults, ", ")));
  return mended;
}

/// Completed by their mirror images, as surfaces are.
void read_points(const std::string& path, const BuildSources& sources, CartilageRequest& c) {
  const NumberTable table = read_table(path);
  int column[4];
  const char* names[] = {"x", "y", "z", "thickness"};
  for (int i = 0; i < 4; ++i) {
    column[i] = find_column(table, names[i]);
    if (column[i] < 0)
      throw InputError(path, 0, fmt::format("found no column \"{}\", expected x, y, z, thickness", names[i]));
  }
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto value = [&](int i) { return sources.scale * table.rows[r][at(column[i])]; };
    if (!(value(3) > 0))
      throw InputError(path, table.lines[r], fmt::format("found a thickness of {}, expected one above 0", value(3)));
    c.places.push_back(sources.poses[at(c.bone)] * Eigen::Vector3d(value(0), value(1), value(2)));
    c.thickness_there.push_back(value(3));
  }
  for (const MirrorPlane& mirror : sources.mirrors) {
    const std::size_t points = c.places.size();
    for (std::size_t i = 0; i < points; ++i) {
      Eigen::Vector3d image = c.places[i];
      image[mirror.axis] = 2 * mirror.at - image[mirror.axis];
      c.places.push_back(image);
      c.thickness_there.push_back(c.thickness_there[i]);
    }
  }
}

void read_all_landmarks(const BuildArguments& a, BuildInputs& inputs, std::vector<std::string>& findings) {
  AnatomyRequest& anatomy = inputs.anatomy;
  std::string axes;
  for (const auto& [bone, path] : inputs.sources.landmarks) {
    const LandmarkFile file = read_landmarks(path);
    if (!axes.empty() && !file.axes.empty() && axes != file.axes)
      throw InputError(path, 0,
                       fmt::format("found landmarks in {}, and in {} before, expected one of them", file.axes, axes));
    if (!file.axes.empty()) axes = file.axes;
    for (Landmark l : file.landmarks) {
      l.point *= anatomy.landmark_scale;
      l.file = path;
      if (a.flip_landmarks) l.point.head<2>() *= -1;
      if (bone >= 0) l.point = inputs.sources.poses[at(bone)] * l.point;
      anatomy.landmarks.push_back(l);
    }
    findings.push_back(
        fmt::format("landmarks: {}: {}{}{}{}", path, file.landmarks.size(),
                    file.axes.empty() ? "" : fmt::format(", in {} as it says", file.axes),
                    a.flip_landmarks ? ", x and y turned over" : ", taken in the bones' axes",
                    bone >= 0 ? fmt::format(", placed with {}", inputs.request.bones[at(bone)].name) : ""));
  }
}

}  // namespace

BuildInputs build_inputs(const BuildArguments& a) {
  BuildInputs inputs;
  BuildRequest& request = inputs.request;
  BuildSources& sources = inputs.sources;
  sources.scale = scale_of(a);
  sources.mirrors = mirrors_of(a);
  for (const std::string& text : a.bones) {
    const Named n = named("bone", text, "NAME=FILE");
    const std::vector<std::string> names = bone_names(request);
    if (std::find(names.begin(), names.end(), n.name) != names.end())
      throw wrong("bone", text, fmt::format("the name \"{}\" twice", n.name), "another");
    BoneRequest bone;
    bone.name = n.name;
    request.bones.push_back(bone);
    sources.bones.push_back(n.value);
    inputs.files.push_back({"--bone", n.value});
  }
  if (request.bones.size() < 2)
    throw UsageError("--bone: found fewer than two, expected --bone NAME=FILE for each bone of the joint");
  refuse_names_of_parts(bone_names(request));
  for (const std::string& text : a.cartilages) {
    const Named n = named("cartilage", text, "NAME=FILE");
    sources.outer.push_back({add_cartilage(request, "cartilage", n.name, Way::Segmented), n.value});
    inputs.files.push_back({"--cartilage", n.value});
  }
  for (const std::string& text : a.uniform) {
    const Named n = named("uniform", text, "NAME=T");
    const std::size_t c = add_cartilage(request, "uniform", n.name, Way::Uniform);
    request.cartilages[c].thickness = positive_argument("uniform", n.value);
  }
  for (const std::string& text : a.thickness_at) {
    const Named n = named("thickness-at", text, "NAME=FILE");
    sources.places.push_back({add_cartilage(request, "thickness-at", n.name, Way::Points), n.value});
    inputs.files.push_back({"--thickness-at", n.value});
  }
  if (!a.half_gap.empty()) add_half_gap(a.half_gap, request);
  if (request.cartilages.empty())
    throw UsageError(
        "no cartilage is given, expected --cartilage, --uniform, --half-gap or --thickness-at for one bone at least");
  for (const std::string& text : a.regions) {
    const Named n = named("region", text, "NAME=FILE, NAME=sphere:x,y,z,r or NAME=plane:x,y,z,nx,ny,nz");
    const int bone = bone_of(request, "region", n.name);
    const auto own = [&](const CartilageRequest& c) { return c.bone == bone && c.way != Way::Segmented; };
    const auto c = std::find_if(request.cartilages.begin(), request.cartilages.end(), own);
    if (c == request.cartilages.end())
      throw UsageError(
          fmt::format("--region {}: the bone has no cartilage that is made here, expected --uniform, --half-gap or "
                      "--thickness-at for it",
                      text));
    refuse_second("region", text, c->region.has_value());
    c->region = region_of(text, n.value);
    refuse_lopsided(text, *c->region, sources.mirrors);
    if (c->region->kind != GivenRegion::Kind::Surface) continue;
    sources.regions.push_back({static_cast<std::size_t>(c - request.cartilages.begin()), n.value});
    inputs.files.push_back({"--region", n.value});
  }
  inputs.anatomy.landmark_scale =
      a.landmark_units.empty() ? sources.scale : millimetres("landmark-units", a.landmark_units);
  for (const std::string& text : a.landmarks) {
    const std::vector<std::string> names = bone_names(request);
    const std::size_t cut = text.find('=');
    const auto bone =
        std::find(names.begin(), names.end(), trimmed(text.substr(0, cut)));  // a file's name may have '='
    LandmarkSource source{-1, text};
    if (cut != text.npos && bone != names.end())
      source = {static_cast<int>(bone - names.begin()), trimmed(text.substr(cut + 1))};
    sources.landmarks.push_back(source);
    inputs.files.push_back({"--landmarks", source.path});
  }
  request.wording = inputs.anatomy.wording = command_line_wording();
  add_loads(a, inputs);
  add_standing(a, inputs);
  set_mesh(a, request);
  set_anatomy(a, request, inputs.anatomy);
  if (!a.E.empty()) inputs.model.E = positive_argument("E", a.E);
  if (!a.nu.empty()) inputs.model.nu = not_negative("nu", a.nu);
  if (inputs.model.nu >= 0.5) throw wrong_word("nu", a.nu, "a number below 0.5");
  if (!a.penalty.empty()) inputs.model.penalty = positive_argument("penalty", a.penalty);
  return inputs;
}

std::vector<std::string> read_surfaces(const BuildArguments& a, BuildInputs& inputs) {
  std::vector<std::string> findings;
  BuildRequest& request = inputs.request;
  const BuildSources& sources = inputs.sources;
  for (std::size_t b = 0; b < request.bones.size(); ++b) {
    MendedSurface mended = read_mended(sources.bones[b], sources, b, request.bones[b].name, findings);
    request.bones[b].closed = mended.closed();
    request.bones[b].surface = std::move(mended.surface);
  }
  if (!sources.mirrors.empty())
    findings.push_back(
        "all surfaces completed by their mirror images: forces are those of the whole joint, of each of its parts 1/" +
        std::to_string(std::size_t{1} << sources.mirrors.size()));
  const std::string units = refuse_size(a, request);
  if (!units.empty()) findings.push_back(units);
  const auto bone_name = [&](const CartilageRequest& c) { return request.bones[at(c.bone)].name; };
  for (const CartilageFile& file : sources.outer) {
    CartilageRequest& c = request.cartilages[file.cartilage];
    c.outer = read_mended(file.path, sources, at(c.bone), bone_name(c) + " cartilage", findings).surface;
  }
  for (const CartilageFile& file : sources.places) read_points(file.path, sources, request.cartilages[file.cartilage]);
  for (const CartilageFile& file : sources.regions) {
    CartilageRequest& c = request.cartilages[file.cartilage];
    c.region->surface = read_mended(file.path, sources, at(c.bone), bone_name(c) + " region", findings).surface;
  }
  read_all_landmarks(a, inputs, findings);
  return findings;
}

}  // namespace dea
