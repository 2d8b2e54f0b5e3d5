// febiodea/io/files/existing_model.h – a model that is there already: may another one take its place unasked?
#pragma once
#include <string>
#include <string_view>

namespace dea {

/// Words in what `dea convert` and `dea build` write, by which they know their own files.
inline constexpr std::string_view kConvertedMark = "type=\"dea\"", kBuiltMark = "Made by dea build";

/// Why a model must not replace the file at `path` unless it is asked for: "it is there already, not made by dea
/// build"; empty: it may. One that is not there, is empty, no plain file or cannot be read, or has the mark, may be
/// replaced.
std::string why_kept_model(const std::string& path, std::string_view mark, const std::string& command);

}  // namespace dea
