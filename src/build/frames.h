// src/build/frames.h – landmarks on bones become anatomical frames.
//
// Pelvis and femur: Wu et al. 2002, J Biomech 35:543 (ISB). Tibia: Grood and Suntay 1983, J Biomech Eng 105:136, in
// ISB's letters. All of them: x forwards (anterior), y upwards (proximal), z to the right of the body, on either side.
// Frame: points and directions are in the scans' axes. Lengths: the scans'.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace dea {

enum class BodySide { Right, Left };
/// Inline: views word it without linking the library dea_build.
inline const char* name(BodySide side) { return side == BodySide::Right ? "right" : "left"; }
/// The side's lateral direction, in a frame whose z points to the right: 1 or -1 times z.
double lateral_sign(BodySide side);

struct Landmark {
  std::string name;  ///< as its file has it
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::string file = {};  ///< for messages
};

struct AnatomicalFrame {
  std::string name;  ///< pelvis, femur or tibia
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns x, y, z; orthonormal, right-handed
  std::string words;                                   ///< of which points it was made
};

/// The three columns of the pelvis' axes, without its origin. Throws InputError: not all four spines are there, or they
/// lie on a line. nullopt: not one of them is there.
std::optional<Eigen::Matrix3d> pelvis_axes(const std::vector<Landmark>& landmarks);

/// RASIS and LASIS; empty: they are not both there.
std::vector<Landmark> front_spines(const std::vector<Landmark>& landmarks);

/// What landmarks alone say of the side: those with R or L before their name (but for the spines, which have both).
/// nullopt: nothing, or both.
std::optional<BodySide> side_of(const std::vector<Landmark>& landmarks);

/// Those landmarks' names, "RMFE, RLFE", for messages.
std::string sided_names(const std::vector<Landmark>& landmarks);

/// The hip's centre: RHJC or LHJC of that side, or HJC. nullopt: none is there, or two and nobody knows the side.
std::optional<Eigen::Vector3d> hip_center(const std::vector<Landmark>& landmarks, std::optional<BodySide> side);

struct FramesRequest {
  std::vector<Landmark> landmarks;
  std::optional<BodySide> side;               ///< of the limb; empty: nobody knows
  std::optional<Eigen::Vector3d> hip_center;  ///< of the landmarks, or fitted
  std::string hip_center_words;               ///< how it was found
  bool has_femur = true;                      ///< a femur is among the bones: say what its frame lacks
};

struct FramesFound {
  std::vector<AnatomicalFrame> frames;  ///< pelvis, femur, tibia: those that can be made
  std::vector<std::string> findings;    ///< what was concluded or is missing, a line each
};

/// Names are compared without capitals and without what is no letter. Throws InputError: a landmark twice; some of a
/// bone's landmarks without the others; points on a line; sides that do not fit together.
///   pelvis  z along LASIS to RASIS; x across it, in the plane of both and the middle of RPSIS, LPSIS; origin: the
///   hip's
///           centre, or the middle of RASIS, LASIS
///   femur   y from the middle of MFE, LFE to the hip's centre, the origin; z across it, in the plane of the three
///   tibia   y from the middle of MM, LM to that of MC, LC, the origin; z across it, in the plane of MC, LC and the
///   former
FramesFound make_frames(const FramesRequest& request);

}  // namespace dea
