#include "io/results/existing_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "io/results/plot_file.h"
#include "io/xplt/xplt.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/base/time_text.h"

namespace dea {

namespace {

constexpr std::string_view kName = "FEBioDEA", kLibraryHead =
                                                   "\x7f"
                                                   "ELF";
// first columns: of dea run and its compartments, its facets, dea compare, dea study
constexpr std::string_view kTableHeads[] = {"time,contact,", "time,outcome,contact,", "label,file,time,",
                                            "case_id,model,"};
// JSON, pages, manual pages
constexpr std::string_view kTextMarks[] = {"\"schema\": \"dea.", "name=\"generator\" content=\"FEBioDEA\"",
                                           "\"FEBioDEA "};
constexpr std::string_view kColumnsHead = "\x89HDF\r\n", kColumnsMark = "dea.study-columns/";
constexpr std::string_view kFramesMarks[] = {"?xml ", "febiodea_settings ", "/febiodea_settings>",
                                             "!-- ",  "frame name=",        "/frame>"};

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

std::string head_of(const std::string& path) {
  std::string text(4096, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

/// A settings file of frames alone, as `dea build` writes it: a user's own settings in it would be lost.
bool is_frames_alone(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text;
  while (std::getline(in, text, '<'))
    if (!trimmed(text).empty() && std::none_of(std::begin(kFramesMarks), std::end(kFramesMarks),
                                               [&](std::string_view mark) { return text.starts_with(mark); }))
      return false;
  return true;
}

bool made_by_dea(const std::string& path) {
  const std::string head = head_of(path);
  const auto starts = [&](std::string_view mark) { return head.starts_with(mark); };
  const auto holds = [&](std::string_view mark) { return head.find(mark) != head.npos; };
  if (std::any_of(std::begin(kTableHeads), std::end(kTableHeads), starts)) return true;
  if (std::any_of(std::begin(kTextMarks), std::end(kTextMarks), holds)) return true;
  if (starts(kColumnsHead)) return holds(kColumnsMark);
  if (holds("<febiodea_settings")) return is_frames_alone(path);
  return has(path, starts(kLibraryHead) ? kName : kPictureMark);
}

PlotKind kind_of(const XpltFile& file) {
  if (find_variable(file, XpltGroup::Surface, "missed normal") >= 0) return PlotKind::Check;
  const bool run = find_variable(file, XpltGroup::Surface, "contact pressure") >= 0;
  return run ? PlotKind::Run : PlotKind::Comparison;
}

const char* words_of(PlotKind kind) {
  return word_of(kind, {"results of dea run", "what dea info -o writes", "what dea compare -o writes"});
}

/// `outline`: filled if the file may be of this kind and ours.
std::string why_foreign(const std::string& path, PlotKind kind, std::optional<XpltFile>& outline) {
  if (!would_replace(path)) return "";
  try {
    outline = read_xplt_outline(path);
  } catch (const InputError&) {
    return "it is there already, and is no whole plot file";
  }
  if (!written_by_dea(*outline))
    return fmt::format("it is there already, written by {}",
                       outline->software.empty() ? "another program" : outline->software);
  const PlotKind found = kind_of(*outline);
  return found == kind ? "" : fmt::format("it is there already, {}", words_of(found));
}

bool same_domains(const XpltMesh& a, const XpltMesh& b) {
  return std::equal(a.domains.begin(), a.domains.end(), b.domains.begin(), b.domains.end(),
                    [](const XpltDomain& x, const XpltDomain& y) {
                      return x.element_ids.size() == y.element_ids.size() && x.element_type == y.element_type &&
                             x.name == y.name;
                    });
}

std::string mesh_words(const XpltMesh& mesh) {
  return fmt::format("{} nodes and {} elements", mesh.node_ids.size(), element_count(mesh));
}

}  // namespace

bool would_replace(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) > 0 && !error;
}

std::string why_kept_file(const std::string& path) {
  return !would_replace(path) || made_by_dea(path) ? "" : "it is there already, not made by dea";
}

std::string why_kept_model(const std::string& path, ModelOf command) {
  if (!would_replace(path)) return "";
  if (!std::ifstream(path, std::ios::binary)) return "it is there already, and cannot be read";
  if (command == ModelOf::Convert)
    return has(path, kConvertedMark) ? "" : "it is there already, a model without a contact of type dea";
  const bool ours = has(path, kBuiltMark) && !has(path, kConvertedMark);
  return ours ? "" : "it is there already, not made by dea build";
}

std::string why_kept(const std::string& path, PlotKind kind) {
  std::optional<XpltFile> outline;
  return why_foreign(path, kind, outline);
}

std::string why_kept(const std::string& path, const JointModel& model, const std::vector<double>& times) {
  std::optional<XpltFile> outline;
  const std::string foreign = why_foreign(path, PlotKind::Run, outline);
  if (!foreign.empty() || !outline) return foreign;
  const XpltMesh &there = outline->meshes.front(), ours = plot_mesh(model);
  if (there.node_ids.size() != ours.node_ids.size() || !same_domains(there, ours)) {
    const std::string a = mesh_words(there), b = mesh_words(ours);
    return "it is there already, results of another mesh" +
           (a == b ? ", of other parts" : fmt::format(": {}, not {}", a, b));
  }
  const double scale = times.empty() ? 0.0 : std::max(std::abs(times.front()), std::abs(times.back()));
  std::vector<double> lost;  // times in single precision
  for (const XpltState& s : outline->states)
    if (std::none_of(times.begin(), times.end(), [&](double t) { return std::abs(t - s.time) <= 1e-6 * scale; }))
      lost.push_back(s.time);
  if (lost.empty()) return "";
  return fmt::format("it is there already, results of this model with {} state{} that would be lost (time{} {}{})",
                     lost.size(), lost.size() == 1 ? "" : "s", lost.size() == 1 ? "" : "s", time_text(lost.front()),
                     lost.size() == 1 ? "" : fmt::format(" to {}", time_text(lost.back())));
}

}  // namespace dea
