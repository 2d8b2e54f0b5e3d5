#include "plugin/fe_reading.h"

#include <FECore/FELoadController.h>
#include <FECore/FEModelParam.h>
#include <fmt/format.h>

#include "src/base/error.h"
#include "src/base/parse.h"

namespace dea::fe {

void ignore(Reading& reading, const std::string& what) { febio::ignore(reading, kNowhere, what); }

void unsupported(Reading& reading, const std::string& what, const Sentence& advice) {
  febio::unsupported(reading, kNowhere, what, advice);
}

void fail(const Reading& reading, const std::string& fault) { febio::fail(reading, kNowhere, fault); }

Vector3d vector_of(const vec3d& v) { return {v.x, v.y, v.z}; }

std::string type_of(FECoreBase& object) {
  const char* type = object.GetTypeStr();
  return type == nullptr ? "" : type;
}

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

std::string text_of(FECoreBase& object, const char* name) {
  FEParam* parameter = object.GetParameter(name);
  if (parameter == nullptr || parameter->type() != FE_PARAM_STD_STRING) return "";
  return trimmed(parameter->value<std::string>());
}

std::string kind_of(FEParam& parameter) {
  FECoreBase* valuator = nullptr;
  if (parameter.type() == FE_PARAM_DOUBLE_MAPPED) valuator = parameter.value<FEParamDouble>().valuator();
  if (parameter.type() == FE_PARAM_VEC3D_MAPPED) valuator = parameter.value<FEParamVec3>().valuator();
  return valuator == nullptr ? "map" : type_of(*valuator);
}

febio::Steps steps_of(const Reading& reading, const FEStepComponent& component) {
  const auto place = reading.steps_of.find(&component);
  return place == reading.steps_of.end() ? febio::Steps{-1} : place->second;
}

}  // namespace dea::fe
