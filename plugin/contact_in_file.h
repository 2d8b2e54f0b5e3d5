// plugin/contact_in_file.h – a contact of type dea as its file has it: FEBio's reader keeps no lines, and
// takes "11,85" for 11.
#pragma once
#include <map>
#include <string>

namespace dea {

struct ParameterInFile {
  std::string text, type;  ///< type: the attribute
  int line = 0;
};

/// The contact's parameters by their names. Empty where they are not found: the contact is in an included file, the
/// file is none of FEBio's XML (a dump of a run), or cannot be read.
std::map<std::string, ParameterInFile> contact_in_file(const std::string& path, const std::string& contact);

}  // namespace dea
