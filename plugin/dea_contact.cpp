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

/// Everything that follows from the reference configuration, and the springs at the last poses. Contacts that press one
/// layer are one problem: each has all of them in its joint.
struct FEDeaContact::Bed {
  dea::JointModel model;  // with these contacts alone
  dea::Joint joint;       // the same
  dea::SpringBeds beds;
  dea::FieldMaps maps;
  std::vector<FEDeaContact*> members;           // per contact of the joint; not owned
  std::size_t own = 0;                          // place of this contact among them
  std::vector<FERigidBody*> rigid;              // per body of the joint; null: of none of these contacts
  FERigidBody* bodies[2] = {nullptr, nullptr};  // target, source
  // of the evaluation below
  std::vector<dea::Pose> poses;  // per body of the joint
  std::vector<char> active;      // per contact
  bool evaluated = false;
  std::vector<dea::PressedContact> pressed;  // per contact
  dea::PressMemory memory;                   // where the search for pressures starts
  dea::StateResult shown;                    // the fields in the surfaces; without statistics
  bool output = false;                       // it is there
  dea::SolvedStates solution;                // states that FEBio has found, with what their rules look at

  const dea::SpringBed& bed() const { return beds.beds[own]; }
  const dea::SpringStates& springs() const { return pressed[own].springs; }
  const dea::ContactWrench& wrench() const { return pressed[own].wrench; }
  const dea::Pose& source() const { return poses[at(bed().source_body)]; }
  const dea::Pose& target() const { return poses[at(bed().target_body)]; }
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

/// Two contacts of type dea on the same surfaces would share the load between them.
void refuse_doubled_contacts(const dea::JointModel& model) {
  for (std::size_t i = 0; i < model.contacts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const dea::Contact &a = model.contacts[k], &b = model.contacts[i];
      if (a.dea && b.dea && dea::double_contact(a, b))
        throw dea::fault_at(model, {0, 0},
                            fmt::format("contacts \"{}\" and \"{}\" join the same surfaces at the same time; remove "
                                        "one",
                                        a.name, b.name));
    }
}

/// The contacts that press layers together with contact `own`, itself among them, ascending.
std::vector<int> pressed_together(const dea::Joint& joint, int own) {
  std::set<int> together = {own};
  for (std::size_t before = 0; before != together.size();) {
    before = together.size();
    for (const dea::SharedLayer& layer : joint.shared_layers) {
      const auto is_in = [&](const dea::LayerUse& use) {
        return together.count(joint.contacts[at(use.contact)].contact) > 0 &&
               joint.contacts[at(use.contact)].law == dea::Law::Layer;
      };
      if (std::none_of(layer.uses.begin(), layer.uses.end(), is_in)) continue;
      for (const dea::LayerUse& use : layer.uses)
        if (joint.contacts[at(use.contact)].law == dea::Law::Layer)
          together.insert(joint.contacts[at(use.contact)].contact);
    }
  }
  return {together.begin(), together.end()};
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

void FEDeaContact::refuse_other_nodes(const dea::JointModel& model) {
  for (FEDeaSurface& surface : surfaces_) {
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
  }
}

void FEDeaContact::build() {
  auto bed = std::make_unique<Bed>();
  FEMechModel& fem = dynamic_cast<FEMechModel&>(*GetFEModel());
  dea::JointModel model = dea::read_fe_model(fem);
  refuse_doubled_contacts(model);
  refuse_other_nodes(model);
  std::vector<FEDeaContact*> all;
  model.contacts.clear();  // contacts of other types have nothing to do with these
  for (int i = 0; i < fem.SurfacePairConstraints(); ++i)
    if (auto* contact = dynamic_cast<FEDeaContact*>(fem.SurfacePairConstraint(i))) {
      all.push_back(contact);
      model.contacts.push_back(contact->statement(model));
    }
  const dea::Settings settings;
  const auto own = std::find(all.begin(), all.end(), this) - all.begin();
  std::vector<int> together = {static_cast<int>(own)};
  if (all.size() > 1) together = pressed_together(dea::make_joint(model, settings), together.front());
  std::vector<dea::Contact> contacts;
  for (const int c : together) contacts.push_back(model.contacts[at(c)]);
  model.contacts = std::move(contacts);
  bed->joint = dea::make_joint(model, settings);
  bed->rigid.assign(bed->joint.bodies.size(), nullptr);
  for (const dea::ContactPair& pair : bed->joint.contacts) {
    FEDeaContact* member = all[at(together[at(pair.contact)])];
    if (member == this) bed->own = bed->members.size();
    bed->members.push_back(member);
    for (const dea::Layer& layer : pair.layers) {
      const int rigid = fem.GetMesh().Node(layer.articular.model_nodes.front()).m_rid;
      if (rigid < 0)
        throw dea::fault_at(model, pair.origin,
                            fmt::format("contact \"{}\": a surface of it belongs to no rigid body", pair.name));
      bed->rigid[at(layer.body)] = fem.GetRigidBody(rigid);
      // FEBio's own centre of mass, about which its equations are written
      bed->joint.bodies[at(layer.body)].center_of_mass = from_fe(bed->rigid[at(layer.body)]->m_r0);
    }
  }
  bed->pressed.resize(bed->members.size());
  const dea::ContactPair& pair = bed->joint.contacts[bed->own];
  for (int side = 0; side < 2; ++side) {
    surfaces_[side].set_layer(pair.layers[side]);
    bed->bodies[side == pair.source ? 1 : 0] = bed->rigid[at(pair.layers[side].body)];
  }
  bed->beds = dea::make_spring_beds(bed->joint);
  bed->maps = dea::make_field_maps(model, bed->joint);
  std::string text = own == 0 ? dea::untested_line() : "";  // one contact tells it for all
  text += findings_text(fmt::format("{}: contact \"{}\"\n", dea::version_line(), GetName()),
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
      text += fmt::format("; carries {} springs, law {}", bed->bed().springs.size(), dea::name(pair.law));
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

bool same(const std::vector<dea::Pose>& a, const std::vector<dea::Pose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const dea::Pose& one, const dea::Pose& other) {
    return one.center == other.center && one.rotation == other.rotation;
  });
}

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
  std::vector<dea::Pose> poses = dea::reference_poses(b.joint);
  bool good = true;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (b.rigid[i] == nullptr) continue;
    poses[i] = pose_of(*b.rigid[i], alpha);
    good = good && usable(poses[i]);
  }
  b.pressed.resize(b.members.size());
  if (!good) {  // FEBio gives the time step up and tries a shorter one
    b.evaluated = false;
    b.pressed[b.own].wrench = {};
    b.pressed[b.own].wrench.wrench.setConstant(std::numeric_limits<double>::quiet_NaN());
    return false;
  }
  std::vector<char> active;
  for (const FEDeaContact* member : b.members) active.push_back(member == this || member->IsActive());
  if (!b.evaluated || !same(poses, b.poses) || active != b.active) {
    b.poses = std::move(poses);
    b.active = std::move(active);
    b.output = false;
    const auto knows = [&](const FEDeaContact* member) {  // one of them presses for all
      return member->bed_ && member->bed_->evaluated && same(member->bed_->poses, b.poses) &&
             member->bed_->active == b.active && member->bed_->members == b.members;
    };
    if (const auto other = std::find_if(b.members.begin(), b.members.end(), knows);
        other != b.members.end() && *other != this) {
      b.pressed = (*other)->bed_->pressed;
    } else {
      const std::vector<int>& group = b.beds.groups.front();  // of all
      std::vector<dea::PressedContact> pressed =
          dea::press_group(b.beds, group, b.poses, std::vector<dea::Motions>(b.members.size(), dea::kAllMotions),
                           b.active, {}, &b.memory);
      for (std::size_t k = 0; k < group.size(); ++k) b.pressed[at(group[k])] = std::move(pressed[k]);
    }
    b.evaluated = true;
  }
  const dea::SpringDepth depth = dea::spring_depth(b.springs());
  attempt_.too_deep = std::max(attempt_.too_deep, depth.strained + depth.through);
  if (b.wrench().normal_force > 0 && !attempt_.met) {
    attempt_.met = true;
    const std::array<bool, 12> free = free_of(equations(b.bodies));
    attempt_.free = dea::free_motions(b.source(), b.target(), free);
    attempt_.resisted = dea::resisted_motions(b.springs(), b.source(), b.target(), free);
  }
  return true;
}

void FEDeaContact::BuildMatrixProfile(FEGlobalMatrix& matrix) {
  if (!bed_) return;
  std::vector<int> lm;
  for (FERigidBody* body : bed_->rigid)
    if (body != nullptr) lm.insert(lm.end(), body->m_LM, body->m_LM + 6);
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
          failed_ ? std::numeric_limits<double>::quiet_NaN() : bed_->wrench().wrench[static_cast<Eigen::Index>(i)];
  }
  for (int b = 0; b < 2; ++b) {
    const Eigen::Index first = 6 * b;
    bed_->bodies[b]->m_Fr -= to_fe(bed_->wrench().wrench.segment<3>(first));
    bed_->bodies[b]->m_Mr -= to_fe(bed_->wrench().wrench.segment<3>(first + 3));
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
    if (bed_->wrench().normal_force > 0) {
      K = -time.alphaf * bed_->wrench().derivative;
    } else {
      // All that acts on the bodies, what holds them apart (joints, ligaments) too: this stiffness goes as they
      // balance.
      Eigen::Matrix<double, 12, 1> force = Eigen::Matrix<double, 12, 1>::Zero();
      const auto* newton = dynamic_cast<FENewtonSolver*>(GetFEModel()->GetCurrentStep()->GetFESolver());
      for (std::size_t i = 0; i < 12; ++i)
        if (free[i] && newton != nullptr) force[static_cast<Eigen::Index>(i)] = newton->m_R1[at(lm[i])];
      K = dea::closing_stiffness(bed_->bed(), bed_->springs(), bed_->source(), bed_->target(), force, free);
    }
  });
  if (!known || failed_) return;
  if (system.IsSymmetric()) K = (0.5 * (K + K.transpose())).eval();
  const auto assemble = [&](const Eigen::Matrix<double, 12, 12>& block, const std::vector<int>& columns) {
    FEElementMatrix ke(12, 12);
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) ke[i][j] = block(i, j);
    ke.SetIndices(lm, columns);
    system.Assemble(ke);
  };
  assemble(K, lm);
  if (system.IsSymmetric()) return;  // a block beside the diagonal would need its mirror image
  for (const dea::ContactWrench::Cross& other : bed_->wrench().cross) {
    FERigidBody* const bodies[2] = {bed_->rigid[at(other.bodies.target)], bed_->rigid[at(other.bodies.source)]};
    assemble(-time.alphaf * other.derivative, equations(bodies));
  }
}

bool FEDeaContact::update_fields() {
  if (!bed_ || failed_) return !failed_;
  return !IsActive() || guarded([&] { make_fields(); });
}

void FEDeaContact::make_fields() {
  Bed& b = *bed_;
  if (!evaluate(1.0)) return;
  if (b.output) return;
  const dea::ContactPair& pair = b.joint.contacts[b.own];
  b.shown = {};
  dea::Equilibrium& e = b.shown.equilibrium;
  e.poses = b.poses;
  for (const dea::PressedContact& contact : b.pressed) {
    e.springs.push_back(contact.springs);
    e.contact_on_target.push_back(contact.wrench.wrench.segment<6>(0));
  }
  dea::refuse_zero_thickness(b.model, b.joint, b.beds, e);
  b.shown.fields = dea::contact_fields(b.joint, b.beds, b.maps, e);
  for (int side = 0; side < 2; ++side) {
    const dea::Layer& layer = pair.layers[side];
    const dea::SurfaceMesh& mesh = layer.articular;
    std::vector<const dea::SideFields*> sides;  // FEBio writes a surface once, from the first contact that has it
    for (std::size_t c = 0; c < b.joint.contacts.size(); ++c)
      for (int of = 0; of < 2; ++of)
        if (b.joint.contacts[c].layers[of].surface == layer.surface) sides.push_back(&b.shown.fields[c].sides[of]);
    const dea::SideFields values = dea::added_sides(sides);
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
    state.layers = dea::layer_statistics(b.joint, b.maps, state.fields);
    const std::array<bool, 12> free = free_of(equations(b.bodies));
    const bool any_free = std::find(free.begin(), free.end(), true) != free.end();
    state.equilibrium.outcome = any_free ? dea::Outcome::Balanced : dea::Outcome::Prescribed;
    state.equilibrium.load = dea::kInfinity;  // FEBio's, not known here
    states.push_back(std::move(state));
    b.solution.free_to_move.assign(b.joint.bodies.size(), 0);
    b.solution.free_to_turn = b.solution.free_to_move;
    for (std::size_t body = 0; body < b.rigid.size(); ++body)
      for (int i = 0; b.rigid[body] != nullptr && i < 6; ++i)
        if (b.rigid[body]->m_LM[i] >= 0) (i < 3 ? b.solution.free_to_move : b.solution.free_to_turn)[body] = 1;
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
  const dea::SpringStates& s = bed_->springs();
  if (bed_->wrench().normal_force > 0) last_pressed_ = GetFEModel()->GetCurrentTime();
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
  if (bed_->members.front() != this) return;  // one tells of all that press the layer
  std::vector<dea::SpringStates> springs;
  for (const dea::PressedContact& contact : bed_->pressed) springs.push_back(contact.springs);
  const dea::PressedTwice twice = dea::pressed_twice(bed_->joint, bed_->beds, springs, bed_->poses);
  if (twice.share > dea::kMostTwice)
    dea::log_warning(
        *GetFEModel(),
        fmt::format("dea: contact \"{}\" and others press {:.3g} of one layer at once, with {:.3g}, {:.0f}% of "
                    "the force on it: the load counts twice there, and the pressures mean nothing",
                    GetName(), twice.area, twice.force, 100 * twice.share));
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
    load.head<6>() -= contact->bed_->wrench().wrench.segment<6>(exchanged ? 6 : 0);
    load.tail<6>() -= contact->bed_->wrench().wrench.segment<6>(exchanged ? 0 : 6);
  }
  double force = 0.0;
  for (const std::size_t i : {0, 1, 2, 6, 7, 8})
    if (free[i]) force = std::hypot(force, load[static_cast<Eigen::Index>(i)]);
  attempt_.opens = dea::opening_part(bed_->springs(), load, free) > kOpens * force;
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
  const dea::SpringStates& s = bed_->springs();
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
