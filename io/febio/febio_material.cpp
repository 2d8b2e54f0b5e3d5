// FEBio's materials reduced to small-strain E and nu.
#include "io/febio/febio_material.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include "io/febio/febio_rules.h"
#include "io/febio/known_words.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/model/load_curve.h"

namespace dea {

namespace {

using febio::Component;
using febio::find;
using febio::one_of;
using febio::quote;

/// What is the same for a material and all that is nested in it.
struct Reading {
  JointModel& model;
  const std::string& name;
  bool nested_k_adds;
  std::vector<Axes> axes = {};  ///< of what it is nested in
  std::string path = {};        ///< the same, as data of elements name it
};

/// A part of the material that has no place in E and nu. `instead`: what is taken.
void leave_out(const Reading& reading, const Component& part, const std::string& what, const char* instead) {
  reading.model.ignored.push_back(
      {fmt::format("material {}: {}; {}", quote(reading.name), what, instead), 1, part.origin, {}});
}

constexpr const char* kGroundMatrix =
    "what is pressed of a layer is the matrix around them; what a part that gives way has of them is told by "
    "part-fibres";
constexpr const char* kMatrixNote = "ground matrix without its fibres";

/// Small-strain stiffness of a material or of a part of one. E and nu are those of G and lambda.
struct Stiffness {
  std::string type = {};  ///< nested types after a slash
  double E = kNaN, nu = kNaN;
  double G = kNaN, lambda = kNaN;
  std::string note = {};
  /// An uncoupled material: its bulk stiffness is a number of its own, K = k.
  bool uncoupled = false;
  double k = 0.0;
  std::vector<Fibres> fibres = {};
  std::vector<StiffnessInAxes> in_axes = {};  ///< what comes to that of G and lambda, of G and k if it is uncoupled
  bool fluid = false;
};

void add_note(std::string& note, const std::string& more) {
  if (more.empty() || note.find(more) != note.npos) return;
  if (!note.empty()) note += "; ";
  note += more;
}

/// The value, or `fallback` if there is none of this name; NaN with the reason added to `why` if it is not one number.
double constant_of(const Component& material, const char* name, double fallback, std::string& why) {
  const Component* part = find(material, name);
  if (part == nullptr) return fallback;
  const std::string &kind = part->type, &text = part->text;
  const auto value = febio::whole_double(text);
  const bool math = kind == "math" || (kind.empty() && !value);
  if (math && !part->lc && part->parts.empty() && expression_fault(text, {}).empty()) {
    try {
      return constant_value(text);
    } catch (const InputError& error) {
      add_note(why, fmt::format("{}: {}", name, error.what()));
    }
  } else if (!kind.empty() && kind != "const") {
    add_note(why, fmt::format("{} is a {}, not one number", name, quote(kind)));
  } else if (part->lc) {
    add_note(why, fmt::format("{} follows a load controller", name));
  } else if (value) {
    return *value;
  } else {
    add_note(why, fmt::format("{} = {} is not one number{}", name, quote(febio::trim(text)),
                              has_decimal_comma(text) ? ": write it with a decimal point" : ""));
  }
  return kNaN;
}

Stiffness unknown(const std::string& type, const std::string& why) { return {.type = type, .note = why}; }

void set_from_E_nu(Stiffness& s, double E, double nu) {
  s.E = E;
  s.nu = nu;
  s.G = E / (2 * (1 + nu));
  s.lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
}

void set_from_G_lambda(Stiffness& s, double G, double lambda) {
  const double K = lambda + 2 * G / 3;
  s.G = G;
  s.lambda = lambda;
  s.E = 9 * K * G / (3 * K + G);
  s.nu = (3 * K - 2 * G) / (2 * (3 * K + G));
  if (!(G > 0 && K > 0)) s.E = s.nu = kNaN;  // a part alone may have none; a whole material gets a note
}

/// Sum of c1 .. c6 (those given).
double sum_of_c(const Component& material, std::string& why) {
  double sum = 0.0;
  for (const char* name : {"c1", "c2", "c3", "c4", "c5", "c6"}) sum += constant_of(material, name, 0.0, why);
  return sum;
}

Stiffness stiffness_of(const Reading& reading, const Component& material);

/// Whole numbers in a text, "1,2,3"; fewer where there are none.
std::vector<int> node_places(const std::string& text) {
  std::vector<int> places;
  std::string_view rest = text;
  double value = 0.0;
  do {
    if (febio::take_double(rest, value) != febio::Number::Ok) break;
    places.push_back(static_cast<int>(value) - 1);
  } while (febio::take_comma(rest));
  return places;
}

std::optional<Vector3d> vector_in(const std::string& text) {
  std::string_view rest = text;
  Vector3d v;
  for (int k = 0; k < 3; ++k)
    if ((k > 0 && !febio::take_comma(rest)) || febio::take_double(rest, v[k]) != febio::Number::Ok) return std::nullopt;
  if (!(v.norm() > 0)) return std::nullopt;
  return v;
}

/// The unit vector of this name; `fallback`: there is none.
std::optional<Vector3d> unit_vector_of(const Component& of, const char* name, const Vector3d& fallback) {
  const Component* part = find(of, name);
  if (part == nullptr) return fallback;
  const auto v = vector_in(part->text);
  return v ? std::optional<Vector3d>(v->normalized()) : std::nullopt;
}

/// `center`, `axis` and `vector` of what is cylindrical or spherical, where FEBio has these defaults; are they known?
bool read_around(const Component& given, Vector3d& center, Vector3d& axis, Vector3d& vector) {
  const auto along = unit_vector_of(given, "axis", Vector3d::UnitZ()),
             turned = unit_vector_of(given, "vector", Vector3d::UnitX());
  if (const Component* part = find(given, "center")) {
    std::string_view rest = part->text;
    for (int k = 0; k < 3; ++k)
      if ((k > 0 && !febio::take_comma(rest)) || febio::take_double(rest, center[k]) != febio::Number::Ok) return false;
  }
  if (!along || !turned) return false;
  axis = *along;
  vector = *turned;
  return true;
}

/// theta and phi [degrees] of type `angles`, FEBio's from z; nothing: they are no numbers.
std::optional<std::array<double, 2>> angles_of(const Component& given) {
  std::string why;
  const double degree = std::acos(-1.0) / 180;
  const double theta = degree * constant_of(given, "theta", 0.0, why),
               phi = degree * constant_of(given, "phi", 90.0, why);
  if (!why.empty()) return std::nullopt;
  return std::array<double, 2>{theta, phi};
}

/// <fiber>: FEBio's default is along x.
Direction direction_of(const Component& material) {
  Direction of;
  const Component* fiber = find(material, "fiber");
  if (fiber == nullptr) return of;
  of.by = Direction::By::Unknown;
  const std::string& type = fiber->type;
  const Component* inside = find(*fiber, "vector");
  if (type == "cylindrical" || type == "spherical") {
    if (read_around(*fiber, of.center, of.axis, of.vector))
      of.by = type == "spherical" ? Direction::By::Spherical : Direction::By::Cylindrical;
  } else if (type == "angles") {
    if (const auto angles = angles_of(*fiber)) {
      const auto [theta, phi] = *angles;
      of.by = Direction::By::Vector;
      of.vector = Vector3d(std::cos(theta) * std::sin(phi), std::sin(theta) * std::sin(phi), std::cos(phi));
    }
  } else if (const auto v = vector_in(inside != nullptr ? inside->text : fiber->text);
             v && (type.empty() || type == "vector")) {
    of.by = Direction::By::Vector;
    of.vector = v->normalized();
  } else if (const std::vector<int> places = node_places(fiber->text); type == "local" && places.size() >= 2) {
    of.by = Direction::By::Nodes;
    of.nodes = {places[0], places[1]};
    if (of.nodes[0] < 0 && of.nodes[1] < 0) of.nodes = {0, 1};  // "0,0"
  } else if (type == "user" || type == "map") {
    of.by = Direction::By::Element;
    of.map = febio::trim(fiber->text);
  }
  return of;
}

/// <mat_axis>
Axes axes_of(const Component& given) {
  Axes axes;
  axes.by = Axes::By::Unknown;
  const std::string& type = given.type;
  const Component *a = find(given, "a"), *d = find(given, "d");
  const auto along = a ? vector_in(a->text) : Vector3d(Vector3d::UnitX());
  const auto across = d ? vector_in(d->text) : Vector3d(Vector3d::UnitY());
  if (type == "cylindrical" || type == "spherical") {
    if (read_around(given, axes.center, axes.axis, axes.a))
      axes.by = type == "spherical" ? Axes::By::Spherical : Axes::By::Cylindrical;
  } else if (type == "angles") {
    if (const auto angles = angles_of(given)) {
      const auto [theta, phi] = *angles;
      axes.by = Axes::By::Vectors;
      axes.a = Vector3d(std::cos(theta) * std::sin(phi), std::sin(theta) * std::sin(phi), std::cos(phi));
      axes.d = Vector3d(-std::sin(theta), std::cos(theta), 0);
    }
  } else if ((type == "vector" || (type.empty() && a != nullptr)) && along && across) {
    axes.by = Axes::By::Vectors;
    axes.a = *along;
    axes.d = *across;
    if (!axes_from(axes.a, axes.d))
      axes.d = std::abs(along->normalized().x()) > 0.999 ? Vector3d::UnitY() : Vector3d::UnitX();
  } else if (const std::vector<int> places = node_places(given.text); type == "local" && places.size() >= 3) {
    axes.by = Axes::By::Nodes;
    axes.nodes = {places[0], places[1], places[2]};
    if (places[0] < 0 && places[1] < 0 && places[2] < 0) axes.nodes = {0, 1, 3};  // "0,0,0"
    if (axes.nodes[2] < 0) axes.nodes[2] = axes.nodes[1];                         // "1,2,0"
  } else if (type == "user" || type == "map") {
    axes.by = Axes::By::Element;
  }
  return axes;
}

/// The axes of a material, which are told in those of what it is nested in.
std::vector<Axes> axes_within(const Reading& reading, const Component& material) {
  std::vector<Axes> axes = reading.axes;
  if (const Component* given = find(material, "mat_axis")) axes.push_back(axes_of(*given));
  return axes;
}

/// The law of fibres and its constants; NaN leaves it unknown.
void set_law(Fibres& fibres, const Component& m) {
  const std::string& type = m.type_or_tag();
  std::string why;
  const auto constant = [&](const char* name, double fallback) { return constant_of(m, name, fallback, why); };
  using Law = Fibres::Law;
  const bool coupled = type.rfind("coupled", 0) == 0;
  if (coupled || type.rfind("trans iso", 0) == 0 || type.find("fiber-exp-linear") != type.npos) {
    fibres.law = Law::ExpLinear;
    const char* end = find(m, "lam_max") != nullptr ? "lam_max" : "lambda";
    fibres.c = {constant("c3", 0), constant("c4", 0), constant("c5", 0), constant(end, 1)};
    if (!coupled && fibres.c[0] == 0 && fibres.c[1] > 0)  // FEBio's: the curve is to be smooth
      fibres.c[0] = fibres.c[2] / fibres.c[1] * std::exp(-fibres.c[1] * (fibres.c[3] - 1));
  } else if (one_of(type, {"fiber-exp-pow", "fiber-exp-pow-uncoupled", "fiber-exponential-power-law",
                           "fiber-exponential-power-law-uncoupled"})) {
    if (constant("mu", 0) == 0) fibres.law = Law::ExpPow;  // mu: they resist shear, too
    fibres.c = {constant("alpha", 0), constant("beta", 2), constant("ksi", 0), constant("lam0", 1)};
  } else if (one_of(type, {"fiber-NH", "fiber-NH-uncoupled"})) {
    fibres.law = Law::ExpPow;
    fibres.c = {0, 2, constant("mu", 0) / 2, 1};
  } else if (type == "fiber-pow") {
    fibres.law = Law::ExpPow;
    fibres.c = {0, constant("beta", 2), constant("beta", 2) * constant("ksi", 0), 1};
  } else if (type == "fiber-Kiousis-uncoupled") {
    fibres.law = Law::ExpPow;
    fibres.c = {0, constant("n", 2), constant("d1", 0), std::sqrt(constant("d2", 1))};
  } else if (one_of(type, {"fiber-pow-linear", "fiber-pow-linear-uncoupled", "fiber-exp-pow-linear"})) {
    fibres.c = {constant("alpha", 0), constant("beta", type == "fiber-exp-pow-linear" ? 3 : 2), constant("E", 0),
                constant("lam0", 1)};
    if (fibres.c[3] > 1) fibres.law = Law::ExpPowLinear;
  } else if (type == "fiber-natural-NH") {
    fibres.law = Law::Logarithmic;
    fibres.c = {constant("ksi", 0), 0, 0, constant("lam0", 1)};
  }
  const bool power = fibres.law == Law::ExpPow || fibres.law == Law::ExpPowLinear;
  if (!why.empty() || !(fibres.c[3] >= 1) || (power && !(fibres.c[1] >= 2))) fibres.law = Law::Unknown;
}

/// How the fibres of a continuous distribution are spread; nothing: it is not known.
std::optional<Matrix6d> spread_within(const Component& m, bool deviatoric) {
  const Component* given = find(m, "distribution");
  if (given == nullptr) return std::nullopt;
  std::string why;
  const std::string& type = given->type;
  if (type == "spherical" || type == "circular")
    return spread_of([](const Vector3d&) { return 1.0; }, type == "circular", deviatoric);
  if (type == "ellipsoidal" || type == "elliptical") {
    Vector3d half = Vector3d::Ones();
    if (type == "elliptical")
      half.head<2>() << constant_of(*given, "spa1", 1, why), constant_of(*given, "spa2", 1, why);
    else if (const Component* spa = find(*given, "spa"))
      half = vector_in(spa->text).value_or(Vector3d::Zero());
    if (!why.empty() || !(half.minCoeff() > 0)) return std::nullopt;
    return spread_of([&](const Vector3d& n) { return 1 / n.cwiseQuotient(half).norm(); }, type == "elliptical",
                     deviatoric);
  }
  if (type == "von-Mises-3d" || type == "von-Mises-2d") {
    const double b = constant_of(*given, "b", 0, why);
    if (!why.empty()) return std::nullopt;
    return spread_of([&](const Vector3d& n) { return std::exp(2 * b * (n.x() * n.x() - 1)); }, type == "von-Mises-2d",
                     deviatoric);
  }
  return std::nullopt;
}

/// What is known of the fibres of a material or of a part of a mixture.
Fibres fibres_of(const Reading& reading, const Component& m, bool deviatoric) {
  Fibres fibres;
  fibres.deviatoric = deviatoric;
  fibres.direction = direction_of(m);
  fibres.axes = axes_within(reading, m);
  fibres.path = reading.path;
  if (m.type_or_tag().rfind("continuous fiber distribution", 0) == 0) {
    fibres.spread = spread_within(m, deviatoric);
    if (const Component* one = find(m, "fibers"); one != nullptr && fibres.spread) set_law(fibres, *one);
  } else {
    set_law(fibres, m);
  }
  return fibres;
}

/// The two families of Holzapfel, Gasser and Ogden, at +-gamma from the first axis in the plane of the first two. What
/// `kappa` spreads of them is even in all directions.
Fibres families_of(const Reading& reading, const Component& m, bool deviatoric) {
  Fibres fibres;
  std::string why;
  const auto constant = [&](const char* name) { return constant_of(m, name, 0, why); };
  const double kappa = constant("kappa"), along = 1 - 3 * kappa, gamma = constant("gamma") * std::acos(-1.0) / 180;
  fibres.c = {constant("k2") * along * along, 2, constant("k1") * along * along, 1};
  fibres.axes = axes_within(reading, m);
  fibres.path = reading.path;
  if (!why.empty() || !(along > 1e-6)) return fibres;
  fibres.law = Fibres::Law::ExpPow;
  Matrix6d both = Matrix6d::Zero();
  for (const double turn : {gamma, -gamma})
    both += fibre_stiffness(1.0, deviatoric, Vector3d(std::cos(turn), std::sin(turn), 0), kappa / along);
  fibres.spread = both;
  return fibres;
}

/// Fibres alone: they pull in tension only and leave the small-strain stiffness in compression to the others.
bool is_fibre(const std::string& type) {
  return (type.rfind("fiber", 0) == 0 || type.find("fiber distribution") != type.npos ||
          type.find("-fiber") != type.npos || type.rfind("uncoupled fiber", 0) == 0) &&
         type.find("neo-Hookean") == type.npos && type.find("Mooney") == type.npos;
}

/// Where a constant stands, or the material if it has none.
Origin place_of(const Component& material, const char* name) {
  const Component* part = find(material, name);
  return part == nullptr ? material.origin : part->origin;
}

/// E and v as written; what no material may have is refused here, with its line.
Stiffness from_E_and_v(const Reading& reading, const Component& material) {
  Stiffness s;
  s.type = material.type_or_tag();
  const double E = constant_of(material, "E", 0.0, s.note);
  const double nu = constant_of(material, "v", 0.0, s.note);
  if (!std::isnan(E) && E <= 0) {
    const std::string found = find(material, "E") == nullptr ? "E is missing" : fmt::format("E = {:g}", E);
    throw fault_at(reading.model, place_of(material, "E"),
                   fmt::format("material {}: {}, need E > 0", quote(reading.name), found));
  }
  if (!std::isnan(nu) && !(nu > -1 && nu < 0.5)) {
    throw fault_at(reading.model, place_of(material, "v"),
                   fmt::format("material {}: v = {:g}, need -1 < v < 0.5", quote(reading.name), nu));
  }
  if (find(material, "v") == nullptr)
    reading.model.assumed.push_back(
        {fmt::format("material {}: {} without <v>: 0, as in FEBio", quote(reading.name), quote(s.type)), 1,
         material.origin});
  if (std::isnan(E) || std::isnan(nu)) return s;
  set_from_E_nu(s, E, nu);
  return s;
}

/// The shear modulus of types that have a bulk modulus k of their own; nothing: another type.
std::optional<double> uncoupled_shear(const Component& m, const std::string& type, std::string& note) {
  const auto constant = [&](const char* name) { return constant_of(m, name, 0, note); };
  if (one_of(type, {"Mooney-Rivlin", "trans iso Mooney-Rivlin"})) return 2 * (constant("c1") + constant("c2"));
  if (one_of(type, {"Veronda-Westmann", "trans iso Veronda-Westmann"})) return constant("c1") * constant("c2");
  if (type == "Ogden") return sum_of_c(m, note) / 2;
  if (one_of(type, {"incomp neo-Hookean", "Gent"})) return constant("G");
  if (type == "Yeoh") return 2 * constant("c1");
  if (type == "uncoupled Holmes-Mow") return constant("mu");
  if (type != "Arruda-Boyce") return std::nullopt;
  const double f = 3 / constant("N");
  return constant("mu") * (1 + f * (0.4 + f * (66.0 / 350 + f * (152.0 / 1750 + f * (5190.0 / 134750)))));
}

void set_uncoupled(Stiffness& s, double G, double k) {
  s.uncoupled = true;
  s.k = k;
  s.G = G;
  s.E = s.nu = s.lambda = kNaN;
  if (std::isnan(G) || std::isnan(k)) return;
  set_from_G_lambda(s, G, k - 2 * G / 3);
}

/// Parts of a material with one of these tags, each with what it is to be read with.
std::vector<std::pair<const Component*, Reading>> parts_within(const Reading& reading, const Component& material,
                                                               std::initializer_list<const char*> tags) {
  std::vector<std::pair<const Component*, Reading>> parts;
  std::map<std::string, int> count;
  for (const Component& part : material.parts) {
    if (!one_of(part.tag, tags)) continue;
    Reading inner = reading;
    inner.nested_k_adds = reading.nested_k_adds && material.type_or_tag().rfind("uncoupled", 0) == 0;
    inner.axes = axes_within(reading, material);
    const int index = count[part.tag]++;
    inner.path += (inner.path.empty() ? "" : ".") + part.tag;
    if (index > 0) inner.path += fmt::format("[{}]", index);
    parts.push_back({&part, inner});
  }
  return parts;
}

/// Sum of the parts; `k` is the top-level bulk modulus of an uncoupled mixture.
Stiffness mixture(const Reading& reading, const Component& m) {
  const std::string& type = m.type_or_tag();
  const bool uncoupled = type == "uncoupled solid mixture";
  Stiffness sum;
  double G = 0.0, lambda = 0.0;
  double k = uncoupled ? constant_of(m, "k", 0.0, sum.note) : 0.0;
  std::string types;
  for (const auto& [part, inner] : parts_within(reading, m, {"solid", "elastic", "mat"})) {
    const bool fibre = is_fibre(part->type_or_tag());
    const Stiffness of = fibre ? Stiffness{.type = part->type_or_tag()} : stiffness_of(inner, *part);
    if (!types.empty()) types += "+";
    types += of.type;
    if (fibre) {
      leave_out(reading, *part, fmt::format("the fibres {} of its {}", quote(of.type), quote(type)), kGroundMatrix);
      add_note(sum.note, kMatrixNote);
      sum.fibres.push_back(fibres_of(inner, *part, uncoupled));
      continue;
    }
    add_note(sum.note, of.note);
    sum.fibres.insert(sum.fibres.end(), of.fibres.begin(), of.fibres.end());
    sum.in_axes.insert(sum.in_axes.end(), of.in_axes.begin(), of.in_axes.end());
    G += of.G;
    lambda += of.lambda;
    if (uncoupled && reading.nested_k_adds) k += of.k;
  }
  sum.type = types.empty() ? type : fmt::format("{}/{}", type, types);
  if (G == 0.0 && sum.in_axes.empty()) {
    add_note(sum.note, "no part with a stiffness");
  } else if (uncoupled) {
    set_uncoupled(sum, G, k);
  } else if (!std::isnan(G) && !std::isnan(lambda)) {
    set_from_G_lambda(sum, G, lambda);
  }
  return sum;
}

/// A material that wraps one nested elastic material.
Stiffness wrapped(const Reading& reading, const Component& m) {
  const std::string& type = m.type_or_tag();
  const auto parts = parts_within(reading, m, {"elastic", "solid"});
  if (parts.empty()) return unknown(type, fmt::format("{} without a nested solid", quote(type)));
  Stiffness s = stiffness_of(parts.front().second, *parts.front().first);
  if (std::string unused; constant_of(m, "fixed_charge_density", 0.0, unused) != 0)
    return unknown(fmt::format("{}/{}", type, s.type),
                   "its fixed charges make it swell (fixed_charge_density), at rest too, which has no single E and nu");
  for (const Component& part : m.parts)
    if (part.tag == "solid_bound")
      leave_out(reading, part, fmt::format("<solid_bound> of {}", quote(type)),
                "what is taken is the drained solid without its charge and mass");
  s.type = fmt::format("{}/{}", type, s.type);
  if (type.find("viscoelastic") == type.npos) {
    if (type.find("prestrain") == type.npos) {
      add_note(s.note, "drained solid");
      s.fluid = true;
    }
    if (type.find("prestrain") != type.npos) {
      add_note(s.note, "prestrain left out");
      leave_out(reading, m, fmt::format("the prestrain of {}", quote(type)), "it begins without stress");
    }
    if (type.rfind("uncoupled", 0) == 0) {  // only the nested shear counts
      const double k = constant_of(m, "k", 0.0, s.note);
      set_uncoupled(s, s.G, reading.nested_k_adds ? k + s.k : k);
    }
    return s;
  }
  std::string why;
  const double g0 = constant_of(m, "g0", 1.0, why);
  add_note(s.note, why);
  add_note(s.note, fmt::format("long-term (g0 = {:g})", g0));
  leave_out(reading, m, fmt::format("the relaxation of {}", quote(type)), "what is taken is its long-term stiffness");
  for (Fibres& fibres : s.fibres) fibres.share *= g0;
  for (StiffnessInAxes& part : s.in_axes) part.D *= g0;
  if (type.rfind("uncoupled", 0) == 0) {  // only the shear relaxes
    // In files of every version (FEUncoupledViscoElasticMaterial::Init).
    const double k = constant_of(m, "k", 0.0, s.note) + s.k;
    set_uncoupled(s, s.G * g0, k);
  } else if (!(g0 > 0)) {
    s.E = s.nu = s.G = s.lambda = kNaN;
    add_note(s.note, "no stiffness in the long term");
  } else {
    s.E *= g0;
    s.G *= g0;
    s.lambda *= g0;
  }
  return s;
}

/// The type that is meant. FEBio has others with names like these, which are no slips of the keyboard.
std::string misspelt_type(const std::string& type) {
  constexpr int kMostSlips = 2;
  const std::string meant = nearest_name(type, febio::material_types());
  return edit_distance(type, meant) <= kMostSlips ? meant : "";
}

/// Fung's energies c/2 (exp(q/c) - 1) have the quadratic form q of the orthotropic one: at no strain they are alike,
/// and c does not count.
Stiffness orthotropic(const Reading& reading, const Component& m) {
  Stiffness s;
  s.type = m.type_or_tag();
  s.note = "orthotropic, no single E and nu";
  std::string why, missing;
  const auto constant = [&](const char* name) {
    if (find(m, name) == nullptr) missing += std::string(missing.empty() ? "" : ", ") + name;
    return constant_of(m, name, 0, why);
  };
  const std::array<double, 3> E = {constant("E1"), constant("E2"), constant("E3")},
                              G = {constant("G12"), constant("G23"), constant("G31")},
                              nu = {constant("v12"), constant("v23"), constant("v31")};
  const auto D = orthotropic_stiffness(E, G, nu);
  const double k = constant_of(m, "k", 0.0, why);
  const bool uncoupled = s.type == "Fung orthotropic";
  if (!why.empty()) {
    add_note(s.note, why);
  } else if (!D && !missing.empty()) {
    add_note(s.note, fmt::format("missing: {}", missing));
  } else if (!D) {
    add_note(s.note, "no elastic body has its E1 to v31: need E and G > 0, and v12 < sqrt(E1/E2) and so on");
  } else if (uncoupled && !(k > 0)) {
    add_note(s.note, fmt::format("no stiffness: K = {:g}, need K > 0", k));
  } else {
    s.in_axes.push_back({uncoupled ? deviatoric_stiffness(*D) : *D, axes_within(reading, m)});
    if (uncoupled)
      set_uncoupled(s, 0.0, k);
    else
      set_from_G_lambda(s, 0.0, s.type == "Fung-ortho-compressible" ? k : 0.0);
  }
  return s;
}

Stiffness stiffness_of(const Reading& reading, const Component& m) {
  const std::string& type = m.type_or_tag();
  if (one_of(type, {"neo-Hookean", "isotropic elastic", "St.Venant-Kirchhoff", "natural neo-Hookean",
                    "isotropic Hencky", "Holmes-Mow"})) {
    return from_E_and_v(reading, m);
  }
  if (type == "EFD neo-Hookean") {
    Stiffness s = from_E_and_v(reading, m);
    add_note(s.note, kMatrixNote);
    leave_out(reading, m, fmt::format("the fibres of {}", quote(type)), kGroundMatrix);
    s.fibres.push_back({});
    return s;
  }
  Stiffness s;
  s.type = type;
  if (const std::optional<double> G = uncoupled_shear(m, type, s.note)) {
    if (type.rfind("trans iso", 0) == 0) {
      add_note(s.note, kMatrixNote);
      leave_out(reading, m, fmt::format("the fibres of {}", quote(type)), kGroundMatrix);
      s.fibres.push_back(fibres_of(reading, m, true));
    }
    set_uncoupled(s, *G, constant_of(m, "k", 0.0, s.note));
    return s;
  }
  if (type == "Ogden unconstrained") {
    const double G = sum_of_c(m, s.note) / 2;
    const double lambda = constant_of(m, "cp", 0.0, s.note);
    if (!std::isnan(G + lambda)) set_from_G_lambda(s, G, lambda);
    return s;
  }
  if (one_of(type, {"coupled Mooney-Rivlin", "coupled Veronda-Westmann", "coupled trans-iso Mooney-Rivlin",
                    "coupled trans-iso Veronda-Westmann"})) {
    if (type.rfind("coupled trans-iso", 0) == 0) {
      add_note(s.note, kMatrixNote);
      leave_out(reading, m, fmt::format("the fibres of {}", quote(type)), kGroundMatrix);
      s.fibres.push_back(fibres_of(reading, m, false));
      s.fibres.back().axes.clear();  // FEBio tells their direction in global axes
    }
    const double c1 = constant_of(m, "c1", 0, s.note), c2 = constant_of(m, "c2", 0, s.note),
                 k = constant_of(m, "k", 0, s.note);
    if (std::isnan(c1 + c2 + k)) return s;
    if (type.find("Mooney") != type.npos)
      set_from_G_lambda(s, 2 * (c1 + c2), k + 4 * c2);
    else
      set_from_G_lambda(s, c1 * c2, k + c1 * c2 * (4 * c2 - 2));
    return s;
  }
  if (one_of(type, {"solid mixture", "uncoupled solid mixture"})) return mixture(reading, m);
  if (one_of(type, {"viscoelastic", "uncoupled viscoelastic", "prestrain elastic", "uncoupled prestrain elastic",
                    "biphasic", "biphasic-solute", "triphasic", "multiphasic"})) {
    return wrapped(reading, m);
  }
  if (one_of(type, {"Holzapfel-Gasser-Ogden", "HGO unconstrained"})) {
    const bool uncoupled = type != "HGO unconstrained";
    add_note(s.note, kMatrixNote);
    leave_out(reading, m, fmt::format("the fibres of {}", quote(type)), kGroundMatrix);
    s.fibres.push_back(families_of(reading, m, uncoupled));
    const double G = constant_of(m, "c", 0.0, s.note), k = constant_of(m, "k", 0.0, s.note);
    if (uncoupled)
      set_uncoupled(s, G, k);
    else if (!std::isnan(G + k))
      set_from_G_lambda(s, G, k);
    return s;
  }
  if (one_of(type, {"orthotropic elastic", "Fung orthotropic", "Fung-ortho-compressible"}))
    return orthotropic(reading, m);
  const std::string meant = misspelt_type(type);
  return unknown(type, fmt::format("no small-strain E and nu are known for type {}{}", quote(type),
                                   meant.empty() ? "" : fmt::format(": did you mean {}?", quote(meant))));
}

}  // namespace

void set_elasticity(Material& material, const Component& given, bool nested_k_adds, JointModel& model) {
  Stiffness s = stiffness_of({model, material.name, nested_k_adds}, given);
  if (!s.in_axes.empty()) {
    if (!std::isnan(s.G + s.lambda)) {
      s.in_axes.push_back({lame_stiffness(s.G, s.lambda), {}});
      material.stiffness = std::move(s.in_axes);
    }
    s.E = s.nu = kNaN;
  } else if (std::isnan(s.E) && !std::isnan(s.G + s.lambda)) {
    add_note(s.note, fmt::format("no stiffness: G = {:g}, K = {:g}, need both > 0", s.G, s.lambda + 2 * s.G / 3));
  }
  material.type = s.type;
  material.E = s.E;
  material.nu = s.nu;
  material.note = s.note;
  material.fibres = std::move(s.fibres);
  material.fluid = s.fluid;
}

void set_density(Material& material, const Component& given, const JointModel& model, std::string& why) {
  const double value = constant_of(given, "density", 1.0, why);
  if (!std::isnan(value) && value < 0) {
    throw fault_at(model, place_of(given, "density"),
                   fmt::format("material {}: density = {:g}, need density >= 0", quote(material.name), value));
  }
  material.density = value;
}

}  // namespace dea
