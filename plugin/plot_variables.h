// plugin/plot_variables.h – what FEBio's plot file can show of contacts of type dea beside its own variables.
#pragma once
#include <FECore/FEPlotData.h>

#include "fields.h"

/// `cartilage thickness`: per facet node.
class FEPlotCartilageThickness : public FEPlotSurfaceData {
 public:
  explicit FEPlotCartilageThickness(FEModel* fem);
  bool Save(FESurface& surface, FEDataStream& data) override;
};

/// `joint space`: signed gap at the current pose, > 0 apart, per facet.
class FEPlotJointSpace : public FEPlotSurfaceData {
 public:
  explicit FEPlotJointSpace(FEModel* fem);
  bool Save(FESurface& surface, FEDataStream& data) override;
};

/// `overlap`: >= 0, per facet.
class FEPlotOverlap : public FEPlotSurfaceData {
 public:
  explicit FEPlotOverlap(FEModel* fem);
  bool Save(FESurface& surface, FEDataStream& data) override;
};

/// `spring strain`: of this surface's layer, >= 0, per facet.
class FEPlotSpringStrain : public FEPlotSurfaceData {
 public:
  explicit FEPlotSpringStrain(FEModel* fem);
  bool Save(FESurface& surface, FEDataStream& data) override;
};
