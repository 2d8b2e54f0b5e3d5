// The file of a study, read as `dea study FILE.db` and Python read it.
#include "fuzz/fuzz.h"
#include "io/study/read_study.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = dea::fuzz::file_of(data, size, ".db");
  dea::fuzz::answer_or_refusal([&] { dea::read_study_head(path); });
  dea::fuzz::answer_or_refusal([&] { dea::count_cases(path); });
  dea::fuzz::answer_or_refusal([&] { dea::read_cases(path); });
  dea::fuzz::answer_or_refusal([&] { dea::read_results(path, [](const std::vector<std::string>&) {}); });
  dea::fuzz::answer_or_refusal([&] { dea::read_surfaces(path, 0); });
  dea::fuzz::answer_or_refusal([&] { dea::read_fields(path, {{1, 1, 1}}, [](std::size_t, std::vector<float>&&) {}); });
  return 0;
}
