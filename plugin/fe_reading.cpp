#include <febiodea/plugin/fe_reading.h>

#include <FEBioMech/FERigidBody.h>
#include <FECore/FELoadController.h>
#include <FECore/FEModelParam.h>
#include <fmt/format.h>

#include <algorithm>

#include <febiodea/base/error.h>

namespace dea::fe {

void ignore(Reading& reading, const std::string& what) {
  febio::list_once(reading.model.ignored, reading.ignored_index, what, kNowhere);
}

void unsupported(Reading& reading, const std::string& what, const std::string& advice) {
  febio::list_once(reading.model.unsupported, reading.unsupported_index, what, kNowhere, advice);
}

void fail(const Reading& reading, const std::string& fault) { throw fault_at(reading.model, kNowhere, fault); }

Vector3d vector_of(const vec3d& v) { return {v.x, v.y, v.z}; }

std::string type_of(FECoreBase& object) {
  const char* type = object.GetTypeStr();
  return type == nullptr ? "" : type;
}

bool one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* candidate) { return word == candidate; });
}

bool has(const std::string& text, const char* word) { return text.find(word) != text.npos; }

// -- parameters --------------------------------------------------------------------------------------

int controller_of(Reading& reading, FEParam& parameter) {
  FELoadController* controller = reading.fem.GetLoadController(&parameter);
  return controller == nullptr ? -1 : controller->GetID();
}

FEParam& need_parameter(const Reading& reading, FECoreBase& object, const char* name) {
  FEParam* parameter = object.GetParameter(name);
  if (parameter == nullptr) fail(reading, fmt::format("{} without parameter {}", quote(type_of(object)), name));
  return *parameter;
}

std::optional<double> number_of(const FEParam& parameter) {
  switch (parameter.type()) {
    case FE_PARAM_INT:
      return parameter.value<int>();
    case FE_PARAM_BOOL:
      return parameter.value<bool>() ? 1.0 : 0.0;
    case FE_PARAM_DOUBLE:
      return parameter.value<double>();
    case FE_PARAM_DOUBLE_MAPPED: {
      const auto& mapped = parameter.value<FEParamDouble>();
      if (mapped.isConst()) return mapped.constValue();
      return std::nullopt;
    }
    default:
      return std::nullopt;
  }
}

double need_number(const Reading& reading, FECoreBase& object, const char* name) {
  const auto number = number_of(need_parameter(reading, object, name));
  if (!number) fail(reading, fmt::format("{}: {} is not one number", quote(type_of(object)), name));
  return *number;
}

int need_int(const Reading& reading, FECoreBase& object, const char* name) {
  return static_cast<int>(need_number(reading, object, name));
}

Vector3d need_vector(const Reading& reading, FECoreBase& object, const char* name) {
  FEParam& parameter = need_parameter(reading, object, name);
  if (parameter.type() == FE_PARAM_VEC3D) return vector_of(parameter.value<vec3d>());
  if (parameter.type() == FE_PARAM_VEC3D_MAPPED && parameter.value<FEParamVec3>().isConst())
    return vector_of(parameter.value<FEParamVec3>().constValue());
  fail(reading, fmt::format("{}: {} is not one vector", quote(type_of(object)), name));
}

Vector3d constant_vector(Reading& reading, FECoreBase& object, const char* name) {
  if (controller_of(reading, need_parameter(reading, object, name)) >= 0)
    unsupported(reading, fmt::format("{} that follows a load controller", name));
  return need_vector(reading, object, name);
}

bool flag(FECoreBase& object, const char* name) {
  const FEParam* parameter = object.GetParameter(name);
  return parameter != nullptr && number_of(*parameter).value_or(0.0) != 0.0;
}

Scaled need_scaled(Reading& reading, FECoreBase& object, const char* name) {
  return {need_number(reading, object, name), controller_of(reading, need_parameter(reading, object, name))};
}

bool is_zero(FEParam& parameter) {
  if (parameter.type() == FE_PARAM_VEC3D) return parameter.value<vec3d>().norm2() == 0.0;
  if (parameter.type() == FE_PARAM_VEC3D_MAPPED) {
    auto& mapped = parameter.value<FEParamVec3>();
    return mapped.isConst() && mapped.constValue().norm2() == 0.0;
  }
  const auto number = number_of(parameter);
  return number && *number == 0.0;
}

std::string text_of(FECoreBase& object, const char* name) {
  FEParam* parameter = object.GetParameter(name);
  if (parameter == nullptr || parameter->type() != FE_PARAM_STD_STRING) return "";
  const std::string& text = parameter->value<std::string>();
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

std::string kind_of(FEParam& parameter) {
  FECoreBase* valuator = nullptr;
  if (parameter.type() == FE_PARAM_DOUBLE_MAPPED) valuator = parameter.value<FEParamDouble>().valuator();
  if (parameter.type() == FE_PARAM_VEC3D_MAPPED) valuator = parameter.value<FEParamVec3>().valuator();
  return valuator == nullptr ? "map" : type_of(*valuator);
}

// -- names and steps ---------------------------------------------------------------------------------

int need_rigid(const Reading& reading, FECoreBase& object, int id) {
  FEModel& fem = reading.fem;
  FEMaterial* material = id >= 1 && id <= fem.Materials() ? fem.GetMaterial(id - 1) : nullptr;
  const auto place = reading.materials.find(material);
  if (place == reading.materials.end() || !reading.model.materials[static_cast<std::size_t>(place->second)].rigid) {
    fail(reading, fmt::format("{} is on material {}, expected a rigid body", quote(type_of(object)), id));
  }
  return place->second;
}

int body_of(const Reading& reading, FECoreBase& object, const char* name) {
  return need_rigid(reading, object, need_int(reading, object, name));
}

int renamed_body_of(const Reading& reading, FECoreBase& object, const char* name) {
  const int id = need_int(reading, object, name);
  if (!reading.in_init) return need_rigid(reading, object, id);
  if (id < 0 || id >= reading.fem.RigidBodies()) fail(reading, fmt::format("{} without {}", type_of(object), name));
  return need_rigid(reading, object, reading.fem.GetRigidBody(id)->m_mat + 1);
}

int xyz_of(Reading& reading, int dof) {
  for (int i = 0; i < 3; ++i)
    if (dof == reading.fem.GetDOFIndex(kDofNames[i])) return i;
  return -1;
}

std::string dof_name(Reading& reading, int dof) {
  const char* name = reading.fem.GetDOFS().GetDOFName(dof);
  return name == nullptr ? fmt::format("{}", dof) : name;
}

std::vector<int> steps_of(const Reading& reading, const FEStepComponent& component) {
  const auto place = reading.steps_of.find(&component);
  return place == reading.steps_of.end() ? std::vector<int>{-1} : place->second;
}

void set_curve(LoadController& curve, int interpolate, int extend, const std::vector<vec2d>& points) {
  if (interpolate >= 0 && interpolate < static_cast<int>(febio::kInterpolateWords.size()))
    febio::set_interpolate(curve, interpolate);
  else
    curve.unsupported = fmt::format("interpolation {}", interpolate);
  if (extend >= 0 && extend < static_cast<int>(febio::kExtendWords.size()))
    curve.extend = static_cast<LoadController::Extend>(extend);
  else
    curve.unsupported = fmt::format("extend {}", extend);
  for (const vec2d& point : points) curve.points.push_back({point.x(), point.y()});
  febio::check_times(curve);
}

}  // namespace dea::fe
