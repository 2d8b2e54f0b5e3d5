// Formulas of load controllers and constants, values of settings, factors of a study: text of one line. The first byte
// chooses.
#include "fuzz/fuzz.h"
#include "src/model/load_curve.h"
#include "src/model/settings_table.h"
#include "src/study/plan.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 2, size - 2);
  dea::fuzz::answer_or_refusal([&] {
    if (data[0] % 4 == 0) {
      if (!dea::expression_fault(text, {"t"}).empty()) return;
      dea::LoadController curve;
      curve.expression = text;
      for (const double t : {0.0, 0.5, 1.0}) dea::value(curve, t);
    } else if (data[0] % 4 == 1) {
      dea::constant_value(text);
    } else if (data[0] % 4 == 2) {
      dea::parse_factor(text);
    } else if (!text.empty()) {
      const std::vector<dea::SettingOption>& options = dea::setting_options();
      dea::Settings settings;
      dea::set_value(settings, {&options[data[1] % options.size()], "femur", text, "fuzz"});
    }
  });
  return 0;
}
