#include "plugin/read_fe_model.h"

#include <FEBioLib/FEBioModel.h>
#include <FEBioMech/FERigidConnector.h>
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
#include <FECore/FEMaterial.h>
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
#include <FECore/FEVec3dValuator.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "io/febio/febio_material.h"
#include "plugin/contact_statement.h"
#include "plugin/fe_reading.h"
#include "src/base/error.h"

namespace dea {

namespace {

using namespace fe;

// -- mesh --------------------------------------------------------------------------------------------

constexpr std::pair<int, ElementShape> kShapes[] = {
    {ET_TET4, ElementShape::Tet4},       {ET_TET5, ElementShape::Tet5},   {ET_TET10, ElementShape::Tet10},
    {ET_TET15, ElementShape::Tet15},     {ET_TET20, ElementShape::Tet20}, {ET_PENTA6, ElementShape::Penta6},
    {ET_PENTA15, ElementShape::Penta15}, {ET_HEX8, ElementShape::Hex8},   {ET_HEX20, ElementShape::Hex20},
    {ET_HEX27, ElementShape::Hex27},     {ET_PYRA5, ElementShape::Pyra5}, {ET_PYRA13, ElementShape::Pyra13},
    {ET_QUAD4, ElementShape::Quad4},     {ET_QUAD8, ElementShape::Quad8}, {ET_QUAD9, ElementShape::Quad9},
    {ET_TRI3, ElementShape::Tri3},       {ET_TRI6, ElementShape::Tri6},   {ET_TRUSS2, ElementShape::Line2},
    {ET_LINE2, ElementShape::Line2},     {ET_LINE3, ElementShape::Line3}};

/// FEBio keeps numbers of nodes that do not exist where it looks at them only as it solves.
void need_nodes(const Reading& reading, const char* what, const std::string& name, const std::vector<int>& nodes) {
  const int count = static_cast<int>(reading.model.nodes.size());
  if (std::all_of(nodes.begin(), nodes.end(), [&](int node) { return node >= 0 && node < count; })) return;
  fail(reading,
       fmt::format("{} {} uses a node that does not exist: mend the number, or add the node", what, quote(name)));
}

/// Fibres that are given element by element; nullptr: the material says it for all, or has none.
FEVec3dValuator* fibres_by_element(FECoreBase& material) {
  FEProperty* property = material.FindProperty("fiber");
  auto* fibre =
      property == nullptr || property->size() == 0 ? nullptr : dynamic_cast<FEVec3dValuator*>(property->get(0));
  const std::string type = fibre == nullptr ? "" : type_of(*fibre);
  return type == "map" || type == "user" ? fibre : nullptr;
}

/// Fibres that elements have of their own, and the axes of all: of their own or the material's.
void read_directions(FEDomain& fe, Domain& domain) {
  FEMaterial* material = fe.GetMaterial();
  if (material == nullptr || fe.Class() != FE_DOMAIN_SOLID) return;
  FEVec3dValuator* fibre = fibres_by_element(*material);
  bool turned = false;
  for (int i = 0; i < fe.Elements(); ++i) {
    FEMaterialPoint* point = fe.ElementRef(i).GetMaterialPoint(0);
    if (point == nullptr) return;
    if (fibre != nullptr) domain.fibre[""].push_back(vector_of(fibre->unitVector(*point)));
    const mat3d Q = material->GetLocalCS(*point);
    Eigen::Matrix3d& axes = domain.axes.emplace_back();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) axes(row, column) = Q(row, column);
    turned = turned || !axes.isIdentity(0);
  }
  if (!turned) domain.axes.clear();
}

void read_domain(Reading& reading, FEDomain& fe) {
  if (fe.Elements() == 0) return;
  const auto* shape = std::find_if(std::begin(kShapes), std::end(kShapes),
                                   [&](const auto& row) { return row.first == fe.ElementRef(0).Shape(); });
  if (shape == std::end(kShapes)) {
    unsupported(reading, fmt::format("elements of a kind of their own in {}", quote(fe.GetName())));
    return;
  }
  Domain domain;
  domain.name = fe.GetName();
  domain.shape = shape->second;
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
  read_directions(fe, domain);
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
    Surface surface = {{}, set.GetName(), kNowhere};
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
    NodeSet set = {fe.GetName(), {}, kNowhere};
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
    DiscreteSet set = {fe.GetName(), {}, kNowhere};
    for (int k = 0; k < fe.size(); ++k) {
      need_nodes(reading, "discrete set", set.name, {fe.Element(k).n0, fe.Element(k).n1});
      set.pairs.push_back({fe.Element(k).n0, fe.Element(k).n1});
    }
    model.discrete_sets.push_back(std::move(set));
  }
  if (mesh.DataMaps() > 0 || reading.fem.MeshDataGenerators() > 0) ignore(reading, "mesh data");
}

// -- materials ---------------------------------------------------------------------------------------

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
    const febio::Component given = component_of(reading, *fe, "material");
    if (material.rigid) {
      if (febio::flag_of(reading, given, "override_com"))
        material.center_of_mass = vector_of(need_parameter(reading, *fe, "center_of_mass").value<vec3d>());
      material.note = "rigid body";
    } else {
      // FEBio's reader has added nested k of old files already.
      set_elasticity(material, given, false, model);
    }
    std::string why;
    set_density(material, given, model, why);
    if (std::isnan(material.density) && material.rigid && !material.center_of_mass)
      unsupported(reading, fmt::format("rigid body whose density is not one number ({})", why),
                  "give it a center_of_mass");
    reading.materials.emplace(fe, static_cast<int>(model.materials.size()));
    model.materials.push_back(std::move(material));
  }
}

// -- steps and load controllers ----------------------------------------------------------------------

/// Interpolation, extension and points of a curve.
void set_curve(LoadController& curve, const FELoadCurve& fe) {
  febio::set_interpolate(curve, std::to_string(fe.GetInterpolation()));
  febio::set_extend(curve, std::to_string(fe.GetExtendMode()));
  for (const vec2d& point : fe.GetPoints()) curve.points.push_back({point.x(), point.y()});
  febio::check_times(curve);
}

void read_controllers(Reading& reading) {
  for (int i = 0; i < reading.fem.LoadControllers(); ++i) {
    FELoadController& fe = *reading.fem.GetLoadController(i);
    LoadController controller;
    controller.id = i + 1;
    controller.name = fe.GetName();
    if (const auto* curve = dynamic_cast<const FELoadCurve*>(&fe))
      set_curve(controller, *curve);
    else if (type_of(fe) == "math")
      febio::set_expression(controller, text_of(fe, "math"),
                            !need_parameter(reading, fe, "var").value<std::vector<std::string>>().empty());
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

// -- conditions ----------------------------------------------------------------------------------------

/// Nodes of a set, for a condition of this name.
febio::OnNodes on_nodes(const Reading& reading, const FEStepComponent& condition, const FENodeSet& set) {
  febio::OnNodes on = {{}, condition.GetName(), set.GetName(), kNowhere, steps_of(reading, condition)};
  for (int i = 0; i < set.Size(); ++i) on.nodes.push_back(set[i]);
  return on;
}

febio::OnNodes on_nodes(const Reading& reading, FENodalBC& condition) {
  FENodeSet* set = condition.GetNodeSet();
  if (set == nullptr) fail(reading, fmt::format("bc {} without a node set", quote(type_of(condition))));
  return on_nodes(reading, condition, *set);
}

/// Before all other conditions: which nodes are a body's.
void read_rigid_nodes(Reading& reading) {
  for (int i = 0; i < reading.fem.BoundaryConditions(); ++i) {
    auto* nodal = dynamic_cast<FENodalBC*>(reading.fem.BoundaryCondition(i));
    if (nodal == nullptr || type_of(*nodal) != "rigid") continue;
    const febio::OnNodes on = on_nodes(reading, *nodal);
    febio::add(reading.model.rigid_nodes,
               RigidNodes{{}, febio::body_of(reading, component_of(reading, *nodal, "bc")), on.nodes}, on.name,
               kNowhere, on.steps);
  }
}

void read_boundary_condition(Reading& reading, FEBoundaryCondition& fe) {
  const febio::Component component = component_of(reading, fe, "bc");
  const std::string& type = component.type;
  auto* nodal = dynamic_cast<FENodalBC*>(&fe);
  const auto prescribe = [&](const char* value) {
    febio::prescribe_nodes(reading, on_nodes(reading, *nodal), febio::text_of(component, "dof"),
                           febio::find(component, value), febio::flag_of(reading, component, "relative"));
  };
  if (nodal == nullptr)
    febio::other_boundary_condition(reading, component, fmt::format("bc {}", quote(type)));
  else if (type == "zero displacement")
    febio::zero_displacement(reading, component, on_nodes(reading, *nodal));
  else if (type == "fix")
    febio::fix_nodes(reading, on_nodes(reading, *nodal), febio::text_of(component, "dofs"));
  else if (type == "prescribed displacement")
    prescribe("value");
  else if (type == "prescribe")
    prescribe("scale");
  else if (type != "rigid")  // read_rigid_nodes
    febio::other_boundary_condition(reading, component, fmt::format("bc {}", quote(type)));
}

void read_boundary(Reading& reading) {
  for (int i = 0; i < reading.fem.BoundaryConditions(); ++i) {
    FEBoundaryCondition& fe = *reading.fem.BoundaryCondition(i);
    if (dynamic_cast<FERigidBC*>(&fe) == nullptr) read_boundary_condition(reading, fe);  // read_rigid_conditions
  }
  if (reading.fem.GetLinearConstraintManager().LinearConstraints() > 0)
    unsupported(reading, "bc \"linear constraint\"", febio::word_advice(febio::WordOf::Boundary, "linear constraint"));
}

void read_rigid_conditions(Reading& reading) {
  for (int i = 0; i < reading.fem.RigidBCs(); ++i) {
    FERigidBC& fe = *reading.fem.GetRigidBC(i);
    febio::Component component = component_of(reading, fe, "rigid_bc");
    // FEBio's words for what files before 4.0 say
    if (component.type == "rigid_fixed_old") component.type = "fix";
    if (component.type == "rigid_prescribed_old") component.type = "prescribe";
    if (!febio::rigid_condition(reading, component, steps_of(reading, fe)))
      unsupported(reading, fmt::format("rigid_bc {}", quote(component.type)),
                  febio::word_advice(febio::WordOf::RigidCondition, component.type));
  }
}

/// FEBio's section of a load: its tag in a file.
const char* tag_of(FEModelLoad& fe) {
  return dynamic_cast<FESurfaceLoad*>(&fe) != nullptr ? "surface_load"
         : dynamic_cast<FENodalLoad*>(&fe) != nullptr ? "nodal_load"
         : dynamic_cast<FEBodyLoad*>(&fe) != nullptr  ? "body_load"
         : type_of(fe).rfind("rigid", 0) == 0         ? "rigid_load"
                                                      : "load";
}

void read_nodal_load(Reading& reading, FENodalLoad& fe, const febio::Component& component) {
  const FENodeSet* set = fe.GetNodeSet();
  if (set == nullptr)
    fail(reading, "nodal_load without a node set: FEBio 4 forgets it in files of version 2.0, save the file as 4.0");
  febio::nodal_load(reading, component, on_nodes(reading, fe, *set));
}

void read_loads(Reading& reading) {
  for (int i = 0; i < reading.fem.ModelLoads(); ++i) {
    FEModelLoad& fe = *reading.fem.ModelLoad(i);
    const febio::Component component = load_of(reading, fe, tag_of(fe));
    if (febio::rigid_condition(reading, component, steps_of(reading, fe))) continue;
    auto* nodal = dynamic_cast<FENodalLoad*>(&fe);
    if (nodal != nullptr && (component.type == "nodal_load" || component.type == "nodal_force"))
      read_nodal_load(reading, *nodal, component);
    else
      febio::other_load(reading, component);
  }
  for (int i = 0; i < reading.fem.InitialConditions(); ++i)
    febio::initial_condition(reading, component_of(reading, *reading.fem.InitialCondition(i), "ic"));
}

/// The facet set a contact's surface was built from; -1: none.
int surface_index(const Reading& reading, FESurface* surface) {
  if (surface == nullptr) return -1;
  const auto place = reading.surfaces.find(surface->GetFacetSet());
  return place == reading.surfaces.end() ? -1 : place->second;
}

void read_constraint(Reading& reading, FENLConstraint& fe) {
  auto* connector = dynamic_cast<FERigidConnector*>(&fe);
  const febio::Component component =
      connector != nullptr ? connector_of(reading, *connector) : component_of(reading, fe, "constraint");
  const febio::Steps steps = steps_of(reading, fe);
  if (component.type == "symmetry plane") {
    auto* plane = dynamic_cast<FESurfaceConstraint*>(&fe);
    const int surface = plane == nullptr ? -1 : surface_index(reading, plane->GetSurface());
    febio::symmetry_plane(reading, component, surface, steps);
  } else if (!febio::rigid_connector(reading, component, steps)) {
    febio::other_constraint(reading, component);
  }
}

void read_constraints(Reading& reading) {
  for (int i = 0; i < reading.fem.NonlinearConstraints(); ++i)
    read_constraint(reading, *reading.fem.NonlinearConstraint(i));
}

// -- contact ------------------------------------------------------------------------------------------

void read_contacts(Reading& reading) {
  for (int i = 0; i < reading.fem.SurfacePairConstraints(); ++i) {
    FESurfacePairConstraint& fe = *reading.fem.SurfacePairConstraint(i);
    const std::string type = type_of(fe);
    if (!febio::contact_kind(type)) {
      unsupported(reading, fmt::format("contact {}", quote(type)), febio::word_advice(febio::WordOf::Contact, type));
      continue;
    }
    const int primary = surface_index(reading, fe.GetPrimarySurface());
    const int secondary = surface_index(reading, fe.GetSecondarySurface());
    if (primary < 0 || secondary < 0) {
      unsupported(reading,
                  fmt::format("contact {} with a surface that is no Surface of the mesh", quote(fe.GetName())));
      continue;
    }
    Contact contact = febio::contact_of(reading, component_of(reading, fe, "contact"));
    contact.primary = primary;
    contact.secondary = secondary;
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
  Reading reading(*mechanics);
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
  febio::resolve_controllers(model);
  febio::check_joints(reading);
  febio::hold_from_the_start(reading);
  febio::remark_double_motion(reading);
  febio::refuse_moved_rigid_nodes(model, reading.unsupported_index);
  febio::refuse_unusable_controllers(model);
  return std::move(reading.model);
}

}  // namespace dea
