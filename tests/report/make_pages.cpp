// make_pages awkward|large|hard OUT.html: pages of made-up results, for report_test.py.
#include <fmt/format.h>

#include <chrono>
#include <string>

#include "tests/report/synthetic.h"
#include "views/page/write_page.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string what = argv[1];
  const std::vector<dea::ResultFile> files =
      what != "awkward" ? dea::test::large_results(224, 50, what == "hard") : dea::test::awkward_results();
  const auto start = std::chrono::steady_clock::now();
  const dea::CompareOptions options;
  const dea::Comparison comparison = dea::compare_files(files, options);
  dea::write_text(argv[2], dea::page_html(dea::compare_page(files, options, comparison, {"dea", "compare"})));
  fmt::print("{:.2f} s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}
