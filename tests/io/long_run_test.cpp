// A run of many states: what is as large as the mesh is written as it is solved, and not kept.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <vector>

#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/results/plot_file.h"
#include "io/vtu/write_vtu.h"
#include "src/base/error.h"
#include "src/run/recognise.h"
#include "tests/io/resident.h"
#include "tests/program.h"
#include "views/data/run_csv.h"
#include "views/data/run_json.h"
#include "views/run_model.h"

namespace dea::long_run_test {

using test::resident;

/// Two plateaus under a femur, in one step of so many states.
Recognition of_states(int states) {
  JointModel model = read_feb(DEA_SAMPLES_DIR "/plateaus/plateaus.feb");
  for (Step& step : model.steps) step.step_size = step.duration / states;
  Settings settings;
  settings.law = Law::Linear;
  return recognise(std::move(model), settings);
}

RunOptions all_files(const std::filesystem::path& folder) {
  RunOptions options;
  options.outputs.output = (folder / "plot.xplt").string();
  options.outputs.json = (folder / "run.json").string();
  options.outputs.csv = (folder / "run.csv").string();
  options.outputs.facets_csv = (folder / "facets.csv").string();
  options.outputs.vtu = (folder / "vtu").string();
  return options;
}

// 12 KB of numbers per state stay, for the table and the remarks at the end; a state's displacements and fields are
// many times as large.
TEST(LongRun, MemoryDoesNotGrowWithItsStates) {
#ifdef DEA_SANITIZE_ADDRESS
  GTEST_SKIP() << "the sanitizer keeps what was given back";
#endif
  constexpr double kNumbers = 12000;
  const test::TemporaryFolder folder;
  const Recognition recognition = of_states(120);
  ASSERT_GT(static_cast<double>(recognition.model.nodes.size() * sizeof(Vector3d)), 5 * kNumbers);
  RunOptions options = all_files(folder.path);
  std::vector<double> held;
  options.on_state = [&](const StateResult&, std::size_t, std::size_t) { held.push_back(resident()); };
  const RunResult result = run_model(recognition, options);
  ASSERT_EQ(held.size(), 121U);
  EXPECT_LT(held.back() - held[20], 100 * kNumbers);
  EXPECT_TRUE(all_solved(result.analysis));
  EXPECT_EQ(read_xplt(options.outputs.output).states.size(), 121U);
  EXPECT_TRUE(std::filesystem::exists(folder.path / "vtu" / "surfaces_0120.vtu"));
}

// The same files as of an analysis that keeps everything.
TEST(LongRun, FilesAreThoseOfTheWholeAnalysis) {
  const test::TemporaryFolder folder;
  const Recognition recognition = of_states(3);
  const RunOptions options = all_files(folder.path);
  const RunResult result = run_model(recognition, options);
  const Analysis whole = analyse(recognition);
  const XpltFile plot = make_plot_file(recognition, whole);
  EXPECT_EQ(test::file_text(options.outputs.output), xplt_bytes(plot));
  EXPECT_EQ(test::file_text(options.outputs.facets_csv), facets_csv(recognition.model, whole));
  EXPECT_EQ(test::file_text(options.outputs.json),
            json_text(run_json(recognition.model, recognition.settings, result.analysis, result.timings)));
  write_vtu((folder.path / "whole").string(), plot);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "whole")) {
    EXPECT_EQ(test::file_text(folder.path / "vtu" / entry.path().filename()), test::file_text(entry.path()));
    ++files;
  }
  EXPECT_EQ(files, 9);  // two per state, and the list
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path))
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
}

TEST(LongRun, NoStateAtAll) {
  Recognition recognition = of_states(2);
  Analysis none;
  none.joint = recognition.joint;
  std::string text;
  put_run_json(recognition.model, recognition.settings, none, {}, [&](const std::string& piece) { text += piece; });
  EXPECT_EQ(text, json_text(run_json(recognition.model, recognition.settings, none, {})));
}

// What was added comes back from anywhere, and more may be added afterwards; no name is to be seen.
TEST(Spool, GivesBackWhatWasAdded) {
  const test::TemporaryFolder folder;
  Spool spool((folder.path / "result.csv").string());
  const std::string large(3 << 20, 'b');
  spool.add("aaaa");
  spool.add(large);
  const auto part = [&](std::uint64_t begin, std::uint64_t count) {
    std::string text;
    spool.read(begin, count, [&](const std::string& piece) { text += piece; });
    return text;
  };
  EXPECT_EQ(part(2, 4), "aabb");
  spool.add("c");
  EXPECT_EQ(part(0, spool.size()), "aaaa" + large + "c");
  EXPECT_EQ(part(spool.size(), 0), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

// Every byte of a full disk is told of, at the latest when it is read.
TEST(Spool, TellsOfAFullDisk) {
  const test::TemporaryFolder folder;
  const auto limited = [&] {
    const rlimit limit = {1 << 16, RLIM_INFINITY};
    ::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      Spool spool((folder.path / "result.csv").string());
      for (int i = 0; i < 100; ++i) spool.add(std::string(1000, 'a'));
      spool.read(0, spool.size(), [](const std::string&) {});
    } catch (const WriteError& e) {
      ::_exit(std::string(e.what()) == (folder.path / "result.csv").string() + ": File too large" ? 4 : 5);
    }
    ::_exit(0);
  };
  EXPECT_EXIT(limited(), testing::ExitedWithCode(4), "");
}

}  // namespace dea::long_run_test
