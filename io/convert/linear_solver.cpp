#include "io/convert/linear_solver.h"

#include <algorithm>
#include <array>

namespace dea {

namespace {

struct Row {
  const char* type;
  bool alone;      ///< solves by its name alone; iterative ones and those of blocks want parameters and other solvers
  bool symmetric;  ///< takes symmetric matrices only
};

// Of FEBio 4.11 (NumCore.cpp, FECore.cpp). LU is there for other uses: it tells every solve that it failed.
constexpr std::array kSolvers = {Row{"accelerate", true, false},
                                 Row{"bicgstab", false, false},
                                 Row{"bipn", false, false},
                                 Row{"block", false, false},
                                 Row{"boomeramg", false, false},
                                 Row{"cg", false, true},
                                 Row{"fgmres", false, false},
                                 Row{"hypre_gmres", false, false},
                                 Row{"hypre_pcg_amg", false, false},
                                 Row{"LU", false, false},
                                 Row{"mkl_dss", true, false},
                                 Row{"pardiso", true, false},
                                 Row{"pardiso-project", true, false},
                                 Row{"pardiso_64", true, false},
                                 Row{"schur", false, false},
                                 Row{"skyline", true, true},
                                 Row{"strategy", false, false},
                                 Row{"superlu_mt", true, false},
                                 Row{"test", false, false}};

const Row* find(const std::string& type) {
  const auto row = std::find_if(kSolvers.begin(), kSolvers.end(), [&](const Row& r) { return r.type == type; });
  return row == kSolvers.end() ? nullptr : &*row;
}

}  // namespace

std::vector<std::string> linear_solver_names() {
  std::vector<std::string> names;
  for (const Row& r : kSolvers)
    if (r.alone) names.push_back(r.type);
  return names;
}

bool known_linear_solver(const std::string& type) { return find(type) != nullptr; }

bool symmetric_only(const std::string& type) {
  const Row* row = find(type);
  return row != nullptr && row->symmetric;
}

}  // namespace dea
