#include "plugin/dea_contact.h"

#include <FEBioMech/FEMechModel.h>
#include <FEBioMech/FERigidBody.h>
#include <FECore/FEAnalysis.h>
#include <FECore/FEGlobalMatrix.h>
#include <FECore/FEGlobalVector.h>
#include <FECore/FELinearSystem.h>
#include <FECore/FEMesh.h>
#include <FECore/FENewtonSolver.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "plugin/febio_log.h"
#include "plugin/febio_wording.h"
#include "plugin/read_fe_model.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/rules/rules.h"
#include "src/run/analysis.h"
#include "src/springs/press.h"
#include "src/springs/spring_law.h"
#include "src/springs/wrench.h"

namespace {

using dea::at;

vec3d to_fe(const dea::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
dea::Vector3d from_fe(const vec3d& v) { return {v.x, v.y, v.z}; }
Eigen::Quaterniond from_fe(const quatd& q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized(); }

constexpr double kOpens = 0.1;  // of the load's force: what opens the joint, and is no rounding of its surfaces

}  // namespace

// -- the surfaces --------------------------------------------------------------------------------------------------

FEDeaSurface::FEDeaSurface(FEModel* fem) : FEContactSurface(fem) {}

FEMaterialPoint* FEDeaSurface::CreateMaterialPoint() { return new FEContactMaterialPoint; }

void FEDeaSurface::set_layer(const dea::Layer& layer) {
  const std::unordered_map<int, int> vertex_of_node = dea::articular_vertices(layer);
  facet_vertices_.assign(at(Elements()), {});
  for (int f = 0; f < Elements(); ++f) {
    const FESurfaceElement& facet = Element(f);
    for (int k = 0; k < facet.Nodes(); ++k) {
      // the middle node of a facet of nine may be no vertex of the triangles it is cut into
      const auto found = vertex_of_node.find(facet.m_node[at(k)]);
      facet_vertices_[at(f)].push_back(found == vertex_of_node.end() ? -1 : found->second);
    }
  }
}

void FEDeaSurface::set_fields(dea::SideFields fields, std::vector<vec3d> tractions) {
  fields_ = std::make_unique<dea::SideFields>(std::move(fields));
  tractions_ = std::move(tractions);
  for (int f = 0; f < Elements(); ++f) {
    FESurfaceElement& facet = Element(f);
    for (int k = 0; k < facet.GaussPoints(); ++k) {
      auto* point = dynamic_cast<FEContactMaterialPoint*>(facet.GetMaterialPoint(k));
      if (point == nullptr) continue;
      point->m_Ln = fields_->pressure[at(f)];
      point->m_gap = 0.0;
    }
  }
}

vec3d FEDeaSurface::GetContactForce() { return fields_ ? to_fe(fields_->force) : vec3d(0, 0, 0); }

double FEDeaSurface::GetContactArea() { return fields_ ? fields_->contact_area : 0.0; }

void FEDeaSurface::GetContactTraction(int facet, vec3d& traction) {
  traction = fields_ ? tractions_[at(facet)] : vec3d(0, 0, 0);
}

void FEDeaSurface::GetNodalContactPressure(int facet, double* pressure) {
  for (std::size_t k = 0; k < facet_vertices_[at(facet)].size(); ++k) {
    const int v = facet_vertices_[at(facet)][k];
    pressure[k] = !fields_ ? 0.0 : v >= 0 ? fields_->vertex_pressure[at(v)] : fields_->pressure[at(facet)];
  }
}

void FEDeaSurface::GetNodalContactTraction(int facet, vec3d* traction) {
  for (int k = 0; k < Element(facet).Nodes(); ++k) GetContactTraction(facet, traction[k]);
}

void FEDeaSurface::GetVectorGap(int, vec3d& gap) { gap = vec3d(0, 0, 0); }

void FEDeaSurface::GetNodalVectorGap(int facet, vec3d* gap) {
  for (int k = 0; k < Element(facet).Nodes(); ++k) gap[k] = vec3d(0, 0, 0);
}

// -- the contact ---------------------------------------------------------------------------------------------------

BEGIN_FECORE_CLASS(FEDeaContact, FEContactInterface)
ADD_PARAMETER(law_, "law")->setEnums("linear\0logarithmic\0neo-Hookean\0layer\0");
ADD_PARAMETER(facets_, "facets")->setEnums("curved\0flat\0");
ADD_PARAMETER(source_, "source")->setEnums("primary\0secondary\0");
ADD_PARAMETER(refine_, "refine");
ADD_PARAMETER(symmetry_planes_, "symmetry_planes");
ADD_PARAMETER(E_[0], "primary_E")->setUnits(UNIT_PRESSURE);
ADD_PARAMETER(nu_[0], "primary_nu");
ADD_PARAMETER(thickness_[0], "primary_thickness")->setUnits(UNIT_LENGTH);
ADD_PARAMETER(E_[1], "secondary_E")->setUnits(UNIT_PRESSURE);
ADD_PARAMETER(nu_[1], "secondary_nu");
ADD_PARAMETER(thickness_[1], "secondary_thickness")->setUnits(UNIT_LENGTH);
END_FECORE_CLASS();

/// Everything that follows from the reference configuration, and the springs at the last poses.
struct FEDeaContact::Bed {
  dea::JointModel model;  // with this contact alone
  dea::Joint joint;       // this contact alone
  dea::SpringBeds beds;
  dea::FieldMaps maps;
  FERigidBody* bodies[2] = {nullptr, nullptr};  // target, source
  dea::Pose poses[2];                           // of the evaluation below: target, source
  bool evaluated = false;
  dea::SpringStates springs;
  dea::ContactWrench wrench;
  dea::PressMemory memory;     // where the search for pressures starts
  dea::StateResult shown;      // the fields in the surfaces; without statistics
  bool output = false;         // it is there
  dea::SolvedStates solution;  // states that FEBio has found, with what their rules look at

  const dea::SpringBed& bed() const { return beds.beds.front(); }
};

FEDeaContact::FEDeaContact(FEModel* fem) : FEContactInterface(fem), surfaces_{FEDeaSurface(fem), FEDeaSurface(fem)} {
  static int count = 1;
  SetID(count++);
  for (int side = 0; side < 2; ++side) {
    surfaces_[side].SetContactInterface(this);
    surfaces_[side].SetSibling(&surfaces_[1 - side]);
  }
}

FEDeaContact::~FEDeaContact() = default;

namespace {

/// Per facet, its nodes in rising order.
std::set<std::vector<int>> facets_of(const dea::Surface& surface) {
  std::set<std::vector<int>> facets;
  for (int f = 0; f < surface.size(); ++f) {
    std::vector<int> nodes(surface.nodes.begin() + surface.begin[at(f)],
                           surface.nodes.begin() + surface.begin[at(f + 1)]);
    std::sort(nodes.begin(), nodes.end());
    facets.insert(std::move(nodes));
  }
  return facets;
}

/// Cartilage, as the contact states it; a bare surface may be pressed by several contacts.
bool has_layer(const dea::Contact& c, int side) {
  const dea::DeaLayer& layer = c.dea->layers[side];
  return layer.E && !(layer.thickness && *layer.thickness == 0.0);
}

/// The facets that a layer of one contact shares with a layer of the other, where their other sides are on one body.
/// `body_of`: per model node.
int shared_facets(const dea::JointModel& model, const dea::Contact& a, const dea::Contact& b,
                  const std::function<int(int)>& body_of) {
  int shared = 0;
  const int of_a[2] = {a.primary, a.secondary}, of_b[2] = {b.primary, b.secondary};
  const auto body = [&](int surface) { return body_of(model.surfaces[at(surface)].nodes.front()); };
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k) {
      if (!has_layer(a, i) || !has_layer(b, k) || body(of_a[i]) != body(of_b[k]) ||
          body(of_a[1 - i]) != body(of_b[1 - k]))
        continue;
      const std::set<std::vector<int>> one = facets_of(model.surfaces[at(of_a[i])]);
      for (const std::vector<int>& facet : facets_of(model.surfaces[at(of_b[k])]))
        shared += static_cast<int>(one.count(facet));
    }
  return shared;
}

/// Two contacts of type dea on the same surfaces, or on the same facets of others, would count the cartilage twice.
void refuse_doubled_contacts(const dea::JointModel& model, const std::function<int(int)>& body_of) {
  const auto has_facets = [&](const dea::Contact& c) {
    return model.surfaces[at(c.primary)].size() > 0 && model.surfaces[at(c.secondary)].size() > 0;
  };
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const dea::Contact &a = model.contacts[k], &b = model.contacts[i];
      if (!a.dea || !b.dea) continue;
      if (dea::double_contact(a, b))
        throw dea::fault_at(model, {0, 0},
                            fmt::format("contacts \"{}\" and \"{}\" join the same surfaces at the same time; remove "
                                        "one",
                                        a.name, b.name));
      if (!has_facets(a) || !has_facets(b) || !dea::at_same_time(a.step, b.step)) continue;
      if (const int shared = shared_facets(model, a, b, body_of); shared > 0)
        throw dea::fault_at(model, {0, 0},
                            fmt::format("contacts \"{}\" and \"{}\" both press {} of the same layer's facets, which "
                                        "would count twice; give each facet to one of them, or remove one",
                                        a.name, b.name, shared));
    }
  }
}

/// A line each below the heading.
std::string findings_text(std::string text, const dea::Findings& findings) {
  for (const std::string& line : dea::coded_lines(findings, dea::febio_wording()))
    text += fmt::format("  {}\n", dea::message_line(line));
  return text;
}

}  // namespace

template <class Action>
bool FEDeaContact::guarded(Action action) {
  try {
    action();
    return true;
  } catch (const dea::InputError& e) {
    fault(line(e.fault, dea::febio_wording()).c_str());
  } catch (const std::exception& e) {
    fault(e.what());
  } catch (...) {
    fault("a fault of the plugin, please report");
  }
  return false;
}

void FEDeaContact::build() {
  auto bed = std::make_unique<Bed>();
  FEMechModel& fem = dynamic_cast<FEMechModel&>(*GetFEModel());
  dea::JointModel model = dea::read_fe_model(fem);
  FEMesh& mesh = fem.GetMesh();
  refuse_doubled_contacts(model, [&](int node) { return mesh.Node(node).m_rid; });
  model.contacts = {statement(model)};  // the others have nothing to do with this one
  int rigid_bodies[2];
  for (int side = 0; side < 2; ++side) {
    FEDeaSurface& surface = surfaces_[side];
    int body = -1;
    for (int k = 0; k < surface.Nodes(); ++k) {
      const int b = surface.Node(k).m_rid;
      if (b < 0 || (body >= 0 && b != body))
        throw dea::fault_at(
            model, {0, 0},
            fmt::format("contact \"{}\": node {} of surface \"{}\" belongs to {}, but a dea contact joins two rigid "
                        "bodies; give the elements under the surface their bone's rigid material (`dea convert` does)",
                        GetName(), surface.Node(k).GetID(), surface.GetName(),
                        b < 0 ? "no rigid body" : "another rigid body than the nodes before it"));
      body = b;
    }
    rigid_bodies[side] = body;
  }
  const dea::Settings settings;
  bed->joint = dea::make_joint(model, settings);
  dea::ContactPair& pair = bed->joint.contacts.front();
  for (int side = 0; side < 2; ++side) {
    surfaces_[side].set_layer(pair.layers[side]);
    FERigidBody* rigid = fem.GetRigidBody(rigid_bodies[side]);
    bed->bodies[side == pair.source ? 1 : 0] = rigid;
    // FEBio's own centre of mass, about which its equations are written
    bed->joint.bodies[at(pair.layers[side].body)].center_of_mass = from_fe(rigid->m_r0);
  }
  bed->beds = dea::make_spring_beds(bed->joint);
  bed->maps = dea::make_field_maps(model, bed->joint);
  std::string text = findings_text(fmt::format("{}: contact \"{}\"\n", dea::version_line(), GetName()),
                                   dea::model_findings(model, bed->joint));
  for (int side = 0; side < 2; ++side) {
    const dea::Layer& layer = pair.layers[side];
    text += fmt::format("  {} surface \"{}\" on body \"{}\": ", dea::kSides[side],
                        model.surfaces[at(layer.surface)].name, bed->joint.bodies[at(layer.body)].name);
    if (layer.rigid)
      text += "bare rigid surface";
    else
      text += fmt::format("E {:g}, nu {:g}, thickness {:g} to {:g}, mean {:g}, {}", layer.elasticity.E,
                          layer.elasticity.nu, layer.min_thickness(), layer.max_thickness(), layer.mean_thickness(),
                          layer.thickness_given ? "given" : "measured");
    if (layer.missed_count() > 0)
      text +=
          fmt::format("; {} of {} normals met no bone, closest points used", layer.missed_count(), layer.missed.size());
    if (side == pair.source)
      text += fmt::format("; carries {} springs, law {}", bed->beds.beds.front().springs.size(), dea::name(pair.law));
    text += "\n";
  }
  dea::log_text(fem, text);
  bed->model = std::move(model);
  bed->solution.start = dea::reference_poses(bed->joint);
  bed_ = std::move(bed);
}

void FEDeaContact::listen() {
  if (listening_) return;
  // Fields are made before FEBio's own callbacks write them; every Newton iteration would be too often.
  GetFEModel()->AddCallback(
      [](FEModel* fem, unsigned int when, void* contact) {
        auto* self = static_cast<FEDeaContact*>(contact);
        if (when == CB_SERIALIZE_LOAD) return self->rebuild();
        if (when == CB_UPDATE_TIME) {
          self->attempt_ = {};
          return true;
        }
        if (when == CB_PRE_MATRIX_SOLVE) {
          self->attempt_.factoring = false;
          self->note_load();
          return true;
        }
        const bool every_iteration = fem->GetCurrentStep()->GetPlotLevel() == FE_PLOT_MINOR_ITRS;
        if (when == CB_MINOR_ITERS && !every_iteration) return true;
        if (when == CB_TIMESTEP_FAILED) self->note_failure();
        const bool good = self->update_fields();
        if (good && when == CB_MAJOR_ITERS) {  // of converged states, not of every retry
          self->warn_of_depth();
          return self->keeps_to_its_planes() && self->keep_state();
        }
        if (good && when == CB_STEP_SOLVED) {
          self->warn_of_failure();
          if (fem->GetCurrentStepIndex() + 1 == fem->Steps()) self->tell_results();
        }
        return good;
      },
      CB_INIT | CB_STEP_ACTIVE | CB_UPDATE_TIME | CB_MINOR_ITERS | CB_MAJOR_ITERS | CB_AUGMENT | CB_TIMESTEP_FAILED |
          CB_STEP_SOLVED | CB_SOLVED | CB_SERIALIZE_LOAD | CB_PRE_MATRIX_SOLVE,
      this, CallbackHandler::CB_ADD_FRONT);
  listening_ = true;
}

bool FEDeaContact::Init() {
  failed_ = false;
  attempt_ = {};
  last_pressed_ = -1.0;
  bed_.reset();
  listen();
  if (!FEContactInterface::Init() || !surfaces_[0].Init() || !surfaces_[1].Init()) return false;
  return guarded([&] { build(); });
}

bool FEDeaContact::rebuild() {
  if (!from_archive_) return true;
  from_archive_ = false;
  return guarded([&] { build(); });
}

void FEDeaContact::Reset() {
  if (bed_) bed_->evaluated = bed_->output = false;
}

void FEDeaContact::Serialize(DumpStream& archive) {
  FEContactInterface::Serialize(archive);
  for (FEDeaSurface& surface : surfaces_) surface.Serialize(archive);
  (void)(archive & last_pressed_);
  if (!archive.IsLoading()) return;
  if (bed_) bed_->evaluated = bed_->output = false;
  if (archive.IsShallow()) return;
  // A restart: FEBio does not call Init, and the rest of the model is read after this.
  failed_ = false;
  attempt_ = {};
  bed_.reset();
  from_archive_ = true;
  listen();
}

void FEDeaContact::fault(const char* what) {
  if (!failed_) dea::log_error(*GetFEModel(), what);
  failed_ = true;
}

// -- forces and stiffness ------------------------------------------------------------------------------------------

namespace {

/// Where a body is between the last time step (alpha = 0) and the current iterate (alpha = 1).
dea::Pose pose_of(const FERigidBody& body, double alpha) {
  dea::Pose pose;
  pose.center = from_fe(body.m_rt);
  Eigen::Quaterniond rotation = from_fe(body.GetRotation());
  if (alpha != 1.0) {
    pose.center = alpha * pose.center + (1 - alpha) * from_fe(body.m_rp);
    rotation = from_fe(body.m_qp).slerp(alpha, rotation);
  }
  pose.rotation = rotation.toRotationMatrix();
  return pose;
}

/// False where Newton's method has thrown a body out of all proportion, or its pose is no number: no ray can be cast.
bool usable(const dea::Pose& pose) { return (pose.center.array().abs() < 1e15).all() && pose.rotation.allFinite(); }

bool same(const dea::Pose& a, const dea::Pose& b) { return a.center == b.center && a.rotation == b.rotation; }

/// The twelve equations: target's six, source's six.
std::vector<int> equations(FERigidBody* const bodies[2]) {
  std::vector<int> lm;
  for (int b = 0; b < 2; ++b) lm.insert(lm.end(), bodies[b]->m_LM, bodies[b]->m_LM + 6);
  return lm;
}

/// Those of the twelve that FEBio solves.
std::array<bool, 12> free_of(const std::vector<int>& lm) {
  std::array<bool, 12> free;
  std::transform(lm.begin(), lm.end(), free.begin(), [](int equation) { return equation >= 0; });
  return free;
}

}  // namespace

bool FEDeaContact::evaluate(double alpha) {
  Bed& b = *bed_;
  const dea::Pose target = pose_of(*b.bodies[0], alpha), source = pose_of(*b.bodies[1], alpha);
  if (!usable(target) || !usable(source)) {  // FEBio gives the time step up and tries a shorter one
    b.evaluated = false;
    b.wrench = {};
    b.wrench.wrench.setConstant(std::numeric_limits<double>::quiet_NaN());
    return false;
  }
  if (!b.evaluated || !same(target, b.poses[0]) || !same(source, b.poses[1])) {
    b.poses[0] = target;
    b.poses[1] = source;
    b.springs = dea::press_springs(b.bed(), source, target, {}, &b.memory);
    b.wrench = dea::contact_wrench(b.springs, source, target);
    b.evaluated = true;
  }
  const dea::SpringDepth depth = dea::spring_depth(b.springs);
  attempt_.too_deep = std::max(attempt_.too_deep, depth.strained + depth.through);
  if (b.wrench.normal_force > 0 && !attempt_.met) {
    attempt_.met = true;
    const std::array<bool, 12> free = free_of(equations(b.bodies));
    attempt_.free = dea::free_motions(source, target, free);
    attempt_.resisted = dea::resisted_motions(b.springs, source, target, free);
  }
  return true;
}

void FEDeaContact::BuildMatrixProfile(FEGlobalMatrix& matrix) {
  if (!bed_) return;
  std::vector<int> lm = equations(bed_->bodies);
  matrix.build_add(lm);
}

void FEDeaContact::LoadVector(FEGlobalVector& R, const FETimeInfo& time) {
  if (!bed_) {
    if (R.Size() > 0) R[0] = std::numeric_limits<double>::quiet_NaN();  // never go on without the contact
    return;
  }
  guarded([&] { evaluate(time.alphaf); });
  const std::vector<int> lm = equations(bed_->bodies);
  for (std::size_t i = 0; i < 12; ++i) {
    // FEBio stops at a residual that is no number
    if (lm[i] >= 0)
      R[lm[i]] +=
          failed_ ? std::numeric_limits<double>::quiet_NaN() : bed_->wrench.wrench[static_cast<Eigen::Index>(i)];
  }
  for (int b = 0; b < 2; ++b) {
    const Eigen::Index first = 6 * b;
    bed_->bodies[b]->m_Fr -= to_fe(bed_->wrench.wrench.segment<3>(first));
    bed_->bodies[b]->m_Mr -= to_fe(bed_->wrench.wrench.segment<3>(first + 3));
  }
}

void FEDeaContact::StiffnessMatrix(FELinearSystem& system, const FETimeInfo& time) {
  if (!bed_ || failed_) return;
  const std::vector<int> lm = equations(bed_->bodies);
  const std::array<bool, 12> free = free_of(lm);
  attempt_.factoring = true;
  attempt_.symmetric = system.IsSymmetric();
  Eigen::Matrix<double, 12, 12> K;
  bool known = false;
  guarded([&] {
    known = evaluate(time.alphaf);
    if (!known) return;
    if (bed_->wrench.normal_force > 0) {
      K = -time.alphaf * bed_->wrench.derivative;
    } else {
      // All that acts on the bodies, what holds them apart (joints, ligaments) too: this stiffness goes as they
      // balance.
      Eigen::Matrix<double, 12, 1> force = Eigen::Matrix<double, 12, 1>::Zero();
      const auto* newton = dynamic_cast<FENewtonSolver*>(GetFEModel()->GetCurrentStep()->GetFESolver());
      for (std::size_t i = 0; i < 12; ++i)
        if (free[i] && newton != nullptr) force[static_cast<Eigen::Index>(i)] = newton->m_R1[at(lm[i])];
      K = dea::closing_stiffness(bed_->bed(), bed_->springs, bed_->poses[1], bed_->poses[0], force, free);
    }
  });
  if (!known || failed_) return;
  if (system.IsSymmetric()) K = (0.5 * (K + K.transpose())).eval();
  FEElementMatrix ke(12, 12);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) ke[i][j] = K(i, j);
  ke.SetIndices(lm);
  system.Assemble(ke);
}

bool FEDeaContact::update_fields() {
  if (!bed_ || failed_) return !failed_;
  return !IsActive() || guarded([&] { make_fields(); });
}

void FEDeaContact::make_fields() {
  Bed& b = *bed_;
  const dea::Pose target = pose_of(*b.bodies[0], 1.0), source = pose_of(*b.bodies[1], 1.0);
  const int at_target = b.bed().target_body, at_source = b.bed().source_body;
  if (b.output && same(target, b.shown.equilibrium.poses[at(at_target)]) &&
      same(source, b.shown.equilibrium.poses[at(at_source)]))
    return;
  if (!evaluate(1.0)) return;
  const dea::ContactPair& pair = b.joint.contacts.front();
  b.shown = {};
  dea::Equilibrium& e = b.shown.equilibrium;
  e.poses = dea::reference_poses(b.joint);
  e.poses[at(at_target)] = target;
  e.poses[at(at_source)] = source;
  e.springs = {b.springs};
  e.contact_on_target = {b.wrench.wrench.segment<6>(0)};
  dea::refuse_zero_thickness(b.model, b.joint, b.beds, e);
  b.shown.fields = dea::contact_fields(b.joint, b.beds, b.maps, e);
  for (int side = 0; side < 2; ++side) {
    const dea::Layer& layer = pair.layers[side];
    const dea::SurfaceMesh& mesh = layer.articular;
    const dea::SideFields& values = b.shown.fields.front().sides[side];
    std::vector<dea::Vector3d> area(values.pressure.size(), dea::Vector3d::Zero());
    for (int t = 0; t < mesh.size(); ++t) area[at(mesh.facet[at(t)])] += mesh.areas[at(t)] * mesh.normals[at(t)];
    std::vector<vec3d> tractions;
    for (std::size_t f = 0; f < area.size(); ++f)
      tractions.push_back(to_fe(-values.pressure[f] * (e.poses[at(layer.body)].rotation * area[f].normalized())));
    surfaces_[side].set_fields(values, std::move(tractions));
  }
  b.output = true;
}

bool FEDeaContact::keeps_to_its_planes() {
  if (!bed_ || !IsActive() || !bed_->output) return true;
  return guarded([&] {
    const Bed& b = *bed_;
    dea::refuse_left_planes(b.model, b.joint, b.shown.equilibrium.poses, GetFEModel()->GetCurrentTime());
  });
}

bool FEDeaContact::keep_state() {
  if (!bed_ || !IsActive() || !bed_->output) return true;
  return guarded([&] {
    Bed& b = *bed_;
    std::vector<dea::StateResult>& states = b.solution.states;
    if (!states.empty()) {  // as large as the mesh: rules ask for them in the last state alone
      states.back().fields.clear();
      states.back().equilibrium.springs.clear();
    }
    dea::StateResult state = b.shown;
    state.when = {GetFEModel()->GetCurrentTime(), GetFEModel()->GetCurrentStepIndex(), -1};
    state.statistics = dea::contact_statistics(b.joint, b.beds, b.maps, state.equilibrium, state.fields);
    const std::array<bool, 12> free = free_of(equations(b.bodies));
    const bool any_free = std::find(free.begin(), free.end(), true) != free.end();
    state.equilibrium.outcome = any_free ? dea::Outcome::Balanced : dea::Outcome::Prescribed;
    state.equilibrium.load = dea::kInfinity;  // FEBio's, not known here
    states.push_back(std::move(state));
    b.solution.free_to_move.assign(b.joint.bodies.size(), 0);
    b.solution.free_to_turn = b.solution.free_to_move;
    for (int i = 0; i < 12; ++i) {
      const int body = i < 6 ? b.bed().target_body : b.bed().source_body;
      if (free[at(i)]) (i % 6 < 3 ? b.solution.free_to_move : b.solution.free_to_turn)[at(body)] = 1;
    }
  });
}

void FEDeaContact::tell_results() {
  const std::vector<const FEDeaContact*> all = contacts();
  if (all.empty() || all.front() != this) return;  // one tells of all
  guarded([&] {
    std::vector<dea::Findings> found;
    for (const FEDeaContact* contact : all) {
      if (contact->attempt_.failed) return;  // the last state is no solution
      found.push_back(dea::result_findings(contact->bed_->model, contact->bed_->joint, contact->bed_->solution));
    }
    // what names no part of the joint is of it as a whole: all its contacts have it
    const auto counts = [&](const dea::Finding& f) {
      const auto has_it = [&](const dea::Findings& one) { return std::find(one.begin(), one.end(), f) != one.end(); };
      const bool of_a_part = !(f.subject.contact + f.subject.surface + f.subject.body).empty();
      return of_a_part || std::all_of(found.begin(), found.end(), has_it);
    };
    dea::Findings told;
    for (const dea::Findings& one : found)
      for (const dea::Finding& f : one)
        if (counts(f)) dea::add_once(told, {f});
    if (!told.empty()) dea::log_text(*GetFEModel(), findings_text(dea::version_line() + ": results\n", told));
  });
}

void FEDeaContact::warn_of_depth() {
  if (!bed_ || !IsActive() || !bed_->evaluated) return;
  const dea::SpringStates& s = bed_->springs;
  if (bed_->wrench.normal_force > 0) last_pressed_ = GetFEModel()->GetCurrentTime();
  const dea::SpringDepth depth = dea::spring_depth(s);
  if (depth.through > 0)
    dea::log_warning(*GetFEModel(), fmt::format("dea: contact \"{}\": under {} of {} springs the bodies overlap deeper "
                                                "than the cartilage is thick; these carry nothing and the pressures "
                                                "mean nothing",
                                                GetName(), depth.through, s.size()));
  if (!s.complementary)
    dea::log_warning(*GetFEModel(), fmt::format("dea: contact \"{}\": the layers' pressures are known to {:.1e} only",
                                                GetName(), s.complementarity));
  if (depth.strained > 0)
    dea::log_warning(*GetFEModel(), fmt::format("dea: contact \"{}\": {} springs are strained beyond {:g} (up to "
                                                "{:.3g}); their pressures mean nothing",
                                                GetName(), depth.strained, dea::kStrainLimit, depth.largest));
}

std::vector<const FEDeaContact*> FEDeaContact::contacts() const {
  // FEBio's accessors are not const.
  auto& self = const_cast<FEDeaContact&>(*this);
  FEModel& fem = *self.GetFEModel();
  std::vector<const FEDeaContact*> contacts;
  for (int i = 0; i < fem.SurfacePairConstraints(); ++i) {
    auto* other = dynamic_cast<FEDeaContact*>(fem.SurfacePairConstraint(i));
    if (other != nullptr && other->bed_ && other->IsActive()) contacts.push_back(other);
  }
  return contacts;
}

bool FEDeaContact::joins_the_bodies_of(const FEDeaContact& other) const {
  return std::is_permutation(bed_->bodies, bed_->bodies + 2, other.bed_->bodies);
}

void FEDeaContact::note_load() {
  if (attempt_.load_known) return;
  attempt_.load_known = true;
  const auto* newton = dynamic_cast<FENewtonSolver*>(GetFEModel()->GetCurrentStep()->GetFESolver());
  if (!bed_ || !IsActive() || !bed_->evaluated || newton == nullptr) return;
  if (newton->m_R0.size() != newton->m_Fd.size()) return;
  // The residual, without what FEBio adds for motions that are prescribed, and without the contacts.
  Eigen::Matrix<double, 12, 1> load = Eigen::Matrix<double, 12, 1>::Zero();
  const std::vector<int> lm = equations(bed_->bodies);
  const std::array<bool, 12> free = free_of(lm);
  for (std::size_t i = 0; i < 12; ++i) {
    if (free[i]) load[static_cast<Eigen::Index>(i)] = newton->m_R0[at(lm[i])] - newton->m_Fd[at(lm[i])];
  }
  for (const FEDeaContact* contact : contacts()) {
    if (!joins_the_bodies_of(*contact)) continue;
    const bool exchanged = contact->bed_->bodies[0] != bed_->bodies[0];
    load.head<6>() -= contact->bed_->wrench.wrench.segment<6>(exchanged ? 6 : 0);
    load.tail<6>() -= contact->bed_->wrench.wrench.segment<6>(exchanged ? 0 : 6);
  }
  double force = 0.0;
  for (const std::size_t i : {0, 1, 2, 6, 7, 8})
    if (free[i]) force = std::hypot(force, load[static_cast<Eigen::Index>(i)]);
  attempt_.opens = dea::opening_part(bed_->springs, load, free) > kOpens * force;
}

void FEDeaContact::note_failure() {
  attempt_.failed = true;
  if (!bed_) return;
  const auto* newton = dynamic_cast<FENewtonSolver*>(GetFEModel()->GetCurrentStep()->GetFESolver());
  const auto finite = [](double x) { return std::isfinite(x); };
  attempt_.no_number = attempt_.factoring ||
                       (newton != nullptr && !std::all_of(newton->m_ui.begin(), newton->m_ui.end(), finite)) ||
                       !usable(pose_of(*bed_->bodies[0], 1.0)) || !usable(pose_of(*bed_->bodies[1], 1.0));
}

void FEDeaContact::warn_of_failure() {
  if (!bed_ || !IsActive() || !attempt_.failed) return;
  if (free_of(equations(bed_->bodies)) == std::array<bool, 12>{}) return;  // these bodies balance whatever happens
  const std::vector<const FEDeaContact*> all = contacts();
  // A compartment may be lifted off while another one carries; and any contact, if the equations had a solution.
  const bool others_tell = std::any_of(all.begin(), all.end(), [&](const FEDeaContact* contact) {
    return contact->attempt_.met && (!attempt_.no_number || joins_the_bodies_of(*contact));
  });
  const dea::SpringStates& s = bed_->springs;
  const int under_pressure = static_cast<int>(
      std::count_if(s.pressure.begin(), s.pressure.end(), [](double pressure) { return pressure > 0; }));
  const int loose = attempt_.free - attempt_.resisted;
  const std::string check = "check thickness, E, the load and their units, or take smaller steps (step_size)";
  std::string why;
  if (attempt_.opens)
    why = fmt::format(
        "the load opens the joint{}, and springs do not pull; let the load press the bodies together, or "
        "something else hold them (rigid_fixed, ligaments)",
        last_pressed_ < 0 ? "" : fmt::format(" after time {}", dea::time_text(last_pressed_)));
  else if (attempt_.too_deep > 0)
    why = fmt::format("on the way {} of {} springs were strained beyond {:g}; {}", attempt_.too_deep, s.size(),
                      dea::kStrainLimit, check);
  else if (attempt_.no_number && loose > 0)
    why = fmt::format(
        "its springs resist {} of {} free motions of the bodies, and little or nothing the other {}: if "
        "nothing else holds these, FEBio's stiffness is singular (NAN); hold them (rigid_fixed), or add "
        "what resists them",
        attempt_.resisted, attempt_.free, loose);
  else if (!attempt_.met && others_tell)
    return;
  else if (!attempt_.met && attempt_.no_number)
    why =
        "the surfaces do not touch, so that no spring holds the bodies; first move the bone into contact by a "
        "prescribed displacement (rigid_displacement) in a step of its own, its other motions held, then load it; or "
        "let something else hold it";
  else if (attempt_.met && under_pressure == 0)
    why = fmt::format("the bodies met, and Newton's method lost them again; {}", check);
  else
    why = fmt::format("{} of {} springs carry pressure{}; {}", under_pressure, s.size(),
                      under_pressure == 0 ? "" : fmt::format(", strained up to {:.3g}", dea::spring_depth(s).largest),
                      attempt_.symmetric ? "set symmetric_stiffness to non-symmetric, with a linear solver that takes "
                                           "it, or allow more iterations (max_refs)"
                                         : "try smaller time steps (step_size) or more iterations (max_refs)");
  dea::log_warning(*GetFEModel(), fmt::format("dea: contact \"{}\": FEBio found no balance at time {}: {}", GetName(),
                                              dea::time_text(GetFEModel()->GetCurrentTime()), why));
}
