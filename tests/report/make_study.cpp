// make_study KIND OUT.db: studies of made-up results, for study_page_test.py and sizes. None of them is solved.
//
//   big       10,000 cases x 13 states with pressures at 225 nodes: three factors as a grid
//   million   80,000 cases x 13 states without pressures: 1,040,000 rows
//   turn      30 cases as a grid, with pressures
//   awkward   names of models, factors, contacts and messages that are markup; failed and refused cases
//   subjects  two models of each of six subjects, on meshes of their own; subjects.csv beside it tells of them
//   sample    Saltelli's design of Ishigami's function: p99 is the function
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/report/made_study.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  using namespace dea::test;
  const std::string kind = argv[1], path = argv[2];
  if (kind == "big")
    write_grid(path, grid({"a: move pelvis={-9:9:1},0,0", "b: E={-9:9:1}", "c: nu={1:28:1}"}), true);
  else if (kind == "million")
    write_grid(path, grid({"a: move pelvis={1:40:1},0,0", "b: E={1:40:1}", "c: nu={1:50:1}"}), false);
  else if (kind == "turn")
    write_grid(path, grid({"a: move pelvis={-8:8:4},0,0", "b: E={-8|0|8}", "c: nu={1|2}"}), true);
  else if (kind == "awkward")
    write_awkward(path);
  else if (kind == "subjects") {
    write_subjects(path);
    std::ofstream(std::filesystem::path(path).replace_extension(".csv")) << subjects_table();
  } else if (kind == "sample")
    write_sample(path);
  else
    return 2;
  return 0;
}
