// `dea build` starts dea-build, the program that lies beside dea or on the path.
#include "app/commands.h"
#include "app/process.h"
#include "src/base/error.h"

namespace dea {

int start_build(const BuildArguments& a) {
  need_programs("build");
  std::vector<std::string> build(a.words.begin() + 1, a.words.end());  // "build", which its own name takes the place of
  for (const std::string& program : {(own_path().parent_path() / "dea-build").string(), std::string("dea-build")}) {
    build.front() = program;
    become_program(build);
  }
  throw UsageError(
      "build: found no program dea-build beside dea or on the path; install the package febiodea-build, or build the "
      "target dea-build, which needs CGAL (libcgal-dev)");
}

}  // namespace dea
