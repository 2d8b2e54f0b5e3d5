// plugin/plugin.cpp – what FEBio looks for in the library, and what its plot file can show of contacts of type dea
// beside its own variables.
#include <FECore/FECoreKernel.h>
#include <FECore/FEDataStream.h>
#include <FECore/FEPlotData.h>
#include <FECore/sdk.h>
#include <FECore/units.h>
#include <FECore/version.h>

#include <cstdio>

#include "plugin/dea_contact.h"
#include "plugin/dea_task.h"
#include "src/version.h"

namespace {

/// The fields of a surface of an active contact of type dea, nullptr for any other.
FEDeaSurface* dea_surface(FESurface& surface) {
  auto* found = dynamic_cast<FEDeaSurface*>(&surface);
  if (found == nullptr || found->fields() == nullptr || !found->GetContactInterface()->IsActive()) return nullptr;
  return found;
}

/// `cartilage thickness`: per facet node.
class FEPlotCartilageThickness : public FEPlotSurfaceData {
 public:
  explicit FEPlotCartilageThickness(FEModel* fem) : FEPlotSurfaceData(fem, PLT_FLOAT, FMT_MULT) {
    SetUnits(UNIT_LENGTH);
  }
  bool Save(FESurface& surface, FEDataStream& data) override {
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
};

/// A field of SideFields with a value per facet.
class FEPlotDeaFacets : public FEPlotSurfaceData {
 public:
  FEPlotDeaFacets(FEModel* fem, std::vector<double> dea::SideFields::*field, const char* units)
      : FEPlotSurfaceData(fem, PLT_FLOAT, FMT_ITEM), field_(field) {
    if (units != nullptr) SetUnits(units);
  }
  bool Save(FESurface& surface, FEDataStream& data) override {
    const FEDeaSurface* found = dea_surface(surface);
    if (found == nullptr) return false;
    for (double v : found->fields()->*field_) data << v;
    return true;
  }

 private:
  std::vector<double> dea::SideFields::*field_;
};

/// `joint space`: signed gap at the current pose, > 0 apart, per facet.
struct FEPlotJointSpace : FEPlotDeaFacets {
  explicit FEPlotJointSpace(FEModel* fem) : FEPlotDeaFacets(fem, &dea::SideFields::joint_space, UNIT_LENGTH) {}
};

/// `overlap`: >= 0, per facet.
struct FEPlotOverlap : FEPlotDeaFacets {
  explicit FEPlotOverlap(FEModel* fem) : FEPlotDeaFacets(fem, &dea::SideFields::overlap, UNIT_LENGTH) {}
};

/// `spring strain`: of this surface's layer, >= 0, per facet.
struct FEPlotSpringStrain : FEPlotDeaFacets {
  explicit FEPlotSpringStrain(FEModel* fem) : FEPlotDeaFacets(fem, &dea::SideFields::strain, nullptr) {}
};

}  // namespace

FECORE_PLUGIN unsigned int GetSDKVersion() { return FE_SDK_VERSION; }

FECORE_PLUGIN void GetPluginVersion(int& major, int& minor, int& patch) {
  major = minor = patch = 0;
  std::sscanf(dea::kVersion, "%d.%d.%d", &major, &minor, &patch);
}

/// Registers what the plugin offers. FEBio Studio may load plugins without a model: nothing is printed or opened.
FECORE_PLUGIN void PluginInitialize(FECoreKernel& kernel) {
  FECoreKernel::SetInstance(&kernel);
  REGISTER_FECORE_CLASS(DeaTask, "dea");
  kernel.SetActiveModule("solid");  // and the modules that rest on it
  REGISTER_FECORE_CLASS(FEDeaContact, "dea");
  REGISTER_FECORE_CLASS(FEPlotCartilageThickness, "cartilage thickness");
  REGISTER_FECORE_CLASS(FEPlotJointSpace, "joint space");
  REGISTER_FECORE_CLASS(FEPlotOverlap, "overlap");
  REGISTER_FECORE_CLASS(FEPlotSpringStrain, "spring strain");
  kernel.SetActiveModule(0);
}

FECORE_PLUGIN void PluginCleanup() {}
