#include "io/study/study_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <filesystem>
#include <fstream>

#include "io/files/output.h"
#include "io/files/packed_bytes.h"
#include "io/settings/setting_words.h"
#include "io/study/database.h"
#include "io/study/study_schema.h"
#include "src/rules/rules.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/rotations.h"
#include "src/results/contact_numbers.h"

namespace dea {

namespace fs = std::filesystem;

namespace {

constexpr double kBatch = 0.5;          ///< between two times of writing [s]
constexpr double kLongestPause = 10.0;  ///< the same on slow disks [s]
constexpr int kWait = 100;              ///< for who reads the file; then the batch grows [ms]
constexpr double kLongestWait = 600.0;  ///< after which that is a fault [s]
static_assert(std::endian::native == std::endian::little, "blobs are little endian");

std::int64_t whole(std::size_t n) { return static_cast<std::int64_t>(n); }

/// An array's bytes as a zlib stream.
template <class T>
std::string packed(const std::vector<T>& values) {
  return packed_bytes({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

/// NAME in "INSERT INTO NAME VALUES (?, ?, ...)".
std::string insert_sql(const char* table, std::size_t columns, const char* what = "INSERT") {
  std::string marks = "?";
  for (std::size_t i = 1; i < columns; ++i) marks += ",?";
  return fmt::format("{} INTO {} VALUES ({})", what, table, marks);
}

void bind_text_or_null(Statement& to, const std::string& text) {
  if (text.empty())
    to.bind_null();
  else
    to.bind(text);
}

template <class Of>
void bind_numbers(Statement& to, const std::vector<NamedNumber<Of>>& numbers, const Of& of) {
  for (const NamedNumber<Of>& n : numbers) {
    if (n.count)
      to.bind(static_cast<std::int64_t>(n.value(of)));
    else
      to.bind(n.value(of));
  }
}

/// Its numbers as JSON: {"across":2.1,"size":0.7}.
std::string numbers_of(const Finding& finding) {
  std::string text;
  for (const NamedValue& v : finding.values)
    if (const double* number = std::get_if<double>(&v.value.is); number != nullptr && std::isfinite(*number))
      text += fmt::format("{}\"{}\":{}", text.empty() ? "" : ",", v.name, *number);
  return "{" + text + "}";
}

void bind_finding(Statement& to, const Finding& finding) {
  to.bind(finding.code).bind(std::string(name(severity(finding))));
  for (const std::string& of : {finding.subject.contact, finding.subject.surface, finding.subject.body})
    bind_text_or_null(to, of);
  to.bind(finding.subject.time.value_or(kNaN)).bind(numbers_of(finding)).bind(worded(finding, command_line_wording()));
}

void bind_vector(Statement& to, const Vector3d& v) { to.bind(v.x()).bind(v.y()).bind(v.z()); }

}  // namespace

/// All that is inserted, prepared once.
struct StudyInserts {
  Statement remove, one, warning, state, statistics, part, inside, inside_part, pose, surface, field;
  StudyInserts(const Database& d, std::size_t factors)
      : remove(d, "DELETE FROM cases WHERE case_id = ?"),
        one(d, insert_sql("cases", 5 + factors)),
        warning(d, insert_sql("warnings", 10)),
        state(d, insert_sql("states", 8)),
        statistics(d, insert_sql("statistics", 6 + contact_numbers().size())),
        part(d, insert_sql("parts", 6 + compartment_numbers().size())),
        inside(d, insert_sql("inside", 3 + inside_numbers().size())),
        inside_part(d, insert_sql("inside_parts", 4 + compartment_inside_numbers().size())),
        pose(d, insert_sql("poses", 16)),
        surface(d, insert_sql("surfaces", 6, "INSERT OR IGNORE")),
        field(d, insert_sql("fields", 4)) {}
};

namespace {

using Inserts = StudyInserts;

void insert_contact(Inserts& in, std::int64_t number, std::int64_t s, std::int64_t id, const CaseContact& contact,
                    const ContactStatistics& statistics) {
  in.statistics.bind(number).bind(s).bind(id).bind(contact.name).bind(contact.source).bind(contact.target);
  bind_numbers(in.statistics, contact_numbers(), statistics);
  in.statistics.run();
  if (statistics.inside[0] || statistics.inside[1]) {
    in.inside.bind(number).bind(s).bind(id);
    bind_numbers(in.inside, inside_numbers(), statistics);
    in.inside.run();
  }
  for (std::size_t p = 0; p < statistics.compartments.size(); ++p) {
    in.part.bind(number).bind(s).bind(id).bind(whole(p + 1)).bind(contact.name).bind(contact.parts[p]);
    bind_numbers(in.part, compartment_numbers(), statistics.compartments[p]);
    in.part.run();
    if (!statistics.compartments[p].inside) continue;
    in.inside_part.bind(number).bind(s).bind(id).bind(whole(p + 1));
    bind_numbers(in.inside_part, compartment_inside_numbers(), statistics.compartments[p]);
    in.inside_part.run();
  }
}

void insert_state(Inserts& in, std::int64_t number, std::int64_t s, const CaseResult& result, const CaseState& state) {
  in.state.bind(number).bind(s).bind(state.time).bind(std::string(name(state.outcome)));
  bind_text_or_null(in.state, state.message);
  in.state.bind(std::int64_t{state.iterations}).bind(state.residual_force).bind(state.residual_moment).run();
  for (std::size_t c = 0; c < state.statistics.size(); ++c)
    insert_contact(in, number, s, whole(c + 1), result.contacts[c], state.statistics[c]);
  for (std::size_t b = 0; b < state.poses.size(); ++b) {
    in.pose.bind(number).bind(s).bind(whole(b + 1)).bind(result.bodies[b]);
    bind_vector(in.pose, state.poses[b].center);
    bind_vector(in.pose, rotation_vector(state.poses[b].rotation));
    const Vector6 reaction = b < state.reactions.size() ? state.reactions[b] : Vector6::Constant(kNaN);
    bind_vector(in.pose, reaction.head<3>());
    bind_vector(in.pose, reaction.tail<3>());
    in.pose.run();
  }
  for (std::size_t c = 0; c < state.fields.size(); ++c)
    in.field.bind(number).bind(s).bind(whole(c + 1)).bind_bytes(packed(state.fields[c].pressure)).run();
}

void insert_surfaces(Inserts& in, int model, const CaseResult& result) {
  for (std::size_t c = 0; c < result.surfaces.size(); ++c) {
    const CaseSurface& surface = result.surfaces[c];
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
    for (const Vector3d& v : surface.vertices) vertices.insert(vertices.end(), v.data(), v.data() + 3);
    for (const std::array<int, 3>& t : surface.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
    in.surface.bind(std::int64_t{model + 1}).bind(result.contacts[c].name).bind(result.contacts[c].source);
    in.surface.bind(surface.name).bind_bytes(packed(vertices)).bind_bytes(packed(triangles)).run();
  }
}

void insert_case(Inserts& in, const Plan& plan, const CaseResult& result) {
  const PlannedCase& planned = plan.cases[result.number - 1];
  const std::int64_t number = whole(result.number);
  in.one.bind(number).bind(std::int64_t{planned.model + 1}).bind(std::string(name(result.outcome)));
  bind_text_or_null(in.one, result.message);
  in.one.bind(result.seconds);
  for (const std::string& value : planned.values) in.one.bind(value);
  in.one.run();
  for (std::size_t i = 0; i < result.warnings.size(); ++i) {
    bind_finding(in.warning.bind(number).bind(whole(i + 1)), result.warnings[i]);
    in.warning.run();
  }
  for (std::size_t s = 0; s < result.states.size(); ++s)
    insert_state(in, number, whole(s + 1), result, result.states[s]);
  insert_surfaces(in, planned.model, result);
}

void insert_spread(Statement& to, const Spread& spread) {
  if (spread.kind == Spread::Kind::None)
    to.bind_null().bind_null().bind_null();
  else
    to.bind(std::string(word_of(spread.kind, {"", "uniform", "normal", "lognormal"}))).bind(spread.a).bind(spread.b);
}

/// All tables but the cases, at once.
void make_study(Database& d, const Plan& plan, const StudyIdentity& identity) {
  d.execute("BEGIN IMMEDIATE");
  make_study_tables(d, plan.factors, identity.inside);
  Statement study(d, insert_sql("study", 2)), option(d, insert_sql("options", 2)), input(d, insert_sql("inputs", 3)),
      factor(d, insert_sql("factors", 7)), model(d, insert_sql("models", 2));
  const auto say = [&](const char* key, const std::string& value) { study.bind(std::string(key)).bind(value).run(); };
  say("schema", fmt::format("dea.study/{}", kStudyVersion));
  say("version", identity.version);
  say("shard", std::to_string(identity.shard));
  say("shards", std::to_string(identity.shards));
  say("cases", std::to_string(plan.cases.size()));
  say("inside", identity.inside ? "1" : "0");
  for (std::size_t i = 0; i < identity.options.size(); ++i) option.bind(whole(i + 1)).bind(identity.options[i]).run();
  for (std::size_t i = 0; i < identity.inputs.size(); ++i)
    input.bind(whole(i + 1)).bind(identity.inputs[i][0]).bind(identity.inputs[i][1]).run();
  for (std::size_t i = 0; i < plan.factors.size(); ++i) {
    const Factor& f = plan.factors[i];
    factor.bind(whole(i + 1)).bind(f.name).bind(f.option).bind(f.before + "{}" + f.after);
    insert_spread(factor, f.spread);
    factor.run();
  }
  for (std::size_t i = 0; i < plan.models.size(); ++i) model.bind(whole(i + 1)).bind(plan.models[i]).run();
  d.execute("COMMIT");
}

/// What a database has of the cases, into `there`; their indices.
std::vector<std::size_t> note_cases(const Database& d, std::vector<CaseThere>& there) {
  std::vector<std::size_t> indices;
  const std::size_t count = there.size();
  for (Statement rows(d, "SELECT case_id, case_outcome FROM cases"); rows.step();) {
    const std::int64_t number = rows.integer(0);
    if (number < 1 || number > whole(count))
      throw InputError(fmt::format("{}: found case {}, expected numbers from 1 to {}", d.path(), number, count));
    const std::string outcome = rows.text(1);
    there[at(number - 1)] = outcome == name(CaseResult::Outcome::Solved)   ? CaseThere::Solved
                            : outcome == name(CaseResult::Outcome::Failed) ? CaseThere::Failed
                                                                           : CaseThere::Refused;
    indices.push_back(static_cast<std::size_t>(number - 1));
  }
  return indices;
}

}  // namespace

const char* name(CaseResult::Outcome outcome) { return word_of(outcome, {"solved", "failed", "refused"}); }

ShardCases shard_cases(std::size_t cases, int shard, int shards) {
  assert(1 <= shard && shard <= shards);
  const auto start = [&](int i) { return cases * static_cast<std::size_t>(i) / static_cast<std::size_t>(shards); };
  return {start(shard - 1), start(shard)};
}

namespace {

std::string digest_words(uLong sum, std::uint64_t size) { return fmt::format("crc32:{:08x}:{}", sum, size); }

}  // namespace

std::string bytes_digest(const std::string& bytes) {
  return digest_words(crc32_z(crc32(0L, Z_NULL, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
                      bytes.size());
}

std::string file_digest(const std::string& path) {
  std::error_code error;
  std::ifstream in(path, std::ios::binary);
  uLong sum = crc32(0L, Z_NULL, 0);
  std::uint64_t size = 0;
  if (in && fs::is_regular_file(path, error)) {  // a device may never end
    std::string piece(1 << 20, '\0');
    while (in) {
      in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
      sum = crc32(sum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(in.gcount()));
      size += static_cast<std::uint64_t>(in.gcount());
    }
  }
  if (!in.eof()) throw InputError(fmt::format("{}: found no readable file", path));
  return digest_words(sum, size);
}

bool has_content(const std::string& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  return !error && size > 0;
}

struct StudyWriter::Parts {
  Database database;
  const Plan& plan;
  StudyInserts inserts;
  std::vector<CaseThere> there;
  std::vector<CaseResult> waiting;
  std::function<void()> before_writing;
  std::vector<std::unique_ptr<Database>> batches;  ///< that wait
  double written = 0.0;                            ///< when something was written last [s]
  double pause = kBatch;  ///< until the next time: where writing is slow, it shall not take most of the time [s]
  double busy_since = 0;  ///< when somebody began to keep us from it; 0: nobody does

  Parts(const std::string& path, const Plan& p, const StudyIdentity& identity)
      : database(path, Database::For::Writing), plan(p), inserts(made(path, p, identity), p.factors.size()) {}

  const Database& made(const std::string& path, const Plan& p, const StudyIdentity& identity) {
    if (!has_content(path)) make_study(database, p, identity);
    return database;
  }

  void insert(const CaseResult& result) {
    if (there[result.number - 1] != CaseThere::Missing) inserts.remove.bind(whole(result.number)).run();
    insert_case(inserts, plan, result);
  }

  void insert(const Database& batch) {
    std::vector<CaseThere> its(there.size(), CaseThere::Missing);
    for (const std::size_t i : note_cases(batch, its))
      if (there[i] != CaseThere::Missing) inserts.remove.bind(whole(i + 1)).run();
    for (const std::string& table : study_tables())
      if (!describes_study(table)) copy_table(batch, database, table);
  }

  /// All that waits, at once. False: another program reads the file.
  bool write() {
    if (before_writing) before_writing();
    const double start = seconds();
    try {
      database.execute("BEGIN IMMEDIATE");
      for (const CaseResult& result : waiting) insert(result);
      for (const auto& batch : batches) insert(*batch);
      database.execute("COMMIT");
    } catch (const DatabaseBusy&) {
      take_back();
      return false;
    } catch (...) {
      take_back();
      throw;
    }
    for (const CaseResult& result : waiting)
      there[result.number - 1] = result.outcome == CaseResult::Outcome::Solved   ? CaseThere::Solved
                                 : result.outcome == CaseResult::Outcome::Failed ? CaseThere::Failed
                                                                                 : CaseThere::Refused;
    for (const auto& batch : batches) note_cases(*batch, there);
    waiting.clear();
    batches.clear();
    written = seconds();
    pause = std::clamp(5 * (written - start), kBatch, kLongestPause);
    busy_since = 0.0;
    return true;
  }

  void write_if_due() {
    if (seconds() - written >= pause && !write()) wait_or_fail();
  }

  void take_back() {
    try {
      database.execute("ROLLBACK");
    } catch (const std::exception&) {
      // it was taken back already
    }
  }

  void wait_or_fail() {
    const double now = seconds();
    if (busy_since <= 0.0) busy_since = now;
    if (now - busy_since > kLongestWait)
      throw WriteError(
          fmt::format("{}: another program has read it for {:.0f} minutes; the same command goes on when it "
                      "has ended",
                      database.path(), kLongestWait / 60));
    written = now;
  }
};

StudyWriter::StudyWriter(const std::string& path, const Plan& plan, const StudyIdentity& identity)
    : parts_(std::make_unique<Parts>(path, plan, identity)) {
  parts_->there.assign(plan.cases.size(), CaseThere::Missing);
  note_cases(parts_->database, parts_->there);
  parts_->database.wait_for_others(kWait);
  parts_->written = seconds();
}

StudyWriter::~StudyWriter() = default;

void StudyWriter::before_writing(std::function<void()> check) { parts_->before_writing = std::move(check); }

const std::vector<CaseThere>& StudyWriter::there() const { return parts_->there; }

void StudyWriter::add(CaseResult&& result) {
  parts_->waiting.push_back(std::move(result));
  parts_->write_if_due();
}

void StudyWriter::add(std::string&& packed) {
  const std::optional<std::string> bytes = unpacked_bytes(packed);
  if (!bytes) throw InputError("found a damaged batch of results, expected what another writer has packed");
  parts_->batches.push_back(std::make_unique<Database>("a batch of results", *bytes));
  parts_->write_if_due();
}

void StudyWriter::finish() {
  while (!parts_->waiting.empty() || !parts_->batches.empty())
    if (!parts_->write()) parts_->wait_or_fail();
}

std::string StudyWriter::packed() const { return packed_bytes(parts_->database.bytes()); }

}  // namespace dea
