// plugin/dea_task.h – FEBio's task `dea`: febio4 -i hip.feb -import libfebio_dea-4.11.so -task=dea
// [settings.xml]
#pragma once
#include <FECore/FECoreTask.h>

#include <string>

/// What `dea run` does, from FEBio's own model and into FEBio's log. The model is not initialised: FEBio then writes no
/// plot file of its own, and values that follow a load controller are still those of the file.
class DeaTask : public FECoreTask {
 public:
  explicit DeaTask(FEModel* fem);
  /// `file`: the settings file (docs/settings.md); null or empty: none.
  bool Init(const char* file) override;
  /// False, after one error in the log: a fault, or a state without a solution (results are written all the same).
  bool Run() override;

 private:
  std::string settings_file_;
};
