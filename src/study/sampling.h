// src/study/sampling.h – values of factors drawn from their spreads.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace dea {

/// What a factor's values are drawn from.
struct Spread {
  enum class Kind { None, Uniform, Normal, LogNormal };
  Kind kind = Kind::None;
  double a = 0.0;  ///< Uniform: least; Normal: mean; LogNormal: mean of the logarithm
  double b = 0.0;  ///< Uniform: largest; Normal: standard deviation, > 0; LogNormal: that of the logarithm
};

/// Of each kind.
inline constexpr std::array<const char*, 4> kSpreadWords = {"", "uniform", "normal", "lognormal"};

enum class Design { Sobol, Latin, Saltelli };

/// As many factors as the design can have.
int most_dimensions(Design design);

/// Points in the unit cube, [0, 1)^d, a row each; the same for the same arguments on every machine. Sobol: the Sobol
/// sequence without its first point, shifted by random numbers of the seed (Cranley-Patterson). Latin: one point in
/// each of `count` slices of every axis. Saltelli: `count` points A, B of a Sobol sequence in 2 d, and for each factor
/// i A with column i of B: count (d + 2) rows, in the order A, B, AB_1 .. AB_d.
std::vector<std::vector<double>> unit_points(Design design, int dimensions, int count, std::uint64_t seed);

/// The value at which the spread's distribution function is `u`, in [0, 1). A normal spread's ends, which are at
/// infinity, are taken where u is 2^-54 from 0.
double quantile(const Spread& spread, double u);

}  // namespace dea
