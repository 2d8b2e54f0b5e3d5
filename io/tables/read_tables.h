// io/tables/read_tables.h – loads, motions and thicknesses from the files that settings name.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "io/files/output.h"
#include "io/tables/table.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// The model's system of units is settings.units where the model names none: from here on model.units has it. Throws
/// UsageError: it names another, or settings.units is none of FEBio's.
void settle_units(JointModel& model, const Settings& settings);

/// Tables that are in memory, by what settings have for their file.
using GivenTables = std::map<std::string, NumberTable>;

/// Fills the rows of settings.loads and settings.motion from their files, or from `given`; nothing where there are
/// none. Units: from the table's to the model's, as model.units names it (settle_units first). OpenSim's tables are in
/// N, m, and N m; a table that names no units and for which none are given is in the model's. Throws InputError (a
/// file's fault, with its line) and UsageError (settings that do not fit together). Thicknesses: as read_thickness.
void read_tables(const JointModel& model, Settings& settings, const GivenTables& given = {});

/// Of matrices that are hardly moved against a joint, or bones, of this size: they may be in metres. Empty: they may
/// not.
std::string matrices_in_doubt(const MotionTable& motion, double size);

/// Fills settings.thickness_from from its files, or from `given`: columns "node", numbers of the model's nodes, and
/// "thickness", >= 0, in the model's length (a unit in its name must be that); other columns are passed over. Throws
/// InputError (a file's fault, with its line).
void read_thickness(const JointModel& model, Settings& settings, const GivenTables& given = {});

/// What a table's rows are counted in, by its column of times: "cycle [%]"; "time": it has no such column, or cannot be
/// read.
std::string time_name(const std::string& table);

/// The files that the settings name to be read, so that no output takes their place.
std::vector<NamedPath> table_files(const Settings& settings);

}  // namespace dea
