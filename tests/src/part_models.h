// tests/src/part_models.h – joints with deformable parts, for tests: meshes as domains, their facets, one load case.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/equilibrium/load_case.h"
#include "src/joint/joint.h"
#include "src/model/element_faces.h"
#include "src/results/fields.h"
#include "tests/src/part_meshes.h"
#include "tests/src/test_models.h"

namespace dea::test {

/// A contact surface: the faces of elements whose corners are all `there`, of those that look along `side` at their
/// middle. The mesh's nodes are the model's first.
inline int add_facets(JointModel& model, const std::string& name, const PartMesh& mesh,
                      const std::function<bool(const Vector3d&)>& there,
                      const std::function<Vector3d(const Vector3d&)>& side) {
  Surface surface;
  surface.name = name;
  for (int e = 0; e < mesh.elements(); ++e)
    for (const std::vector<int>& face : element_faces(mesh.shape[at(e)])) {
      const int corners = facet_corners(static_cast<int>(face.size()));
      std::vector<int> nodes;
      for (const int k : face) nodes.push_back(mesh.element_node[at(mesh.begin[at(e)] + k)]);
      Vector3d middle = Vector3d::Zero();
      bool all = true;
      for (int k = 0; k < corners; ++k) {
        const Vector3d& x = mesh.nodes[at(nodes[at(k)])];
        all = all && there(x);
        middle += x / corners;
      }
      const Vector3d a = mesh.nodes[at(nodes[1])] - mesh.nodes[at(nodes[0])],
                     b = mesh.nodes[at(nodes[2])] - mesh.nodes[at(nodes[0])];
      if (!all || !(a.cross(b).dot(side(middle)) > 0)) continue;
      surface.nodes.insert(surface.nodes.end(), nodes.begin(), nodes.end());
      surface.begin.push_back(static_cast<int>(surface.nodes.size()));
    }
  model.surfaces.push_back(surface);
  return static_cast<int>(model.surfaces.size()) - 1;
}

/// Puts a mesh of one shape into a model that has no nodes yet.
inline void add_mesh(JointModel& model, const PartMesh& mesh, const std::string& name, double E, double nu) {
  for (const Vector3d& x : mesh.nodes) {
    model.nodes.push_back(x);
    model.node_ids.push_back(static_cast<int>(model.nodes.size()));
  }
  Domain d;
  d.name = name;
  d.shape = mesh.shape.front();
  d.material = add_material(model, name, false, E, nu);
  d.nodes = mesh.element_node;
  for (int e = 0; e < mesh.elements(); ++e) d.element_ids.push_back(e + 1);
  model.domains.push_back(d);
}

/// Rigid square |x|, |y| <= half of n x n facets at height(x, y), looking up or down.
inline int add_rigid_square(JointModel& model, const std::string& name, int material, int n, double half, bool up,
                            const std::function<double(double, double)>& height) {
  return add_rigid_surface(
      model, name, n, n,
      [&](double u, double v) {
        const double x = half * (2 * (up ? u : v) - 1), y = half * (2 * (up ? v : u) - 1);
        return Vector3d(x, y, height(x, y));
      },
      material);
}

struct Solved {
  Joint joint;
  SpringBeds beds;
  Equilibrium e;
};
inline Solved solve(const JointModel& model, const Settings& settings = {}) {
  Solved s;
  s.joint = make_joint(model, settings);
  s.beds = make_spring_beds(s.joint);
  const std::vector<Pose> start = reference_poses(s.joint);
  s.e = solve_equilibrium(s.joint, s.beds, make_load_case(model, s.joint, settings, 0, 1.0), start, start);
  return s;
}

/// How a part's nodes have moved in space, nodes x 3.
inline Eigen::MatrixX3d moved(const Solved& s, int part) {
  const SoftPart& of = s.joint.parts[at(part)];
  const Pose pose = s.e.poses[at(of.body)], start = reference_poses(s.joint)[at(of.body)];
  Eigen::MatrixX3d u = *part_motion(s.joint, s.e, part);
  for (int i = 0; i < of.mesh.size(); ++i) {
    const Vector3d x = of.mesh.nodes[at(i)], in_frame = x + u.row(i).transpose() - start.center;
    u.row(i) = (pose.center + pose.rotation * in_frame - x).transpose();
  }
  return u;
}

}  // namespace dea::test
