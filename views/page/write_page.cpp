#include "views/page/write_page.h"

#include <fmt/format.h>

#include <filesystem>

#include "io/files/output.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "views/data/json.h"
#include "views/page/page.h"
#include "views/page/page_parts.h"
#include "views/text/info_text.h"
#include "views/text/table.h"

namespace dea {

namespace {

/// So many values are written as they are; more are written in 16 bits.
constexpr std::size_t kMostExactValues = 1000000;

/// null; or { fixed, ranges: per state [least, most] (null: exact) or null where the state has none, edges: per state
/// or empty, values: array of the states that have any, one after the other }.
Json field_json(const std::optional<PageField>& field, bool exact, PageArrays& arrays) {
  if (!field) return nullptr;
  Json j;
  j["fixed"] = field->fixed;
  j["facets"] = 0;
  j["ranges"] = Json::array();
  std::vector<float> floats;
  std::vector<std::uint16_t> all_codes;
  for (const std::vector<double>& values : field->states) {
    if (values.empty()) {
      j["ranges"].push_back(nullptr);
      continue;
    }
    j["facets"] = values.size();
    if (exact) {
      j["ranges"].push_back(Json::array({0, 0}));
      for (double x : values) floats.push_back(static_cast<float>(x));
    } else {
      const Codes codes = quantise(values);
      j["ranges"].push_back(Json::array({codes.least, codes.most}));
      all_codes.insert(all_codes.end(), codes.codes.begin(), codes.codes.end());
    }
  }
  j["edges"] = Json::array();
  for (double x : field->edges) j["edges"].push_back(json_number(x));
  j["exact"] = exact;
  j["values"] = arrays.add(exact ? pack_floats(floats) : pack_codes(all_codes));
  return j;
}

Json scales_json(const PageScales& s) {
  return {{"all", scale_json(s.all)}, {"frames", list_json(s.frames, scale_json)}};
}

Json quantity_json(const PageQuantity& q) {
  return {{"field", q.field}, {"pair", {q.a, q.b}}, {"nodes", scales_json(q.nodes)}, {"facets", scales_json(q.facets)}};
}

Json surface_json(const PageSurface& s, bool exact, Json& meshes, PageArrays& arrays) {
  Json j;
  j["title"] = s.title;
  j["note"] = s.note;
  j["names"] = s.names;
  j["meshes"] = Json::array();
  const std::size_t reference = meshes.size();
  meshes.push_back(mesh_json(s.geometry.back(), s.node_ids.back(), arrays));
  for (std::size_t i = 0; i < s.geometry.size(); ++i) {
    if (s.same_mesh[i]) {
      j["meshes"].push_back(reference);
      continue;
    }
    j["meshes"].push_back(meshes.size());
    meshes.push_back(mesh_json(s.geometry[i], s.node_ids[i], arrays));
  }
  j["carry"] = list_json(s.carry, [&](const std::optional<PageCarry>& c) -> Json {
    if (!c) return nullptr;
    return {{"vertices", arrays.add(pack_integers(c->vertices))}, {"weights", arrays.add(pack_floats(c->weights))}};
  });
  const auto field = [&](const std::optional<PageField>& f) { return field_json(f, exact, arrays); };
  j["fields"] = {{"pressure", list_json(s.pressure, field)},
                 {"space", list_json(s.space, field)},
                 {"thickness", list_json(s.thickness, field)},
                 {"gap", list_json(s.gap, field)}};
  j["scales"] = list_json(s.scales, quantity_json);
  j["differences"] = list_json(s.differences, quantity_json);
  j["regions"] = s.regions;
  j["measures"] = s.measures;
  j["patterns"] = s.patterns;
  j["bins"] = s.bins;
  j["profiles"] = list_json(s.profiles, [](const auto& frame) {
    return list_json(frame, [](const auto& result) { return list_json(result, short_number); });
  });
  j["view"] = view_json(s.view, s.geometry.back().mesh.vertices);
  return j;
}

/// Quaternion x, y, z, w and translation of each.
Json poses_json(const std::vector<std::optional<PagePose>>& poses) {
  return list_json(poses, [](const std::optional<PagePose>& p) -> Json {
    if (!p) return nullptr;
    const Eigen::Vector4d& q = p->rotation.coeffs();
    return {q[0], q[1], q[2], q[3], p->translation[0], p->translation[1], p->translation[2]};
  });
}

std::size_t values_of(const PageData& data) {
  std::size_t n = 0;
  for (const PageSurface& s : data.surfaces)
    for (const auto* fields : {&s.pressure, &s.space, &s.thickness, &s.gap})
      for (const std::optional<PageField>& f : *fields)
        if (f)
          for (const auto& values : f->states) n += values.size();
  return n;
}

Json page_json(const PageData& data, PageArrays& arrays) {
  const bool exact = values_of(data) <= kMostExactValues;
  Json j;
  j["schema"] = "dea.report/1";
  j["kind"] = data.kind;
  j["title"] = data.title;
  j["command"] = data.command;
  add_page_head(data.units, j);
  j["exact"] = exact;
  j["results"] = data.results;
  j["frames"] = list_json(data.frames, [](const PageFrame& f) -> Json {
    return {{"time", time_json(f.time)}, {"states", f.states}, {"unsolved", f.unsolved}};
  });
  j["frame"] = data.frame;
  j["time_name"] = data.time_name;
  Json meshes = Json::array(), surfaces = Json::array();
  for (const PageSurface& s : data.surfaces) surfaces.push_back(surface_json(s, exact, meshes, arrays));
  j["meshes"] = std::move(meshes);
  j["surfaces"] = std::move(surfaces);
  j["context"] = nullptr;
  if (!data.context.triangles.empty())
    j["context"] = {{"vertices", arrays.add(pack_floats(data.context.vertices))},
                    {"triangles", arrays.add(pack_integers(data.context.triangles))},
                    {"parts", data.context.parts},
                    {"begin", data.context.begin},
                    {"parts_move", list_json(data.context.parts_move, poses_json)},
                    {"surfaces_move", list_json(data.context.surfaces_move, poses_json)}};
  j["context_note"] = data.context.note;
  j["charts"] = data.charts;
  j["tables"] = list_json(data.tables, table_json);
  j["texts"] = Json::array();
  if (!data.recognised.empty()) j["texts"].push_back({{"title", "What was recognised"}, {"text", data.recognised}});
  j["warnings"] = data.warnings;
  j["headline"] = headline_words();
  return j;
}

}  // namespace

std::string page_html(const PageData& data) {
  PageArrays arrays;
  const Json json = page_json(data, arrays);
  return page_text(data.title, json, arrays, "", page::main());
}

void write_run_page(const std::string& path, const Recognition& recognition, const Analysis& analysis, XpltFile&& xplt,
                    const std::string& model_path, const std::string& output, const std::vector<std::string>& words,
                    const std::vector<NamedPath>& files) {
  std::vector<std::string> paths;
  for (const NamedPath& file : files) paths.push_back(file.path);
  const ResultFile result{output, std::filesystem::path(model_path).stem().string(), std::move(xplt)};
  const JointCheck check = check_joint(recognition, analysis.beds.beds);
  PageData page = run_page(recognition.model, analysis, result,
                           info_text(recognition.model, recognition.settings, check), words, paths);
  const std::string& loads = recognition.settings.loads.file;
  page.time_name = time_name(loads.empty() ? recognition.settings.motion.file : loads);
  write_text(path, page_html(page));
}

void require_page_name(const std::string& option, const std::string& path) {
  if (path.empty()) return;
  if (path == "-") throw UsageError(fmt::format("{} -: the page cannot go to standard output, give it a name", option));
  const std::string extension = extension_of(path);
  if (extension != ".html" && extension != ".htm")
    throw UsageError(wrong_ending(option, path, ".html or .htm", ".html"));
}

}  // namespace dea
