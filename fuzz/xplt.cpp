// A plot file: read in full and in outline; what was read can be written and read again, and looked at as `dea compare`
// and `dea plot` do.
#include <stdexcept>

#include "fuzz/fuzz.h"
#include "io/results/result_file.h"
#include "io/xplt/xplt.h"

namespace {

/// Every surface of a state, with all its fields and all regions.
void look_at_surfaces(const dea::ResultFile& result, int state) {
  const dea::XpltMesh& mesh = dea::mesh_of(result, state);
  for (int s = 0; s < static_cast<int>(mesh.surfaces.size()); ++s) {
    dea::fuzz::answer_or_refusal([&] { dea::result_surface(result, state, s); });
    dea::fuzz::answer_or_refusal([&] { dea::deformed_surface(result, state, s); });
    dea::has_springs(result, state, s);
    for (const dea::XpltVariable& v : result.xplt.variables) {
      dea::fuzz::answer_or_refusal([&] { dea::facet_values(result, state, s, v.name); });
      dea::fuzz::answer_or_refusal([&] { dea::facet_values(result, state, s, v.name, true); });
      dea::surface_vector(result, state, s, v.name);
    }
    for (const std::string& region : dea::region_names(mesh))
      dea::fuzz::answer_or_refusal([&] { dea::facets_in(result, state, s, region); });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = dea::fuzz::file_of(data, size, ".xplt");
  dea::fuzz::answer_or_refusal([&] { dea::read_xplt_outline(path); });
  dea::fuzz::answer_or_refusal([&] {
    const dea::XpltFile file = dea::read_xplt(path);
    const std::string again = path + ".again.xplt";
    try {
      dea::write_xplt(again, file);
    } catch (const std::logic_error&) {  // values may be no number, which the writer takes for a fault of ours
      return;
    }
    dea::read_xplt(again);
  });
  dea::fuzz::answer_or_refusal([&] {
    const dea::ResultFile result = dea::read_result(path, "fuzz");
    const int last = static_cast<int>(result.xplt.states.size()) - 1;
    dea::body_poses(result, last);
    look_at_surfaces(result, last);
  });
  return 0;
}
