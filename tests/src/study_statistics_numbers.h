// Written by study_statistics_numbers.py: scipy's and numpy's answers. Not to be edited.
#pragma once

// clang-format off
namespace dea::test {

inline constexpr double kFirst[] = {4.243, 11.32, 6.803, 2.87, 2.692, 5.152, 3.504, 2.292, 7.539, 3.976, 1.898, 2.265, 15.8, 1.932, 5.723, 4.601, 5.91, 7.735, 6.89, 3.57, 7.044, 7.751, 4.06};
inline constexpr double kSecond[] = {3.411, 10.589, 4.198, 2.078, 3.249, 5.613, 3.472, 3.389, 7.051, 2.622, 3.312, 1.806, 11.509, 2.484, 6.893, 5.14, 6.225, 6.879, 3.547, 4.036, 6.293, 4.06, 3.096};
inline constexpr double kThird[] = {3.0, 2.0, 3.0, 0.0, 2.0, 0.0, 1.0, 3.0, 3.0, 2.0, 2.0, 5.0, 4.0, 2.0, 5.0, 3.0, 5.0, 2.0, 4.0, 4.0, 3.0, 2.0, 0.0};
inline constexpr double kDesign[] = {2.5, 3.56, 3.19, 2.38, 1.1, 0.41, 1.56, 2.85, 3.91, 2.58, 3.68, 4.16, 5.38, 3.29, 4.49, 3.23, 1.76, 0.73, 3.3, 3.89, 5.47, 2.33, 3.49, 2.88, 0.63, 3.37, 2.68, 1.72, 4.69, 2.38, 3.47, 2.73, 2.28, 2.83, 3.79, 2.31, 1.35, 4.8, 3.44, 2.04, 2.91, 1.44, 2.93, 3.86, 1.07, 3.87, 3.81, 2.73, 3.1, 2.67, 2.55, 1.14, 4.63, 2.33, 3.13, 2.77, 3.46, 3.57, 1.98, 3.36, 2.73, 2.12, 4.3, 4.18, 2.1, 2.7, 1.99, 1.86, 2.02, 3.55, 1.58, 1.54, 3.29, 2.28, 4.23, 2.04, 2.51, 2.22, 0.69, 3.35};
inline constexpr double kQuartiles[] = {3.1870000000000003, 4.601, 6.967};
inline constexpr double kTenths[] = {2.2704, 7.747800000000001};
inline constexpr double kMean[] = {5.459565217391304};
inline constexpr double kDeviation[] = {3.2770132164142027};
inline constexpr double kPairedMean[] = {0.6355652173913044};
inline constexpr double kPairedInterval[] = {-0.03610658646244924, 1.3072370212450581};
inline constexpr double kPairedMedian[] = {0.48799999999999955};
inline constexpr double kLimits[] = {-2.408731327026567, 3.6798617618091765};
inline constexpr double kLimitIntervals[] = {-3.573657978107706, -1.2438046759454287, 2.5149351107280378, 4.844788412890315};
inline constexpr double kPairedDz[] = {0.40918646319047275};
inline constexpr double kCohenD[] = {0.21479989856765438};
inline constexpr double kHedges[] = {0.5641895835477563, 0.8407486824596893, 0.9654506587906297, 0.9789963891541879};
inline constexpr double kSpearman[] = {0.8418972332015809, 0.3129076835493154};
inline constexpr double kRanks[] = {14.5, 8.0, 14.5, 2.0, 8.0, 2.0, 4.0, 14.5, 14.5, 8.0, 8.0, 22.0, 19.0, 8.0, 22.0, 14.5, 22.0, 8.0, 19.0, 19.0, 14.5, 8.0, 2.0};
inline constexpr double kRegression[] = {1.0371776170278988, 0.1615372845739504, -0.21704135764641289};
inline constexpr double kRSquared[] = {0.7951908034841257};
inline constexpr double kBootstrapped[] = {0.13429482779838678, 0.8876748033327322, -0.29940589294055325, 0.5372706093867814, 0.4020314069548029, 1.4935548106677405, -0.0021573061798053858, 0.8015461253867607, -0.5000992888753051, 0.38089842767117055, 0.48550584031090105, 1.3872197570192712};

}  // namespace dea::test
