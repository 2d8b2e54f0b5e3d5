#include "io/study/study_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "io/files/output.h"
#include "io/study/hdf5_file.h"
#include "io/study/open_study.h"
#include "io/study/study_file.h"
#include "src/base/numbers.h"
#include "src/equilibrium/search.h"

namespace dea {

namespace {

const std::vector<std::string> kSolvedWords = {"no", "yes"};
constexpr std::size_t kBlockValues = 1 << 16;  ///< of a variable, written at a time: half a megabyte of numbers

/// A column of a query, and the variable it becomes.
struct Column {
  std::string name;
  Hdf5Type type = Hdf5Type::Double;
  std::vector<std::string> words = {};  ///< what the numbers 0, 1, ... of a column of words stand for
};

/// A variable whose values come in the order of their cases. They are written a block of cases at a time, so that
/// memory does not grow with the cases. What is not given is `none`.
template <class T>
class Blocks {
 public:
  /// The first of `dimensions` is that of the cases.
  Blocks(const Hdf5File& file, const Hdf5Object& in, const std::string& name, Hdf5Type type,
         const std::vector<Hdf5Dimension>& dimensions, T none)
      : file_(file), none_(std::move(none)), cases_(dimensions.front().size) {
    for (std::size_t i = 1; i < dimensions.size(); ++i) of_case_ *= dimensions[i].size;
    block_ =
        std::clamp<std::size_t>(kBlockValues / std::max<std::size_t>(1, of_case_), 1, std::max<std::size_t>(1, cases_));
    variable_ = file.variable(in, name, type, dimensions, block_);
    values_.assign(count() * of_case_, none_);
  }

  /// Where the values of the case of index `of` begin.
  auto at(std::size_t of) {
    while (of >= begin_ + block_) write();
    return values_.begin() + static_cast<std::ptrdiff_t>((of - begin_) * of_case_);
  }

  void finish() {
    while (begin_ < cases_) write();
  }

  const Hdf5Variable& variable() const { return variable_; }

 private:
  std::size_t count() const { return std::min(block_, cases_ - begin_); }

  void write() {
    file_.write(variable_, begin_, count(), values_);
    begin_ += count();
    values_.assign(count() * of_case_, none_);
  }

  const Hdf5File& file_;
  T none_;
  Hdf5Variable variable_;
  std::vector<T> values_;
  std::size_t cases_, of_case_ = 1, block_ = 1, begin_ = 0;
};

/// Words as numbers.
Blocks<double> word_blocks(const Hdf5File& file, const Hdf5Object& in, const std::string& name,
                           const std::vector<Hdf5Dimension>& dimensions, const std::vector<std::string>& words) {
  Blocks<double> blocks(file, in, name, Hdf5Type::Word, dimensions, 0.0);
  file.words(blocks.variable(), words);
  return blocks;
}

/// What a query finds, as variables: its rows come in the order of their cases.
class Pass {
 public:
  Pass(const Hdf5File& file, const Hdf5Object& in, const std::vector<Hdf5Dimension>& dimensions,
       std::vector<Column> columns)
      : columns_(std::move(columns)) {
    for (const Column& c : columns_)
      if (c.type == Hdf5Type::Text)
        texts_.emplace_back(file, in, c.name, c.type, dimensions, "");
      else if (c.type == Hdf5Type::Word)
        numbers_.push_back(word_blocks(file, in, c.name, dimensions, c.words));
      else
        numbers_.emplace_back(file, in, c.name, c.type, dimensions, kNaN);
  }

  /// Of the case of index `of`, at `place` among what a case has; the values begin at column `first` of the row.
  void add(std::size_t of, std::size_t place, const Statement& row, int first) {
    const auto offset = static_cast<std::ptrdiff_t>(place);
    auto text = texts_.begin();
    auto number = numbers_.begin();
    int column = first;
    for (const Column& c : columns_) {
      if (c.type == Hdf5Type::Text)
        (text++)->at(of)[offset] = row.text(column);
      else
        (number++)->at(of)[offset] = c.type == Hdf5Type::Word ? number_of(c, row.text(column)) : row.number(column);
      ++column;
    }
  }

  void finish() {
    for (auto& blocks : texts_) blocks.finish();
    for (auto& blocks : numbers_) blocks.finish();
  }

 private:
  static double number_of(const Column& column, const std::string& word) {
    const auto found = std::find(column.words.begin(), column.words.end(), word);
    if (found == column.words.end())
      throw InputError(fmt::format("found {} = \"{}\" in a study, expected one of {}", column.name, word,
                                   fmt::join(column.words, ", ")));
    return static_cast<double>(found - column.words.begin());
  }

  std::vector<Column> columns_;
  std::vector<Blocks<std::string>> texts_;  // in the order of their columns
  std::vector<Blocks<double>> numbers_;
};

/// The file that is made, and what all of its parts share.
struct Columns {
  const Database& database;
  const Hdf5File& file;
  std::vector<std::int64_t> cases, states;  ///< their numbers, in ascending order
};

/// 0, 1, ...
std::vector<std::int64_t> counted(std::size_t count) {
  std::vector<std::int64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
  return numbers;
}

std::size_t index_of(const std::vector<std::int64_t>& cases, std::int64_t number) {
  return static_cast<std::size_t>(std::lower_bound(cases.begin(), cases.end(), number) - cases.begin());
}

std::vector<std::int64_t> integers(const Database& d, const std::string& sql) {
  std::vector<std::int64_t> all;
  for (Statement row(d, sql); row.step();) all.push_back(row.integer(0));
  return all;
}

/// The dimensions of the cases and of their states. Each group has its own, so that it can be read by itself.
std::vector<Hdf5Dimension> cases_and_states(const Columns& c, const Hdf5Object& in,
                                            const std::vector<std::int64_t>& cases) {
  return {c.file.dimension(in, "case", cases), c.file.dimension(in, "state", c.states)};
}

/// Of the study as a whole. What tells cases and states apart is named as coordinates, which xarray takes them for.
void write_head(const Columns& c, const std::vector<std::string>& factors) {
  const Database& d = c.database;
  const auto say = [&](const char* name, const std::string& text) { c.file.attribute(c.file.root(), name, text); };
  std::string coordinates = "model";
  for (const std::string& factor : factors) coordinates += " " + factor;
  say("schema", "dea.study-columns/1");
  for (Statement row(d, "SELECT value FROM study WHERE key = 'version'"); row.step();)
    say("program", "FEBioDEA " + row.text(0));
  for (Statement row(d, "SELECT value FROM study WHERE key = 'cases'"); row.step();)
    say("cases", fmt::format("{} of {} of the study", c.cases.size(), row.text(0)));
  std::string options;
  for (Statement row(d, "SELECT text FROM options ORDER BY number"); row.step();)
    options += (options.empty() ? "" : "\n") + row.text(0);
  say("options", options);
  say("coordinates", coordinates + " time solved");
}

void write_cases(const Columns& c, const Hdf5Dimension& of_case, const std::vector<std::string>& factors) {
  std::vector<Column> columns = {{"model", Hdf5Type::Text}};
  std::string names;
  for (const std::string& factor : factors) {
    const std::string name = quoted_name(factor);
    const auto words = integers(c.database, fmt::format("SELECT count(*) FROM cases WHERE typeof({}) = 'text'", name));
    columns.push_back({factor, words.front() > 0 ? Hdf5Type::Text : Hdf5Type::Double});
    names += "c." + name + ", ";
  }
  std::vector<std::string> outcomes;
  for (const auto o : {CaseResult::Outcome::Refused, CaseResult::Outcome::Failed, CaseResult::Outcome::Solved})
    outcomes.emplace_back(name(o));
  columns.push_back({"case_outcome", Hdf5Type::Word, outcomes});
  columns.push_back({"case_message", Hdf5Type::Text});
  columns.push_back({"codes", Hdf5Type::Text});
  columns.push_back({"seconds"});
  Pass pass(c.file, c.file.root(), {of_case}, columns);
  Statement row(c.database,
                fmt::format("SELECT c.case_id, m.path, {}c.case_outcome, c.case_message, (SELECT "
                            "replace(group_concat(DISTINCT w.code), ',', ' ') FROM warnings w WHERE w.case_id = "
                            "c.case_id), c.seconds FROM cases c JOIN models m USING (model_id) ORDER BY c.case_id",
                            names));
  while (row.step()) pass.add(index_of(c.cases, row.integer(0)), 0, row, 1);
  pass.finish();
}

void write_states(const Columns& c, const std::vector<Hdf5Dimension>& of_state) {
  std::vector<std::string> outcomes = {"none"};
  for (int o = 0; o <= static_cast<int>(kLastOutcome); ++o) outcomes.emplace_back(name(static_cast<Outcome>(o)));
  Pass pass(c.file, c.file.root(), of_state,
            {{"time"},
             {"outcome", Hdf5Type::Word, outcomes},
             {"solved", Hdf5Type::Word, kSolvedWords},
             {"message", Hdf5Type::Text},
             {"iterations"},
             {"residual_force"},
             {"residual_moment"}});
  Statement row(c.database,
                fmt::format("SELECT s.case_id, s.state, s.time, s.outcome, CASE WHEN {} THEN 'yes' ELSE 'no' END, "
                            "s.message, s.iterations, s.residual_force, s.residual_moment FROM states s ORDER BY 1, 2",
                            solved_condition("s")));
  while (row.step()) pass.add(index_of(c.cases, row.integer(0)), static_cast<std::size_t>(row.integer(1) - 1), row, 2);
  pass.finish();
}

/// A table with several rows per state: a group of its name, but for that of contacts, which is the root.
struct ItemTable {
  const char* table;
  const char* inside;                  ///< what its layers' inside is in; empty: nothing
  std::vector<std::string> ids;        ///< the columns of an item's numbers in its case
  std::vector<std::string> names;      ///< those of its names, the last one its own
  std::vector<std::string> says = {};  ///< more of the item
};
const std::vector<ItemTable> kItemTables = {{"statistics", "inside", {"contact_id"}, {"contact"}, {"source", "target"}},
                                            {"parts", "inside_parts", {"contact_id", "part_id"}, {"contact", "part"}},
                                            {"layers", "", {"layer_id"}, {"layer"}},
                                            {"soft_parts", "", {"soft_part_id"}, {"soft_part"}},
                                            {"poses", "", {"body_id"}, {"body"}}};

/// The columns of a table that hold numbers.
std::vector<std::string> number_names(const Database& d, const ItemTable& t, const std::string& table) {
  std::vector<std::string> names;
  const auto is_of = [](const std::string& name, const std::vector<std::string>& all) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  for (const std::string& name : column_names(d, "SELECT * FROM " + table))
    if (!is_of(name, {"case_id", "state"}) && !is_of(name, t.ids) && !is_of(name, t.names) && !is_of(name, t.says))
      names.push_back(name);
  return names;
}

bool has_rows(const Database& d, const std::string& table) {
  return !table.empty() &&
         integers(d, fmt::format("SELECT count(*) FROM (SELECT 1 FROM {} LIMIT 1)", table)).front() > 0;
}

/// The columns that tell items apart: their names, which models may have in different orders, and their numbers only
/// where a state has two of one name.
std::vector<std::string> key_columns(const Database& d, const ItemTable& t) {
  std::vector<std::string> keys = t.names;
  Statement twice(d, fmt::format("SELECT 1 FROM {} GROUP BY case_id, state, {} HAVING count(*) > 1 LIMIT 1", t.table,
                                 fmt::join(t.names, ", ")));
  if (twice.step()) keys.insert(keys.begin(), t.ids.begin(), t.ids.end());
  return keys;
}

/// The items of all cases by their keys: where each stands along `dimension`, which is made with what they are.
std::map<std::vector<std::string>, std::size_t> write_items(const Columns& c, const ItemTable& t,
                                                            const std::vector<std::string>& keys, const Hdf5Object& in,
                                                            Hdf5Dimension& dimension) {
  std::string says, order;
  for (const std::string& name : t.says)  // of several models: one a line
    says += fmt::format(
        ", replace(replace(group_concat(DISTINCT replace({}, ',', char(1))), ',', char(10)), char(1), ',')", name);
  for (const std::string& id : t.ids) order += fmt::format("{}min({})", order.empty() ? "" : ", ", id);
  std::vector<std::string> names = keys;
  names.insert(names.end(), t.says.begin(), t.says.end());
  std::map<std::vector<std::string>, std::size_t> items;
  std::vector<std::vector<std::string>> columns(names.size());
  Statement row(c.database, fmt::format("SELECT {0}{1} FROM {2} GROUP BY {0} ORDER BY {3}, {0}", fmt::join(keys, ", "),
                                        says, t.table, order));
  while (row.step()) {
    for (std::size_t i = 0; i < names.size(); ++i) columns[i].push_back(row.text(static_cast<int>(i)));
    std::vector<std::string> key;
    for (std::size_t i = 0; i < keys.size(); ++i) key.push_back(columns[i].back());
    items.insert({key, items.size()});
  }
  dimension = c.file.dimension(in, keys.back(), columns[keys.size() - 1]);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (i + 1 != keys.size())
      c.file.write(c.file.variable(in, names[i], Hdf5Type::Text, {dimension}, dimension.size), 0, dimension.size,
                   columns[i]);
  return items;
}

/// `dimensions`: the root's, of cases and states.
void write_item_table(const Columns& c, std::vector<Hdf5Dimension> dimensions, const ItemTable& t) {
  const Database& d = c.database;
  const bool root = t.table == std::string("statistics");
  if (!root && !has_rows(d, t.table)) return;
  const Hdf5Object in = root ? c.file.root() : c.file.group(c.file.root(), t.table);
  if (!root) dimensions = cases_and_states(c, in, c.cases);
  Hdf5Dimension of_item;
  const std::vector<std::string> keys = key_columns(d, t);
  const auto items = write_items(c, t, keys, in, of_item);
  std::vector<std::string> names = number_names(d, t, t.table);
  std::string from = t.table;
  if (has_rows(d, t.inside)) {
    from += fmt::format(" LEFT JOIN {} USING (case_id, state, {})", t.inside, fmt::join(t.ids, ", "));
    for (std::string& name : number_names(d, t, t.inside)) names.push_back(std::move(name));
  }
  std::string numbers;
  std::vector<Column> columns;
  for (const std::string& name : names) {
    numbers += ", " + quoted_name(name);
    columns.push_back({name});
  }
  dimensions.push_back(of_item);
  Pass pass(c.file, in, dimensions, columns);
  std::vector<std::string> key(keys.size());
  Statement row(d,
                fmt::format("SELECT case_id, state, {}{} FROM {} ORDER BY 1, 2", fmt::join(keys, ", "), numbers, from));
  while (row.step()) {
    for (std::size_t i = 0; i < key.size(); ++i) key[i] = row.text(static_cast<int>(i) + 2);
    const auto state = static_cast<std::size_t>(row.integer(1) - 1);
    pass.add(index_of(c.cases, row.integer(0)), state * of_item.size + items.at(key), row,
             static_cast<int>(key.size()) + 2);
  }
  pass.finish();
}

/// A surface with pressures at its vertices, and the cases that have it; those written a block at a time.
struct Sheet {
  std::int64_t model = 0;  ///< whose surface it is, of several that have the same
  std::string contact, source;
  std::vector<std::int64_t> cases = {};  ///< their numbers, in ascending order
  std::size_t vertices = 0;
  std::optional<Blocks<float>> pressure = {};  ///< from its first case to its last
  std::optional<Blocks<double>> solved = {};
  std::pair<std::int64_t, std::int64_t> last = {};  ///< case and state
};

void begin_sheet(const Columns& c, Sheet& s, const Hdf5Object& in) {
  Statement of(c.database,
               "SELECT surface, vertices, triangles FROM surfaces WHERE model_id = ? AND contact = ? AND source = ?");
  of.bind(s.model).bind(s.contact).bind(s.source).step();
  const std::vector<double> vertices = unpacked<double>(c.database, of.bytes(1));
  const std::vector<std::int32_t> triangles = unpacked<std::int32_t>(c.database, of.bytes(2));
  c.file.attribute(in, "contact", s.contact);
  c.file.attribute(in, "source", s.source);
  c.file.attribute(in, "surface", of.text(0));
  std::vector<Hdf5Dimension> dimensions = cases_and_states(c, in, s.cases);
  const Hdf5Dimension vertex = c.file.dimension(in, "vertex", counted(vertices.size() / 3)),
                      triangle = c.file.dimension(in, "triangle", counted(triangles.size() / 3)),
                      axis = c.file.dimension(in, "axis", std::vector<std::string>{"x", "y", "z"}),
                      corner = c.file.dimension(in, "corner", counted(3));
  dimensions.push_back(vertex);
  c.file.write(c.file.variable(in, "vertices", Hdf5Type::Double, {vertex, axis}, vertex.size), 0, vertex.size,
               vertices);
  c.file.write(c.file.variable(in, "triangles", Hdf5Type::Integer, {triangle, corner}, triangle.size), 0, triangle.size,
               std::vector<double>(triangles.begin(), triangles.end()));
  s.vertices = vertex.size;
  s.solved.emplace(word_blocks(c.file, in, "solved", {dimensions[0], dimensions[1]}, kSolvedWords));
  s.pressure.emplace(c.file, in, "pressure", Hdf5Type::Float, dimensions, static_cast<float>(kNaN));
}

/// A row's pressures, at `column`, and whether its state is a solution behind them.
void add_field(const Columns& c, Sheet& s, const Statement& row, int column) {
  const std::vector<float> pressure = unpacked<float>(c.database, row.bytes(column));
  if (pressure.size() != s.vertices)
    throw InputError(fmt::format("{}: found {} pressures of a surface of {} vertices (case {}), expected as many",
                                 c.database.path(), pressure.size(), s.vertices, row.integer(0)));
  const std::pair here(row.integer(0), row.integer(1));
  if (here == s.last)
    throw InputError(
        fmt::format("{}: found two contacts of the name \"{}\" with springs on \"{}\" (case {}), expected "
                    "other names: which of them a field is of cannot be told",
                    c.database.path(), s.contact, s.source, here.first));
  s.last = here;
  const std::size_t index = index_of(s.cases, here.first);
  const auto state = static_cast<std::ptrdiff_t>(here.second - 1);
  s.solved->at(index)[state] = row.number(column + 1);
  std::copy(pressure.begin(), pressure.end(), s.pressure->at(index) + state * static_cast<std::ptrdiff_t>(s.vertices));
}

/// Writes what is left, and gives its memory free.
void end_sheet(Sheet& s) {
  s.pressure->finish();
  s.solved->finish();
  s.pressure.reset();
  s.solved.reset();
}

void write_fields(const Columns& c) {
  if (!has_rows(c.database, "fields")) return;
  std::vector<Sheet> sheets;
  std::map<std::tuple<std::int64_t, std::string, std::string>, std::size_t> sheet_of;  // of a model's contact, source
  std::map<std::vector<std::string>, std::size_t> same;
  for (Statement row(c.database,
                     "SELECT model_id, contact, source, surface, vertices, triangles FROM surfaces ORDER BY 1, 2, 3");
       row.step();) {
    const Sheet s{row.integer(0), row.text(1), row.text(2)};
    const auto [found, is_new] = same.insert(
        {{s.contact, s.source, row.text(3), bytes_digest(row.bytes(4)), bytes_digest(row.bytes(5))}, sheets.size()});
    if (is_new) sheets.push_back(s);
    sheet_of[{s.model, s.contact, s.source}] = found->second;
  }
  const auto each_field = [&](const std::string& more, const auto& take) {
    Statement row(c.database,
                  fmt::format("SELECT f.case_id, f.state, c.model_id, t.contact, t.source{} FROM fields f JOIN cases c "
                              "USING (case_id) JOIN states s USING (case_id, state) JOIN statistics t USING (case_id, "
                              "state, contact_id) ORDER BY 1, 2",
                              more));
    while (row.step()) take(sheets[sheet_of.at({row.integer(2), row.text(3), row.text(4)})], row);
  };
  each_field("", [](Sheet& s, const Statement& row) {
    if (s.cases.empty() || s.cases.back() != row.integer(0)) s.cases.push_back(row.integer(0));
  });
  const Hdf5Object fields = c.file.group(c.file.root(), "fields");
  std::vector<Sheet*> of_case;  // those of the last row's case
  std::int64_t last = 0;
  const auto end_case = [&] {
    for (Sheet* s : of_case)
      if (s->cases.back() == last) end_sheet(*s);
    of_case.clear();
  };
  each_field(fmt::format(", f.pressure, {}", solved_condition("s")), [&](Sheet& s, const Statement& row) {
    if (row.integer(0) != last) end_case();
    last = row.integer(0);
    if (!s.pressure) begin_sheet(c, s, c.file.group(fields, fmt::format("surface_{}", &s - sheets.data() + 1)));
    if (std::find(of_case.begin(), of_case.end(), &s) == of_case.end()) of_case.push_back(&s);
    add_field(c, s, row, 5);
  });
  end_case();
}

void write_columns(const Database& d, const Hdf5File& file) {
  d.execute("BEGIN");  // one state of it, whoever adds to it
  std::vector<std::string> factors;
  for (Statement row(d, "SELECT name FROM factors ORDER BY number"); row.step();) factors.push_back(row.text(0));
  const auto last = static_cast<std::size_t>(integers(d, "SELECT coalesce(max(state), 0) FROM states").front());
  Columns c{d, file, integers(d, "SELECT case_id FROM cases ORDER BY 1"), counted(last + 1)};
  c.states.erase(c.states.begin());
  write_head(c, factors);
  const std::vector<Hdf5Dimension> dimensions = cases_and_states(c, file.root(), c.cases);
  write_cases(c, dimensions.front(), factors);
  write_states(c, dimensions);
  for (const ItemTable& t : kItemTables) write_item_table(c, dimensions, t);
  write_fields(c);
}

}  // namespace

void check_columns_possible() {}

void write_study_columns(const std::string& study, const std::string& path) {
  write_named_file(path, [&](const std::string& name) {
    reading(study, [&](const Database& d) {
      Hdf5File file(name, path);
      write_columns(d, file);
      file.close();
      return 0;
    });
  });
}

}  // namespace dea
