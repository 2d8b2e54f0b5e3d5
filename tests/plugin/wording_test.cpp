// Words of the plugin that need no FEBio.
#include "plugin/febio_wording.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace dea {

TEST(PluginWording, AnSdkThatWasNotVerifiedIsSaidInOneLine) {
  EXPECT_EQ(untested_line("4.11", "4.11"), "");
  EXPECT_EQ(untested_line("4.11 4.13", "4.13"), "");
  for (const char* compiled : {"4.1", "4.12", "14.11"}) {
    const std::string line = untested_line("4.11", compiled);
    EXPECT_NE(line.find(std::string("verified with FEBio 4.11 and is compiled for ") + compiled + ";"), line.npos)
        << line;
    EXPECT_NE(line.find("dea compare task.xplt run.xplt"), line.npos) << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
  }
}

}  // namespace dea
