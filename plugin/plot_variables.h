// plugin/plot_variables.h – what FEBio's plot file can show of contacts of type dea beside its own variables.
#pragma once
#include <FECore/FEPlotData.h>

#include "src/results/fields.h"

/// `cartilage thickness`: per facet node.
class FEPlotCartilageThickness : public FEPlotSurfaceData {
 public:
  explicit FEPlotCartilageThickness(FEModel* fem);
  bool Save(FESurface& surface, FEDataStream& data) override;
};

/// A field of SideFields with a value per facet.
class FEPlotDeaFacets : public FEPlotSurfaceData {
 public:
  bool Save(FESurface& surface, FEDataStream& data) override;

 protected:
  FEPlotDeaFacets(FEModel* fem, std::vector<double> dea::SideFields::*field, const char* units);

 private:
  std::vector<double> dea::SideFields::*field_;
};

/// `joint space`: signed gap at the current pose, > 0 apart, per facet.
class FEPlotJointSpace : public FEPlotDeaFacets {
 public:
  explicit FEPlotJointSpace(FEModel* fem);
};

/// `overlap`: >= 0, per facet.
class FEPlotOverlap : public FEPlotDeaFacets {
 public:
  explicit FEPlotOverlap(FEModel* fem);
};

/// `spring strain`: of this surface's layer, >= 0, per facet.
class FEPlotSpringStrain : public FEPlotDeaFacets {
 public:
  explicit FEPlotSpringStrain(FEModel* fem);
};
