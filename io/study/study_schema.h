// io/study/study_schema.h – the tables of a study's file (docs/studies.md says what is in them).
#pragma once
#include <string>
#include <vector>

#include "io/study/database.h"
#include "src/study/plan.h"

namespace dea {

/// "DEAS": what `file` and SQLite call the application_id.
inline constexpr int kStudyApplication = 0x44454153;
/// The number in "dea.study/2", and the database's user_version. Later programs only add tables and columns to it.
inline constexpr int kStudyVersion = 2;

/// Those of a file, in the order in which rows may be added, the ones that others refer to first.
std::vector<std::string> study_tables(const Database& database);

/// Throws InputError: not a study, or one of another version.
void check_study(const Database& database);

/// Makes all tables and views. A factor is a column of `cases` and of the views.
/// `inside`: the views also have what cases tell of the inside of layers.
void make_study_tables(Database& database, const std::vector<Factor>& factors, bool inside);

/// A condition on a row of `states` under the name `alias`: its state is a solution.
std::string solved_condition(const std::string& alias);

/// Is a table of the study as a whole, the same in every shard?
bool describes_study(const std::string& table);

/// Adds the rows of a table as they are to the same table of another study's file; a surface that it has is left.
void copy_table(const Database& from, const Database& to, const std::string& table);

/// UsageError: a factor has the name of a column that is there anyway.
void check_factor_names(const std::vector<Factor>& factors);

}  // namespace dea
