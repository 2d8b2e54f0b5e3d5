#include "plugin/plot_variables.h"

#include <FECore/FEDataStream.h>
#include <FECore/units.h>

#include "plugin/dea_contact.h"

namespace {

/// The fields of a surface of an active contact of type dea, nullptr for any other.
FEDeaSurface* dea_surface(FESurface& surface) {
  auto* found = dynamic_cast<FEDeaSurface*>(&surface);
  if (found == nullptr || found->fields() == nullptr || !found->GetContactInterface()->IsActive()) return nullptr;
  return found;
}

}  // namespace

FEPlotCartilageThickness::FEPlotCartilageThickness(FEModel* fem) : FEPlotSurfaceData(fem, PLT_FLOAT, FMT_MULT) {
  SetUnits(UNIT_LENGTH);
}
bool FEPlotCartilageThickness::Save(FESurface& surface, FEDataStream& data) {
  const FEDeaSurface* found = dea_surface(surface);
  if (found == nullptr) return false;
  const std::vector<double>& thickness = found->fields()->vertex_thickness;
  for (const std::vector<int>& facet : found->facet_vertices()) {
    // a middle node that is no vertex of the triangles: the mean of the others
    double sum = 0.0;
    int known = 0;
    for (int v : facet) {
      if (v < 0) continue;
      sum += thickness[static_cast<std::size_t>(v)];
      ++known;
    }
    for (int v : facet) data << (v >= 0 ? thickness[static_cast<std::size_t>(v)] : sum / known);
  }
  return true;
}

FEPlotDeaFacets::FEPlotDeaFacets(FEModel* fem, std::vector<double> dea::SideFields::*field, const char* units)
    : FEPlotSurfaceData(fem, PLT_FLOAT, FMT_ITEM), field_(field) {
  if (units != nullptr) SetUnits(units);
}
bool FEPlotDeaFacets::Save(FESurface& surface, FEDataStream& data) {
  const FEDeaSurface* found = dea_surface(surface);
  if (found == nullptr) return false;
  for (double v : found->fields()->*field_) data << v;
  return true;
}

FEPlotJointSpace::FEPlotJointSpace(FEModel* fem) : FEPlotDeaFacets(fem, &dea::SideFields::joint_space, UNIT_LENGTH) {}

FEPlotOverlap::FEPlotOverlap(FEModel* fem) : FEPlotDeaFacets(fem, &dea::SideFields::overlap, UNIT_LENGTH) {}

FEPlotSpringStrain::FEPlotSpringStrain(FEModel* fem) : FEPlotDeaFacets(fem, &dea::SideFields::strain, nullptr) {}
