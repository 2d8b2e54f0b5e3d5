// plugin/read_fe_model.h – FEBio's own model becomes a JointModel, the same as read_feb makes of its file.
#pragma once
#include "src/model/joint_model.h"

class FEModel;

namespace dea {

/// Before FEModel::Init, or from the Init of a component of the model; not after: values that follow a load controller
/// are then no longer those of the file. Origins: file 0, the name of the input file; no lines. Not in FEBio's model
/// (plugin/README.md): the version of the file, some names, the order of unlike things. Throws InputError for a model
/// that FEBio itself would refuse later.
JointModel read_fe_model(FEModel& fem);

}  // namespace dea
