// views/page/page_data.h – everything a page shows, as plain numbers: made here, drawn there.
//
// Frame: reference configuration, as in src/results/comparison.h: a surface keeps its place while the states go by.
// Whatever is printed as a number on the page is computed here or comes from `compare_files` and `analyse`; the page
// only colours, draws and averages facets to nodes for smooth maps (nodal_average's definition).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/results/result_file.h"
#include "src/base/unit_names.h"
#include "src/run/analysis.h"
#include "views/compare/compare_files.h"
#include "views/map/map_geometry.h"
#include "views/page/page_context.h"
#include "views/page/page_parts.h"
#include "views/text/table.h"

namespace dea {

/// One value per facet in each state of a result; a state's list is empty where it has none. `fixed`: one list for all.
struct PageField {
  bool fixed = false;
  std::vector<std::vector<double>> states;
  std::vector<double>
      edges;  ///< per entry of `states`: edge_level of its nodal averages; infinite: none; pressure only
};

/// Where a result's nodal values are taken for the reference's nodes: three of its vertices and their weights each.
struct PageCarry {
  std::vector<std::int32_t> vertices;  ///< -1: not covered
  std::vector<float> weights;
};

struct PageScales {
  PageScale all;  ///< of all states of all results
  std::vector<PageScale> frames;
};
/// Of one quantity's maps of all results; or of differences of result `b` from result `a`.
struct PageQuantity {
  std::string field;  ///< "pressure", "space", "thickness", "gap"
  int a = -1, b = -1;
  PageScales nodes, facets;
};

struct PageSurface {
  std::string title;
  std::string note;                                 ///< why it stands last
  std::vector<std::string> names;                   ///< one per result
  std::vector<ResultSurface> geometry;              ///< one per result; the reference's own where meshes are the same
  std::vector<std::vector<std::int32_t>> node_ids;  ///< per result and vertex
  std::vector<char> same_mesh;                      ///< per result: as the reference's
  std::vector<std::optional<PageCarry>> carry;      ///< per result; none: same mesh
  std::vector<std::optional<PageField>> pressure, thickness, space, gap;  ///< one per result
  std::vector<PageQuantity> scales, differences;
  std::vector<std::string> regions;                      ///< "" first: the whole surface
  std::vector<std::vector<std::vector<Json>>> measures;  ///< result, state, region; null: no pressure, or another mesh
  std::vector<std::vector<std::vector<Json>>> patterns;  ///< against the last result; frame, region, result; null: none
  std::vector<double> bins;                              ///< of the profile: edges [degrees]
  std::vector<std::vector<std::vector<double>>> profiles;  ///< frame, result, bin
  MapView view;                                            ///< how to look at it first
};

/// States that are shown together.
struct PageFrame {
  double time = 0.0;               ///< NaN: the compared states, whose times differ
  std::vector<int> states;         ///< per result; -1: it has none at this time
  std::vector<int> unsolved = {};  ///< results whose state here is no solution
};

struct PageData {
  std::string kind;  ///< "run", "compare"
  std::string title;
  std::string command;
  UnitNames units;  ///< words for axes
  Json results;     ///< compare: the last one is the reference
  std::vector<PageFrame> frames;
  int frame = 0;  ///< shown first
  std::vector<PageSurface> surfaces;
  PageContext context;
  std::string time_name = "time";  ///< what the states are counted in: "cycle [%]"
  Json charts = Json::array();
  std::vector<TitledTable> tables;
  std::string recognised;  ///< text of `dea info`
  std::vector<std::string> warnings;
};

/// Curves over time: force, pressures and area of contacts; motion of bodies; tension of ligaments; how well all
/// balances. Each with title, caption, quantity and dimension of the axis ("pressure", "force", "length", "area",
/// "degrees", "": pure number); values per name, null: a gap.
Json run_charts(const Analysis& analysis);

/// `to` wherever `from` stands.
void replace_all(std::string& text, const std::string& from, const std::string& to);
/// The command line with file names instead of paths: of `files`, and of all words that begin with a slash.
std::string command_text(const std::vector<std::string>& words, const std::vector<std::string>& files);
/// "folder/hip.feb:12: ..." -> "hip.feb:12: ..." for every path of `files`.
std::string without_folders(std::string text, const std::vector<std::string>& files);

/// `files`, `options`: as `comparison` was made of. Throws InputError.
PageData compare_page(const std::vector<ResultFile>& files, const CompareOptions& options, const Comparison& comparison,
                      const std::vector<std::string>& words);

/// `file`: what was written. `recognised`: text of `dea info`. Throws InputError.
PageData run_page(const JointModel& model, const Analysis& analysis, const ResultFile& file,
                  const std::string& recognised, const std::vector<std::string>& words,
                  const std::vector<std::string>& paths);

}  // namespace dea
