// app/build_main.cpp – the program `dea-build`, which `dea build` starts: CGAL and its licence are in it alone.
#include "app/command_line.h"
#include "app/commands.h"

int main(int argc, char** argv) {
  using namespace dea;
  std::vector<std::string> words = {"dea", "build"};
  words.insert(words.end(), argv + 1, argv + argc);
  return run_program([&] {
    CLI::App app(kAbout, "dea");
    BuildArguments arguments;
    arguments.words = words;
    add_build(app, arguments);
    const std::optional<int> code = parse(app, words);
    return code ? *code : build(arguments);
  });
}
