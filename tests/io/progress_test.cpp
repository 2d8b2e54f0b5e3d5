// The progress line: when it is written, what it says, and that nothing of it is left behind.
#include "app/progress.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace dea::progress_test {

/// A clock that is set, and all that was written.
struct Watch {
  double now = 10.0;
  std::string text;
  Progress start(ProgressStyle style) {
    return Progress(
        style, [this](const std::string& s) { text += s; }, [this] { return now; });
  }
};

TEST(Progress, BarComesLateAndGoes) {
  Watch w;
  {
    Progress p = w.start(ProgressStyle::Bar);
    w.now = 10.4;
    p.step("state 1 of 8", "long", 1, 8);
    EXPECT_EQ(w.text, "");  // a command that takes half a second needs no bar
    w.now = 12.0;
    p.step("state 2 of 8", "long", 2, 8);
    EXPECT_EQ(w.text, "\r\033[K[######..................] state 2 of 8, about 6 s left");
    w.now = 12.05;
    p.step("state 3 of 8", "long", 3, 8);
    EXPECT_EQ(w.text.find("state 3"), std::string::npos);
    w.now = 400;
    p.step("state 4 of 8", "long", 4, 8);
    EXPECT_NE(w.text.find("\r\033[K[############............] state 4 of 8, about 7 min left"), std::string::npos);
    EXPECT_EQ(w.text.find('\n'), std::string::npos);
  }
  EXPECT_EQ(w.text.substr(w.text.size() - 4), "\r\033[K");  // also when a fault ends the command
}

TEST(Progress, NothingToClearWithoutBar) {
  Watch w;
  {
    Progress p = w.start(ProgressStyle::Bar);
    p.step("state 1 of 2", "long", 1, 2);
    p.clear();
  }
  EXPECT_EQ(w.text, "");
}

TEST(Progress, BarClearedOnceByAFault) {
  Watch w;
  try {
    Progress p = w.start(ProgressStyle::Bar);
    w.now = 11;
    p.step("1024 springs solved", "long", 0, 0);
    EXPECT_EQ(w.text, "\r\033[K1024 springs solved");
    throw 1;
  } catch (int) {
    w.text += "message";
  }
  EXPECT_EQ(w.text, "\r\033[K1024 springs solved\r\033[Kmessage");
}

TEST(Progress, LinesElsewhereEveryTwoSeconds) {
  Watch w;
  Progress p = w.start(ProgressStyle::Lines);
  for (std::size_t i = 1; i <= 50; ++i) {
    w.now += 0.125;
    p.step(fmt::format("state {} of 50", i), "long", i, 50);
  }
  EXPECT_EQ(w.text, "state 16 of 50, about 5 s left\nstate 32 of 50, about 3 s left\nstate 48 of 50, about 1 s left\n");
}

TEST(Progress, LifeBeforeTheFirstStepIsDone) {
  Watch w;
  Progress p = w.start(ProgressStyle::Bar);
  p.now("reading hip.feb", "", "");
  w.now = 10.4;
  p.tick();
  EXPECT_EQ(w.text, "");
  w.now = 10.5;
  p.tick();
  EXPECT_EQ(w.text, "\r\033[Kreading hip.feb");
  w.now = 13.5;
  p.tick();
  EXPECT_EQ(w.text.substr(w.text.rfind('\r')), "\r\033[Kreading hip.feb (3 s)");
  w.now = 14;
  p.now("state 1 of 4", "", "", 0, 4);
  EXPECT_EQ(w.text.substr(w.text.rfind('\r')), "\r\033[K[........................] state 1 of 4");
  w.now = 15;
  p.now("state 1 of 4", "iteration 2, unbalanced 3e-04", "", 0, 4);
  w.now = 27.5;
  p.tick();
  EXPECT_EQ(w.text.substr(w.text.rfind('\r')),
            "\r\033[K[........................] state 1 of 4: iteration 2, unbalanced 3e-04 (12 s)");
  w.now = 34;  // a state in 20 s: what came before the first does not count
  p.step("state 1 of 4", "", 1, 4);
  EXPECT_EQ(w.text.substr(w.text.rfind('\r')), "\r\033[K[######..................] state 1 of 4, about 1 min left");
  w.now = 44;
  p.now("state 2 of 4", "", "", 1, 4);
  EXPECT_EQ(w.text.substr(w.text.rfind('\r')), "\r\033[K[######..................] state 2 of 4, about 50 s left");
  w.now = 48;
  p.now("state 2 of 4", "iteration 12, unbalanced 1e-10", "", 1, 4);  // no room for what is left
  EXPECT_EQ(w.text.substr(w.text.rfind('\r')),
            "\r\033[K[######..................] state 2 of 4: iteration 12, unbalanced 1e-10");
  for (std::size_t i = w.text.find('\r'); i != std::string::npos; i = w.text.find('\r', i + 1))
    EXPECT_LE(w.text.substr(i, w.text.find('\r', i + 1) - i).size(), 79u + 4);
  p.clear();
  w.text.clear();
  w.now = 99;
  p.tick();
  EXPECT_EQ(w.text, "");  // messages may follow
  p.now("state 3 of 4", "", "", 2, 4);  // and what goes on is shown again
  EXPECT_EQ(w.text.find("\r\033[K[############............] state 3 of 4"), 0u);
}

TEST(Progress, AStepWithoutDetailsHasNoLine) {
  Watch w;
  Progress p = w.start(ProgressStyle::Every);
  p.step("solving a few", "", 1, 3);
  p.step("solving a few", "case 2: solved", 2, 3);
  EXPECT_EQ(w.text, "case 2: solved\n");
}

TEST(Progress, LongNamesAreCutToALine) {
  Watch w;
  Progress p = w.start(ProgressStyle::Bar);
  p.now("reading " + std::string(200, 'x'), "", "", 0, 3);
  w.now = 30;
  p.tick();
  EXPECT_EQ(w.text.size(), 79u + 4);
  EXPECT_EQ(w.text.substr(w.text.size() - 7), " (20 s)");
}

TEST(Progress, LinesThatOnlyCountComeSeldom) {
  Watch w;
  Progress p = w.start(ProgressStyle::Lines);
  p.now("springs and layers", "", "hidden");
  for (int i = 0; i < 60; ++i) {
    w.now += 0.5;
    p.tick();
  }
  EXPECT_EQ(w.text, "springs and layers\nsprings and layers (17 s)\n");
  w.text.clear();
  w.now += 2;
  p.now("state 1 of 4", "iteration 1, unbalanced 2e-01", "", 0, 4);
  EXPECT_EQ(w.text, "state 1 of 4: iteration 1, unbalanced 2e-01\n");
}

TEST(Progress, TheClockTicksByItself) {
  testing::internal::CaptureStderr();
  {
    Progress p(ProgressStyle::Bar);
    p.now("waiting", "", "");
    std::this_thread::sleep_for(std::chrono::milliseconds(1300));
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr().substr(0, 11), "\r\033[Kwaiting");
}

TEST(Progress, EveryStepOrNone) {
  Watch w;
  Progress every = w.start(ProgressStyle::Every), none = w.start(ProgressStyle::Quiet);
  every.step("state 1 of 2", "state 1 of 2, time 0: Prescribed", 1, 2);
  none.step("state 2 of 2", "hidden", 2, 2);
  every.now("state 2 of 2", "iteration 1", "  iteration 1, pose 2", 1, 2);
  every.now("state 2 of 2", "", "", 1, 2);
  none.now("reading", "", "reading");
  EXPECT_EQ(w.text, "state 1 of 2, time 0: Prescribed\n  iteration 1, pose 2\n");
}

}  // namespace dea::progress_test
