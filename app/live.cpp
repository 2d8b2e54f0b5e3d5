// What a page calls from JavaScript: a joint that stays ready between answers.
#include <emscripten/emscripten.h>

#include <string>
#include <vector>

#include "app/command_line.h"
#include "app/commands.h"
#include "views/live/live_joint.h"

namespace dea {

namespace {

LiveJoint& live_joint() {
  static LiveJoint joint;
  return joint;
}
std::string& answer_text() {
  static std::string text;
  return text;
}
std::vector<float>& answer_pressure() {
  static std::vector<float> pressure;
  return pressure;
}

int answer(const std::vector<std::string>& words, bool quick, const std::string& from) {
  CLI::App app(kAbout, "dea");
  app.require_subcommand(1);
  RunArguments a;
  add_run(app, a);
  if (const std::optional<int> code = parse(app, words)) return *code;
  OutputSettings file;
  LiveRequest request;
  request.model = a.model;
  request.settings = effective_settings(a.settings, &file);
  OutputSettings typed = a.outputs;
  typed.states_given = "--states " + typed.states;
  request.outputs = over(typed, file);
  request.quick = quick;
  if (!from.empty()) request.from = Json::parse(from);
  LiveAnswer answer = live_answer(live_joint(), request);
  const bool solved = answer.text["solved"].get<bool>();
  answer_text() = json_text(answer.text);
  answer_pressure() = std::move(answer.pressure);
  return solved ? kSolved : kNoSolution;
}

}  // namespace

}  // namespace dea

extern "C" {

/// Solves what a line of `dea run` asks for. `words`: its words, the program's name first, each ended by a line feed.
/// `quick`, `from` (its text; empty: null): LiveRequest. Returns the exit code of `dea run`; a fault is a line of
/// standard error.
EMSCRIPTEN_KEEPALIVE int dea_live(const char* words, int quick, const char* from) {
  std::vector<std::string> list;
  std::string word;
  for (const char* c = words; *c != 0; ++c) {
    if (*c != '\n') {
      word += *c;
      continue;
    }
    list.push_back(word);
    word.clear();
  }
  dea::answer_text().clear();
  dea::answer_pressure().clear();
  return dea::run_program([&] { return dea::answer(list, quick != 0, from); });
}

/// Of the last call: the text of LiveAnswer, empty after a fault, and its pressures.
EMSCRIPTEN_KEEPALIVE const char* dea_live_text() { return dea::answer_text().c_str(); }
EMSCRIPTEN_KEEPALIVE const float* dea_live_pressure() { return dea::answer_pressure().data(); }
}
