#include "read_fe_model.h"

#include <FEBioLib/FEBioModel.h>
#include <FEBioMech/FEMechModel.h>
#include <FEBioMech/FERigidBody.h>
#include <FEBioMech/FERigidConnector.h>
#include <FEBioMech/RigidBC.h>
#include <FECore/FEAnalysis.h>
#include <FECore/FEBodyLoad.h>
#include <FECore/FEBoundaryCondition.h>
#include <FECore/FEDiscreteDomain.h>
#include <FECore/FEDiscreteMaterial.h>
#include <FECore/FEDiscreteSet.h>
#include <FECore/FEFacetSet.h>
#include <FECore/FEInitialCondition.h>
#include <FECore/FELinearConstraintManager.h>
#include <FECore/FELoadCurve.h>
#include <FECore/FEMaterial.h>
#include <FECore/FEMesh.h>
#include <FECore/FEModelLoad.h>
#include <FECore/FEModelParam.h>
#include <FECore/FENLConstraint.h>
#include <FECore/FENodalBC.h>
#include <FECore/FENodalLoad.h>
#include <FECore/FEShellDomain.h>
#include <FECore/FESurfaceLoad.h>
#include <FECore/FESurfacePairConstraint.h>
#include <FECore/FETimeStepController.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "dea_contact.h"
#include "error.h"
#include "febio_material.h"
#include "febio_rules.h"

namespace dea {

namespace {

using febio::quote;

constexpr Origin kNowhere = {0, 0};

/// What is known while FEBio's model is read.
struct Reading {
  FEMechModel& fem;
  JointModel model;
  std::map<const FEMaterial*, int> materials;      ///< index into JointModel::materials
  std::map<const FEFacetSet*, int> surfaces;       ///< index into JointModel::surfaces
  std::map<const FEStepComponent*, int> step_of;   ///< of what is active in one step only
  std::set<const FEStepComponent*> several_steps;  ///< active in more than one step
  febio::RemarkIndex ignored_index, unsupported_index;
};

void ignore(Reading& reading, const std::string& what) {
  febio::list_once(reading.model.ignored, reading.ignored_index, what, kNowhere);
}

void unsupported(Reading& reading, const std::string& what) {
  febio::list_once(reading.model.unsupported, reading.unsupported_index, what, kNowhere);
}

[[noreturn]] void fail(const Reading& reading, const std::string& fault) {
  throw InputError(reading.model, kNowhere, fault);
}

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

/// Index of the load controller a parameter follows; -1: none.
int controller_of(Reading& reading, FEParam& parameter) {
  FELoadController* controller = reading.fem.GetLoadController(&parameter);
  return controller == nullptr ? -1 : controller->GetID();
}

FEParam& need_parameter(const Reading& reading, FECoreBase& object, const char* name) {
  FEParam* parameter = object.GetParameter(name);
  if (parameter == nullptr) fail(reading, fmt::format("{} without parameter {}", quote(type_of(object)), name));
  return *parameter;
}

/// A parameter that is one number now; nothing for a map, an expression, a vector.
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

/// False also if there is no such parameter.
bool flag(FECoreBase& object, const char* name) {
  const FEParam* parameter = object.GetParameter(name);
  return parameter != nullptr && number_of(*parameter).value_or(0.0) != 0.0;
}

Scaled need_scaled(Reading& reading, FECoreBase& object, const char* name) {
  return {need_number(reading, object, name), controller_of(reading, need_parameter(reading, object, name))};
}

/// Whether a load's vector or number is zero, whatever its load controller.
bool is_zero(FEParam& parameter) {
  if (parameter.type() == FE_PARAM_VEC3D) return parameter.value<vec3d>().norm2() == 0.0;
  if (parameter.type() == FE_PARAM_VEC3D_MAPPED) {
    auto& mapped = parameter.value<FEParamVec3>();
    return mapped.isConst() && mapped.constValue().norm2() == 0.0;
  }
  const auto number = number_of(parameter);
  return number && *number == 0.0;
}

/// The rigid material with this 1-based number, as rigid conditions name it.
int need_rigid(const Reading& reading, FECoreBase& object, int id) {
  FEModel& fem = reading.fem;
  FEMaterial* material = id >= 1 && id <= fem.Materials() ? fem.GetMaterial(id - 1) : nullptr;
  const auto place = reading.materials.find(material);
  if (place == reading.materials.end() || !reading.model.materials[static_cast<std::size_t>(place->second)].rigid) {
    fail(reading, fmt::format("{} is on material {}, expected a rigid body", quote(type_of(object)), id));
  }
  return place->second;
}

int body_of(const Reading& reading, FECoreBase& object) {
  return need_rigid(reading, object, need_int(reading, object, "rb"));
}

int step_of(Reading& reading, FEStepComponent& component) {
  const auto place = reading.step_of.find(&component);
  if (place == reading.step_of.end()) return -1;
  if (reading.several_steps.count(&component) > 0)
    unsupported(reading, fmt::format("{} of several steps", quote(type_of(component))));
  return place->second;
}

// -- mesh --------------------------------------------------------------------------------------------

std::optional<ElementShape> shape_of(int shape) {
  switch (shape) {
    case ET_TET4:
      return ElementShape::Tet4;
    case ET_TET5:
      return ElementShape::Tet5;
    case ET_TET10:
      return ElementShape::Tet10;
    case ET_TET15:
      return ElementShape::Tet15;
    case ET_TET20:
      return ElementShape::Tet20;
    case ET_PENTA6:
      return ElementShape::Penta6;
    case ET_PENTA15:
      return ElementShape::Penta15;
    case ET_HEX8:
      return ElementShape::Hex8;
    case ET_HEX20:
      return ElementShape::Hex20;
    case ET_HEX27:
      return ElementShape::Hex27;
    case ET_PYRA5:
      return ElementShape::Pyra5;
    case ET_PYRA13:
      return ElementShape::Pyra13;
    case ET_QUAD4:
      return ElementShape::Quad4;
    case ET_QUAD8:
      return ElementShape::Quad8;
    case ET_QUAD9:
      return ElementShape::Quad9;
    case ET_TRI3:
      return ElementShape::Tri3;
    case ET_TRI6:
      return ElementShape::Tri6;
    case ET_TRUSS2:
    case ET_LINE2:
      return ElementShape::Line2;
    case ET_LINE3:
      return ElementShape::Line3;
    default:
      return std::nullopt;
  }
}

void read_domain(Reading& reading, FEDomain& fe) {
  if (fe.Elements() == 0) return;
  const auto shape = shape_of(fe.ElementRef(0).Shape());
  if (!shape) {
    unsupported(reading, fmt::format("elements of a kind of their own in {}", quote(fe.GetName())));
    return;
  }
  Domain domain;
  domain.name = fe.GetName();
  domain.shape = *shape;
  const auto material = reading.materials.find(fe.GetMaterial());
  if (material != reading.materials.end()) domain.material = material->second;
  bool thick = false;
  for (int i = 0; i < fe.Elements(); ++i) {
    FEElement& element = fe.ElementRef(i);
    domain.element_ids.push_back(element.GetID());
    domain.nodes.insert(domain.nodes.end(), element.m_node.begin(), element.m_node.begin() + element.Nodes());
    const auto* shell = dynamic_cast<const FEShellElement*>(&element);
    if (shell == nullptr) continue;
    domain.shell_thickness.insert(domain.shell_thickness.end(), shell->m_h0.begin(),
                                  shell->m_h0.begin() + element.Nodes());
    thick = thick || std::any_of(shell->m_h0.begin(), shell->m_h0.end(), [](double h) { return h != 0.0; });
  }
  if (!thick) domain.shell_thickness.clear();  // FEBio has 0 where none is given
  reading.model.domains.push_back(std::move(domain));
}

void read_mesh(Reading& reading) {
  FEMesh& mesh = reading.fem.GetMesh();
  JointModel& model = reading.model;
  for (int i = 0; i < mesh.Nodes(); ++i) {
    model.node_ids.push_back(mesh.Node(i).GetID());
    model.nodes.push_back(vector_of(mesh.Node(i).m_r0));
  }
  std::set<std::string> domain_names;
  for (int i = 0; i < mesh.Domains(); ++i) {
    domain_names.insert(mesh.Domain(i).GetName());
    if (mesh.Domain(i).Class() != FE_DOMAIN_DISCRETE) read_domain(reading, mesh.Domain(i));
  }
  for (int i = 0; i < mesh.FacetSets(); ++i) {
    FEFacetSet& set = mesh.FacetSet(i);
    Surface surface;
    surface.name = set.GetName();
    for (int k = 0; k < set.Faces(); ++k) {
      const FEFacetSet::FACET& face = set.Face(k);
      surface.nodes.insert(surface.nodes.end(), face.node, face.node + face.Nodes());
      surface.begin.push_back(static_cast<int>(surface.nodes.size()));
    }
    reading.surfaces.emplace(&set, static_cast<int>(model.surfaces.size()));
    model.surfaces.push_back(std::move(surface));
  }
  for (int i = 0; i < mesh.NodeSets(); ++i) {
    const FENodeSet& fe = *mesh.NodeSet(i);
    NodeSet set;
    set.name = fe.GetName();
    for (int k = 0; k < fe.Size(); ++k) set.nodes.push_back(fe[k]);
    model.node_sets.push_back(std::move(set));
  }
  for (int i = 0; i < mesh.ElementSets(); ++i) {
    const FEElementSet& fe = mesh.ElementSet(i);
    if (domain_names.count(fe.GetName()) > 0) continue;  // FEBio makes one for every domain
    model.element_sets.push_back({fe.GetName(), fe.GetElementIDList(), kNowhere});
  }
  for (int i = 0; i < mesh.DiscreteSets(); ++i) {
    const FEDiscreteSet& fe = mesh.DiscreteSet(i);
    DiscreteSet set;
    set.name = fe.GetName();
    for (int k = 0; k < fe.size(); ++k) set.pairs.push_back({fe.Element(k).n0, fe.Element(k).n1});
    model.discrete_sets.push_back(std::move(set));
  }
  if (mesh.DataMaps() > 0 || reading.fem.MeshDataGenerators() > 0) ignore(reading, "mesh data");
}

// -- materials ---------------------------------------------------------------------------------------

MaterialTree tree_of(Reading& reading, FECoreBase& material) {
  MaterialTree tree;
  tree.type = type_of(material);
  FEParameterList& list = material.GetParameterList();
  FEParamIterator it = list.first();
  for (int i = 0; i < list.Parameters(); ++i, ++it) {
    FEParam& parameter = *it;
    const char* name = parameter.name();
    MaterialTree::Constant constant;
    if (controller_of(reading, parameter) >= 0) {
      constant.why = fmt::format("{} follows a load controller", name);
    } else if (const auto number = number_of(parameter)) {
      constant.value = *number;
    } else if (parameter.type() == FE_PARAM_DOUBLE_MAPPED) {
      FEScalarValuator* value = parameter.value<FEParamDouble>().valuator();
      constant.why = fmt::format("{} is a {}, not one number", name, quote(value == nullptr ? "map" : type_of(*value)));
    } else {
      continue;  // vectors and texts: no constants of elasticity
    }
    tree.constants.emplace(name, constant);
  }
  for (int i = 0; i < material.PropertyClasses(); ++i) {
    FEProperty& property = *material.PropertyClass(i);
    if (property.IsReference()) continue;
    for (int k = 0; k < property.size(); ++k) {
      if (property.get(k) == nullptr) continue;
      tree.parts.push_back(tree_of(reading, *property.get(k)));
      tree.parts.back().tag = property.GetName();
    }
  }
  return tree;
}

void read_materials(Reading& reading) {
  JointModel& model = reading.model;
  for (int i = 0; i < reading.fem.Materials(); ++i) {
    FEMaterial* fe = reading.fem.GetMaterial(i);
    if (dynamic_cast<FEDiscreteMaterial*>(fe) != nullptr) continue;
    Material material;
    material.id = i + 1;
    material.name = fe->GetName();
    material.type = type_of(*fe);
    material.rigid = material.type == "rigid body";
    const MaterialTree tree = tree_of(reading, *fe);
    if (material.rigid) {
      if (flag(*fe, "override_com"))
        material.center_of_mass = vector_of(need_parameter(reading, *fe, "center_of_mass").value<vec3d>());
      material.note = "rigid body";
    } else {
      // FEBio's reader has added nested k of old files already.
      set_elasticity(material, tree, false, model);
    }
    std::string why;
    set_density(material, tree, model, why);
    if (std::isnan(material.density) && material.rigid && !material.center_of_mass)
      unsupported(reading,
                  fmt::format("rigid body whose density is not one number ({}): give it a center_of_mass", why));
    reading.materials.emplace(fe, static_cast<int>(model.materials.size()));
    model.materials.push_back(std::move(material));
  }
}

// -- steps and load controllers ----------------------------------------------------------------------

void read_controllers(Reading& reading) {
  for (int i = 0; i < reading.fem.LoadControllers(); ++i) {
    FELoadController& fe = *reading.fem.GetLoadController(i);
    LoadController controller;
    controller.id = i + 1;
    controller.name = fe.GetName();
    if (const auto* curve = dynamic_cast<const FELoadCurve*>(&fe)) {
      const int interpolate = curve->GetInterpolation(), extend = curve->GetExtendMode();
      if (interpolate >= 0 && interpolate < static_cast<int>(febio::kInterpolateWords.size()))
        febio::set_interpolate(controller, interpolate);
      else
        controller.unsupported = fmt::format("interpolation {}", interpolate);
      if (extend >= 0 && extend < static_cast<int>(febio::kExtendWords.size()))
        controller.extend = static_cast<LoadController::Extend>(extend);
      else
        controller.unsupported = fmt::format("extend {}", extend);
      for (const vec2d& point : curve->GetPoints()) controller.points.push_back({point.x(), point.y()});
      febio::check_times(controller);
    } else {
      controller.unsupported = fmt::format("type {}", quote(type_of(fe)));
    }
    reading.model.controllers.push_back(std::move(controller));
  }
}

/// The load controller whose points a step must meet; -1: none. FEBio's Init detaches it from dtmax.
int must_point_controller(Reading& reading, FETimeStepController& stepper) {
  if (stepper.m_nmplc >= 0) return stepper.m_nmplc;
  FEParam* dtmax = stepper.GetParameter("dtmax");
  return dtmax == nullptr ? -1 : controller_of(reading, *dtmax);
}

void read_steps(Reading& reading) {
  JointModel& model = reading.model;
  double begin = 0.0;
  for (int i = 0; i < reading.fem.Steps(); ++i) {
    FEAnalysis& fe = *reading.fem.GetStep(i);
    Step step;
    step.name = fe.GetName();
    step.step_size = fe.m_dt0;
    step.duration = fe.m_ntime == -1 ? fe.m_final_time : fe.m_ntime * fe.m_dt0;
    if (fe.m_ntime == -1 && !(fe.m_final_time > 0)) fail(reading, "time_steps = -1 without a final_time > 0");
    const int curve = fe.m_timeController == nullptr ? -1 : must_point_controller(reading, *fe.m_timeController);
    if (curve >= 0 && curve < static_cast<int>(model.controllers.size())) {
      const LoadController& controller = model.controllers[static_cast<std::size_t>(curve)];
      step.must_points = febio::must_points(controller, begin, begin + step.duration);
      if (controller.points.empty() && !controller.unsupported.empty())
        ignore(reading, fmt::format("dtmax: load controller {} with {} gives no must points", controller.id,
                                    controller.unsupported));
    }
    const std::string remark = febio::analysis_remark(model.module, fe.m_nanalysis == 1);
    if (!remark.empty()) ignore(reading, remark);
    begin += step.duration;
    model.steps.push_back(std::move(step));
    for (int k = 0; k < fe.StepComponents(); ++k) {
      const FEStepComponent* component = fe.GetStepComponent(k);
      if (reading.step_of.emplace(component, i).first->second != i) reading.several_steps.insert(component);
    }
  }
  if (model.steps.empty()) model.steps.push_back({"", 1.0, 0.1, {}, kNowhere});  // FEBio's defaults
}

// -- nodes -------------------------------------------------------------------------------------------

std::vector<int> nodes_of(const Reading& reading, FENodalBC& condition) {
  FENodeSet* set = condition.GetNodeSet();
  if (set == nullptr) fail(reading, fmt::format("bc {} without a node set", quote(type_of(condition))));
  std::vector<int> nodes;
  for (int i = 0; i < set->Size(); ++i) nodes.push_back((*set)[i]);
  return nodes;
}

/// Holds the nodes of a condition in x, y, z as flagged.
void fix_nodes(Reading& reading, FENodalBC& condition, const std::array<bool, 3>& xyz) {
  if (!xyz[0] && !xyz[1] && !xyz[2]) return;
  reading.model.fixed_nodes.push_back(
      {nodes_of(reading, condition), xyz, step_of(reading, condition), condition.GetName(), kNowhere});
}

/// 0, 1, 2 for x, y, z; -1: another degree of freedom.
int xyz_of(Reading& reading, int dof) {
  for (int i = 0; i < 3; ++i)
    if (dof == reading.fem.GetDOFIndex(kDofNames[i])) return i;
  return -1;
}

std::string dof_name(Reading& reading, int dof) {
  const char* name = reading.fem.GetDOFS().GetDOFName(dof);
  return name == nullptr ? fmt::format("{}", dof) : name;
}

void prescribe_nodes(Reading& reading, FENodalBC& condition, const char* value) {
  const int dof = need_int(reading, condition, "dof");
  const int place = xyz_of(reading, dof);
  if (place < 0) {
    const std::string name = dof_name(reading, dof);
    if (one_of(name, {"u", "v", "w", "sx", "sy", "sz"}))
      unsupported(reading, fmt::format("prescribed shell dof {}", quote(name)));
    else
      ignore(reading, fmt::format("prescribed dof {}: no displacement", quote(name)));
  } else if (is_zero(need_parameter(reading, condition, value))) {
    std::array<bool, 3> xyz = {};
    xyz[static_cast<std::size_t>(place)] = true;
    fix_nodes(reading, condition, xyz);
  } else {
    unsupported(reading, "prescribed displacement of nodes");
  }
}

void read_boundary(Reading& reading) {
  for (int i = 0; i < reading.fem.BoundaryConditions(); ++i) {
    FEBoundaryCondition& fe = *reading.fem.BoundaryCondition(i);
    const std::string type = type_of(fe);
    auto* nodal = dynamic_cast<FENodalBC*>(&fe);
    if (dynamic_cast<FERigidBC*>(&fe) != nullptr) continue;  // read_rigid_conditions
    if (type == "zero displacement" && nodal != nullptr) {
      const std::array<bool, 3> xyz = {flag(fe, "x_dof"), flag(fe, "y_dof"), flag(fe, "z_dof")};
      if (!xyz[0] && !xyz[1] && !xyz[2]) ignore(reading, "zero displacement of no component");
      fix_nodes(reading, *nodal, xyz);
    } else if (type == "fix" && nodal != nullptr) {
      std::array<bool, 3> xyz = {};
      for (const int dof : need_parameter(reading, fe, "dofs").value<std::vector<int>>()) {
        const int place = xyz_of(reading, dof);
        if (place >= 0)
          xyz[static_cast<std::size_t>(place)] = true;
        else
          ignore(reading, fmt::format("fixed dof {}: no displacement", quote(dof_name(reading, dof))));
      }
      fix_nodes(reading, *nodal, xyz);
    } else if (type == "prescribed displacement" && nodal != nullptr) {
      prescribe_nodes(reading, *nodal, "value");
    } else if (type == "prescribe" && nodal != nullptr) {
      prescribe_nodes(reading, *nodal, "scale");
    } else if (type == "rigid" && nodal != nullptr) {
      reading.model.rigid_nodes.push_back(
          {body_of(reading, fe), nodes_of(reading, *nodal), step_of(reading, fe), fe.GetName(), kNowhere});
    } else if (type == "zero rotation" || type == "zero shell displacement" || has(type, "fluid") ||
               has(type, "concentration") || has(type, "temperature")) {
      ignore(reading, fmt::format("bc {}", quote(type)));
    } else {
      unsupported(reading, fmt::format("bc {}", quote(type)));
    }
  }
  if (reading.fem.GetLinearConstraintManager().LinearConstraints() > 0)
    unsupported(reading, "bc \"linear constraint\"");
}

// -- rigid bodies ------------------------------------------------------------------------------------

void add_prescribed(Reading& reading, FEStepComponent& fe, int dof, const char* value) {
  if (dof < 0 || dof >= kDofs) fail(reading, fmt::format("{} without a dof", quote(type_of(fe))));
  reading.model.rigid_prescribed.push_back({body_of(reading, fe), dof, need_scaled(reading, fe, value),
                                            flag(fe, "relative"), step_of(reading, fe), fe.GetName(), kNowhere});
}

/// Place of the dof among kDofNames; -1: none of them.
int rigid_dof_of(Reading& reading, FECoreBase& fe) {
  const int dof = need_int(reading, fe, "dof");
  for (int i = 0; i < kDofs; ++i)
    if (dof == reading.fem.GetDOFIndex(kDofNames[i])) return i;
  return -1;
}

void read_rigid_conditions(Reading& reading) {
  constexpr const char* kFlags[kDofs] = {"Rx_dof", "Ry_dof", "Rz_dof", "Ru_dof", "Rv_dof", "Rw_dof"};
  for (int i = 0; i < reading.fem.RigidBCs(); ++i) {
    FERigidBC& fe = *reading.fem.GetRigidBC(i);
    const std::string type = type_of(fe);
    if (type == "rigid_fixed" || type == "rigid_fixed_old") {
      RigidFixed fixed;
      fixed.material = body_of(reading, fe);
      fixed.step = step_of(reading, fe);
      fixed.name = fe.GetName();
      if (type == "rigid_fixed") {
        for (std::size_t k = 0; k < kDofs; ++k) fixed.dofs[k] = flag(fe, kFlags[k]);
      } else {
        for (const int dof : need_parameter(reading, fe, "dofs").value<std::vector<int>>()) {
          if (dof < 0 || dof >= kDofs) fail(reading, "rigid condition with a dof that is none of Rx,Ry,Rz,Ru,Rv,Rw");
          fixed.dofs[static_cast<std::size_t>(dof)] = true;
        }
      }
      reading.model.rigid_fixed.push_back(std::move(fixed));
    } else if (type == "rigid_prescribed_old") {
      add_prescribed(reading, fe, need_int(reading, fe, "dof"), "value");
    } else if (type == "rigid_displacement" || type == "rigid_rotation") {
      add_prescribed(reading, fe, rigid_dof_of(reading, fe), "value");
    } else if (type == "rigid_rotation_vector") {
      add_prescribed(reading, fe, 3, "vx");
      add_prescribed(reading, fe, 4, "vy");
      add_prescribed(reading, fe, 5, "vz");
    } else {
      unsupported(reading, fmt::format("rigid_bc {}", quote(type)));
    }
  }
}

void add_rigid_load(Reading& reading, FEModelLoad& fe, bool moment) {
  const char* what = moment ? "rigid moment" : "rigid force";
  const int load_type = need_int(reading, fe, "load_type");
  const int dof = need_int(reading, fe, "dof");
  if (dof < 0 || dof > 2) fail(reading, fmt::format("{} without a dof", what));
  if (load_type == 2) {
    unsupported(reading, fmt::format("{} with load_type TARGET", what));
  } else if (load_type == 1 && moment) {
    unsupported(reading, "rigid moment with load_type FOLLOW");
  } else if (flag(fe, "relative")) {
    unsupported(reading, fmt::format("{} with relative = 1", what));
  } else {
    RigidLoad load;
    load.material = body_of(reading, fe);
    load.dof = moment ? 3 + dof : dof;
    load.value = need_scaled(reading, fe, "value");
    load.kind = load_type == 1 ? RigidLoad::Kind::Follower : RigidLoad::Kind::Dead;
    load.step = step_of(reading, fe);
    load.name = fe.GetName();
    load.origin = kNowhere;
    reading.model.rigid_loads.push_back(std::move(load));
  }
}

/// A load whose factor, or all of whose values, are zero.
bool is_zero_load(FEModelLoad& fe) {
  FEParam* scale = fe.GetParameter("scale");
  if (scale != nullptr && is_zero(*scale)) return true;
  bool found = false;
  for (const char* name : {"pressure", "traction", "value", "force"}) {
    FEParam* parameter = fe.GetParameter(name);
    if (parameter == nullptr) continue;
    if (!is_zero(*parameter)) return false;
    found = true;
  }
  return found;
}

void read_loads(Reading& reading) {
  for (int i = 0; i < reading.fem.ModelLoads(); ++i) {
    FEModelLoad& fe = *reading.fem.ModelLoad(i);
    const std::string type = type_of(fe);
    if (type == "rigid_force" || type == "rigid_moment") {
      add_rigid_load(reading, fe, type == "rigid_moment");
      continue;
    }
    const char* section = dynamic_cast<FESurfaceLoad*>(&fe) != nullptr ? "surface_load"
                          : dynamic_cast<FENodalLoad*>(&fe) != nullptr ? "nodal_load"
                          : dynamic_cast<FEBodyLoad*>(&fe) != nullptr  ? "body_load"
                          : type.rfind("rigid", 0) == 0                ? "rigid_load"
                                                                       : "load";
    const std::string what = fmt::format("{} {}", section, quote(type));
    const bool of_fluid =
        type.rfind("fluid", 0) == 0 || type.rfind("solute", 0) == 0 || type.rfind("concentration", 0) == 0;
    if (is_zero_load(fe))
      ignore(reading, what + " of zero");
    else if (of_fluid && !has(type, "FSI"))
      ignore(reading, what);
    else
      unsupported(reading, what);
  }
  for (int i = 0; i < reading.fem.InitialConditions(); ++i) {
    const std::string type = type_of(*reading.fem.InitialCondition(i));
    if (has(type, "prestrain"))
      unsupported(reading, fmt::format("initial {}", quote(type)));
    else
      ignore(reading, "initial conditions");
  }
}

/// FEBio's Init turns a connector's material numbers into bodies; the pointers, protected, tell that it has been
/// called.
struct Connected : FERigidConnector {
  static FERigidBody* a(FERigidConnector& c) { return c.*&Connected::m_rbA; }
  static FERigidBody* b(FERigidConnector& c) { return c.*&Connected::m_rbB; }
};

int connected_material(const Reading& reading, FERigidConnector& connector, FERigidBody* body, const char* name) {
  return need_rigid(reading, connector, body == nullptr ? need_int(reading, connector, name) : body->m_mat + 1);
}

void read_rigid_spring(Reading& reading, FERigidConnector& fe) {
  RigidSpring spring;
  spring.material_a = connected_material(reading, fe, Connected::a(fe), "body_a");
  spring.material_b = connected_material(reading, fe, Connected::b(fe), "body_b");
  spring.insertion_a = vector_of(need_parameter(reading, fe, "insertion_a").value<vec3d>());
  spring.insertion_b = vector_of(need_parameter(reading, fe, "insertion_b").value<vec3d>());
  spring.k = need_number(reading, fe, "k");
  spring.free_length = need_number(reading, fe, "free_length");
  for (const char* name : {"k", "free_length", "insertion_a", "insertion_b"}) {
    if (controller_of(reading, need_parameter(reading, fe, name)) >= 0)
      unsupported(reading, fmt::format("rigid spring whose {} follows a load controller", name));
  }
  spring.step = step_of(reading, fe);
  spring.name = fe.GetName();
  reading.model.rigid_springs.push_back(std::move(spring));
}

void read_constraints(Reading& reading) {
  for (int i = 0; i < reading.fem.NonlinearConstraints(); ++i) {
    FENLConstraint& fe = *reading.fem.NonlinearConstraint(i);
    const std::string type = type_of(fe);
    auto* connector = dynamic_cast<FERigidConnector*>(&fe);
    if (type == "rigid spring" && connector != nullptr)
      read_rigid_spring(reading, *connector);
    else if (febio::is_damper(type))
      ignore(reading, fmt::format("{}: statics has no velocity", type));
    else if (type.rfind("rigid ", 0) == 0 || type == "generic rigid joint")
      unsupported(reading, fmt::format("rigid connector {}", quote(type)));
    else if (type == "symmetry plane")
      ignore(reading, "symmetry plane");
    else
      unsupported(reading, fmt::format("constraint {}", quote(type)));
  }
}

// -- contact and springs -----------------------------------------------------------------------------

/// The facet set a contact's surface was built from; -1: none.
int surface_index(const Reading& reading, FESurface* surface) {
  if (surface == nullptr) return -1;
  const auto place = reading.surfaces.find(surface->GetFacetSet());
  return place == reading.surfaces.end() ? -1 : place->second;
}

std::vector<std::string> ignored_parameters(Reading& reading, FECoreBase& fe, const std::string& type) {
  std::vector<std::string> ignored;
  for (const febio::ContactParameter& usual : febio::unused_contact_parameters(type)) {
    FEParam* parameter = fe.GetParameter(usual.name);
    if (parameter == nullptr) continue;
    const auto value = number_of(*parameter);
    if (value && *value == usual.usual && controller_of(reading, *parameter) < 0) continue;
    ignored.push_back(fmt::format("{} = {}", usual.name, value ? fmt::format("{:g}", *value) : "not one number"));
  }
  return ignored;
}

void read_contacts(Reading& reading) {
  for (int i = 0; i < reading.fem.SurfacePairConstraints(); ++i) {
    FESurfacePairConstraint& fe = *reading.fem.SurfacePairConstraint(i);
    Contact contact;
    contact.type = type_of(fe);
    const auto kind = febio::contact_kind(contact.type);
    if (!kind) {
      unsupported(reading, fmt::format("contact {}", quote(contact.type)));
      continue;
    }
    contact.primary = surface_index(reading, fe.GetPrimarySurface());
    contact.secondary = surface_index(reading, fe.GetSecondarySurface());
    if (contact.primary < 0 || contact.secondary < 0) {
      unsupported(reading,
                  fmt::format("contact {} with a surface that is no Surface of the mesh", quote(fe.GetName())));
      continue;
    }
    contact.name = fe.GetName();
    if (contact.name.empty()) contact.name = fmt::format("contact {}", reading.model.contacts.size() + 1);
    contact.kind = *kind;
    if (FEParam* distance = fe.GetParameter("max_distance")) contact.max_distance = number_of(*distance).value_or(0.0);
    contact.ignored = ignored_parameters(reading, fe, contact.type);
    if (auto* own = dynamic_cast<FEDeaContact*>(&fe)) contact.dea = own->statement(reading.model).dea;
    contact.step = step_of(reading, fe);
    reading.model.contacts.push_back(std::move(contact));
  }
}

/// Index of the discrete set a domain of springs was made from; a new one if there is none.
int discrete_set_of(Reading& reading, FEDomain& fe) {
  auto& sets = reading.model.discrete_sets;
  for (std::size_t i = 0; i < sets.size(); ++i)
    if (sets[i].name == fe.GetName()) return static_cast<int>(i);
  DiscreteSet set;
  set.name = fe.GetName();
  for (int i = 0; i < fe.Elements(); ++i) set.pairs.push_back({fe.ElementRef(i).m_node[0], fe.ElementRef(i).m_node[1]});
  sets.push_back(std::move(set));
  return static_cast<int>(sets.size()) - 1;
}

void read_discrete(Reading& reading) {
  FEMesh& mesh = reading.fem.GetMesh();
  for (int i = 0; i < mesh.Domains(); ++i) {
    FEDomain& fe = mesh.Domain(i);
    if (fe.Class() != FE_DOMAIN_DISCRETE) continue;
    FEMaterial* material = fe.GetMaterial();
    const std::string type = material == nullptr ? "" : type_of(*material);
    if (type != "linear spring" && type != "tension-only linear spring") {
      unsupported(reading, fmt::format("discrete material {}", quote(type)));
      continue;
    }
    FEParam& E = need_parameter(reading, *material, "E");
    const auto stiffness = number_of(E);
    if (!stiffness || controller_of(reading, E) >= 0) {
      unsupported(reading, "spring whose E is not one number");
      continue;
    }
    DiscreteSprings springs;
    springs.set = discrete_set_of(reading, fe);
    springs.stiffness = *stiffness;
    springs.tension_only = type != "linear spring";
    springs.name = fe.GetName();
    springs.origin = kNowhere;
    reading.model.discrete_springs.push_back(std::move(springs));
  }
}

}  // namespace

JointModel read_fe_model(FEModel& fem) {
  auto* mechanics = dynamic_cast<FEMechModel*>(&fem);
  if (mechanics == nullptr) throw InputError("a model without mechanics");
  auto* febio_model = dynamic_cast<FEBioModel*>(&fem);
  Reading reading{*mechanics, {}, {}, {}, {}, {}, {}, {}};
  JointModel& model = reading.model;
  model.files = {febio_model != nullptr ? febio_model->GetInputFileName() : std::string("model")};
  model.module = fem.GetModuleName();
  if (fem.GetUnits() != nullptr) model.units = fem.GetUnits();
  if (!febio::known_module(model.module)) unsupported(reading, fmt::format("module {}", quote(model.module)));

  read_materials(reading);
  read_mesh(reading);
  read_controllers(reading);
  read_steps(reading);
  read_boundary(reading);
  read_rigid_conditions(reading);
  read_loads(reading);
  read_constraints(reading);
  read_contacts(reading);
  read_discrete(reading);
  if (fem.MeshAdaptors() > 0) ignore(reading, "mesh adaptors");
  febio::refuse_unusable_controllers(model);
  return std::move(reading.model);
}

}  // namespace dea
