// io/vtu/write_vtu.h – a plot file's content for ParaView: VTK XML files, read by everything that rests on
// VTK. What is in them: docs/vtk.md.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/files/output.h"
#include "io/xplt/xplt.h"

namespace dea {

/// A cell of VTK: its type number, and the nodes it takes, in VTK's order: cell node k is node order[k] of ours.
struct VtkCell {
  int type = 0;
  std::vector<int> order;
};
/// Of an element-type code of the plot file. VTK has no tet5 and tet15: they become tetrahedra without the nodes inside
/// element and faces. Throws std::logic_error for an unknown code.
const VtkCell& vtk_cell(int element_type);
/// Of a facet with 3, 4, 6, 7, 8, 9 or 10 nodes. Throws std::logic_error for another number.
const VtkCell& vtk_facet(int nodes);

/// One state as the text of a .vtu file. Frame: points at their reference positions, `displacement` beside them.
/// Numbers are the plot file's (4-byte floats), inline base64. Mesh: all nodes, all elements; point data: nodal
/// variables, `node id`; cell data: `element id`, `part`.
std::string mesh_vtu(const XpltFile& file, std::size_t state);
/// Surfaces: the facets of all surfaces that have values in this state, each with points of its own; cell data:
/// variables per facet, `surface` (1-based place in the mesh's surfaces), `facet` (1-based in its surface); point data:
/// nodal variables, variables per facet node (at a point its first facet's), `node id`; field data: variables per
/// surface and `surface names`, in the order of the surfaces. A value that a surface does not have is 0, the range of a
/// viewer's colours being made of all.
std::string surfaces_vtu(const XpltFile& file, std::size_t state);

/// Writes mesh_NNNN.vtu and surfaces_NNNN.vtu per state (NNNN from 0000), and results.pvd, which lists them with their
/// times. `folder` is made if it is missing. All files are complete before the first replaces an older one of its name,
/// results.pvd comes last; files of other names stay. Throws WriteError.
void write_vtu(const std::string& folder, const XpltFile& file);

/// The same state by state, so that memory holds one at a time. They wait on disk (Spool), and nothing is in `folder`
/// before finish.
class VtuWriter {
 public:
  /// `head`: header, dictionary and meshes; its states are left out.
  VtuWriter(std::string folder, XpltFile head);
  void add(XpltState state);
  void finish();

 private:
  std::string folder_;
  XpltFile head_;  ///< with one state while its texts are made
  Spool texts_;
  std::vector<std::uint64_t> ends_;  ///< of each text
  std::vector<float> times_;
};

}  // namespace dea
