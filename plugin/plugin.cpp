// plugin/plugin.cpp – what FEBio looks for in the library.
#include <FECore/FECoreKernel.h>
#include <FECore/sdk.h>
#include <FECore/version.h>

#include <cstdio>

#include "dea_task.h"
#include "version.h"

FECORE_PLUGIN unsigned int GetSDKVersion() { return FE_SDK_VERSION; }

FECORE_PLUGIN void GetPluginVersion(int& major, int& minor, int& patch) {
  major = minor = patch = 0;
  std::sscanf(dea::kVersion, "%d.%d.%d", &major, &minor, &patch);
}

/// Registers what the plugin offers. FEBio Studio may load plugins without a model: nothing is printed or opened.
FECORE_PLUGIN void PluginInitialize(FECoreKernel& kernel) {
  FECoreKernel::SetInstance(&kernel);
  REGISTER_FECORE_CLASS(DeaTask, "dea");
  // Classes of the module solid (contact, plot variables) go here, between SetActiveModule("solid") and
  // SetActiveModule(0).
}

FECORE_PLUGIN void PluginCleanup() {}
