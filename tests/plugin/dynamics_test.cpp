// A contact of type dea in a dynamic analysis: small oscillations on the bed of springs, against the answer on paper.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "io/results/result_file.h"
#include "src/base/numbers.h"
#include "tests/plugin/febio_runs.h"

namespace dea::test {
namespace {

/// Times at which `y` goes upwards through `level`, linear between the samples.
std::vector<double> upward_crossings(const std::vector<double>& t, const std::vector<double>& y, double level) {
  std::vector<double> times;
  for (std::size_t i = 1; i < y.size(); ++i)
    if (y[i - 1] < level && y[i] >= level)
      times.push_back(t[i - 1] + (t[i] - t[i - 1]) * (level - y[i - 1]) / (y[i] - y[i - 1]));
  return times;
}

/// A flat layer of area A = 9, thickness h = 2 and confined modulus M on a rigid base of mass m, pressed statically by
/// 5 against a rigid plate that is held: linear springs of total stiffness k = M A / h. A tenth of the load is taken
/// away at once: the base oscillates by a tenth of the overlap about the new equilibrium with the period 2 pi sqrt(h m
/// / (M A)). Steps are a hundredth of that, for which the trapezoidal rule (rhoi = 1) gives a period longer by (2 pi /
/// 100)^2 / 12 = 0.03 %. FEBio takes the velocity of the static step along: that step takes 100 s, so that it is next
/// to none.
TEST(ContactDea, OscillatesWithThePeriodOnPaper) {
  constexpr double E = 10, nu = 0.3, A = 9, h = 2, load = 5, mass = 2e-3;
  const double k = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * A / h, period = 2 * kPi * std::sqrt(mass / k);
  constexpr int kSteps = 400;
  const double dt = period / 100;

  const TemporaryFolder folder;
  Parts pressed;
  pressed.motion = fmt::format(
      "<rigid_load name=\"push\" type=\"rigid_force\"><rb>base</rb><dof>Rz</dof><value lc=\"1\">{}</value>"
      "</rigid_load>",
      load);
  std::string model = model_40(false, pressed);
  const auto replace = [](std::string& text, const std::string& old, const std::string& by) {
    const std::size_t place = text.find(old);
    ASSERT_NE(place, text.npos) << old;
    text.replace(place, old.size(), by);
  };
  replace(model, "<density>1</density>", fmt::format("<density>{}</density>", mass / (A * h)));
  // the base is free in z, the plate is held
  replace(model, "<Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof><Ru_dof>", "<Ry_dof>1</Ry_dof><Ru_dof>");
  replace(model, "<rb>plate</rb><Rx_dof>1</Rx_dof>", "<rb>plate</rb><Rx_dof>1</Rx_dof><Rz_dof>1</Rz_dof>");
  replace(model, kControl4, "");
  replace(model, "<LoadData>",
          fmt::format("<Step><step id=\"1\" name=\"press\"><Control><time_steps>4</time_steps><step_size>25"
                      "</step_size><solver type=\"solid\"/></Control></step>\n"
                      "<step id=\"2\" name=\"swing\"><Control><analysis>DYNAMIC</analysis><time_steps>{}</time_steps>"
                      "<step_size>{:.17g}</step_size><solver type=\"solid\"><rhoi>1</rhoi></solver></Control></step>"
                      "</Step>\n<LoadData>",
                      kSteps, dt));
  replace(model, "<interpolate>SMOOTH", "<interpolate>LINEAR");
  replace(model, "<point>1,1</point>", fmt::format("<point>100,1</point><point>{:.17g},0.9</point>", 100 + dt / 100));
  write(folder.path / "m.feb", model);
  Finished f = run_program(folder.path, {DEA_PROGRAM, "convert", "m.feb", "-o", "plate.feb", "--law", "linear"}, 60);
  ASSERT_EQ(f.code, 0) << f.err;
  write(folder.path / "febio.xml", fmt::format("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<febio_config "
                                               "version=\"3.0\"><import>{}</import><import>{}</import>"
                                               "<default_linear_solver type=\"sparse_lu\"></default_linear_solver>"
                                               "</febio_config>\n",
                                               DEA_DUMP_PLUGIN, DEA_PLUGIN));
  f = run_program(folder.path, {DEA_FEBIO4, "-nosplash", "-config", "febio.xml", "-i", "plate.feb"}, 300);
  ASSERT_EQ(f.code, 0) << f.out.substr(f.out.size() < 4000 ? 0 : f.out.size() - 4000);

  const ResultFile result = read_result((folder.path / "plate.xplt").string(), "plate");
  ASSERT_EQ(result.xplt.states.size(), static_cast<std::size_t>(1 + 4 + kSteps));
  std::vector<double> times, heights;  // of the swing, from the static equilibrium on; the file's times are rounded
  for (int i = 4; i < 5 + kSteps; ++i)
    for (const BodyPose& body : body_poses(result, i)) {
      if (body.name != "base") continue;
      times.push_back((i - 4) * dt);
      heights.push_back(body.position.z());
    }
  ASSERT_EQ(times.size(), static_cast<std::size_t>(1 + kSteps));
  EXPECT_NEAR(heights.front(), -2 + 0.1 + load / k, 1e-5);  // mm: centre of mass at -2, gap 0.1
  const double amplitude = 0.1 * load / k, middle = heights.front() - amplitude;
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  EXPECT_NEAR(*high - middle, amplitude, 0.01 * amplitude);
  EXPECT_NEAR(middle - *low, amplitude, 0.01 * amplitude);
  const std::vector<double> crossings = upward_crossings(times, heights, middle);
  ASSERT_GE(crossings.size(), 3u);
  const double found = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  EXPECT_NEAR(found, period, 0.001 * period);
  std::cout << fmt::format("period: {:.6g} found, {:.6g} on paper ({:+.3f}%), amplitude {:.5g} and {:.5g} of {:.5g}\n",
                           found, period, 100 * (found / period - 1), *high - middle, middle - *low, amplitude);
}

}  // namespace
}  // namespace dea::test
