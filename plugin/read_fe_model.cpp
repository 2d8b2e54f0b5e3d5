#include <febiodea/plugin/read_fe_model.h>

#include <FEBioLib/FEBioModel.h>
#include <FEBioMech/RigidBC.h>
#include <FECore/FEAnalysis.h>
#include <FECore/FEBodyLoad.h>
#include <FECore/FEBoundaryCondition.h>
#include <FECore/FEDiscreteMaterial.h>
#include <FECore/FEDiscreteSet.h>
#include <FECore/FEFacetSet.h>
#include <FECore/FEInitialCondition.h>
#include <FECore/FELinearConstraintManager.h>
#include <FECore/FELoadCurve.h>
#include <FECore/FEMesh.h>
#include <FECore/FEModelLoad.h>
#include <FECore/FEModelParam.h>
#include <FECore/FENLConstraint.h>
#include <FECore/FENodalBC.h>
#include <FECore/FENodalLoad.h>
#include <FECore/FEShellDomain.h>
#include <FECore/FESurfaceConstraint.h>
#include <FECore/FESurfaceLoad.h>
#include <FECore/FESurfacePairConstraint.h>
#include <FECore/FETimeStepController.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <febiodea/base/error.h>
#include <febiodea/io/febio/febio_material.h>
#include <febiodea/model/load_curve.h>
#include <febiodea/plugin/contact_statement.h>
#include <febiodea/plugin/fe_reading.h>

namespace dea {

namespace {

using namespace fe;

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

/// FEBio keeps numbers of nodes that do not exist where it looks at them only as it solves.
void need_nodes(const Reading& reading, const char* what, const std::string& name, const std::vector<int>& nodes) {
  const int count = static_cast<int>(reading.model.nodes.size());
  if (std::all_of(nodes.begin(), nodes.end(), [&](int node) { return node >= 0 && node < count; })) return;
  fail(reading,
       fmt::format("{} {} uses a node that does not exist: mend the number, or add the node", what, quote(name)));
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
  need_nodes(reading, "domain", domain.name, domain.nodes);
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
    need_nodes(reading, "surface", surface.name, surface.nodes);
    reading.surfaces.emplace(&set, static_cast<int>(model.surfaces.size()));
    model.surfaces.push_back(std::move(surface));
  }
  for (int i = 0; i < mesh.NodeSets(); ++i) {
    const FENodeSet& fe = *mesh.NodeSet(i);
    NodeSet set;
    set.name = fe.GetName();
    for (int k = 0; k < fe.Size(); ++k) set.nodes.push_back(fe[k]);
    need_nodes(reading, "node set", set.name, set.nodes);
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
    for (int k = 0; k < fe.size(); ++k) {
      need_nodes(reading, "discrete set", set.name, {fe.Element(k).n0, fe.Element(k).n1});
      set.pairs.push_back({fe.Element(k).n0, fe.Element(k).n1});
    }
    model.discrete_sets.push_back(std::move(set));
  }
  if (mesh.DataMaps() > 0 || reading.fem.MeshDataGenerators() > 0) ignore(reading, "mesh data");
}

// -- materials ---------------------------------------------------------------------------------------

/// Value of an expression without variables.
void set_constant(MaterialTree::Constant& constant, const char* name, const std::string& expression) {
  try {
    constant.value = constant_value(expression);
  } catch (const InputError& error) {
    constant.why = fmt::format("{}: {}", name, error.what());
  }
}

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
      FEScalarValuator* values = parameter.value<FEParamDouble>().valuator();
      const std::string kind = kind_of(parameter), text = kind == "math" ? text_of(*values, "math") : "";
      if (!text.empty() && expression_fault(text, {}).empty())
        set_constant(constant, name, text);
      else
        constant.why = fmt::format("{} is a {}, not one number", name, quote(kind));
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
      unsupported(reading, fmt::format("rigid body whose density is not one number ({})", why),
                  "give it a center_of_mass");
    reading.materials.emplace(fe, static_cast<int>(model.materials.size()));
    model.materials.push_back(std::move(material));
  }
}

// -- steps and load controllers ----------------------------------------------------------------------

/// A controller of type math: an expression in t. Its <var> are numbers of FEBio's model, which change as it is solved.
void set_expression(Reading& reading, FECoreBase& fe, LoadController& controller) {
  controller.expression = text_of(fe, "math");
  std::string fault = expression_fault(controller.expression, {"t"});
  if (!need_parameter(reading, fe, "var").value<std::vector<std::string>>().empty())
    fault = "a <var>, a number of FEBio's model";
  if (!fault.empty()) controller.unsupported = fmt::format("expression {}: {}", quote(controller.expression), fault);
}

void read_controllers(Reading& reading) {
  for (int i = 0; i < reading.fem.LoadControllers(); ++i) {
    FELoadController& fe = *reading.fem.GetLoadController(i);
    LoadController controller;
    controller.id = i + 1;
    controller.name = fe.GetName();
    if (const auto* curve = dynamic_cast<const FELoadCurve*>(&fe))
      set_curve(controller, curve->GetInterpolation(), curve->GetExtendMode(), curve->GetPoints());
    else if (type_of(fe) == "math")
      set_expression(reading, fe, controller);
    else
      controller.unsupported = fmt::format("type {}", quote(type_of(fe)));
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
      if (controller.points.empty() && (!controller.unsupported.empty() || !controller.expression.empty()))
        ignore(reading, fmt::format("dtmax: load controller {} with {} gives no must points", controller.id,
                                    controller.unsupported.empty() ? "an expression" : controller.unsupported));
    }
    const std::string remark = febio::analysis_remark(model.module, fe.m_nanalysis == 1);
    if (!remark.empty()) ignore(reading, remark);
    begin += step.duration;
    model.steps.push_back(std::move(step));
    for (int k = 0; k < fe.StepComponents(); ++k) {
      std::vector<int>& steps = reading.steps_of[fe.GetStepComponent(k)];
      if (steps.empty() || steps.back() != i) steps.push_back(i);
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
  add(reading, condition, reading.model.fixed_nodes, FixedNodes{nodes_of(reading, condition), xyz, -1, {}, {}});
}

void prescribe_nodes(Reading& reading, FENodalBC& condition, const char* value) {
  const int dof = need_int(reading, condition, "dof");
  const int place = xyz_of(reading, dof);
  if (place < 0) {
    const std::string name = dof_name(reading, dof);
    if (one_of(name, {"u", "v", "w", "sx", "sy", "sz"}))
      unsupported(reading, fmt::format("prescribed shell dof {}", quote(name)),
                  "take it out: DEA has no deformable shells, take their material as rigid with --rigid");
    else
      ignore(reading, fmt::format("prescribed dof {}: no displacement", quote(name)));
  } else if (is_zero(need_parameter(reading, condition, value)) && !flag(condition, "relative")) {
    std::array<bool, 3> xyz = {};
    xyz[static_cast<std::size_t>(place)] = true;
    fix_nodes(reading, condition, xyz);
  } else if (!number_of(need_parameter(reading, condition, value))) {  // a map or an expression of the place
    unsupported(reading, febio::kMovedApart, febio::kMovedApartAdvice);
  } else {
    PrescribedNodes prescribed;
    prescribed.nodes = nodes_of(reading, condition);
    prescribed.component = place;
    prescribed.value = need_scaled(reading, condition, value);
    prescribed.relative = flag(condition, "relative");
    const std::string set = condition.GetNodeSet()->GetName();
    std::vector<PrescribedNodes>& all = reading.model.prescribed_nodes;
    const std::size_t before = all.size();
    add(reading, condition, all, prescribed);
    for (std::size_t i = before; i < all.size(); ++i)
      if (all[i].name.empty()) all[i].name = set.empty() ? "moved nodes" : set;
  }
}

void read_rigid_nodes(Reading& reading) {
  for (int i = 0; i < reading.fem.BoundaryConditions(); ++i) {
    auto* nodal = dynamic_cast<FENodalBC*>(reading.fem.BoundaryCondition(i));
    if (nodal == nullptr || type_of(*nodal) != "rigid") continue;
    add(reading, *nodal, reading.model.rigid_nodes,
        RigidNodes{body_of(reading, *nodal), nodes_of(reading, *nodal), -1, {}, {}});
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
      continue;  // read_rigid_nodes
    } else if (type == "zero rotation" || type == "zero shell displacement" || has(type, "fluid") ||
               has(type, "concentration") || has(type, "temperature")) {
      ignore(reading, fmt::format("bc {}", quote(type)));
    } else {
      unsupported(reading, fmt::format("bc {}", quote(type)), febio::word_advice(febio::WordOf::Boundary, type));
    }
  }
  if (reading.fem.GetLinearConstraintManager().LinearConstraints() > 0)
    unsupported(reading, "bc \"linear constraint\"", febio::word_advice(febio::WordOf::Boundary, "linear constraint"));
}

// -- rigid bodies ------------------------------------------------------------------------------------

void add_prescribed(Reading& reading, FEStepComponent& fe, int dof, const Scaled& value) {
  if (dof < 0 || dof >= kDofs) fail(reading, fmt::format("{} without a dof", quote(type_of(fe))));
  RigidPrescribed motion;
  motion.material = body_of(reading, fe);
  motion.dof = dof;
  motion.value = value;
  motion.relative = flag(fe, "relative");
  add(reading, fe, reading.model.rigid_prescribed, std::move(motion));
}

void remark_double_motion(Reading& reading) {
  std::map<std::pair<int, int>, const RigidPrescribed*> before;  // of a material and dof
  for (const RigidPrescribed& motion : reading.model.rigid_prescribed) {
    const RigidPrescribed*& other = before[{motion.material, motion.dof}];
    if (other != nullptr && (other->step == motion.step || other->step < 0)) {
      ignore(reading, fmt::format("prescribed {} of {}: it is prescribed again, and the last one counts, as in FEBio",
                                  kDofNames[motion.dof],
                                  quote(reading.model.materials[static_cast<std::size_t>(motion.material)].name)));
    }
    other = &motion;
  }
}

/// Euler angles [degrees]: x, then y, then z about the fixed axes. As a rotation vector if they are constant; a single
/// angle may follow a load controller.
void read_euler_angles(Reading& reading, FEStepComponent& fe) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::array<Scaled, 3> angles;
  int turning = 0, steered = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    angles[i] = need_scaled(reading, fe, std::array{"Ex", "Ey", "Ez"}[i]);
    if (angles[i].factor == 0) angles[i].controller = -1;
    angles[i].factor *= kDegree;
    turning += angles[i].factor != 0 ? 1 : 0;
    steered += angles[i].controller >= 0 ? 1 : 0;
  }
  if (turning > 1 && steered > 0) {
    unsupported(reading, "rigid_euler_angles of which several turn and one follows a load controller",
                "give rigid_rotation_vector, or let one angle alone turn");
    return;
  }
  if (turning > 1) {
    const Eigen::Quaterniond q = Eigen::AngleAxisd(angles[2].factor, Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(angles[1].factor, Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(angles[0].factor, Vector3d::UnitX());
    const Eigen::AngleAxisd turn(q);
    for (int i = 0; i < 3; ++i) angles[static_cast<std::size_t>(i)].factor = turn.angle() * turn.axis()[i];
  }
  for (std::size_t i = 0; i < 3; ++i) add_prescribed(reading, fe, 3 + static_cast<int>(i), angles[i]);
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
      if (type == "rigid_fixed") {
        for (std::size_t k = 0; k < kDofs; ++k) fixed.dofs[k] = flag(fe, kFlags[k]);
      } else {
        for (const int dof : need_parameter(reading, fe, "dofs").value<std::vector<int>>()) {
          if (dof < 0 || dof >= kDofs) fail(reading, "rigid condition with a dof that is none of Rx,Ry,Rz,Ru,Rv,Rw");
          fixed.dofs[static_cast<std::size_t>(dof)] = true;
        }
      }
      add(reading, fe, reading.model.rigid_fixed, std::move(fixed));
    } else if (type == "rigid_prescribed_old") {
      add_prescribed(reading, fe, need_int(reading, fe, "dof"), need_scaled(reading, fe, "value"));
    } else if (type == "rigid_displacement" || type == "rigid_rotation") {
      add_prescribed(reading, fe, rigid_dof_of(reading, fe), need_scaled(reading, fe, "value"));
    } else if (type == "rigid_rotation_vector") {
      add_prescribed(reading, fe, 3, need_scaled(reading, fe, "vx"));
      add_prescribed(reading, fe, 4, need_scaled(reading, fe, "vy"));
      add_prescribed(reading, fe, 5, need_scaled(reading, fe, "vz"));
    } else if (type == "rigid_euler_angles") {
      read_euler_angles(reading, fe);
    } else {
      unsupported(reading, fmt::format("rigid_bc {}", quote(type)),
                  febio::word_advice(febio::WordOf::RigidCondition, type));
    }
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
    if (read_rigid_load(reading, fe)) continue;
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
      unsupported(reading, what, febio::load_advice(section, type));
  }
  for (int i = 0; i < reading.fem.InitialConditions(); ++i) {
    const std::string type = type_of(*reading.fem.InitialCondition(i));
    if (has(type, "prestrain"))
      unsupported(reading, fmt::format("initial {}", quote(type)),
                  "take it out: DEA's cartilage starts without stress");
    else
      ignore(reading, "initial conditions");
  }
}

/// The facet set a contact's surface was built from; -1: none.
int surface_index(const Reading& reading, FESurface* surface) {
  if (surface == nullptr) return -1;
  const auto place = reading.surfaces.find(surface->GetFacetSet());
  return place == reading.surfaces.end() ? -1 : place->second;
}

void read_constraints(Reading& reading) {
  for (int i = 0; i < reading.fem.NonlinearConstraints(); ++i) {
    FENLConstraint& fe = *reading.fem.NonlinearConstraint(i);
    const std::string type = type_of(fe);
    if (read_connector(reading, fe)) continue;
    if (type == "symmetry plane") {
      auto* on_surface = dynamic_cast<FESurfaceConstraint*>(&fe);
      const int place = on_surface == nullptr ? -1 : surface_index(reading, on_surface->GetSurface());
      const int axis =
          place < 0 ? -1 : febio::plane_axis(reading.model, reading.model.surfaces[static_cast<std::size_t>(place)]);
      if (axis < 0) {
        unsupported(reading, "constraint \"symmetry plane\"", febio::kPlaneAdvice);
      } else {
        std::array<bool, 3> xyz = {};
        xyz[static_cast<std::size_t>(axis)] = true;
        add(reading, fe, reading.model.fixed_nodes,
            FixedNodes{
                febio::nodes_of_surface(reading.model.surfaces[static_cast<std::size_t>(place)]), xyz, -1, {}, {}});
      }
    } else
      unsupported(reading, fmt::format("constraint {}", quote(type)),
                  febio::word_advice(febio::WordOf::Connector, type));
  }
}

// -- contact ------------------------------------------------------------------------------------------

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
      unsupported(reading, fmt::format("contact {}", quote(contact.type)),
                  febio::word_advice(febio::WordOf::Contact, contact.type));
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
    if (auto* own = dynamic_cast<StatesContact*>(&fe)) contact.dea = own->statement(reading.model).dea;
    contact.step = steps_of(reading, fe).front();  // a contact is of one step, or of all
    reading.model.contacts.push_back(std::move(contact));
  }
}

}  // namespace

JointModel read_fe_model(FEModel& fem) {
  auto* mechanics = dynamic_cast<FEMechModel*>(&fem);
  if (mechanics == nullptr) throw InputError("a model without mechanics");
  auto* febio_model = dynamic_cast<FEBioModel*>(&fem);
  Reading reading{*mechanics, mechanics->RigidBodies() > 0, {}, {}, {}, {}, {}, {}};
  JointModel& model = reading.model;
  model.files = {febio_model != nullptr ? febio_model->GetInputFileName() : std::string("model")};
  model.module = fem.GetModuleName();
  if (fem.GetUnits() != nullptr) model.units = fem.GetUnits();
  if (!febio::known_module(model.module))
    unsupported(reading, fmt::format("module {}", quote(model.module)),
                febio::word_advice(febio::WordOf::Module, model.module));

  read_materials(reading);
  read_mesh(reading);
  read_controllers(reading);
  read_steps(reading);
  read_rigid_nodes(reading);
  read_boundary(reading);
  read_rigid_conditions(reading);
  read_constraints(reading);  // before loads, as most files have it: FEBio does not keep the order of the two
  read_loads(reading);
  read_contacts(reading);
  read_discrete(reading);
  if (fem.MeshAdaptors() > 0) ignore(reading, "mesh adaptors");
  check_joints(reading);
  remark_double_motion(reading);
  febio::refuse_moved_rigid_nodes(model, reading.unsupported_index);
  febio::refuse_unusable_controllers(model);
  return std::move(reading.model);
}

}  // namespace dea
