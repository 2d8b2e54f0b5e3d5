// src/base/disjoint_sets.h – things 0 .. n-1 joined into sets.
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

#include "src/base/numbers.h"

namespace dea {

struct DisjointSets {
  std::vector<int> parent;

  explicit DisjointSets(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0); }

  /// The least member of the set that `i` is in.
  int root(int i) {
    while (parent[at(i)] != i) i = parent[at(i)] = parent[at(parent[at(i)])];
    return i;
  }

  /// Per member the number of its set, from 0 on in the order of their least members.
  std::vector<int> numbers() {
    std::vector<int> number;
    int count = 0;
    for (int i = 0; i < static_cast<int>(parent.size()); ++i)
      number.push_back(root(i) == i ? count++ : number[at(root(i))]);
    return number;
  }

  void join(int a, int b) {
    a = root(a);
    b = root(b);
    parent[at(std::max(a, b))] = std::min(a, b);
  }
};

}  // namespace dea
