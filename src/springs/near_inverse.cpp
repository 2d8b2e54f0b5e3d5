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
  MatrixXd scaled = MatrixXd::Zero(g.rows(), g.cols());
  for (Index i = 0; i < g.rows(); ++i)
    if (takes_part(i)) scaled.row(i) = std::sqrt(share(i) * weight[i] / feet.volume[at(i)]) * g.row(i);
  const Nodal q = solved(layer.near, layer.held[1], feet.columns[1], loads(layer, feet, scaled));
  for (Index i = 0; i < g.rows(); ++i)
    for (Index c = 0; c < g.cols() && takes_part(i); ++c)
      inverse(i, c) -=
          std::sqrt(share(i) / (weight[i] * feet.volume[at(i)])) * gathered(feet, static_cast<int>(i), q, c);
}

}  // namespace dea
