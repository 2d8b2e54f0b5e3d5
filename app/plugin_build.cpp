// `dea plugin-build`: compiles the plugin for the FEBio that is installed, from the source that came with the program.
#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <sstream>
#include <thread>

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/process.h"
#include "io/files/encoded_text.h"
#include "io/files/free_memory.h"
#include "io/files/output.h"
#include "io/files/system.h"
#include "src/base/error.h"
#include "src/base/parse.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

constexpr const char* kPluginBuildFooter = R"(
The plugin works only with the version of FEBio it was compiled for, so you compile it for your FEBio. FEBIO_DIR is
FEBio's installation or SDK folder: the one with include and lib/cmake/FEBio, in it or in its folder sdk.
This needs cmake, a C++20 compiler and the libraries in packages.txt beside the source. It takes about a minute.

Standard output has the library's path and the line to put into febio.xml. Nothing is written into FEBio's folder unless -o
names it. docs/plugin.md has the next steps.

Examples:
  dea plugin-build /opt/febio
  dea plugin-build ~/FEBioStudio -o ~/FEBioStudio/lib -v)";

/// Empty: it cannot be read.
std::string text_of(const fs::path& path) { return whole_file(path.string(), 1).value_or(""); }

/// Where the plugin's source and the library are: installed beside this program, or the folder it was built in, which
/// has them to install.
struct Origins {
  fs::path source;  ///< share/febiodea/source of the installed program; empty: not installed
  fs::path build;   ///< the folder this program was built in
};

Origins find_origins() {
  std::error_code error;
  const fs::path program = own_path();
  const fs::path folder = program.parent_path().parent_path(), source = folder / "share" / "febiodea" / "source";
  if (fs::exists(source / "CMakeLists.txt", error)) return {source, {}};
  if (fs::exists(folder / "CMakeCache.txt", error)) return {{}, folder};
  throw InputError(fmt::format("{}: no source of the plugin, expected it in {}", program.string(), source.string()));
}

/// The folder with include/FECore and lib/cmake/FEBio.
fs::path sdk_folder(const std::string& febio) {
  std::error_code error;
  if (!fs::is_directory(febio, error))
    throw InputError(febio + (fs::exists(febio, error) ? ": found a file, expected the folder of FEBio or of its SDK"
                                                       : ": no such folder"));
  for (const fs::path& place : {fs::path(febio), fs::path(febio) / "sdk"})
    if (fs::exists(place / "lib" / "cmake" / "FEBio" / "FEBioConfig.cmake", error)) {
      if (!fs::exists(place / "include" / "FECore" / "version.h", error))
        throw InputError(fmt::format("{}: no include/FECore/version.h, so no SDK of FEBio", place.string()));
      return fs::canonical(place);
    }
  throw InputError(
      fmt::format("{}: no SDK of FEBio, expected lib/cmake/FEBio/FEBioConfig.cmake there or in sdk", febio));
}

/// A folder of ours among the temporary ones: build/ and log.txt. Left with the log alone when `keep_log` says so.
struct Workshop {
  fs::path path;
  bool keep_log = false;
  Workshop() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "febiodea_plugin_XXXXXX").string();
    if (error || !make_own_folder(name)) throw WriteError("a temporary folder: set TMPDIR to a folder that takes one");
    path = name;
  }
  ~Workshop() {
    std::error_code error;
    fs::remove_all(keep_log ? path / "build" : path, error);
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  std::string log_file() const { return (path / "log.txt").string(); }
};

/// Runs a program of the path with these words, no shell between. What it prints goes to the end of `log_file`, or to
/// standard error when that is empty. Throws Stopped, once it has ended with all that it started, if dea was asked to.
int run_program(const std::vector<std::string>& words, const std::string& log_file) {
  const int said = log_file.empty() ? kStandardError : open_file(log_file, OpenAs::Log);
  if (said < 0) throw WriteError(fmt::format("{}: the log of the build", log_file));
  const int nothing = open_file("/dev/null", OpenAs::Reading);
  const int child = start_program(words, {nothing < 0 ? 0 : nothing, said, said}, true);
  const int code = child < 0 ? kNotFound : wait_for(child, stop_flag());
  if (said != kStandardError) close_file(said);
  if (nothing >= 0) close_file(nothing);
  end_if_stopped(stop_flag());
  return code;
}

/// The first error in what cmake or the compiler printed, as one line; empty if there is none.
std::string first_error(const std::string& log) {
  std::istringstream lines(log);
  std::string fault;
  bool in_error = false;
  int paragraphs = 0;
  for (std::string line; std::getline(lines, line);) {
    if (in_error) {  // cmake's: indented paragraphs, of which the first may end in the middle of a sentence
      constexpr int kMost = 3;
      const std::string text = trimmed(line);
      if (!fault.empty() && !text.empty() && line[0] != ' ') return fault;
      if (!fault.empty() && text.empty() && (fault.back() == '.' || ++paragraphs == kMost)) return fault;
      fault += (fault.empty() || text.empty() ? "" : " ") + text;
    } else if (line.rfind("CMake Error", 0) == 0) {
      in_error = true;
      const std::size_t end = line.find("): ");
      if (line.rfind("CMake Error: ", 0) == 0) return trimmed(line.substr(13));
      if (end != line.npos) fault = trimmed(line.substr(end + 3));
    } else if (line.find(" error: ") != line.npos || line.find("ld: ") != line.npos) {
      return trimmed(line);
    }
  }
  return fault;
}

}  // namespace

CLI::App* add_plugin_build(CLI::App& app, PluginBuildArguments& a) {
  CLI::App* c = app.add_subcommand("plugin-build", "Compile the plugin for your FEBio");
  c->footer(kPluginBuildFooter);
  c->add_option("FEBIO_DIR", a.febio, "Folder of FEBio or of its SDK")->required()->type_name("");
  add_once(*c, "-o", a.output, "DIR", "Output", "Folder for the library [the current one]");
  add_overwrite_flag(*c, a.overwrite);
  c->add_flag("-v,--verbose", a.verbose, "What cmake and the compiler say, on standard error")->group("Output");
  c->add_flag("--untested", a.untested, "Compile also for a version of FEBio the plugin has not been tested with");
  add_once(*c, "--threads", a.threads, "N", "Computer", "Files to compile at a time [number of cores]");
  return c;
}

int plugin_build(const PluginBuildArguments& a) {
  need_programs("plugin-build");
  const int jobs = a.threads.empty() ? std::max(1, static_cast<int>(std::thread::hardware_concurrency()))
                                     : count_argument("threads", a.threads, 1, 1024);
  std::error_code error;
  const fs::path output = a.output.empty() ? fs::current_path(error) : fs::absolute(a.output, error).lexically_normal();
  const fs::path sdk = sdk_folder(a.febio);
  if (fs::exists(output, error) && !fs::is_directory(output, error))
    throw WriteError(fmt::format("{}: found a file, expected a folder: the library is named after FEBio's version",
                                 output.string()));
  if (!fs::is_directory(output, error)) throw WriteError(fmt::format("{}: there is no such folder", output.string()));
  if (!may_fill(output.string())) cannot_write(output.string(), errno);
  const Origins origins = find_origins();

  now_under_way(UnderWay::Search);
  Workshop workshop;
  const fs::path prefix = workshop.path / "build" / "installed";
  const fs::path source = origins.build.empty() ? origins.source : prefix / "share" / "febiodea" / "source";
  const std::string build = (workshop.path / "build").string(), log_file = a.verbose ? "" : workshop.log_file();
  log(fmt::format("dea plugin-build: compiling the plugin with the SDK in {}, about a minute", sdk.string()));
  const auto run = [&](const char* doing, const std::vector<std::string>& words) {
    const int code = run_program(words, log_file);
    if (code == 0) return;
    if (code == kNotFound)
      throw InputError(
          fmt::format("dea plugin-build: no program {} on the path; install it ({} lists all that is needed)", words[0],
                      (source / "packages.txt").string()));
    workshop.keep_log = !a.verbose;
    std::string fault = a.verbose ? "" : first_error(text_of(log_file));
    if (!fault.empty() && fault.back() == '.') fault.pop_back();
    throw InputError(fmt::format("dea plugin-build: {} failed{}{}; {}", doing, fault.empty() ? "" : ": ", fault,
                                 a.verbose ? "see above" : "all that was said is in " + log_file));
  };
  if (!origins.build.empty())
    for (const char* component : {"plugin_build", "plugin_source"})
      run("preparing",
          {"cmake", "--install", origins.build.string(), "--component", component, "--prefix", prefix.string()});
  std::vector<std::string> configure = {"cmake", "-S", source.string(), "-B", build, "-DCMAKE_BUILD_TYPE=Release"};
  configure.push_back("-DFEBio_DIR=" + (sdk / "lib" / "cmake" / "FEBio").string());
  if (a.untested) configure.push_back("-DDEA_UNTESTED_FEBIO=ON");
  if (run_program({"ninja", "--version"}, "/dev/null") == 0) configure.insert(configure.end(), {"-G", "Ninja"});
  run("configuring", configure);
  run("compiling", {"cmake", "--build", build, "--target", "febio_dea", "--parallel", std::to_string(jobs)});

  fs::path library;
  for (const auto& entry : fs::directory_iterator(fs::path(build) / "plugin", error)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("libfebio_dea-", 0) == 0) library = entry.path();
  }
  if (library.empty()) throw std::runtime_error("the build made no libfebio_dea");
  const std::string target = (output / library.filename()).string();
  if (!a.overwrite) refuse_to_replace({{"-o", target}});
  write_text(target, text_of(library));
  print(fmt::format("{}\n<import>{}</import>\n", target, escaped(target)));
  return kSolved;
}

}  // namespace dea
