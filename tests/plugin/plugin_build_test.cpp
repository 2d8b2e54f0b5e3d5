// `dea plugin-build` from an installed program: compiles the plugin again, which takes more than a minute.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/plugin/febio_runs.h"

namespace dea::test {
namespace {

TEST(PluginBuild, FromAnInstalledProgram) {
  const TemporaryFolder folder;
  const fs::path prefix = folder.path / "in stalled";  // a space, for whoever forgets quotes
  Finished f;
  for (const char* part :
       {"program", "plugin_build", "plugin_source"}) {  // without the Python module, which need not be built
    f = run_program(folder.path,
                    {DEA_CMAKE, "--install", DEA_BUILD_DIR, "--prefix", prefix.string(), "--component", part}, 60);
    ASSERT_EQ(f.code, 0) << f.err;
  }
  for (const char* not_needed : {"tests", "samples", "bench"})
    EXPECT_FALSE(fs::exists(prefix / "share" / "febiodea" / "source" / not_needed));

  const std::string dea = (prefix / "bin" / "dea").string();
  const fs::path sdk = fs::canonical(DEA_SDK);
  fs::create_directory(folder.path / "made here");
  fs::create_directory(folder.path / "tmp");
  const std::string temporary = "TMPDIR=" + (folder.path / "tmp").string();
  f = run_program(folder.path, {"/usr/bin/env", temporary, dea, "plugin-build", sdk.string(), "-o", "made here"}, 1500);
  ASSERT_EQ(f.code, 0) << f.err;
  const std::vector<std::string> lines = lines_of(f.out);
  ASSERT_EQ(lines.size(), 2u) << f.out;
  const std::string library = lines[0];
  EXPECT_TRUE(fs::exists(library));
  EXPECT_EQ(fs::path(library).filename(), fs::path(DEA_PLUGIN).filename());
  EXPECT_TRUE(fs::equivalent(fs::path(library).parent_path(), folder.path / "made here"));
  EXPECT_EQ(lines[1], fmt::format("<import>{}</import>", library));
  EXPECT_EQ(lines_of(f.err).size(), 1u) << f.err;
  EXPECT_TRUE(fs::is_empty(folder.path / "tmp"));

  // Asked to end while it compiles, which no cache may shorten: it does, with all that it started, and leaves nothing.
  fs::create_directory(folder.path / "stopped");
  f = run_program(folder.path,
                  {"/usr/bin/timeout", "--foreground", "--signal=TERM", "8", "/usr/bin/env", "CCACHE_DISABLE=1",
                   temporary, dea, "plugin-build", sdk.string(), "-o", "stopped"},
                  60);
  EXPECT_EQ(f.code, 124) << f.err;  // timeout's word for it
  EXPECT_NE(f.err.find("dea: stopped, nothing was written\n"), std::string::npos) << f.err;
  EXPECT_TRUE(fs::is_empty(folder.path / "stopped"));
  EXPECT_TRUE(fs::is_empty(folder.path / "tmp"));

  // FEBio takes it from there
  write(folder.path / "m.feb", model_40(false));
  f = febio(folder.path, "m.feb", "dea", "", {}, library);
  EXPECT_EQ(f.code, 0) << f.out;
  EXPECT_TRUE(fs::exists(folder.path / "m_dea.xplt"));

  // An SDK of another version: the reason is in the one line, the rest in the log that it names.
  fs::create_directories(folder.path / "other" / "lib" / "cmake");
  for (const auto& entry : fs::directory_iterator(sdk / "lib"))
    if (entry.path().extension() == ".so" || entry.path().extension() == ".a")  // FEBio builds some of them static
      fs::create_symlink(entry.path(), folder.path / "other" / "lib" / entry.path().filename());
  fs::copy(sdk / "lib" / "cmake", folder.path / "other" / "lib" / "cmake", fs::copy_options::recursive);
  fs::create_directories(folder.path / "other" / "include" / "FECore");
  write(folder.path / "other" / "include" / "FECore" / "version.h",
        "#define FE_SDK_MAJOR_VERSION\t9\n#define FE_SDK_SUB_VERSION\t7\n#define FE_SDK_SUBSUB_VERSION\t0\n");
  f = run_program(folder.path, {"/usr/bin/env", temporary, dea, "plugin-build", "other"}, 300);
  EXPECT_EQ(f.code, 3) << f.err;
  EXPECT_EQ(f.out, "");
  const std::vector<std::string> said = lines_of(f.err);
  ASSERT_EQ(said.size(), 2u) << f.err;
  EXPECT_NE(said[1].find("dea plugin-build: configuring failed: FEBio plugin: SDK 9.7 in"), std::string::npos)
      << said[1];
  EXPECT_NE(said[1].find("has not been tested (tested: 4.11)"), std::string::npos) << said[1];
  EXPECT_NE(said[1].find("--untested"), std::string::npos) << said[1];
  const std::string log = said[1].substr(said[1].rfind(' ') + 1);
  EXPECT_NE(file_text(log).find("CMake Error"), std::string::npos) << log;
}

}  // namespace
}  // namespace dea::test
