// Times as they were meant: sums of time steps, and single precision.
#include "src/base/time_text.h"
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dea::time_text_test {

TEST(TimeText, NoDigitsThatNobodyMeant) {
  EXPECT_EQ(time_text(1.985), "1.985");
  EXPECT_EQ(time_text(1.9850000000000001), "1.985");
  EXPECT_EQ(time_text(1.985f), "1.985");  // 1.98500001... as a double
  EXPECT_EQ(time_text(0.1 + 0.2), "0.3");
  EXPECT_EQ(time_text(1.0 - 0.1 - 0.1 - 0.1), "0.7");
  EXPECT_EQ(time_text(0.0), "0");
  EXPECT_EQ(time_text(-0.0), "0");
  EXPECT_EQ(time_text(2.0), "2");
  EXPECT_EQ(time_text(-0.25), "-0.25");
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += 0.001;
  EXPECT_NE(sum, 1.0);
  EXPECT_EQ(time_text(sum), "1");
}

TEST(TimeText, NoDigitIsLost) {
  EXPECT_EQ(time_text(1.23456789), "1.23456789");
  EXPECT_EQ(time_text(123456.25), "123456.25");
  EXPECT_EQ(time_text(0.001234567), "0.001234567");
  EXPECT_EQ(time_text(1.985f), time_text(1.985));
  // every tenth of a thousandth to 2, as a double and as a plot file has it: two are never printed alike
  std::string before;
  for (int i = 0; i <= 20000; ++i) {
    const double time = i / 10000.0;
    const std::string text = time_text(time);
    EXPECT_EQ(text, time_text(static_cast<double>(static_cast<float>(time))));
    EXPECT_NE(text, before);
    EXPECT_LE(text.size(), 6u);
    before = text;
  }
}

TEST(TimeText, TheNumberBehindIt) {
  EXPECT_EQ(time_meant(1.985f), 1.985);
  EXPECT_EQ(time_meant(0.1 + 0.2), 0.3);
  EXPECT_TRUE(std::isnan(time_meant(std::nan(""))));
  EXPECT_EQ(time_text(std::numeric_limits<double>::infinity()), "-");
}

}  // namespace dea::time_text_test
