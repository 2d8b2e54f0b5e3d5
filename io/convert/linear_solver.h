// io/convert/linear_solver.h – FEBio's linear solvers, as far as a converted model has to know them.
#pragma once
#include <string>
#include <vector>

namespace dea {

/// `<linear_solver type="TYPE">CONTENT</linear_solver>`; without a type: none is named, FEBio takes its default.
struct LinearSolver {
  std::string type;
  std::string content;  ///< XML as it stands
};

/// Those of FEBio 4.11 that need nothing but their name.
std::vector<std::string> linear_solver_names();
/// FEBio 4.11 has it.
bool known_linear_solver(const std::string& type);
/// It takes no other matrices than symmetric ones.
bool symmetric_only(const std::string& type);

}  // namespace dea
