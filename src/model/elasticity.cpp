#include "src/model/elasticity.h"

namespace dea {

double confined_modulus(double E, double nu) { return E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)); }

}  // namespace dea
