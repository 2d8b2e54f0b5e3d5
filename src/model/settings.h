// febiodea/model/settings.h – what a user may say instead of what is inferred from the model.
// Filled from the command line and from a settings file (command line first); everything left empty is
// taken from the model. Names are the model's own: materials (bodies), surfaces, contacts.
#pragma once
#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dea {

/// On which surface of the source layer the springs stand (docs/theory.md, section 3).
enum class SpringsAt { Articular, Bone };

/// Pressure as a function of strain (docs/theory.md, section 3).
enum class Law {
  Linear,
  Logarithmic,
  NeoHookean,
  Layer  ///< springs that share the layers' sideways flow (docs/layer_law.md); at large strain neo-Hookean
};

/// How closely Law::Layer follows short waves of pressure (layer_kernel.h).
enum class LayerFit { OneTerm, TwoTerms };

/// How the facets of a surface are taken when gaps and thicknesses are measured.
enum class Facets {
  Curved,  ///< as the smooth surface they stand for: each facet bulges by the turning of its vertex normals
           ///< (surface_mesh.h)
  Flat     ///< as they are
};

/// Where the force on a body acts.
struct LoadPoint {
  bool sphere_center = false;  ///< centre of the least-squares sphere through the body's articular surface
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< reference coordinates, when not sphere_center
};

struct Settings {
  std::string contact;  ///< only this contact pair; empty: every one that joins two bodies
  std::string source;   ///< body whose layer carries the springs; empty: the contact's primary side
  SpringsAt springs_at = SpringsAt::Articular;
  std::optional<Law> law;                     ///< empty: what the contact says, or layer; springs at the bone: linear
  LayerFit layer_fit = LayerFit::TwoTerms;    ///< of Law::Layer
  std::optional<double> interface_stiffness;  ///< [pressure/length], > 0; empty: rigid
  std::optional<Facets> facets;               ///< empty: what the contact says, or curved
  std::optional<int> refine;       ///< each spring triangle is divided into refine^2, >= 1; empty: the contact's, or 1
  std::vector<std::string> rigid;  ///< deformable materials to take as rigid
  std::map<std::string, std::string> attach;        ///< surface -> body it belongs to ("ground" for the ground)
  std::map<std::string, std::string> bone;          ///< articular surface -> surface that is its bone surface
  std::vector<std::string> keep_facets;             ///< surfaces of which no facet is left out as side wall or bonded
  std::map<std::string, double> thickness;          ///< surface -> constant thickness; "" = all surfaces
  std::map<std::string, double> E;                  ///< surface -> Young's modulus; "" = all
  std::map<std::string, double> nu;                 ///< surface -> Poisson's ratio; "" = all
  std::map<std::string, std::array<bool, 6>> free;  ///< body -> dofs left free (all others held), in all steps
  std::map<std::string, Eigen::Vector3d>
      force;  ///< body -> force replacing the model's rigid forces, scaled 0..1 over the last step
  std::map<std::string, LoadPoint> load_at;  ///< body -> where its force acts
  bool squash = true;                        ///< show the cartilage compressed; false: rigid with its bone
};

const char* name(SpringsAt springs_at);
const char* name(Law law);
const char* name(LayerFit fit);
const char* name(Facets facets);

}  // namespace dea
