// A study's file: what is written is read again, cases are there whole or not at all, shards become one file, and what
// is not a study, or another, is said.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "io/study/read_study.h"
#include "io/study/study_file.h"
#include "io/study/study_schema.h"
#include "io/tables/table.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/results/contact_numbers.h"
#include "src/rules/rules.h"

#include "tests/program.h"

namespace dea::study_file_test {

using test::TemporaryFolder;

Plan plan_of(int cases) {
  PlanRequest r;
  r.models = {"hip.feb"};
  r.factors = {parse_factor(fmt::format("tilt: rotate pelvis=0,1,0,{{1:{}:1}}", cases)),
               parse_factor("shape: law={linear|layer}")};
  r.options = {{"rotate", "", 0}, {"law", "", 1}};
  return make_plan(r);
}

StudyIdentity identity() { return {"0.1 (abc)", {"--vary 'tilt: ...'"}, {{"hip.feb", "crc32:1:2"}}, 1, 1}; }

/// Every number differs from every other's of the same case.
CaseResult result_of(std::size_t number, int states = 2) {
  CaseResult r;
  r.number = number;
  r.outcome = CaseResult::Outcome::Solved;
  r.contacts = {{"hip", "pelvis", "femur", {"front", "back"}}};
  r.bodies = {"pelvis", "femur"};
  r.surfaces = {{"socket", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.1}}, {{0, 1, 2}}}};
  r.warnings = {{"passed-through", {.contact = "with a 'quote'", .time = 1}},
                {"tiny-load", {}, {{"force", 2.5}, {"ratio", 1e-6}}}};
  r.seconds = 0.25;
  for (int s = 0; s < states; ++s) {
    CaseState state;
    state.time = s;
    state.outcome = Outcome::Balanced;
    state.residual_moment = kNaN;
    ContactStatistics statistics;
    statistics.springs = 100 + s;
    statistics.headline = {0.1, 5.0 + static_cast<double>(number), 2.0, 3.0, kNaN};
    statistics.force = {1.0 / 3.0, -2, 3};
    statistics.compartments = {{{0.1, 7, 8, 9, 10}, {1, 2, 3}, {4, 5, 6}, {}}, {}};
    state.statistics = {statistics};
    Pose turned;
    turned.rotation = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()).toRotationMatrix();
    state.poses = {Pose{}, turned};
    state.reactions = {Vector6::Zero(), Vector6::Constant(4)};
    state.fields = {{0.5f, 0.25f, 0.0f}};
    r.states.push_back(state);
  }
  return r;
}

CaseResult refused(std::size_t number) {
  CaseResult r;
  r.number = number;
  r.message = "hip.feb: found nothing";
  return r;
}

/// The first cell of a query on the file by SQLite itself.
std::string query(const std::string& path, const std::string& sql) {
  sqlite3* db = nullptr;
  EXPECT_EQ(sqlite3_open_v2(path.c_str(), &db, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::string text = "no row";
  sqlite3_stmt* statement = nullptr;
  EXPECT_EQ(sqlite3_prepare_v2(db, sql.c_str(), -1, &statement, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
  if (sqlite3_step(statement) == SQLITE_ROW) {
    const auto* cell = reinterpret_cast<const char*>(sqlite3_column_text(statement, 0));
    text = cell == nullptr ? "NULL" : cell;
  }
  sqlite3_finalize(statement);
  sqlite3_close(db);
  return text;
}

/// A column of all results.
std::vector<std::string> column(const std::string& path, const std::string& name) {
  std::vector<std::string> cells;
  std::ptrdiff_t place = -1;
  read_results(path, [&](const std::vector<std::string>& row) {
    if (place < 0)
      place = std::find(row.begin(), row.end(), name) - row.begin();
    else
      cells.push_back(row.at(static_cast<std::size_t>(place)));
  });
  return cells;
}

/// Pressures that are kept; empty: none.
std::vector<float> read_pressure(const std::string& path, int number, int state, int contact) {
  std::vector<float> found;
  read_fields(path, {{number, state, contact}}, [&](std::size_t, std::vector<float>&& values) { found = values; });
  return found;
}

template <class Call>
std::string input_fault(Call call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no fault";
}

struct StudyFile : ::testing::Test {
  TemporaryFolder folder;
  std::string path = (folder.path / "plan.db").string();
  Plan plan = plan_of(3);

  void write(const std::vector<CaseResult>& results, const StudyIdentity& who = identity(), std::string to = "") {
    StudyWriter writer(to.empty() ? path : to, plan, who);
    for (CaseResult r : results) writer.add(std::move(r));
    writer.finish();
  }
};

TEST_F(StudyFile, WhatIsWrittenIsReadAgain) {
  write({result_of(2), refused(5)});
  const StudyHead head = read_study_head(path);
  EXPECT_EQ(study_difference(head, identity()), "");
  EXPECT_EQ(head.planned, 6u);
  ASSERT_EQ(head.factors.size(), 2u);
  EXPECT_EQ(head.factors[0].before, "pelvis=0,1,0,");
  const StudyCounts counts = count_cases(path);
  EXPECT_EQ(counts.solved, 1u);
  EXPECT_EQ(counts.refused, 1u);
  const std::vector<StudyCase> cases = read_cases(path);
  ASSERT_EQ(cases.size(), 2u);
  EXPECT_EQ(cases[0].values, (std::vector<std::string>{"1", "layer"}));
  EXPECT_EQ(cases[1].message, "hip.feb: found nothing");
  EXPECT_EQ(first_failed(path).value().number, 5u);
  EXPECT_EQ(column(path, "case_id"), (std::vector<std::string>{"2", "2", "5"}));  // a case without states is a row too
  EXPECT_EQ(column(path, "contact")[1], "hip");
  EXPECT_EQ(column(path, "headline_p99")[1], "7");
  EXPECT_EQ(column(path, "headline_peak")[0], "");
  EXPECT_EQ(parse_number(column(path, "force_x")[0]), 1.0 / 3.0);
  EXPECT_EQ(column(path, "time")[1], "1");
  EXPECT_EQ(column(path, "tilt")[2], "3");
}

/// All results of a file, one text.
std::string all_results(const std::string& path) {
  std::string text;
  read_results(path, [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) text += cell + "|";
    text += "\n";
  });
  return text;
}

TEST_F(StudyFile, WhatIsPackedIsAddedToAnother) {
  const auto packed = [&](const std::vector<CaseResult>& results) {
    StudyWriter writer(kInMemory, plan, identity());
    for (CaseResult r : results) writer.add(std::move(r));
    writer.finish();
    return writer.packed();
  };
  write({result_of(2), result_of(3), refused(5)});
  const std::string other = (folder.path / "other.db").string();
  StudyWriter writer(other, plan, identity());
  writer.add(packed({refused(3), refused(5)}));
  writer.finish();
  EXPECT_EQ(writer.there()[2], CaseResult::Outcome::Refused);
  writer.add(packed({result_of(2)}));
  writer.add(packed({result_of(3)}));  // in the place of what was there
  writer.finish();
  EXPECT_EQ(writer.there()[2], CaseResult::Outcome::Solved);
  EXPECT_EQ(all_results(other), all_results(path));
  for (const std::string& table : study_tables(Database(path, Database::For::Reading)))
    EXPECT_EQ(query(other, "SELECT count(*) FROM " + table), query(path, "SELECT count(*) FROM " + table)) << table;
  EXPECT_EQ(read_pressure(other, 2, 1, 1), read_pressure(path, 2, 1, 1));
  EXPECT_EQ(read_surfaces(other, 0).at(0).surface.triangles, read_surfaces(path, 0).at(0).surface.triangles);
  EXPECT_EQ(input_fault([&] { writer.add(std::string("no stream")); }),
            "found a damaged batch of results, expected what another writer has packed");
}

TEST_F(StudyFile, OtherProgramsFindItEasy) {
  write({result_of(2)});
  EXPECT_EQ(query(path, "SELECT headline_p99 FROM results WHERE tilt = 1 AND shape = 'layer' AND state = 2"), "7.0");
  EXPECT_EQ(query(path, "SELECT typeof(headline_peak) FROM statistics"), "null");
  EXPECT_EQ(query(path, "SELECT typeof(springs) FROM statistics"), "integer");
  EXPECT_EQ(query(path, "SELECT warnings FROM results"),
            worded(result_of(2).warnings[0]) + "; " + worded(result_of(2).warnings[1]));
  EXPECT_EQ(query(path, "SELECT contact FROM warnings WHERE code = 'passed-through'"), "with a 'quote'");
  EXPECT_EQ(query(path, "SELECT json_extract(numbers, '$.force') FROM warnings WHERE code = 'tiny-load'"), "2.5");
  EXPECT_EQ(query(path, "SELECT rotation_z FROM poses WHERE body = 'femur'"), "0.5");
  EXPECT_EQ(query(path, "SELECT moment_z FROM poses WHERE body = 'femur'"), "4.0");
  EXPECT_EQ(query(path, "SELECT part FROM part_results WHERE center_of_pressure_z = 6"), "front");
  EXPECT_EQ(query(path, "PRAGMA application_id"), std::to_string(kStudyApplication));
  EXPECT_EQ(query(path, "PRAGMA journal_mode"), "delete");
  EXPECT_EQ(query(path, "SELECT count(*) FROM pragma_foreign_key_check"), "0");
}

TEST_F(StudyFile, EveryNumberOfAContactIsAColumn) {
  write({result_of(1)});
  const ContactStatistics statistics = result_of(1).states[1].statistics[0];
  for (const NamedNumber<ContactStatistics>& n : contact_numbers()) {
    const std::string there = column(path, n.name)[1];
    const double wanted = n.value(statistics);
    EXPECT_TRUE(std::isnan(wanted) ? there.empty() : parse_number(there) == wanted) << n.name;
  }
}

TEST_F(StudyFile, FieldsAndSurfacesComeBack) {
  write({result_of(1)});
  EXPECT_EQ(read_pressure(path, 1, 2, 1), (std::vector<float>{0.5f, 0.25f, 0.0f}));
  EXPECT_TRUE(read_pressure(path, 2, 2, 1).empty());
  const std::vector<StudySurface> surfaces = read_surfaces(path, 0);
  ASSERT_EQ(surfaces.size(), 1u);
  EXPECT_EQ(surfaces[0].source, "pelvis");
  EXPECT_EQ(surfaces[0].surface.vertices[2], Vector3d(0, 1, 0.1));
  EXPECT_EQ(surfaces[0].surface.triangles[0][2], 2);
}

TEST_F(StudyFile, GoesOnAndReplaces) {
  write({result_of(1), refused(2)});
  StudyWriter writer(path, plan, identity());
  EXPECT_EQ(writer.there()[0], CaseResult::Outcome::Solved);
  EXPECT_EQ(writer.there()[1], CaseResult::Outcome::Refused);
  EXPECT_FALSE(writer.there()[2]);
  writer.add(result_of(2));
  writer.add(result_of(3));
  writer.finish();
  EXPECT_EQ(count_cases(path).solved, 3u);
  EXPECT_EQ(query(path, "SELECT count(*) FROM statistics WHERE case_id = 2"), "2");
}

// A batch that is not committed is not there, and takes nothing else with it.
TEST_F(StudyFile, ResultsThatWaitAreNotThereYet) {
  {
    StudyWriter writer(path, plan, identity());
    writer.add(result_of(1));
    EXPECT_EQ(count_cases(path).all(), 0u);
  }
  EXPECT_EQ(count_cases(path).all(), 0u);
  write({result_of(1)});
  EXPECT_EQ(count_cases(path).all(), 1u);
}

// Who reads for long keeps nobody from solving: what waits is written afterwards.
TEST_F(StudyFile, IsWrittenWhenAReaderHasEnded) {
  write({result_of(1)});
  StudyWriter writer(path, plan, identity());
  sqlite3* reader = nullptr;
  ASSERT_EQ(sqlite3_open_v2(path.c_str(), &reader, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(reader, "BEGIN; SELECT count(*) FROM cases", nullptr, nullptr, nullptr), SQLITE_OK);
  std::thread end([&] {
    std::this_thread::sleep_for(std::chrono::seconds(3));
    sqlite3_close(reader);
  });
  writer.add(result_of(2));
  writer.finish();
  end.join();
  EXPECT_EQ(count_cases(path).all(), 2u);
}

TEST_F(StudyFile, DifferencesAreNamed) {
  write({});
  const StudyHead head = read_study_head(path);
  const auto with = [&](auto change) {
    StudyIdentity other = identity();
    change(other);
    return study_difference(head, other);
  };
  EXPECT_EQ(with([](StudyIdentity& i) { i.version = "0.2 (d)"; }), "it was made by dea 0.1 (abc), this is dea 0.2 (d)");
  EXPECT_EQ(with([](StudyIdentity& i) { i.options.push_back("--E 8"); }), "it was made without --E 8");
  EXPECT_EQ(with([](StudyIdentity& i) { i.options = {"--E 8"}; }), "it was made with --vary 'tilt: ...', not --E 8");
  EXPECT_EQ(with([](StudyIdentity& i) { i.inputs[0][1] = "crc32:3:4"; }), "hip.feb has changed since");
  EXPECT_EQ(with([](StudyIdentity& i) { i.inputs[0][0] = "knee.feb"; }), "it was made from hip.feb, not knee.feb");
  EXPECT_EQ(with([](StudyIdentity& i) { i.inputs.push_back({"walk.csv", ""}); }), "it was made without walk.csv");
  EXPECT_EQ(with([](StudyIdentity& i) { i.shards = 2; }), "it is shard 1 of 1, not 1 of 2");
}

TEST_F(StudyFile, WhatIsNoStudyIsSaid) {
  std::ofstream(path) << std::string(5000, 'x');
  EXPECT_NE(input_fault([&] { read_study_head(path); }).find("plan.db: found no SQLite database"), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_NE(input_fault([&] { read_study_head(path); }).find("found no readable file"), std::string::npos);
  const auto make = [&](const char* sql) {
    sqlite3* db = nullptr;
    sqlite3_open(path.c_str(), &db);
    sqlite3_exec(db, sql, nullptr, nullptr, nullptr);
    sqlite3_close(db);
  };
  make("CREATE TABLE a (b)");
  EXPECT_NE(input_fault([&] { read_study_head(path); }).find("another program"), std::string::npos);
  std::filesystem::remove(path);
  write({});
  make("PRAGMA user_version = 3");
  EXPECT_NE(input_fault([&] { read_study_head(path); }).find("found dea.study/3, expected dea.study/2"),
            std::string::npos);
  std::filesystem::remove(path);
  write({result_of(1)});
  make("DROP TABLE options");
  EXPECT_NE(input_fault([&] { read_study_head(path); }).find("no such table: options"), std::string::npos);
  std::filesystem::remove(path);
  write({result_of(1)});
  std::filesystem::resize_file(path, 9000);
  EXPECT_NE(input_fault([&] { column(path, "time"); }).find("damaged"), std::string::npos);
}

TEST_F(StudyFile, RowsThatWereDeletedAreMissed) {
  struct Case {
    const char *sql, *found;
  };
  for (const Case& c :
       {Case{"DELETE FROM models", "a case of no model (case 1)"},
        Case{"DELETE FROM cases WHERE case_id = 2", "a warning of no case (case 2)"},
        Case{"DELETE FROM warnings; DELETE FROM cases WHERE case_id = 1", "a state of no case (case 1)"},
        Case{"DELETE FROM states WHERE case_id = 2", "a solved case without states (case 2)"},
        Case{"DELETE FROM states WHERE state = 1", "a case that lacks a state (case 1)"},
        Case{"DELETE FROM states WHERE state = 2", "results of no state (case 1)"},
        Case{"DELETE FROM statistics WHERE case_id = 2 AND state = 2", "a state without contacts (case 2)"},
        Case{"UPDATE statistics SET contact_id = 2", "a state that lacks a contact (case 1)"},
        Case{"DELETE FROM surfaces", "a field of no surface (case 1)"},
        Case{"DELETE FROM factors WHERE number = 2", "1 factors and 2 columns of their values"}}) {
    std::filesystem::remove(path);
    write({result_of(1), result_of(2), refused(3)});
    EXPECT_EQ(input_fault([&] { read_study_head(path); }), "no fault");
    sqlite3* db = nullptr;
    sqlite3_open(path.c_str(), &db);
    EXPECT_EQ(sqlite3_exec(db, c.sql, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(db);
    const std::string fault = input_fault([&] { read_study_head(path); });
    EXPECT_NE(fault.find(fmt::format("plan.db: found {}", c.found)), std::string::npos) << c.sql << ": " << fault;
  }
}

TEST_F(StudyFile, ShardsBecomeOneFile) {
  const auto shard = [&](int i, const std::vector<CaseResult>& results) {
    StudyIdentity who = identity();
    who.shard = i;
    who.shards = 3;
    const std::string to = (folder.path / fmt::format("s{}.db", i)).string();
    write(results, who, to);
    return to;
  };
  const std::string whole = (folder.path / "whole.db").string(), a = shard(1, {result_of(1), result_of(2)}),
                    b = shard(2, {result_of(3), refused(4)}), c = shard(3, {result_of(5), result_of(6)});
  write({result_of(1), result_of(2), result_of(3), refused(4), result_of(5), result_of(6)}, identity(), whole);
  const MergedStudies all = merge_studies({c, a, b}, path);
  EXPECT_EQ(all.cases, 6u);
  EXPECT_EQ(all.failed, 1u);
  EXPECT_EQ(all.missing + all.missing_shards, "");
  EXPECT_EQ(study_difference(read_study_head(path), identity()), "");
  std::string rows[2];
  for (int i = 0; i < 2; ++i)
    read_results(i == 0 ? path : whole, [&](const std::vector<std::string>& cells) {
      for (const std::string& cell : cells) rows[i] += cell + ",";
    });
  EXPECT_EQ(rows[0], rows[1]);
  EXPECT_EQ(read_pressure(path, 5, 1, 1).size(), 3u);

  const std::string part = (folder.path / "part.db").string();
  const MergedStudies some = merge_studies({a, c}, part);
  EXPECT_EQ(some.missing, "3-4");
  EXPECT_EQ(some.missing_shards, "2");
  EXPECT_NE(input_fault([&] {
              merge_studies({a, a}, part + "2");
            }).find("expected each shard once"),
            std::string::npos);
  EXPECT_NE(input_fault([&] {
              merge_studies({a, whole}, part + "2");
            }).find("is of another study than"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(part + "2"));
}

TEST_F(StudyFile, ShardsAreNeighboursAndAllOfThem) {
  std::size_t next = 0;
  for (int i = 1; i <= 7; ++i) {
    const ShardCases s = shard_cases(100, i, 7);
    EXPECT_EQ(s.first, next);
    EXPECT_TRUE(s.last - s.first == 14 || s.last - s.first == 15);
    next = s.last;
  }
  EXPECT_EQ(next, 100u);
}

TEST_F(StudyFile, AFactorIsNoOtherColumn) {
  for (const char* name : {"outcome", "Headline_P99", "time", "case_id", "part", "seconds", "model_id"})
    EXPECT_THROW(check_factor_names({parse_factor(fmt::format("{}: E={{1|2}}", name))}), UsageError) << name;
  check_factor_names({parse_factor("stiffness: E={1|2}")});
}

TEST_F(StudyFile, DigestsTellContents) {
  const std::string file = (folder.path / "f").string();
  std::ofstream(file) << "123456789";
  EXPECT_EQ(file_digest(file), "crc32:cbf43926:9");  // the known check value of CRC-32
  EXPECT_NE(input_fault([&] { file_digest(file + "x"); }).find("found no readable file"), std::string::npos);
}

TEST_F(StudyFile, TablesOfCasesAsOtherProgramsWriteThem) {
  const std::string file = (folder.path / "cases.csv").string();
  const auto read = [&](const std::string& text) {
    std::ofstream(file) << text;
    return read_case_table(file);
  };
  for (const char* text :
       {"tilt,model\n-5,a b.feb\n5,\"x,y.feb\"\n",                               // by hand
        "\"\",\"tilt\",\"model\"\n\"1\",-5,\"a b.feb\"\n\"2\",5,\"x,y.feb\"\n",  // R, rows with names
        ",tilt,model\n0,-5,a b.feb\n1,5,\"x,y.feb\"\n",                          // pandas
        "\xef\xbb\xbftilt;model\r\n-5;a b.feb\r\n5;x,y.feb\r\n",                 // a spreadsheet
        "%eval_id\tinterface\ttilt\tmodel\n1\tNO_ID\t-5\ta b.feb\n2\tNO_ID\t5\tx,y.feb\n"}) {
    const CaseTable t = read(text);
    EXPECT_EQ(t.names, (std::vector<std::string>{"tilt", "model"})) << text;
    EXPECT_EQ(t.rows, (std::vector<std::vector<std::string>>{{"-5", "a b.feb"}, {"5", "x,y.feb"}})) << text;
    EXPECT_EQ(t.lines, (std::vector<int>{2, 3}));
  }
  EXPECT_EQ(read("\"tilt\"\n\"1\"\n").names[0], "tilt");
  EXPECT_EQ(read("%eval_id tilt  force\n 1   0.5  2e3\n").rows[0], (std::vector<std::string>{"0.5", "2e3"}));
  EXPECT_EQ(read("a,b\n\"say \"\"x\"\"\",1\n").rows[0][0], "say \"x\"");
  EXPECT_NE(input_fault([&] { read("tilt,E\n1,2\n3\n"); }).find(":3: found 1 values, expected 2"), std::string::npos);
}

}  // namespace dea::study_file_test
