// src/model/settings.h – what a user may say instead of what is inferred from the model.
// Filled from the command line and from a settings file (command line first); everything left empty is
// taken from the model. Names are the model's own: materials (bodies), surfaces, contacts.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/base/sentence.h"

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

/// One change of a body's starting pose: where it is before anything moves or loads it.
struct Placement {
  enum class Kind {
    Rotate,  ///< by `degrees` about the axis `vector`, right-handed
    Move     ///< by `vector`
  };
  Kind kind = Kind::Move;
  std::string body;
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  ///< along the frame's axes; of an axis: any length > 0
  double degrees = 0.0;
  std::string frame = {};  ///< of Settings::frames; empty: the global one
};

/// The point of a body about which it is turned. It goes along with the body's earlier placements.
struct TurnPoint {
  enum class Kind {
    SphereCenter,  ///< of the least-squares sphere through the body's articular surface
    CenterOfMass,
    Point
  };
  Kind kind = Kind::SphereCenter;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< Point: reference coordinates
};

/// The axes in which a table of loads is given.
struct TableFrame {
  enum class Kind {
    Global,
    Body,  ///< those of `body`: the global axes in its reference position, and they turn with it
    Axes,  ///< columns of `axes`, global directions
    Named  ///< those of `frame`; with a body they turn with it from its reference position
  };
  Kind kind = Kind::Global;
  std::string body;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< orthonormal, right-handed
  std::string frame = {};                              ///< Named: of Settings::frames
};

/// A table of forces and moments on one body: a row is a state, in order, after the model's own steps.
struct LoadTable {
  std::string file;     ///< where the rows are read from (io/tables/read_tables.h); empty: none, or the rows are given
  std::string body;     ///< on which they act, at settings.load_at; the model's own loads on it are replaced
  std::string columns;  ///< names of three or six columns, separated by commas: force, moment; empty: found by name
  TableFrame frame;
  std::optional<double> body_weight;              ///< columns are in % of it; the table's force
  std::string units;                              ///< of the table, FORCE-LENGTH: "N-m"; empty: the model's
  std::vector<double> time;                       ///< one per row, rising
  std::vector<Eigen::Matrix<double, 6, 1>> load;  ///< one per row: force, moment; the model's units, the table's frame
  std::string words;                              ///< how the file was taken
  std::string doubt;                              ///< what may be a slip: "80 kg would be 784.8 N"; empty: nothing
};

/// MotionTable::start of a model whose coordinates of the body are those of its own frame.
inline constexpr const char* kOwnFrame = "own-frame";

/// A table of one body's poses: a row is a state. Row: translation, and rotation vector [rad] about the point of
/// settings.rotate_about (none: the centre of mass), both counted from the body's starting pose, global axes.
struct MotionTable {
  std::string file;
  std::string body;
  std::string columns;   ///< names of three or six columns: translation, rotation; or of a matrix: NAME of NAME11 to
                         ///< NAME44, and of the one of another body that is held, relative to which it is
  std::string rotation;  ///< "vector", or the sequence of three angles: "xyz", "zxy", ...
  std::string units;     ///< ANGLE-LENGTH: "deg-m", of matrices LENGTH; empty: radians, the model's length
  std::string start;     ///< of matrices: kOwnFrame, or TIME or TIME,ground: as that row has it; empty: kOwnFrame
  std::vector<double> time;                         ///< one per row, rising
  std::vector<Eigen::Matrix<double, 6, 1>> motion;  ///< one per row
  bool turns = false;                               ///< rotations are given, not translations alone
  bool about_origin = false;                        ///< rows turn the body about the global origin, then move it
  double farthest = 0.0;  ///< of matrices whose unit nobody says: their longest translation; 0: none
  std::string words;
  std::string doubt;  ///< what may be a slip: that of matrices in another unit; empty: nothing
};

/// Thickness of a layer at the nodes of its surface.
struct NodeThickness {
  std::string file;               ///< where it is read from (io/tables/read_tables.h)
  std::map<int, double> at_node;  ///< by the node's number in the model file; the model's length, >= 0
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
  std::vector<std::string> part;   ///< deformable materials whose elements are to give way as meshed, no layers
  std::vector<std::string> leave_out;         ///< deformable materials whose elements are taken out of the model
  std::optional<double> fibre_strain;         ///< at which fibres of parts have their stiffness, >= 0; empty: 0
  bool instant = false;                       ///< fluid in parts has had no time to get away
  std::map<std::string, std::string> attach;  ///< surface -> body it belongs to ("ground" for the ground)
  std::map<std::string, std::string> bone;    ///< articular surface -> surface that is its bone surface
  std::vector<std::string> keep_facets;       ///< surfaces of which no facet is left out as side wall or bonded
  std::map<std::string, double> thickness;    ///< surface -> constant thickness; "" = all surfaces
  std::map<std::string, NodeThickness>
      thickness_from;                               ///< surface -> thickness per node; not together with `thickness`
  std::map<std::string, double> thickness_scale;    ///< surface -> factor on its thickness, > 0; "" = all
  std::map<std::string, double> E;                  ///< surface -> Young's modulus; "" = all
  std::map<std::string, double> nu;                 ///< surface -> Poisson's ratio; "" = all
  std::map<std::string, std::array<bool, 6>> free;  ///< body -> dofs left free (all others held), in all steps
  std::map<std::string, Eigen::Vector3d>
      force;  ///< body -> force replacing the model's rigid forces, scaled 0..1 over the last step
  std::map<std::string, std::string> force_frame;  ///< body -> frame along whose axes its force is; none: global
  std::map<std::string, Eigen::Matrix3d>
      frames;  ///< name -> axes x, y, z as columns in global directions, orthonormal, right-handed; they never turn
  std::map<std::string, LoadPoint> load_at;       ///< body -> where its force acts
  std::vector<Placement> placements;              ///< act in this order
  std::map<std::string, TurnPoint> rotate_about;  ///< body -> what it is turned about
  std::map<std::string, double> set_values;  ///< "NAME.PARAMETER" -> number in place of the model's (given_values.h)
  LoadTable loads;
  MotionTable motion;
  bool skip_steps = false;  ///< the model's steps are not walked through: what holds at their end starts from rest
  std::string units;        ///< FEBio's name of the model's system of units, where the model names none
  bool squash = true;       ///< show the cartilage compressed; false: rigid with its bone
  bool inside = false;      ///< stress and strain inside the cartilage, too (Law::Layer of two terms)
};

/// The same settings without those that place, load and move bodies or choose states: what a joint is recognised from.
Settings joint_settings(Settings settings);

/// Columns: a frame's axes in global directions; of "" the global ones. Throws UsageError, in the name of the setting
/// that asks: there is no such frame.
Eigen::Matrix3d frame_axes(const Settings& settings, const std::string& frame, const NamedSetting& asks);
/// In global directions.
Eigen::Vector3d global_vector(const Settings& settings, const Placement& placement);
Eigen::Vector3d global_force(const Settings& settings, const std::string& body);

/// Rows of tables, each a state. Both tables have the same times where both are there.
inline std::size_t row_count(const Settings& s) { return std::max(s.loads.time.size(), s.motion.time.size()); }
inline double row_time(const Settings& s, std::size_t row) {
  return s.loads.time.empty() ? s.motion.time[row] : s.loads.time[row];
}

const char* name(SpringsAt springs_at);
const char* name(Law law);
const char* name(LayerFit fit);
const char* name(Facets facets);

}  // namespace dea
