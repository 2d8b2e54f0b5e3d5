// app/build_names.h – how options of `dea build` name bones, and what is said where they do not fit.
#pragma once
#include <string>
#include <vector>

#include "app/options.h"
#include "src/build/build_joint.h"

namespace dea {

/// "--OPTION TEXT: found FOUND, expected EXPECTED".
UsageError wrong(const std::string& option, const std::string& text, const std::string& found,
                 const std::string& expected);

/// "femur=2.0", cut at the first '=': a file's name may have more of them.
struct Named {
  std::string name, value;
};
Named named(const char* option, const std::string& text, const char* form);

std::vector<std::string> bone_names(const BuildRequest& request);

/// Its place among the request's. Throws UsageError: there is none of this name.
int bone_of(const BuildRequest& request, const char* option, const std::string& name);

/// Of an option that a bone has once.
void refuse_second(const char* option, const std::string& text, bool there);

}  // namespace dea
