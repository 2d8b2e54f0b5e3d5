#include "src/base/finding.h"

#include <unordered_map>

namespace dea {

void add_once(Findings& findings, const Findings& more) {
  // a file may have thousands of one kind: only those that may be equal are compared
  const auto key = [](const Finding& f) { return f.code + f.place + f.subject.contact + f.subject.surface; };
  std::unordered_multimap<std::string, std::size_t> there;
  for (std::size_t i = 0; i < findings.size(); ++i) there.emplace(key(findings[i]), i);
  for (const Finding& one : more) {
    const auto [begin, end] = there.equal_range(key(one));
    bool known = false;
    for (auto it = begin; it != end && !known; ++it) known = findings[it->second] == one;
    if (known) continue;
    there.emplace(key(one), findings.size());
    findings.push_back(one);
  }
}

}  // namespace dea
