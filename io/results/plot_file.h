// io/results/plot_file.h – results as a plot file that lies beside FEBio's own: same mesh, names and order.
#pragma once
#include "io/xplt/xplt.h"
#include "src/run/analysis.h"
#include "src/run/check.h"

namespace dea {

/// Every wanted state with displacements, rigid bodies and the fields of each contact surface. A surface of several
/// contacts shows the one that presses hardest on it in that state.
XpltFile make_plot_file(const JointModel& model, const Analysis& analysis, bool compressed = false);

/// Where the states have the inside of the layers, also FEBio's `stress` and `Lagrange strain` of each domain of
/// deformable solid elements, and on contact surfaces what layers bear at the bone and at the surface.
///
/// The same state by state: what all states have in common, and each of them.
struct PlotHead {
  XpltFile file;                        ///< header, dictionary, one mesh; no states
  std::vector<int> material_of_domain;  ///< per domain of the file; -1: springs
  std::vector<int> surface;             ///< per model surface: 1-based region of the file, 0: left out
  bool inside = false;                  ///< with stress and strain inside the cartilage
};
PlotHead plot_head(const JointModel& model, const Joint& joint, bool compressed = false, bool inside = false);
XpltState plot_state(const JointModel& model, const Joint& joint, const PlotHead& head, const StateResult& result);
inline XpltFile make_plot_file(const Recognition& recognition, const Analysis& analysis, bool compressed = false) {
  return make_plot_file(recognition.model, analysis, compressed);
}

/// The mesh in it: the model's as FEBio would write it.
XpltMesh plot_mesh(const JointModel& model);

/// What `dea info -o` shows: thickness, initial gap, missed normals, rims and facets left out on the surfaces, and the
/// springs that face something as line elements (on nodes of their own after the model's).
XpltFile make_check_file(const JointModel& model, const JointCheck& check);

}  // namespace dea
