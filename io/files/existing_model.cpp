#include <febiodea/io/files/existing_model.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace dea {

std::string why_kept_model(const std::string& path, std::string_view mark, const std::string& command) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return "";
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  const std::string there = text.str();
  if (there.empty() || there.find(mark) != there.npos) return "";
  return "it is there already, not made by " + command;
}

}  // namespace dea
