#include "src/springs/near_inverse.h"

#include <cmath>

#include "src/base/numbers.h"

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void add_near_inverse(const LayerOperator& layer, const LayerFeet& feet, const VectorXd& weight,
                      const std::vector<char>& asked, const MatrixXd& g, MatrixXd& inverse) {
  if (layer.law.terms < 2) return;
  const auto takes_part = [&](Index i) { return asked[at(i)] && feet.volume[at(i)] > 0; };
  const auto share = [&](Index i) {  // of the local compliance
    const double own = feet.area[at(i)] * feet.own[at(i)] / weight[i];
    return own < 1 - 1e-9 ? kNear.two * own : 1.0;
  };
  Nodal q = Nodal::Zero(layer.mesh.nodes(), g.cols());
  for (Index i = 0; i < g.rows(); ++i) {
    if (!takes_part(i)) continue;
    const double scale = std::sqrt(share(i) * weight[i] / feet.volume[at(i)]);
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j)
      q.row(feet.node[at(j)]) += scale * feet.weight[at(j)] * g.row(i);
  }
  for (const int v : feet.columns[1])
    if (layer.held[1][at(v)]) q.row(v).setZero();
  solve(layer.near, feet.columns[1], q);
  for (Index i = 0; i < g.rows(); ++i) {
    if (!takes_part(i)) continue;
    const double scale = std::sqrt(share(i) / (weight[i] * feet.volume[at(i)]));
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j)
      inverse.row(i) -= scale * feet.weight[at(j)] * q.row(feet.node[at(j)]);
  }
}

}  // namespace dea
