#include <febiodea/study/plan.h>

#include <febiodea/base/numbers.h>

namespace dea {

std::vector<CaseOption> options_of(const Plan& plan, const PlannedCase& c) {
  std::vector<CaseOption> options;
  for (const PlanOption& option : plan.options) {
    if (option.factor < 0) {
      options.push_back({option.name, option.text});
      continue;
    }
    const Factor& factor = plan.factors[at(option.factor)];
    options.push_back({option.name, factor.before + c.values[at(option.factor)] + factor.after});
  }
  return options;
}

}  // namespace dea
