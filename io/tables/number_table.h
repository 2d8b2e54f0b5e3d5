// io/tables/number_table.h – numbers in columns with names: CSV, and OpenSim's .sto and .mot.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace dea {

struct NumberTable {
  std::string path;
  bool opensim = false;                   ///< .sto or .mot: has a header that ends in "endheader"
  std::optional<bool> degrees;            ///< of its header: inDegrees=yes or no; empty: it does not say
  std::vector<std::string> names;         ///< of the columns, without white space around them
  std::vector<std::vector<double>> rows;  ///< as many numbers each as there are names
  std::vector<int> lines;                 ///< of the rows in the file, 1-based

  int find(const std::string& name) const;  ///< column of this name, whatever its letters' case; -1: none
};

/// CSV: a line of names, then a line of numbers per row, separated by commas, semicolons, tabs or spaces; lines that
/// begin with '#' and empty ones are passed over. OpenSim: what stands before "endheader", then the same with white
/// space. Throws InputError ("loads.csv:12: found ..., expected ...").
NumberTable read_table(const std::string& path);

/// The same of numbers in memory; `path` is what messages call it, and a row's line its number from 1 on. Throws
/// InputError.
NumberTable make_table(const std::string& path, const std::vector<std::string>& names,
                       const std::vector<std::vector<double>>& rows);

}  // namespace dea
