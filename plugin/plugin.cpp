// plugin/plugin.cpp – what FEBio looks for in the library.
#include <FECore/FECoreKernel.h>
#include <FECore/sdk.h>
#include <FECore/version.h>

#include <cstdio>

#include "plugin/dea_contact.h"
#include "plugin/dea_task.h"
#include "plugin/plot_variables.h"
#include "src/version.h"

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
