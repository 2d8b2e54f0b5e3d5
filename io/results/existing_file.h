// io/results/existing_file.h – a file that is there already: may another one take its place unasked? dea replaces what
// it made itself.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "src/model/joint_model.h"

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

/// In every picture and animation: what it was made by.
inline constexpr std::string_view kPictureMark = "Made by FEBioDEA";

/// Why a file that is neither a model nor a plot file nor a study must not be replaced unless it is asked for: "it is
/// there already, not made by dea"; empty: it may. dea knows its JSON by the schema, its tables by their first columns,
/// its pages, pictures, manual pages and libraries by its name, and its frames by having nothing else.
std::string why_kept_file(const std::string& path);

/// What a plot file of ours shows: the results of a run, what was recognised (dea info), results side by side.
enum class PlotKind { Run, Check, Comparison };

/// Why a plot file of this kind must not replace the one at `path` unless it is asked for, as what that one is: "it is
/// there already, written by FEBio4"; empty: it may. Of the same kind and ours, or empty, or none: it may.
std::string why_kept(const std::string& path, PlotKind kind);

/// The same of a run's plot file with states at `times`. Nor must it replace one of another mesh (other numbers of
/// nodes, of elements, or other parts), or with states at other times than these, which would be lost.
std::string why_kept(const std::string& path, const JointModel& model, const std::vector<double>& times);

}  // namespace dea
