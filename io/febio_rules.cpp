// What FEBio's words mean for DEA.
#include "febio_rules.h"

#include <fmt/format.h>

#include <algorithm>

#include "error.h"
#include "load_curve.h"

namespace dea::febio {

namespace {

bool one_of(std::string_view word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* candidate) { return word == candidate; });
}

}  // namespace

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) result += (static_cast<unsigned char>(c) < 32 || c == 127) ? ' ' : c;
  if (text.size() > kLongest) result += "...";
  return result + "\"";
}

void list_once(std::vector<Remark>& remarks, RemarkIndex& index, const std::string& what, Origin origin) {
  const auto [place, is_new] = index.places.try_emplace(what, remarks.size());
  if (is_new) {
    remarks.push_back({what, 1, origin});
  } else {
    ++remarks[place->second].count;
  }
}

bool known_module(const std::string& m) {
  return m.empty() || m.find("solid") != m.npos || m == "biphasic" || m == "solute" || m == "multiphasic";
}

std::string analysis_remark(const std::string& module, bool dynamic) {
  if (!dynamic) return "";
  const bool solid = module.empty() || module.find("solid") != std::string::npos;
  return solid ? "analysis DYNAMIC: DEA is quasi-static, inertia is left out"
               : "analysis TRANSIENT: DEA uses the drained solid, fluid flow is left out";
}

std::optional<Contact::Kind> contact_kind(const std::string& type) {
  if (one_of(type,
             {"sliding-elastic", "sliding-tension-compression", "sliding-facet-on-facet", "facet-to-facet sliding",
              "sliding-node-on-facet", "sliding_with_gaps", "sliding", "sliding2", "sliding3", "sliding-biphasic",
              "sliding-biphasic-mixed", "sliding-biphasic-solute", "sliding-multiphasic", "mortar-sliding", "dea"})) {
    return Contact::Kind::Sliding;
  }
  if (one_of(type, {"tied-node-on-facet", "tied-facet-on-facet", "tied-elastic", "sticky", "tied-biphasic",
                    "tied-multiphasic", "tied", "facet-to-facet tied", "mortar-tied"})) {
    return Contact::Kind::Tied;
  }
  return std::nullopt;
}

std::vector<ContactParameter> unused_contact_parameters(const std::string& type) {
  const bool unlimited = one_of(type, {"sliding-facet-on-facet", "facet-to-facet sliding", "sliding-node-on-facet",
                                       "sliding_with_gaps", "sliding"});
  return {{"fric_coeff", 0},
          {"mu", 0},
          {"tension", 0},
          {"offset", 0},
          {"search_radius", unlimited ? 0.0 : 1.0},
          {"node_reloc", 0},
          {"flip_primary", 0},
          {"flip_secondary", 0},
          {"shell_bottom_primary", 0},
          {"shell_bottom_secondary", 0},
          {"offset_shells", 0},
          {"contact_frac", 0},
          {"max_traction", 0}};
}

bool is_damper(const std::string& connector_type) {
  return one_of(connector_type, {"rigid damper", "rigid angular damper"});
}

void set_interpolate(LoadController& curve, int place) {
  curve.interpolate = static_cast<LoadController::Interpolate>(place);
}

void check_times(LoadController& curve) {
  using Interpolate = LoadController::Interpolate;
  const Interpolate kind = curve.interpolate;
  const bool jumps = kind == Interpolate::Linear || kind == Interpolate::Step || kind == Interpolate::SmoothStep;
  for (std::size_t i = 1; i < curve.points.size() && curve.unsupported.empty(); ++i) {
    const double before = curve.points[i - 1][0], t = curve.points[i][0];
    if (t < before) curve.unsupported = fmt::format("times that go back from {:g} to {:g}", before, t);
    if (t == before && !jumps) curve.unsupported = fmt::format("a smooth curve with time {:g} twice", t);
  }
  // FEBio refuses these, with as many points as there are; a smooth curve takes any number.
  const std::size_t least = jumps || kind == Interpolate::Smooth ? 0 : kind == Interpolate::C2Smooth ? 3 : 2;
  if (curve.points.size() < least && curve.unsupported.empty()) {
    curve.unsupported = fmt::format("{} points, interpolation {} needs {}", curve.points.size(),
                                    quote(kInterpolateWords[static_cast<std::size_t>(kind)]), least);
  }
  if (!curve.unsupported.empty() || jumps || curve.points.size() < 2) return;
  try {
    value(curve, (curve.points.front()[0] + curve.points.back()[0]) / 2);
  } catch (const InputError& error) {
    curve.unsupported = error.what();
  }
}

std::vector<double> must_points(const LoadController& curve, double begin, double end) {
  std::vector<double> times;
  const double close = 1e-9 * (end - begin);
  for (const auto& point : curve.points) {
    if (point[0] > begin + close && point[0] < end + close) times.push_back(std::min(point[0], end));
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

void refuse_unusable_controllers(JointModel& model) {
  for_each_controller(model, [&](int controller, Origin origin) {
    if (controller < 0) return;
    const LoadController& curve = model.controllers[static_cast<std::size_t>(controller)];
    if (curve.unsupported.empty()) return;
    model.unsupported.push_back({fmt::format("load controller {} with {}", curve.id, curve.unsupported), 1, origin});
  });
}

}  // namespace dea::febio
