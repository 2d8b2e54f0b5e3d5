#include "io/feb/feb_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "io/files/free_memory.h"
#include "io/files/output.h"
#include "src/base/error.h"

namespace dea::feb {
namespace {

constexpr double kMemoryPerByte = 8;  // of a file: its text, its elements and what is read from them

bool is_project_file(const std::string& path) { return one_of(extension_of(path), {".fsm", ".fs2", ".fsp", ".fsprj"}); }

/// Up to `most` bytes of the file from `begin` on; "": it cannot be read.
std::string read_piece(const std::string& path, std::uintmax_t begin, std::size_t most) {
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(begin));
  std::string piece(most, '\0');
  in.read(piece.data(), static_cast<std::streamsize>(most));
  piece.resize(at(in.gcount()));
  return piece;
}

}  // namespace

std::unique_ptr<XMLDocument> load_xml(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(path + ": no such file: check the path");
  if (std::filesystem::is_directory(status)) throw InputError(path + ": this is a folder, expected a .feb file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(path + ": not a file, expected a .feb file");
  if (is_project_file(path)) {
    throw InputError(path + ": this is a FEBio Studio project; export the FEBio file: File > Export FE model (.feb)");
  }
  const auto size = std::filesystem::file_size(path, error);
  if (error) throw InputError(path + ": cannot be read: check its permissions");
  if (size == 0) throw InputError(path + ": the file is empty, expected a FEBio model: save it again");
  need_memory(path, kMemoryPerByte * static_cast<double>(size));
  std::string start = read_piece(path, 0, 64);
  if (start.empty()) throw InputError(path + ": cannot be read: check its permissions");
  if (start.rfind("\xFF\xFE", 0) == 0 || start.rfind("\xFE\xFF", 0) == 0) {
    throw InputError(path, 1, "this is text in UTF-16, expected UTF-8: save it with that encoding");
  }
  if (start.rfind(std::string("BEF\0", 4), 0) == 0 || start.rfind(std::string("\0FEB", 4), 0) == 0) {
    throw InputError(path + ": this is a plot file, expected a FEBio model (.feb): dea plot and dea compare show it");
  }
  if (start.rfind("\xEF\xBB\xBF", 0) == 0) start.erase(0, 3);  // byte order mark
  if (start.rfind("<?xml", 0) != 0) {
    for (char& c : start)
      if (static_cast<unsigned char>(c) > 126) c = '?';  // of a binary file: nothing to print
    throw InputError(path, 1,
                     fmt::format("the file starts with {}, expected \"<?xml\": this is no FEBio model (.feb)",
                                 quote(start.substr(0, 12))));
  }

  auto document = std::make_unique<XMLDocument>();
  const tinyxml2::XMLError outcome = document->LoadFile(path.c_str());
  if (outcome == tinyxml2::XML_SUCCESS) return document;
  if (outcome == tinyxml2::XML_ERROR_FILE_NOT_FOUND || outcome == tinyxml2::XML_ERROR_FILE_COULD_NOT_BE_OPENED ||
      outcome == tinyxml2::XML_ERROR_FILE_READ_ERROR) {
    throw InputError(path + ": cannot be read: check its permissions");
  }
  const int line = std::max(1, document->ErrorLineNum());
  if (outcome == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) {
    throw InputError(path, line, "XML nested too deeply: this is no FEBio model");
  }
  constexpr std::uintmax_t kEnd = 256;  // bytes that tell a file that was cut off from one that is damaged
  if (read_piece(path, size - std::min(size, kEnd), kEnd).find("</febio_spec>") == std::string::npos) {
    throw InputError(path, line, "the file ends without </febio_spec>: it is cut off; save or copy it again");
  }
  throw InputError(path, line,
                   fmt::format("broken XML ({}): the file is damaged here; repair or save it again",
                               XMLDocument::ErrorIDToName(outcome)));
}

std::string_view text_of(const XMLElement& element, std::string& store) {
  std::string_view only;
  int pieces = 0;
  for (const tinyxml2::XMLNode* child = element.FirstChild(); child != nullptr; child = child->NextSibling()) {
    if (child->ToText() == nullptr) continue;
    if (++pieces == 1) {
      only = child->Value();
      continue;
    }
    if (pieces == 2) store = only;
    store += child->Value();
  }
  return pieces > 1 ? std::string_view(store) : only;
}

std::string text_of(const XMLElement& element) {
  std::string store;
  return std::string(text_of(element, store));
}

std::string attribute(const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  return text == nullptr ? std::string() : std::string(text);
}

bool is_leaf(const XMLElement& element) { return element.FirstChildElement() == nullptr; }

}  // namespace dea::feb
