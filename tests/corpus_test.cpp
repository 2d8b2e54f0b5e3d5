// FEBio's verification models, which no one here wrote: `dea run` and `dea info` solve a joint, and refuse all else
// with one line, the same line, that says what is missing. A model that moves from one row of the table to another is a
// change that users notice.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "tests/program.h"

namespace dea::corpus_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

// Seconds of processor time. Sanitizers cost ten times as much.
#ifdef DEA_SANITIZE_ADDRESS
constexpr double kLimit = 200;
#else
constexpr double kLimit = 20;
#endif

/// Why a model is refused, and what its line must say.
struct Reason {
  const char* found;   ///< what was found or is missing
  const char* advice;  ///< what to do next
};
// No contact, or contacts that fasten.
const Reason kNoContact = {"no sliding contact in the model; DEA needs one", "(Contact section, e.g. type"};
const Reason kFastened = {"no sliding contact in the model; DEA needs one", "change its type if they are to slide"};
const Reason kModule = {"module \"fluid-FSI\" is not supported", "DEA reads \"solid\", \"biphasic\""};
// Nodes that are moved in one component only.
const Reason kMovedNodes = {"so it is no bone; DEA moves bones", "prescribe or fix these nodes in x, y"};
const Reason kWeight = {"body_", "as a force on its rigid body"};
const Reason kShells = {"lies on deformable shells", "mesh the layer with solid elements, or take the shells as rigid"};
// Blocks that are no layer on a bone: free, or held by rollers at their sides (symmetry), where no thickness is
// defined.
const Reason kNotHeld = {"its layer is held by no rigid body", "name the body with --attach"};
// Parts of which no small-strain stiffness is known: damage, fixed charges.
const Reason kNoStiffness = {"of part \"", "give --E and --nu for one of its surfaces, or take it as rigid"};

/// One problem, in the versions of the format that have it.
struct Row {
  const char* name;
  const char* versions;
  int code;                     ///< exit code of dea run
  const Reason* reason;         ///< of code 3; null: not refused
  std::optional<double> force;  ///< of code 0: the contact's resultant in the last state, where it is known on paper
  const char* states = "";      ///< of its time steps; empty: all
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name << " of " << row.versions; }

const char* const kAll = "1.2 2.0 2.5 3.0 4.0";
const char* const kFrom20 = "2.0 2.5 3.0 4.0";
const char* const kFrom30 = "3.0 4.0";

const std::vector<Row> kRows = {
    // joints: rigid bodies and layers that slide
    {"co34", kAll, 0, nullptr, {}},
    {"co37", kAll, 0, nullptr, {}},
    {"co54", kFrom30, 0, nullptr, 0.02},
    {"co58", kFrom30, 0, nullptr, 0.2},
    {"bs06", kAll, 0, nullptr, 0.2},  // of 100000 time steps
    // layers whose bone is left out: the nodes on its side are moved
    {"co17", kAll, 0, nullptr, {}},
    {"co46", kFrom20, 0, nullptr, {}},
    {"sh21", kFrom20, 0, nullptr, {}},
    // two cubes of a neo-Hookean solid without lateral strain, pressed to 0.9 of their height: (1/J - J) E/2
    {"co01", kAll, 0, nullptr, (1 / 0.9 - 0.9) / 2},
    {"bp15", kAll, 0, nullptr, (1 / 0.75 - 0.75) / 2},  // the drained solid, to 0.75 of its height
    {"sh17", kFrom20, 0, nullptr, (1 / 0.9 - 0.9) / 2},
    // a joint whose load squeezes two springs beyond the strain that a spring can have
    {"co56", kFrom30, 1, nullptr, {}},
    // parts that give way as their elements do, far beyond small strain and turn; no pose bears the load of ex01
    {"co13", kAll, 0, nullptr, {}},
    {"co39", kAll, 1, nullptr, {}},
    {"co19", kAll, 1, nullptr, {}},
    {"co11", kAll, 1, nullptr, {}},
    {"ex01", "4.0", 1, nullptr, {}, "last"},  // of 1000, none of the later ones has a balance
    // no contact between bodies
    {"ar01", kFrom30, 3, &kNoContact, {}},
    {"cf03", kAll, 3, &kNoContact, {}},
    {"cf09", kFrom30, 3, &kNoContact, {}},
    {"ch01", kFrom30, 3, &kNoContact, {}},
    {"dm11", kFrom20, 3, &kNoContact, {}},
    {"fs17", "2.5 3.0 4.0", 3, &kNoContact, {}},
    {"ma41", kFrom30, 3, &kNoContact, {}},
    {"mi44", kFrom30, 3, &kNoContact, {}},
    {"pl04", kFrom30, 3, &kNoContact, {}},
    {"ri01", kAll, 3, &kNoContact, {}},
    {"rj03", kFrom20, 3, &kNoContact, {}},
    {"rj09", kFrom20, 3, &kNoContact, {}},
    {"rj17", kFrom30, 3, &kNoContact, {}},
    {"sh07", "1.2", 3, &kNoContact, {}},  // another problem than the later ones of this name
    {"sh43", kFrom20, 3, &kNoContact, {}},
    {"sh52", kFrom20, 3, &kNoContact, {}},
    {"co26", kAll, 3, &kFastened, {}},
    {"co42", kFrom20, 3, &kFastened, {}},
    {"co52", kFrom30, 3, &kFastened, {}},
    {"sh31", kFrom20, 3, &kFastened, {}},
    // contact between deformable parts only
    {"co43", kFrom20, 3, &kMovedNodes, {}},
    // contact with a rigid body, driven by what DEA does not have
    {"bp05", kAll, 3, &kMovedNodes, {}},
    {"co30", kAll, 3, &kWeight, {}},
    {"fs22", "2.5 3.0 4.0", 3, &kModule, {}},
    // contact with a rigid body, of parts that are no layers
    {"sh07", kFrom20, 3, &kShells, {}},
    {"sh29", kFrom20, 3, &kShells, {}},
    {"co28", kAll, 3, &kNotHeld, {}},
    {"dm17", kFrom30, 3, &kNoStiffness, {}},
    {"mp06", kAll, 3, &kNoStiffness, {}},
    {"mp08", kAll, 3, &kNoStiffness, {}},
};

Words words_of(const std::string& text) {
  Words words;
  std::istringstream in(text);
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

fs::path file_of(const std::string& version, const std::string& name) {
  return fs::path(DEA_CORPUS_DIR) / ("v" + version) / (name + ".feb");
}

int lines_in(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

/// Without " (and 2 more reasons: dea info lists them)".
std::string first_reason(std::string line) {
  const std::size_t more = line.find(" (and ");
  if (more != std::string::npos && line.find("more reason", more) != std::string::npos) line.erase(more);
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line;
}

Words names_in(const fs::path& folder) {
  Words names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

class Corpus : public testing::TestWithParam<Row> {
 protected:
  void SetUp() override {
    if (!fs::is_directory(DEA_CORPUS_DIR)) GTEST_SKIP() << "no " << DEA_CORPUS_DIR;
  }
};

void check_refused(const Row& row, const test::Finished& run, const test::Finished& info, const fs::path& folder) {
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(lines_in(run.err), 1) << run.err;
  EXPECT_NE(run.err.find(row.reason->found), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(row.reason->advice), std::string::npos) << run.err;
  EXPECT_EQ(run.err.rfind(std::string(row.name) + ".feb:", 0), 0u) << "no file and place: " << run.err;
  EXPECT_EQ(info.code, 3);
  EXPECT_EQ(info.err, run.err) << "dea info and dea run differ";
  ASSERT_EQ(names_in(folder), Words{"info.json"});  // dea run leaves nothing behind
  const Json told = Json::parse(test::file_text(folder / "info.json"));
  EXPECT_EQ(told["error"], first_reason(run.err));
  EXPECT_EQ(told["errors"][0], told["error"]);
  const std::size_t more = told["errors"].size() - 1;
  EXPECT_EQ(run.err.find(fmt::format("(and {} more reason", more)) != std::string::npos, more > 0) << run.err;
  for (const Json& reason : told["errors"])
    EXPECT_NE(info.out.find(reason.get<std::string>()), std::string::npos) << "not in the text of dea info: " << reason;
}

/// The numbers of every state are numbers; null is what is not defined. The largest force of a state, and the last.
struct Forces {
  double largest = 0.0, last = 0.0;
};
Forces check_states(const Json& result) {
  Forces force;
  EXPECT_FALSE(result["states"].empty());
  for (const Json& state : result["states"]) {
    for (const Json& contact : state["contacts"]) {
      double sum = 0.0;
      for (const Json& component : contact["force"]) sum += component.get<double>() * component.get<double>();
      EXPECT_TRUE(std::isfinite(sum));
      force.last = std::sqrt(sum);
      force.largest = std::max(force.largest, force.last);
    }
  }
  return force;
}

TEST_P(Corpus, IsSolvedOrRefusedInOneLine) {
  const Row row = GetParam();
  std::optional<double> force_of_first;
  for (const std::string& version : words_of(row.versions)) {
    SCOPED_TRACE(fmt::format("{} of version {}", row.name, version));
    const fs::path path = file_of(version, row.name);
    ASSERT_TRUE(fs::exists(path));
    const test::TemporaryFolder folder;
    const fs::path beside = path.parent_path();  // names in messages are then without a folder
    const std::string model = path.filename().string();
    Words words = {DEA_PROGRAM,
                   "run",
                   model,
                   "-o",
                   (folder.path / "o.xplt").string(),
                   "--json",
                   (folder.path / "run.json").string()};
    if (*row.states != 0) words.insert(words.end(), {"--states", row.states});
    const test::Finished run = test::run_program(beside, words, kLimit);
    const test::Finished info =
        test::run_program(beside, {DEA_PROGRAM, "info", model, "--json", (folder.path / "info.json").string()}, kLimit);
    EXPECT_FALSE(run.timed_out || info.timed_out);
    ASSERT_EQ(run.code, row.code) << run.err;
    for (const std::string* text : {&run.out, &run.err, &info.out, &info.err})
      EXPECT_FALSE(test::has_nan(*text)) << *text;
    EXPECT_FALSE(test::has_nan(test::file_text(folder.path / "info.json")));
    if (row.code == 3) {
      check_refused(row, run, info, folder.path);
      continue;
    }
    EXPECT_EQ(info.code, 0) << info.err;
    ASSERT_EQ(names_in(folder.path), (Words{"info.json", "o.xplt", "run.json"}));
    const std::string json = test::file_text(folder.path / "run.json");
    EXPECT_FALSE(test::has_nan(json));
    const Forces force = check_states(Json::parse(json));
    EXPECT_GT(force.largest, 0.0);
    if (row.force) {
      // Balanced to 1e-6 of the load; what held dofs carry across it, half a percent in co58, whose pressed face ends
      // where it turns away, adds its square.
      EXPECT_NEAR(force.last, *row.force, 2e-5 * *row.force);
    }
    if (!force_of_first) force_of_first = force.largest;
    EXPECT_NEAR(force.largest, *force_of_first, 1e-6 * *force_of_first) << "not as in the first version";
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Corpus, testing::ValuesIn(kRows), [](const testing::TestParamInfo<Row>& info) {
  return std::string(info.param.name) + "_" + words_of(info.param.versions).front().substr(0, 1) +
         words_of(info.param.versions).front().substr(2);
});

TEST(CorpusTable, HasEveryModelOnce) {
  if (!fs::is_directory(DEA_CORPUS_DIR)) GTEST_SKIP() << "no " << DEA_CORPUS_DIR;
  std::set<std::string> table, found;
  for (const Row& row : kRows)
    for (const std::string& version : words_of(row.versions))
      EXPECT_TRUE(table.insert(file_of(version, row.name).string()).second) << row.name << " twice";
  for (const auto& entry : fs::recursive_directory_iterator(DEA_CORPUS_DIR))
    if (entry.path().extension() == ".feb") found.insert(entry.path().string());
  EXPECT_EQ(table, found);
}

/// What a refusal advises leads to an answer: no chain of one refusal after the other.
TEST(CorpusAdvice, TheOptionsThatAreNamedSuffice) {
  if (!fs::is_directory(DEA_CORPUS_DIR)) GTEST_SKIP() << "no " << DEA_CORPUS_DIR;
  struct Advice {
    const char* name;
    Words options;
    int code;  ///< 1: an answer that is no solution, for a thickness that is only as good as a guess
  };
  const std::string one = "PrimarySurface01=1", shell = "PrimarySurface01";
  for (const Advice& a : std::vector<Advice>{
           {"bs06", {"--states", "last"}, 0},
           {"bs06", {"--states", "10,20"}, 0},
           {"co39", {"--thickness", one}, 0},
           {"co11", {"--thickness", one}, 1},
           {"ex01", {"--thickness", "SlidingFacetOnFacet1Secondary=1"}, 0},
           {"dm17",
            {"--thickness", "Sliding-elasticContact1_slave=1", "--E", "Sliding-elasticContact1_slave=1", "--nu",
             "Sliding-elasticContact1_slave=0.4"},
            0},
           {"dm17",
            {"--E", "Sliding-elasticContact1_slave=1", "--nu", "Sliding-elasticContact1_slave=0.4", "--states", "last"},
            0},
           {"sh07", {"--rigid", "Material 3", "--thickness", one, "--E", one, "--nu", shell + "=0.3"}, 0},
           {"sh29", {"--rigid", "shell1", "--thickness", one, "--E", one, "--nu", shell + "=0.3"}, 0},
       }) {
    SCOPED_TRACE(a.name);
    const test::TemporaryFolder folder;
    Words words = {DEA_PROGRAM, "run", file_of("4.0", a.name).string(), "-o", (folder.path / "o.xplt").string(), "-q"};
    words.insert(words.end(), a.options.begin(), a.options.end());
    const test::Finished f = test::run_program(folder.path, words, kLimit);
    EXPECT_FALSE(f.timed_out);
    EXPECT_EQ(f.code, a.code) << f.err;
    EXPECT_EQ(f.out, "");
    EXPECT_EQ(f.err.empty(), a.code == 0) << f.err;
    EXPECT_EQ(f.err.find("warning: no solution in ") != std::string::npos, a.code == 1) << f.err;
    EXPECT_EQ(names_in(folder.path), Words{"o.xplt"});
  }
}

}  // namespace dea::corpus_test
