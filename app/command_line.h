// app/command_line.h – what the programs dea and dea-build share: the command line, and faults as exit codes.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dea {

/// Reads the words of the command line, the program's name first, into what the options of `app` name. The exit code
/// where nothing is left to do: --help is printed, or the fault is told in one line.
std::optional<int> parse(CLI::App& app, const std::vector<std::string>& words);

/// The exit code of `work`; its faults are told in one line each. Ctrl-C is looked after from here on.
int run_program(const std::function<int()>& work);

}  // namespace dea
