// `dea cite`: the paragraph for the methods of a paper.
#include <fmt/format.h>

#include "app/commands.h"
#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/run/spring_memory.h"
#include "io/tables/read_tables.h"
#include "io/xplt/xplt.h"
#include "src/base/error.h"
#include "views/text/methods_text.h"

namespace dea {

namespace {

constexpr const char* kCiteFooter = R"(
Prints what dea run does with this model and these options, as a paragraph for the methods of a paper, with version,
settings and references. Give the same options as to dea run. Nothing is solved: look in the table of dea run whether all
states are solved. A model that dea run refuses is refused here too.

Examples:
  dea cite hip.feb
  dea cite hip.feb --law linear --E 8 > methods.txt
  dea cite hip.feb --bibtex > references.bib
  dea cite hip.feb --compared hip.xplt    hip.xplt: FEBio's result, with which you compared)";

}  // namespace

CLI::App* add_cite(CLI::App& app, CiteArguments& a) {
  CLI::App* c =
      add_model_command(app, "cite", "Print a methods paragraph for a paper, with references", kCiteFooter, a);
  add_once(*c, "--compared", a.compared, "FEA.xplt", "Output",
           "Say that results were compared with this result of FEBio");
  c->add_flag("--bibtex", a.bibtex,
              "Print the program and the papers that the paragraph names, as BibTeX, instead of it")
      ->group("Output");
  add_solving_options(*c, a.settings, a.threads, {"squash"});
  return c;
}

int cite(const CiteArguments& a) {
  const auto threads = limit_threads(a.threads);
  Settings settings = effective_settings(a.settings);
  std::string febio;
  if (!a.compared.empty()) {
    febio = read_xplt(a.compared).software;
    if (febio.rfind("FEBio ", 0) != 0)
      throw InputError(fmt::format("{}: written by {}, expected a result of FEBio", a.compared,
                                   febio.empty() ? "a program that does not say its name" : febio));
  }
  JointModel read = read_feb(a.model);
  settle_units(read, settings);
  read_tables(read, settings);
  const Recognition recognition = recognise(std::move(read), settings);
  const JointCheck check = check_joint(recognition);
  throw_if_any(check.errors);
  print(methods_text(recognition.model, settings, check, febio, a.bibtex));
  return kSolved;
}

}  // namespace dea
