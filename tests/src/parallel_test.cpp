#include "src/base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace dea {
namespace {

TEST(Parallel, EachIndexHasItsTurnOnce) {
  for (const int threads : {1, 4}) {
    const auto limit = limit_threads(threads);
    for (const int count : {-1, 0, 1, 5, 1000})
      for (const std::size_t grain : {1, 256}) {
        std::vector<int> turns(1000, 0);
        parallel_for(
            count, [&](int i) { ++turns[static_cast<std::size_t>(i)]; }, grain);
        EXPECT_EQ(std::accumulate(turns.begin(), turns.end(), 0), std::max(0, count));
        EXPECT_TRUE(count <= 0 || *std::max_element(turns.begin(), turns.end()) == 1) << count;
      }
  }
}

TEST(Parallel, WhatABodyThrowsComesOut) {
  EXPECT_THROW(parallel_for(100,
                            [](int i) {
                              if (i == 57) throw std::out_of_range("57");
                            }),
               std::out_of_range);
  bool began = false;
  EXPECT_THROW(parallel_invoke(
                   [&] {
                     began = true;
                     throw std::out_of_range("first");
                   },
                   [] {}),
               std::out_of_range);
  EXPECT_TRUE(began);
}

}  // namespace
}  // namespace dea
