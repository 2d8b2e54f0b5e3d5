// io/feb/read_feb.h – a FEBio model file becomes a JointModel.
#pragma once
#include <string>

#include "src/model/joint_model.h"

namespace dea {

/// Reads a .feb file of version 1.2, 2.0, 2.5, 3.0 or 4.0 with everything it includes.
/// Takes what the file says without conclusions: node, element and set references are resolved to indices,
/// step membership and load curves are kept. What is harmless and unknown is listed in `ignored`, what changes the
/// mechanics and is not supported in `unsupported`; both with the line of their first occurrence.
/// Throws InputError ("file:line: what was found, what was expected, what to do") on anything malformed:
/// no XML, another root or version, a dangling id, a number that is none (NaN and infinity included), ...
JointModel read_feb(const std::string& path);
/// The same of a text that is in memory; `path` is what messages call it, and where it would include files from.
JointModel read_feb_text(const std::string& text, const std::string& path);

}  // namespace dea
