#include "views/study_page/study_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include "io/files/encoded_text.h"
#include "io/files/output.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/base/time_text.h"
#include "views/page/page.h"
#include "views/page/page_data.h"
#include "views/study_page/study_statistics.h"
#include "views/study_page/study_subjects.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostGroups = 60;
constexpr std::size_t kMostNumbers = 2'000'000;  ///< on the page: 8 MB before they are packed
constexpr std::size_t kMostLines = 300;          ///< over the cycle
constexpr std::size_t kMostLevels = 12;          ///< of a column whose levels have bands
constexpr double kBandLow = 0.05, kBandHigh = 0.95;
constexpr double kMostDraws = 3e8;  ///< rows that all bootstraps together may draw: some seconds

/// `get` of each statistic and place.
template <class Get>
Json of_all_places(const StudyNumbers& n, Get get) {
  Json all = Json::array();
  for (std::size_t s = 0; s < n.statistics.size(); ++s) {
    all.push_back(Json::array());
    for (std::size_t p = 0; p < n.places.size(); ++p) all.back().push_back(get(s, p));
  }
  return all;
}

/// `get` of the outputs of each statistic, place and choice, side by side on all cores.
template <class Get>
Json of_all_choices(const StudyNumbers& n, Get get) {
  const std::size_t P = n.places.size(), K = n.choices();
  std::vector<Json> found(n.statistics.size() * P * K);
  parallel_for(found.size(), [&](std::size_t i) { found[i] = get(n.outputs(i / (P * K), i / K % P, i % K)); });
  return of_all_places(n, [&](std::size_t s, std::size_t p) {
    Json choices = Json::array();
    for (std::size_t k = 0; k < K; ++k) choices.push_back(std::move(found[(s * P + p) * K + k]));
    return choices;
  });
}

/// Numbers in a message differ from case to case; what is left is its kind.
std::string kind_of(const std::string& message) {
  const auto digit = [&](std::size_t i) {
    return i < message.size() && std::isdigit(static_cast<unsigned char>(message[i])) != 0;
  };
  std::string kind;
  for (std::size_t i = 0; i < message.size(); ++i) {
    if (!digit(i)) {
      kind += message[i];
      continue;
    }
    while (digit(i + 1) || (digit(i + 2) && (message[i + 1] == '.' || message[i + 1] == 'e'))) ++i;
    kind += '#';
  }
  return kind;
}

/// "3, 7-9 and 12 more" of case numbers that rise.
std::string case_ranges(const std::vector<std::size_t>& numbers) {
  constexpr std::size_t kMost = 12;
  std::string text;
  std::size_t ranges = 0, i = 0;
  while (i < numbers.size() && ranges < kMost) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += text.empty() ? "" : ", ";
    text += last == i ? fmt::format("{}", numbers[i]) : fmt::format("{}–{}", numbers[i], numbers[last]);
    i = last + 1;
    ++ranges;
  }
  if (i < numbers.size()) text += fmt::format(" and {} more", numbers.size() - i);
  return text;
}

/// What was told of cases, by kind, the most frequent first.
class Reasons {
 public:
  void add(const std::string& kind, const std::string& text, std::size_t number) {
    Reason& r = reasons_[kind];
    if (r.cases.empty()) r.text = text;
    ++r.count;
    if (r.cases.empty() || r.cases.back() != number) r.cases.push_back(number);
  }
  Json json() const {
    std::vector<const Reason*> order;
    for (const auto& [kind, reason] : reasons_) order.push_back(&reason);
    std::stable_sort(order.begin(), order.end(), [](const Reason* a, const Reason* b) { return a->count > b->count; });
    return list_json(order, [](const Reason* r) -> Json {
      return {{"text", r->text}, {"count", r->count}, {"cases", r->cases.size()}, {"which", case_ranges(r->cases)}};
    });
  }

 private:
  struct Reason {
    std::string text;
    std::size_t count = 0;
    std::vector<std::size_t> cases;
  };
  std::map<std::string, Reason> reasons_;
};

/// The cases whose numbers are on the page: all, or some of too many (thinned_cases).
struct ShownCases {
  std::vector<std::size_t> cases;  ///< indices in StudyNumbers::cases, rising
  std::vector<int> place;          ///< per case: its place in `cases`; -1: not shown
  bool all = true;
};
ShownCases shown_cases(const StudyNumbers& n) {
  const std::size_t each = n.statistics.size() * n.places.size() * n.choices();
  const std::vector<char> kept =
      thinned_cases(n, std::vector<char>(n.cases.size(), 1), [&](const std::vector<char>& some) {
        return static_cast<std::size_t>(std::count(some.begin(), some.end(), 1)) * each <= kMostNumbers;
      });
  ShownCases shown;
  shown.place.assign(n.cases.size(), -1);
  for (std::size_t c = 0; c < n.cases.size(); ++c) {
    if (kept[c] == 0) continue;
    shown.place[c] = static_cast<int>(shown.cases.size());
    shown.cases.push_back(c);
  }
  shown.all = shown.cases.size() == n.cases.size();
  return shown;
}

Json column_json(const StudyColumn& c, const ShownCases& shown, PageArrays& arrays) {
  std::vector<std::int32_t> level;
  for (std::size_t i : shown.cases) level.push_back(c.level[i]);
  return {{"name", c.name},
          {"numeric", c.numeric},
          {"dimension", c.dimension},
          {"levels", c.levels},
          {"level", arrays.add(pack_integers(level))},
          {"of", c.of.empty() ? Json(nullptr) : Json(c.of)}};
}

std::string choice_title(const StudyNumbers& n, std::size_t k) {
  if (k == n.states) return "largest of all states";
  return n.same_times && k < n.times.size() ? fmt::format("time {}", time_text(n.times[k]))
                                            : fmt::format("state {}", k + 1);
}

Json band_json(const CycleBand& b) {
  const auto numbers = [](const std::vector<double>& v) { return list_json(v, short_number); };
  return {{"count", b.count},
          {"mean", numbers(b.mean)},
          {"sd", numbers(b.standard_deviation)},
          {"median", numbers(b.median)},
          {"low", numbers(b.low)},
          {"high", numbers(b.high)}};
}

/// All cases, then each level of each column with few.
struct BandGroup {
  int column = -1, level = -1;
  std::vector<std::size_t> cases;
};
std::vector<BandGroup> band_groups(const StudyNumbers& n) {
  std::vector<BandGroup> groups(1);
  for (std::size_t c = 0; c < n.cases.size(); ++c) groups[0].cases.push_back(c);
  for (std::size_t k = 0; k < n.columns.size(); ++k) {
    const StudyColumn& column = n.columns[k];
    if (column.levels.size() > kMostLevels) continue;
    int level = 0;
    for (std::vector<std::size_t>& cases : column.cases())
      groups.push_back({static_cast<int>(k), level++, std::move(cases)});
  }
  return groups;
}

/// What the study is: file, options, models, factors, counts.
Json study_head_json(const StudyNumbers& n) {
  const StudyHead& h = n.head;
  const ShardCases shard = shard_cases(h.planned, h.identity.shard, h.identity.shards);
  std::size_t outcomes[3] = {0, 0, 0};
  for (const StudyCase& c : n.cases) ++outcomes[static_cast<int>(c.outcome)];
  Json j;
  j["file"] = fs::path(h.path).filename().string();
  j["version"] = h.identity.version;
  j["planned"] = shard.last - shard.first;
  j["whole"] = h.planned;
  j["shard"] = {h.identity.shard, h.identity.shards};
  j["there"] = n.cases.size();
  j["solved"] = outcomes[0];
  j["failed"] = outcomes[1];
  j["refused"] = outcomes[2];
  j["options"] = h.identity.options;
  j["inputs"] = list_json(h.identity.inputs, [](const auto& i) -> Json { return {i[0], i[1]}; });
  j["models"] = h.models;
  j["factors"] = list_json(h.factors, [](const Factor& f) -> Json {
    const bool drawn = f.spread.kind != Spread::Kind::None;
    return {{"name", f.name},
            {"option", f.option},
            {"text", f.before + "{}" + f.after},
            {"spread", drawn ? fmt::format("{}({},{})", kSpreadWords[static_cast<std::size_t>(f.spread.kind)],
                                           f.spread.a, f.spread.b)
                             : std::string()}};
  });
  j["states"] = n.states;
  j["times"] = list_json(n.times, [](double t) { return json_number(time_meant(t)); });
  j["same_times"] = n.same_times;
  double seconds = 0.0;
  for (const StudyCase& c : n.cases) seconds += c.seconds;
  j["seconds"] = short_number(seconds);
  return j;
}

/// Cases and states that are no solution, by their reason; warnings by their text.
Json failures_json(const StudyNumbers& n, const std::vector<StudyWarning>& warnings) {
  constexpr std::size_t kMostRows = 500;
  Reasons reasons, states, warned;
  Json rows = Json::array();
  std::size_t count = 0;
  for (std::size_t i = 0; i < n.cases.size(); ++i) {
    const StudyCase& c = n.cases[i];
    if (c.outcome == CaseResult::Outcome::Solved) continue;
    const std::string reason = fmt::format("{}: {}", name(c.outcome), c.message);
    reasons.add(kind_of(reason), reason, c.number);
    if (++count > kMostRows) continue;
    Json row = {c.number, name(c.outcome)};
    for (const StudyColumn& column : n.columns) row.push_back(column.levels[at(column.level[i])]);
    row.push_back(c.message);
    rows.push_back(std::move(row));
  }
  for (const StudyState& s : n.unsolved) states.add(s.outcome, s.outcome, static_cast<std::size_t>(s.case_id));
  for (const StudyWarning& w : warnings)
    warned.add(fmt::format("{}\n{}\n{}\n{}", w.code, w.contact, w.surface, w.body), w.text,
               static_cast<std::size_t>(w.case_id));
  Json j;
  j["cases"] = count;
  j["reasons"] = reasons.json();
  j["rows"] = std::move(rows);
  j["headings"] = Json::array({"case", "outcome"});
  for (const StudyColumn& column : n.columns) j["headings"].push_back(column.name);
  j["headings"].push_back("why");
  j["states"] = n.unsolved.size();
  j["outcomes"] = states.json();
  j["warnings"] = warned.json();
  return j;
}

/// Columns, places, choices, and the numbers of the shown cases.
void add_numbers(const StudyNumbers& n, const ShownCases& shown, Json& j, PageArrays& arrays) {
  j["grid"] = n.grid;
  j["all"] = shown.all;
  j["columns"] = list_json(n.columns, [&](const StudyColumn& c) { return column_json(c, shown, arrays); });
  j["constant"] = list_json(n.constant, [](const StudyColumn& c) -> Json {
    return {{"name", c.name}, {"value", c.levels.front()}};
  });
  std::vector<std::int32_t> numbers, outcomes;
  for (std::size_t c : shown.cases) {
    numbers.push_back(static_cast<std::int32_t>(n.cases[c].number));
    outcomes.push_back(static_cast<std::int32_t>(n.cases[c].outcome));
  }
  j["cases"] = {{"number", arrays.add(pack_integers(numbers))}, {"outcome", arrays.add(pack_integers(outcomes))}};
  j["statistics"] = list_json(n.statistics, [](const StudyStatistic& s) -> Json {
    return {{"name", s.name}, {"title", s.title}, {"quantity", s.quantity}, {"dimension", s.dimension}};
  });
  j["places"] = list_json(n.places, [](const StudyPlace& p) -> Json {
    return {
        {"contact", p.contact}, {"part", p.part}, {"title", p.part.empty() ? p.contact : p.contact + ": " + p.part}};
  });
  j["choices"] = Json::array();
  for (std::size_t k = 0; k < n.choices(); ++k) j["choices"].push_back(choice_title(n, k));
  j["values"] = of_all_places(n, [&](std::size_t s, std::size_t p) {
    std::vector<float> floats;
    for (std::size_t c : shown.cases)
      for (std::size_t k = 0; k < n.choices(); ++k) floats.push_back(static_cast<float>(n.value(s, p, c, k)));
    return arrays.add(pack_floats(floats));
  });
}

/// Lines of some cases over the cycle, bands of all, and of the levels of each column with few.
Json bands_json(const StudyNumbers& n, const ShownCases& shown, PageArrays& arrays) {
  const StudyInstants at_these = study_instants(n);
  if (at_these.instants.empty()) return nullptr;
  Json j;
  j["percent"] = at_these.percent;
  j["instants"] = list_json(at_these.instants, [](double t) { return json_number(time_meant(t)); });
  j["low"] = kBandLow;
  j["high"] = kBandHigh;
  std::vector<std::size_t> drawn;
  const std::size_t every = (shown.cases.size() + kMostLines - 1) / kMostLines;
  std::vector<std::int32_t> places;
  for (std::size_t i = 0; i < shown.cases.size(); i += every) {
    drawn.push_back(shown.cases[i]);
    places.push_back(static_cast<std::int32_t>(i));
  }
  j["drawn"] = arrays.add(pack_integers(places));
  j["all"] = drawn.size() == n.cases.size();
  j["lines"] = of_all_places(n, [&](std::size_t s, std::size_t p) {
    std::vector<float> floats;
    for (const std::vector<double>& line : study_lines(n, at_these, s, p, drawn))
      floats.insert(floats.end(), line.begin(), line.end());
    return arrays.add(pack_floats(floats));
  });
  j["groups"] = list_json(band_groups(n), [&](const BandGroup& g) -> Json {
    const auto bands = [&](std::size_t s, std::size_t p) {
      return band_json(cycle_band(study_lines(n, at_these, s, p, g.cases), kBandLow, kBandHigh));
    };
    return {{"column", g.column}, {"level", g.level}, {"cases", g.cases.size()}, {"bands", of_all_places(n, bands)}};
  });
  return j;
}

Json influence_json(const StudyNumbers& n) {
  const StudyDesign design = study_design(n);
  if (design.numeric.empty()) return nullptr;
  Bootstrap bootstrap;
  const double rows = static_cast<double>(n.head.planned) / (design.saltelli + 2.0) * design.saltelli *
                      static_cast<double>(n.statistics.size() * n.places.size() * n.choices());
  if (design.saltelli > 0)
    bootstrap.resamples = static_cast<int>(std::clamp(kMostDraws / std::max(rows, 1.0), 100.0, 1000.0));
  Json j;
  j["no_sobol"] = design.no_sobol;
  j["no_slopes"] = design.no_slopes;
  j["base"] = design.base < 0 ? Json(nullptr) : Json(n.cases[at(design.base)].number);
  j["resamples"] = bootstrap.resamples;
  j["numbers"] = of_all_choices(
      n, [&](const std::vector<double>& outputs) { return influence_json(n, design, outputs, bootstrap); });
  return j;
}

/// null: not asked for.
Json groups_json(const StudyNumbers& n, int column) {
  if (column < 0) return nullptr;
  Json j;
  j["column"] = column;
  j["numbers"] = of_all_choices(
      n, [&](const std::vector<double>& outputs) { return group_json(n, n.columns[at(column)], outputs); });
  return j;
}

Json pairs_json(const StudyNumbers& n, const StudyPairs& pairs, const ShownCases& shown) {
  if (pairs.column < 0) return nullptr;
  Json j;
  j["column"] = pairs.column;
  j["first"] = pairs.first;
  j["second"] = pairs.second;
  j["alone"] = pairs.alone;
  j["cases"] = Json::array();
  for (const std::array<int, 2>& pair : pairs.cases)
    if (shown.place[at(pair[0])] >= 0 && shown.place[at(pair[1])] >= 0)
      j["cases"].push_back({shown.place[at(pair[0])], shown.place[at(pair[1])]});
  j["numbers"] = of_all_choices(n, [&](const std::vector<double>& outputs) { return pair_json(pairs, outputs); });
  return j;
}

/// Of options, inputs, messages: names of files, not where they were; of models as much as tells them apart.
void hide_folders(StudyNumbers& n, std::vector<StudyWarning>& warnings) {
  const std::vector<std::string> models = n.head.models, names = short_names(models);
  std::vector<std::string> others;
  for (const auto& input : n.head.identity.inputs)
    if (std::find(models.begin(), models.end(), input[0]) == models.end()) others.push_back(input[0]);
  const auto hide = [&](std::string& text) {
    if (text.empty()) return;
    for (std::size_t i = 0; i < models.size(); ++i)
      if (names[i] != models[i]) replace_all(text, models[i], names[i]);
    text = without_folders(text, others);
  };
  for (std::string& option : n.head.identity.options) hide(option);
  for (StudyCase& c : n.cases) hide(c.message);
  for (StudyWarning& w : warnings) hide(w.text);
  for (auto& input : n.head.identity.inputs) hide(input[0]);
  n.head.models = names;
}

int group_column(const StudyNumbers& n, const StudyPageOptions& o) {
  if (o.group.empty()) return -1;
  const int column = study_column(n, o.names.group, o.group);
  const std::size_t levels = n.columns[at(column)].levels.size();
  if (levels > kMostGroups)
    throw UsageError(fmt::format("{} {}: found {} different values, expected groups, {} at most", o.names.group,
                                 o.group, levels, kMostGroups));
  return column;
}

/// Maps and all that comes of stored pressures; regions are places by now.
void add_maps(const std::string& study, const StudyNumbers& n, const StudyFields& fields, const StudyPageOptions& o,
              int group, Json& page, PageArrays& arrays, std::vector<std::string>& notes) {
  Json meshes = Json::array();
  page["maps"] = maps_json(study, n, fields, o.maps, notes, meshes, arrays);
  page["means"] = page["maps"].is_null()
                      ? Json(nullptr)
                      : mean_maps_json(study, n, fields, group, o.maps.regions.up.value_or(Vector3d::Zero()), notes,
                                       meshes, arrays);
  page["meshes"] = std::move(meshes);
}

void require_fields(const StudyFields& fields, const StudyPageOptions& o) {
  if (!fields.fields.empty()) return;
  const char* what = o.maps.dose_above ? "a dose" : o.maps.regions.any() ? "regions" : nullptr;
  if (what != nullptr)
    throw UsageError(
        fmt::format("{}: found no stored pressures in the study, expected one that was solved with "
                    "pressures at nodes kept (fields)",
                    what));
}

}  // namespace

StudyNumbers study_numbers_with(const std::string& study, const std::optional<CaseTable>& subjects) {
  StudyNumbers n = read_study_numbers(study);
  if (subjects) add_subjects(*subjects, n);
  return n;
}

std::vector<std::string> write_study_page(const std::string& path, const std::string& study,
                                          const StudyPageOptions& o) {
  std::vector<std::string> notes;
  StudyNumbers n = study_numbers_with(study, o.subjects);
  std::vector<StudyWarning> warnings = read_warnings(study);
  const int group = group_column(n, o);
  const StudyPairs pairs =
      o.pair.empty() ? StudyPairs{} : study_pairs(n, o.names.pair, o.pair, o.names.pair_by, o.pair_by);
  check_dose(n, o.maps, o.names.cycle_seconds);
  const StudyFields fields = study_fields(study, n);
  require_fields(fields, o);
  if (o.maps.regions.any()) add_regions(study, fields, o.maps.regions, n);
  hide_folders(n, warnings);
  const ShownCases shown = shown_cases(n);
  if (!shown.all)
    notes.push_back(fmt::format("figures and tables show {} of {} cases; statistics are of all", shown.cases.size(),
                                n.cases.size()));
  PageArrays arrays;
  Json page;
  page["schema"] = "dea.report/1";
  page["kind"] = "study";
  page["title"] = fs::path(study).stem().string();
  page["command"] = command_text(o.words, {study, path, o.subjects ? o.subjects->path : std::string()});
  page["subjects"] = o.subjects ? Json(without_folders(o.subjects->path, {o.subjects->path})) : Json(nullptr);
  page["contacts"] = list_json(read_contacts(study), [](const StudyContact& c) -> Json {
    return {c.contact, c.source, c.target};
  });
  add_page_head(n.units, page);
  page["time_name"] = n.time_name;
  page["study"] = study_head_json(n);
  page["failures"] = failures_json(n, warnings);
  add_numbers(n, shown, page, arrays);
  page["headline"] = headline_words();
  page["summary"] = of_all_choices(n, [](const std::vector<double>& of_cases) { return box_json(box_plot(of_cases)); });
  page["bands"] = bands_json(n, shown, arrays);
  page["influence"] = influence_json(n);
  page["groups"] = groups_json(n, group);
  page["pairs"] = pairs_json(n, pairs, shown);
  if (pairs.column >= 0 && !o.pair_by.empty()) page["pairs"]["by"] = o.pair_by;
  add_maps(study, n, fields, o, group, page, arrays, notes);
  page["notes"] = notes;
  const std::string main = fmt::format("{}\n{}\n{}", page::study_figures(), page::study_maps(), page::study_main());
  write_text(path, page_text(page["title"].get<std::string>(), page, arrays, page::study_style(), main));
  return notes;
}

}  // namespace dea
