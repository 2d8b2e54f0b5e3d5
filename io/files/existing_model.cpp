#include "io/files/existing_model.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace dea {

namespace {

/// Is the word in it? Read in pieces: a model may be as large as the memory.
bool has(const std::string& path, std::string_view word) {
  constexpr std::size_t kPiece = 1 << 20, kLongest = 64;  // of words, which may lie across two pieces
  std::ifstream in(path, std::ios::binary);
  std::string text;
  while (in) {
    const std::size_t kept = std::min(text.size(), kLongest);
    text.erase(0, text.size() - kept);
    text.resize(kept + kPiece);
    in.read(text.data() + kept, kPiece);
    text.resize(kept + static_cast<std::size_t>(in.gcount()));
    if (text.find(word) != text.npos) return true;
  }
  return false;
}

}  // namespace

bool would_replace(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) > 0 && !error;
}

std::string why_kept_model(const std::string& path, ModelOf command) {
  if (!would_replace(path)) return "";
  if (!std::ifstream(path, std::ios::binary)) return "it is there already, and cannot be read";
  if (command == ModelOf::Convert)
    return has(path, kConvertedMark) ? "" : "it is there already, a model without a contact of type dea";
  const bool ours = has(path, kBuiltMark) && !has(path, kConvertedMark);
  return ours ? "" : "it is there already, not made by dea build";
}

}  // namespace dea
