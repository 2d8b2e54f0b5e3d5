#include <pybind11/stl.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <utility>

#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/run/spring_memory.h"
#include "io/run/wanted_states.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "io/xplt/xplt.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/plain.h"
#include "python/views.h"
#include "python/work.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/equilibrium/times.h"
#include "src/rules/idle_loads.h"
#include "src/rules/rules.h"
#include "src/run/check.h"
#include "views/data/result_schema.h"
#include "views/data/run_json.h"
#include "views/text/info_text.h"

namespace dea::python {

namespace {

using namespace py::literals;

const SettingOption& option_of(const std::string& keyword) {
  std::vector<std::string> keywords;
  for (const SettingOption& option : setting_options()) {
    keywords.push_back(setting_keyword(option.name));
    if (keywords.back() == keyword) return option;
  }
  throw UsageError(Fault{
      .place = keyword,
      .found = fmt::format("found no setting of this name{},", did_you_mean(keyword, keywords, setting_aliases())),
      .expected = fmt::format("expected one of {}", name_list(keywords, keyword, keywords.size()))});
}

/// The rows of the table of settings, for febiodea/_settings.py and for help.
py::list options_of_python() {
  py::list all;
  for (const SettingOption& o : setting_options()) {
    all.append(py::dict("keyword"_a = setting_keyword(o.name), "key"_a = o.key,
                        "key_form"_a = o.key == nullptr ? std::string() : key_form(o), "value"_a = o.value,
                        "repeatable"_a = o.repeatable, "places"_a = o.places, "group"_a = o.group, "help"_a = o.help));
  }
  return all;
}

/// A table that Python gives: names of its columns, (rows, columns) numbers.
NumberTable numbers_of(const std::string& path, const std::vector<std::string>& names, const DoubleArray& numbers) {
  std::vector<std::vector<double>> rows;
  for (py::ssize_t r = 0; r < numbers.shape(0); ++r)
    rows.emplace_back(numbers.data(r, 0), numbers.data(r, 0) + numbers.shape(1));
  return make_table(path, names, rows);
}

/// And back.
py::tuple table_tuple(const NumberTable& table) {
  py::array_t<double> numbers({table.rows.size(), table.names.size()});
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    std::copy(table.rows[r].begin(), table.rows[r].end(), numbers.mutable_data(static_cast<py::ssize_t>(r), 0));
  return py::make_tuple(table.names, numbers);
}

using TableOfPython = std::pair<std::vector<std::string>, DoubleArray>;

/// `said` with a layer of values over it, and tables that these name.
SaidSettings laid_over(SaidSettings said, const SaidValues& values,
                       const std::map<std::string, TableOfPython>& tables) {
  said.settings = with_values(std::move(said.settings), values);
  said.layers.push_back(values);
  for (const auto& [path, table] : tables) said.tables[path] = numbers_of(path, table.first, table.second);
  return said;
}

SaidSettings file_settings(const std::string& file) {
  return {file.empty() ? Settings{} : read_settings_file(file).settings, file, {}, {}};
}

/// File, layers and tables: enough for `laid_over` to make them again.
py::tuple said_again(const SaidSettings& said) {
  py::dict tables;
  for (const auto& entry : said.tables) tables[text(entry.first)] = table_tuple(entry.second);
  return py::make_tuple(py::bytes(said.file), said.layers, tables);
}

std::vector<FileThen> files_now(const std::vector<std::string>& paths) {
  namespace fs = std::filesystem;
  std::vector<FileThen> files;
  for (const std::string& path : paths) {
    std::error_code error;
    const auto written = fs::last_write_time(path, error);
    if (error) continue;
    const std::chrono::nanoseconds since_1970 = std::chrono::file_clock::to_sys(written).time_since_epoch();
    files.push_back(
        {fs::absolute(path).string(), static_cast<std::int64_t>(fs::file_size(path, error)), since_1970.count()});
  }
  return files;
}

std::shared_ptr<ReadModel> read_model(const std::string& path) {
  return result_of([path](Work&) {
    const double start = seconds();
    const auto read = std::make_shared<ReadModel>();
    read->model = read_feb(path);
    read->files = files_now(read->model.files);
    read->seconds = seconds() - start;
    return read;
  });
}

std::shared_ptr<Recognised> recognise_model(const std::shared_ptr<const ReadModel>& read, const SaidSettings& said) {
  return result_of([read, said](Work&) {
    const auto r = std::make_shared<Recognised>();
    JointModel model = read->model;
    r->read = read;
    r->said = said;
    r->given = said.settings;
    settle_units(model, r->given);
    read_tables(model, r->given, said.tables);
    r->recognition = recognise(std::move(model), r->given);
    return r;
  });
}

std::string recognised_text(const std::shared_ptr<Recognised>& r) {
  return result_of(
      [r](Work&) { return printable(info_text(r->recognition.model, r->given, check_joint(r->recognition))); });
}

Json recognised_json(const std::shared_ptr<Recognised>& r) {
  return result_of([r](Work&) { return info_json(r->recognition.model, r->given, check_joint(r->recognition)); });
}

VtkCells cells_of(const JointModel& model) {
  VtkCells cells;
  for (const Domain& domain : model.domains) append_cells(cells, xplt_element_type(domain.shape), domain.nodes);
  return cells;
}

/// Everything an analysis tells goes to the thread that waits; springs of the states that are kept stay.
AnalysisOptions options_of(const States& states, Work& work, std::vector<std::vector<SpringStates>>& springs) {
  AnalysisOptions options;
  options.times = states.times;
  options.keep_state = states.wanted;
  options.equilibrium.stop = &work.stop;
  options.activity = [&work](const Activity& a) {
    const bool state = a.stage == Activity::Stage::State;
    work.tell({.stage = state                               ? "state"
                        : a.stage == Activity::Stage::Joint ? "joint"
                                                            : "springs",
               .state = state ? a.index + 1 : 0,
               .states = a.count,
               .iterations = a.search.iterations,
               .residual = a.search.residual});
  };
  options.progress = [&work, &states, &springs](const StateResult& s, std::size_t index, std::size_t count) {
    if (states.wanted.empty() || states.wanted[index]) springs.push_back(s.equilibrium.springs);
    work.tell({.stage = "state",
               .state = index + 1,
               .states = count,
               .iterations = s.equilibrium.iterations,
               .residual = s.equilibrium.history.empty() ? kNaN : s.equilibrium.history.back(),
               .outcome = name(s.equilibrium.outcome),
               .time = s.when.time});
  };
  return options;
}

std::shared_ptr<Analysed> analysed(const std::shared_ptr<const Recognised>& recognised, const OutputSettings& asked,
                                   const std::string& times_from, Work& work) {
  const double start = seconds();
  const Recognition& recognition = recognised->recognition;
  throw_if_any(recognition.faults);
  refuse_idle_loads(recognition);
  spring_cost_note(recognition, python_wording());
  const States states = wanted_states(recognition.model, recognition.settings, asked, times_from);
  const auto a = std::make_shared<Analysed>();
  a->recognised = recognised;
  AnalysisOptions how = options_of(states, work, a->springs);
  how.found_before = findings_of_states(recognition.model, asked, times_from, states);
  a->analysis = analyse(recognition, how);
  a->timings = {recognised->read->seconds, a->analysis.seconds_joint, a->analysis.seconds_solve, 0.0,
                recognised->read->seconds + recognition.seconds + seconds() - start};
  return a;
}

std::shared_ptr<Analysed> analyse_joint(const std::shared_ptr<Recognised>& recognised, const std::string& states,
                                        const std::string& times_from, const py::object& progress) {
  OutputSettings asked;
  asked.states = states;
  asked.states_given = python_wording()(NamedSetting{"states", "", states});
  return result_of(
      [recognised, asked, times_from](Work& work) { return analysed(recognised, asked, times_from, work); }, progress);
}

void bind_model(py::module_& m) {
  Class<ReadModel, std::shared_ptr<ReadModel>>(m, "Model",
                                               "A FEBio model that was read: what it says, no conclusions.\n\n"
                                               "Frame: global. Units: the model's own, throughout. Made by read_feb.")
      .value("files", "Its files as they were named: the model, then what it includes.",
             [](const ReadModel& r) { return r.model.files; })
      .value("version", "Of the format: \"4.0\".", [](const ReadModel& r) { return r.model.version; })
      .value("units", "FEBio's name of its system of units; \"\": it names none.",
             [](const ReadModel& r) { return r.model.units; })
      .value("points", "(nodes, 3) reference positions, the model's length.",
             [](const std::shared_ptr<ReadModel>& r) { return view_of(r->model.nodes, r); })
      .value("node_ids", "(nodes,) numbers of the nodes in the file.",
             [](const std::shared_ptr<ReadModel>& r) { return view_of(r->model.node_ids, r); })
      .value(
          "cells",
          "All elements one after the other as pyvista takes them: number of nodes, rows of `points` in VTK's order.",
          [](const ReadModel& r) { return kept(cells_of(r.model).cells); })
      .value("cell_types", "(elements,) VTK's number of each element's type.",
             [](const ReadModel& r) { return kept(cells_of(r.model).types); })
      .value("surfaces", "Names of its surfaces.", [](const ReadModel& r) { return names_of(r.model.surfaces); })
      .value("materials", "Names of its materials.", [](const ReadModel& r) { return names_of(r.model.materials); })
      .def("_files",
           [](const ReadModel& r) {
             py::list all;
             for (const FileThen& f : r.files) all.append(py::make_tuple(py::bytes(f.path), f.bytes, f.written));
             return all;
           })
      .def("__repr__", [](const ReadModel& r) {
        return text(fmt::format("<febiodea.Model {}: {} nodes, {} contacts>", r.model.files.front(),
                                r.model.nodes.size(), r.model.contacts.size()));
      });
}

void bind_recognition(py::module_& m) {
  Class<Recognised, std::shared_ptr<Recognised>>(
      m, "Recognition", "What joint a model was taken for. print() shows it as `dea info` does.\n\nMade by recognise.")
      .value("model", "The model it was made from.",
             [](const Recognised& r) { return std::const_pointer_cast<ReadModel>(r.read); })
      .value("bodies", "Names of the rigid bodies.",
             [](const Recognised& r) { return names_of(r.recognition.joint.bodies); })
      .value("contacts", "Names of the contacts.",
             [](const Recognised& r) { return names_of(r.recognition.joint.contacts); })
      .value("solvable", "No fault is known: it can be analysed.",
             [](const Recognised& r) { return r.recognition.recognised && r.recognition.faults.empty(); })
      .value("faults", "Why it cannot be analysed, as exceptions that were not raised; the most basic first.",
             [](const Recognised& r) { return faults_as_errors(r.recognition.faults); })
      .value("findings", "What was concluded, left out or is doubtful, a line each.",
             [](const Recognised& r) {
               return findings_list(r.recognition.recognised ? model_findings(r.recognition.model, r.recognition.joint)
                                                             : Findings{});
             })
      .value("settings", "All settings by their names in JSON, as they were used.",
             [](const Recognised& r) { return settings_json(r.recognition.settings); })
      .value("times", "Times of the model's states; about 1000 of them where there are very many.",
             [](const Recognised& r) {
               std::vector<double> times;
               for (const TimePoint& p : model_times(r.recognition.model, true)) times.push_back(p.time);
               return times;
             })
      .def("_said", [](const Recognised& r) { return said_again(r.said); })
      .def(
          "info", [](const std::shared_ptr<Recognised>& r) { return plain(recognised_json(r)); },
          "What `dea info --json` writes, as a dictionary.")
      .def("__str__", [](const std::shared_ptr<Recognised>& r) { return text(recognised_text(r)); })
      .def("__repr__", [](const Recognised& r) {
        const Joint& joint = r.recognition.joint;
        return text(fmt::format("<febiodea.Recognition of {}: {} bodies, {} contacts{}>",
                                r.recognition.model.files.front(), joint.bodies.size(), joint.contacts.size(),
                                r.recognition.faults.empty() ? "" : ", refused"));
      });
}

void bind_progress(py::module_& m) {
  Class<Progress>(m, "Progress", "What a callback `progress` is told while an analysis is under way.")
      .value("stage", "\"joint\", \"springs\" or \"state\".", &Progress::stage)
      .value("state", "Number of the state, from 1 on; 0: none yet.", &Progress::state)
      .value("states", "How many states there will be.", &Progress::states)
      .value("iterations", "Newton steps in this state.", &Progress::iterations)
      .value("residual", "Unbalanced over applied force; NaN: not known yet.", &Progress::residual)
      .value("outcome", "How a state ended; \"\": it is being solved.", &Progress::outcome)
      .value("time", "The model's time of a state that ended; else NaN.", &Progress::time);
}

}  // namespace

void refuse_idle_loads(const Recognition& r) {
  for (const IdleLoad& idle : idle_loads(r.model, r.joint, r.settings))
    if (idle.all)
      throw UsageError(Fault{.given = idle.given, .found = idle_in_words(idle) + ";", .expected = instead_of(idle)});
}

Settings with_values(Settings settings, const SaidValues& values) {
  std::vector<SettingValue> all;
  for (const auto& [keyword, key, value] : values) {
    const SettingOption& option = option_of(keyword);
    all.push_back({&option, key, value, python_wording()(NamedSetting{option.name, key, value})});
    if (!key.empty() && option.key == nullptr)
      throw UsageError(Fault{.place = keyword,
                             .found = fmt::format("found a value for \"{}\",", key),
                             .expected = "expected one value for the whole joint"});
    if (key.empty() && option.key != nullptr && option.per_surface == nullptr)
      throw UsageError(Fault{.place = all.back().where,
                             .found = fmt::format("found no {} that it is for,", option.key),
                             .expected = fmt::format("expected {}={{\"{}\": ...}}", keyword, key_form(option))});
  }
  lay_over(settings, all);
  return settings;
}

void bind_stages(py::module_& m) {
  bind_progress(m);
  bind_model(m);
  bind_recognition(m);
  Class<SaidSettings>(m, "NativeSettings")
      .def("as_dict", [](const SaidSettings& s) { return plain(settings_json(s.settings)); })
      .def("said", &said_again);
  m.def("setting_options", &options_of_python);
  m.def("schema", [](const std::string& name) { return plain(result_schema(name)); });
  m.def("file_settings", &file_settings);
  m.def("laid_over", &laid_over);
  m.def("read_feb", &read_model);
  m.def("recognise",
        [](const std::shared_ptr<ReadModel>& read, const SaidSettings& s) { return recognise_model(read, s); });
  m.def("analyse", &analyse_joint);
}

}  // namespace dea::python
