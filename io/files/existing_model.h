// io/files/existing_model.h – a model that is there already: may another one take its place unasked?
#pragma once
#include <string>
#include <string_view>

namespace dea {

/// A plain file with something in it is at `path`: what writing there would replace.
bool would_replace(const std::string& path);

/// Words by which a model is known: a contact of the plugin, and the comment that `dea build` writes.
inline constexpr std::string_view kConvertedMark = "type=\"dea\"", kBuiltMark = "Made by dea build";

/// Who wants to write a model.
enum class ModelOf { Convert, Build };

/// Why a model must not replace the file at `path` unless it is asked for: "it is there already, not made by dea
/// build"; empty: it may. One that is not there, is empty or no plain file may be replaced; `dea convert` replaces
/// models with a contact of type dea, `dea build` its own that have none.
std::string why_kept_model(const std::string& path, ModelOf command);

}  // namespace dea
