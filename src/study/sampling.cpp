#include "src/study/plan.h"

#include <algorithm>
#include <boost/math/distributions/lognormal.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/random/sobol.hpp>
#include <cassert>
#include <cmath>
#include <numeric>
#include <random>

#include "src/base/numbers.h"

namespace dea {

namespace {

using Points = std::vector<std::vector<double>>;

/// The upper 53 bits as a number in [0, 1): std::uniform_real_distribution differs between libraries.
double unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

Points sobol_points(int dimensions, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint64_t> shift(at(dimensions));
  for (std::uint64_t& s : shift) s = random();
  boost::random::sobol sequence(at(dimensions));
  Points points(at(count), std::vector<double>(at(dimensions)));
  for (std::vector<double>& point : points)
    for (std::size_t k = 0; k < point.size(); ++k)
      point[k] = unit(sequence() + shift[k]);  // whole numbers modulo 2^64: the sum modulo 1
  return points;
}

/// 0 .. count - 1, shuffled by Fisher and Yates: std::shuffle differs between libraries.
std::vector<int> permutation(int count, std::mt19937_64& random) {
  std::vector<int> order(at(count));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t left = order.size(); left > 1; --left) std::swap(order[left - 1], order[random() % left]);
  return order;
}

Points latin_points(int dimensions, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Points points(at(count), std::vector<double>(at(dimensions)));
  for (std::size_t k = 0; k < at(dimensions); ++k) {
    const std::vector<int> slice = permutation(count, random);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double next = (slice[i] + 1.0) / count;
      // rounding may reach the slice's end, which is the next one's
      points[i][k] = std::min((slice[i] + unit(random())) / count, std::nextafter(next, 0.0));
    }
  }
  return points;
}

Points saltelli_points(int dimensions, int count, std::uint64_t seed) {
  const std::size_t d = at(dimensions);
  const Points both = sobol_points(2 * dimensions, count, seed);
  Points points;
  points.reserve(both.size() * (d + 2));
  for (const std::vector<double>& row : both) points.emplace_back(row.begin(), row.begin() + dimensions);
  for (const std::vector<double>& row : both) points.emplace_back(row.begin() + dimensions, row.end());
  for (std::size_t k = 0; k < d; ++k)
    for (const std::vector<double>& row : both) {
      points.emplace_back(row.begin(), row.begin() + dimensions);
      points.back()[k] = row[d + k];
    }
  return points;
}

}  // namespace

int most_dimensions(Design design) {
  constexpr int kSobol = 3667;  // Boost's table
  return design == Design::Latin ? 100000 : design == Design::Sobol ? kSobol : kSobol / 2;
}

Points unit_points(Design design, int dimensions, int count, std::uint64_t seed) {
  assert(dimensions > 0 && dimensions <= most_dimensions(design) && count > 0);
  switch (design) {
    case Design::Latin:
      return latin_points(dimensions, count, seed);
    case Design::Saltelli:
      return saltelli_points(dimensions, count, seed);
    case Design::Sobol:
      break;
  }
  return sobol_points(dimensions, count, seed);
}

double quantile(const Spread& spread, double u) {
  const double inside = std::clamp(u, 0x1p-54, 1.0 - 0x1p-53);
  switch (spread.kind) {
    case Spread::Kind::Normal:
      return boost::math::quantile(boost::math::normal_distribution<double>(spread.a, spread.b), inside);
    case Spread::Kind::LogNormal:
      return boost::math::quantile(boost::math::lognormal_distribution<double>(spread.a, spread.b), inside);
    case Spread::Kind::Uniform:
      return spread.a + (spread.b - spread.a) * u;
    case Spread::Kind::None:
      break;
  }
  assert(false);
  return kNaN;
}

}  // namespace dea
