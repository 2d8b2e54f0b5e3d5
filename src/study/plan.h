// src/study/plan.h – a study: which models are solved with which options, as cases in order; values of factors drawn
// from their spreads.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
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

/// One option of `dea run` that differs from case to case: "tilt: rotate pelvis=0,1,0,{-20:20:5}".
struct Factor {
  std::string name;                 ///< of its column in cases, CSV, Python and pages: "tilt"
  std::string option;               ///< without dashes: "rotate"
  std::string before, after;        ///< the option's text around the value: "pelvis=0,1,0,", ""
  std::vector<std::string> values;  ///< of {START:STOP:STEP} or {a|b|c}; empty: `spread`, or from a table of cases ({})
  Spread spread;                    ///< of {uniform(8,16)} and its like; kind None: not sampled
};

/// One option of the line.
struct PlanOption {
  std::string name;  ///< of a setting, without dashes
  std::string text;  ///< its value; empty where `factor` has it
  int factor = -1;   ///< index; -1: the same in every case
};

/// A case: one model with one value of every factor. It depends on nothing but these and the plan's options.
struct PlannedCase {
  int model = 0;                    ///< index
  std::vector<std::string> values;  ///< one per factor
};

struct Plan {
  std::vector<std::string> models;  ///< paths, as they were given
  std::vector<PlanOption> options;  ///< of every case, in the order of the line: placements act in it
  std::vector<Factor> factors;
  std::vector<PlannedCase> cases;  ///< number of a case: its index + 1. Models are the slowest to change, then the
                                   ///< factors with values of their own, in their order, then rows of a table or points
                                   ///< of a sample. Where a table names the models: its rows first
};

/// The option of a case as it stands on the line: name and whole text.
struct CaseOption {
  std::string name, text;
};
/// All options of a case, in the order of the line.
std::vector<CaseOption> options_of(const Plan& plan, const PlannedCase& c);

/// More cases than this are refused.
inline constexpr std::int64_t kMostCases = 10'000'000;
/// More factors than this are refused: each is a column.
inline constexpr std::size_t kMostFactors = 500;

/// "NAME: OPTION VALUE" or "NAME: OPTION=VALUE", with one {...} in VALUE. The numbers of a range are decimal and exact,
/// both ends belong to it. Throws BadValue: it is none, the option is no setting, a range has no end or too many
/// values.
Factor parse_factor(const std::string& text);

/// Cases as a table, every cell as text.
struct CaseTable {
  std::string path;
  int names_line = 1;              ///< of the file, 1-based
  std::vector<std::string> names;  ///< of factors, or "model"
  std::vector<std::vector<std::string>> rows;
  std::vector<int> lines;  ///< of the rows
};

/// Is a cell none: empty, NaN, NA, infinite?
bool is_missing(const std::string& cell);

/// Points drawn for all factors with a spread together.
struct Sampling {
  Design design = Design::Sobol;
  int count = 0;
  std::uint64_t seed = 1;
};
/// "sobol", "latin" or "saltelli". Throws BadValue.
Design parse_design(const std::string& text);

/// What a plan is made of.
struct PlanRequest {
  std::vector<std::string> models;
  std::vector<PlanOption> options;
  std::vector<Factor> factors;
  std::optional<CaseTable> table;
  std::optional<Sampling> sampling;
};
/// Every model with every combination of the factors' values, and of these with each row of the table or point of the
/// sample. A sampled value has 12 significant digits, so that computers whose logarithms differ in the last one agree.
/// Throws UsageError (what does not fit together, too many cases) and InputError (the table).
Plan make_plan(PlanRequest request);

}  // namespace dea
