// plugin/dea_contact.h – `<contact type="dea">`: the spring bed as a contact between two of FEBio's rigid
// bodies.
//
// What is said in the model becomes a dea::Contact; recognition, springs, forces and their derivative are those of
// src/ (press_group, contact_wrench). Only the bodies' equations are assembled: twelve of a contact, and of
// contacts that press one layer those of all their bodies.
#pragma once
#include <FEBioMech/FEContactInterface.h>
#include <FEBioMech/FEContactSurface.h>
#include <memory>
#include <string>
#include <vector>

#include "plugin/contact_statement.h"
#include "src/model/joint_model.h"
#include "src/results/fields.h"

class FERigidBody;

/// One side of the contact. FEBio's plot variables read pressure and gap from its integration points.
class FEDeaSurface : public FEContactSurface {
 public:
  explicit FEDeaSurface(FEModel* fem);
  FEMaterialPoint* CreateMaterialPoint() override;

  /// Values of the last output, for FEBio's and our own plot variables; nullptr before the first.
  const dea::SideFields* fields() const { return fields_ ? fields_.get() : nullptr; }
  /// Per facet and node of it: vertex of the layer's articular surface.
  const std::vector<std::vector<int>>& facet_vertices() const { return facet_vertices_; }

  void set_layer(const dea::Layer& layer);
  void set_fields(dea::SideFields fields, std::vector<vec3d> tractions);

  vec3d GetContactForce() override;  ///< on this surface
  double GetContactArea() override;
  void GetContactTraction(int facet, vec3d& traction) override;  ///< on this surface, mean over the facet
  void GetNodalContactPressure(int facet, double* pressure) override;
  void GetNodalContactTraction(int facet, vec3d* traction) override;
  void GetVectorGap(int facet, vec3d& gap) override;       ///< zero: springs push at the surfaces they model
  void GetNodalVectorGap(int facet, vec3d* gap) override;  ///< zero

 private:
  std::unique_ptr<dea::SideFields> fields_;
  std::vector<vec3d> tractions_;  // per facet
  std::vector<std::vector<int>> facet_vertices_;
};

class FEDeaContact : public FEContactInterface, public dea::StatesContact {
 public:
  explicit FEDeaContact(FEModel* fem);
  ~FEDeaContact() override;

  FESurface* GetPrimarySurface() override { return &surfaces_[0]; }
  FESurface* GetSecondarySurface() override { return &surfaces_[1]; }
  bool UseNodalIntegration() override { return false; }

  bool Init() override;
  void Reset() override;
  void Serialize(DumpStream& archive) override;
  void BuildMatrixProfile(FEGlobalMatrix& matrix) override;
  void LoadVector(FEGlobalVector& R, const FETimeInfo& time) override;
  void StiffnessMatrix(FELinearSystem& system, const FETimeInfo& time) override;

  dea::Contact statement(const dea::JointModel& model) const override;

  /// Fields at the current poses into the surfaces, for output. Cheap when nothing has moved since. False: a fault, the
  /// run is to end.
  bool update_fields();

 private:
  struct Bed;
  void build();
  void refuse_other_nodes(const dea::JointModel& model);  // of a side, that are not all one rigid body's
  std::vector<const FEDeaContact*> contacts() const;      // of type dea that act now, this one too
  bool joins_the_bodies_of(const FEDeaContact& other) const;
  template <class Action>
  bool guarded(Action action);  // a fault goes to the log: no exception leaves the library
  void make_fields();
  bool rebuild();               // after an archive has been read
  void listen();                // to FEBio's callbacks
  bool evaluate(double alpha);  // false: the poses are out of all proportion, the forces no numbers
  void note_load();             // at the first solution of an attempt
  void note_failure();
  void warn_of_depth();
  bool keeps_to_its_planes();  // false: a body has left a plane of symmetry, and the fault is told
  bool keep_state();           // that FEBio has found, for the rules
  void tell_results();         // what rules find in them, once for all contacts
  void warn_of_failure();      // FEBio found no balance: what this contact can say of why
  void fault(const char* what);

  FEDeaSurface surfaces_[2];  // primary, secondary
  int law_ = 3, facets_ = 0, source_ = 0, refine_ = 1;
  double E_[2] = {0, 0}, nu_[2] = {0, 0};
  std::string
      thickness_[2];  // a number, the name of a map, or nothing: a missing map is ours to tell, FEBio tells none
  std::string symmetry_planes_;
  std::unique_ptr<Bed> bed_;
  struct Attempt {  // of FEBio's to find the next state
    bool symmetric = false;
    bool met = false;                        // springs have carried pressure
    int free = 0, resisted = 0;              // motions of the bodies against each other, where springs first did
    int too_deep = 0;                        // springs whose pressure means nothing, at most
    bool load_known = false, opens = false;  // what the bodies' load does where the step begins
    bool factoring = false;                  // the stiffness
    bool failed = false, no_number = false;  // the solution was none
  } attempt_;
  double last_pressed_ = -1.0;  // time of the last state with pressure; -1: none
  bool failed_ = false, listening_ = false, from_archive_ = false;

  DECLARE_FECORE_CLASS()
};
