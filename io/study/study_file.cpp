#include "io/study/study_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <filesystem>
#include <fstream>

#include "io/files/encoded_text.h"
#include "io/files/output.h"
#include "io/settings/settings_xml.h"
#include "io/study/study_schema.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/rotations.h"
#include "src/results/contact_numbers.h"
#include "src/rules/rules.h"

namespace dea {

namespace fs = std::filesystem;

/// All that is inserted, prepared once.
struct StudyInserts {
  Statement remove, one, warning, state, statistics, part, inside, inside_part, layer, soft_part, pose, surface, field;
  explicit StudyInserts(const Database& d)
      : remove(d, "DELETE FROM cases WHERE case_id = ?"),
        one(d, insert_sql(d, "cases")),
        warning(d, insert_sql(d, "warnings")),
        state(d, insert_sql(d, "states")),
        statistics(d, insert_sql(d, "statistics")),
        part(d, insert_sql(d, "parts")),
        inside(d, insert_sql(d, "inside")),
        inside_part(d, insert_sql(d, "inside_parts")),
        layer(d, insert_sql(d, "layers")),
        soft_part(d, insert_sql(d, "soft_parts")),
        pose(d, insert_sql(d, "poses")),
        surface(d, insert_sql(d, "surfaces", "OR IGNORE")),
        field(d, insert_sql(d, "fields")) {}
};

namespace {

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

void insert_contact(StudyInserts& in, std::int64_t number, std::int64_t s, std::int64_t id, const CaseContact& contact,
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

void insert_state(StudyInserts& in, std::int64_t number, std::int64_t s, const CaseResult& result,
                  const CaseState& state) {
  in.state.bind(number).bind(s).bind(state.time).bind(std::string(name(state.outcome)));
  bind_text_or_null(in.state, state.message);
  in.state.bind(std::int64_t{state.iterations}).bind(state.residual_force).bind(state.residual_moment).run();
  for (std::size_t c = 0; c < state.statistics.size(); ++c)
    insert_contact(in, number, s, whole(c + 1), result.contacts[c], state.statistics[c]);
  for (std::size_t k = 0; k < state.layers.size(); ++k) {
    in.layer.bind(number).bind(s).bind(whole(k + 1)).bind(result.layers[k]);
    bind_numbers(in.layer, layer_numbers(), state.layers[k]);
    in.layer.run();
  }
  for (std::size_t k = 0; k < state.parts.size(); ++k) {
    in.soft_part.bind(number).bind(s).bind(whole(k + 1)).bind(result.parts[k]);
    bind_numbers(in.soft_part, part_numbers(), state.parts[k]);
    in.soft_part.run();
  }
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
    in.field.bind(number).bind(s).bind(whole(c + 1)).bind_bytes(packed(state.fields[c])).run();
}

void insert_surfaces(StudyInserts& in, int model, const CaseResult& result) {
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

void insert_case(StudyInserts& in, const Plan& plan, const CaseResult& result) {
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
    to.bind(std::string(kSpreadWords[static_cast<std::size_t>(spread.kind)])).bind(spread.a).bind(spread.b);
}

/// All tables but the cases, at once.
void make_study(Database& d, const Plan& plan, const StudyIdentity& identity) {
  d.execute("BEGIN IMMEDIATE");
  make_study_tables(d, plan.factors, identity.inside);
  Statement study(d, insert_sql(d, "study")), option(d, insert_sql(d, "options")), input(d, insert_sql(d, "inputs")),
      factor(d, insert_sql(d, "factors")), model(d, insert_sql(d, "models"));
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

std::string digest_words(uLong sum, std::uint64_t size) { return fmt::format("crc32:{:08x}:{}", sum, size); }

/// What a database has of the cases, into `there`; their indices.
std::vector<std::size_t> note_cases(const Database& d, CasesThere& there) {
  std::vector<std::size_t> indices;
  for (Statement rows(d, "SELECT case_id, case_outcome FROM cases"); rows.step();) {
    const std::int64_t number = rows.integer(0);
    if (number < 1 || number > whole(there.size()))
      throw InputError(fmt::format("{}: found case {}, expected numbers from 1 to {}", d.path(), number, there.size()));
    indices.push_back(static_cast<std::size_t>(number - 1));
    there[indices.back()] = outcome_of(rows.text(1));
  }
  return indices;
}

}  // namespace

const char* name(CaseResult::Outcome outcome) { return word_of(outcome, {"solved", "failed", "refused"}); }

CaseResult::Outcome outcome_of(const std::string& word) {
  for (const auto outcome : {CaseResult::Outcome::Solved, CaseResult::Outcome::Failed})
    if (word == name(outcome)) return outcome;
  return CaseResult::Outcome::Refused;
}

ShardCases shard_cases(std::size_t cases, int shard, int shards) {
  assert(1 <= shard && shard <= shards);
  const auto start = [&](int i) { return cases * static_cast<std::size_t>(i) / static_cast<std::size_t>(shards); };
  return {start(shard - 1), start(shard)};
}

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

StudyWriter::StudyWriter(const std::string& path, const Plan& plan, const StudyIdentity& identity)
    : database_(path, Database::For::Writing), plan_(plan), there_(plan.cases.size()) {
  if (!has_content(path)) make_study(database_, plan, identity);
  inserts_ = std::make_unique<StudyInserts>(database_);
  note_cases(database_, there_);
  database_.wait_for_others(kWait);
  written_ = seconds();
}

StudyWriter::~StudyWriter() = default;

void StudyWriter::add(CaseResult&& result) {
  waiting_.push_back(std::move(result));
  write_if_due();
}

void StudyWriter::add(std::string&& packed) {
  const std::optional<std::string> bytes = unpacked_bytes(packed);
  if (!bytes) throw InputError("found a damaged batch of results, expected what another writer has packed");
  batches_.push_back(std::make_unique<Database>("a batch of results", *bytes));
  write_if_due();
}

void StudyWriter::finish() {
  while (!waiting_.empty() || !batches_.empty())
    if (!write()) wait_or_fail();
}

std::string StudyWriter::packed() const { return packed_bytes(database_.bytes()); }

void StudyWriter::write_if_due() {
  if (seconds() - written_ >= pause_ && !write()) wait_or_fail();
}

bool StudyWriter::write() {
  if (before_writing) before_writing();
  const double start = seconds();
  try {
    database_.execute("BEGIN IMMEDIATE");
    for (const CaseResult& result : waiting_) insert(result);
    for (const auto& batch : batches_) insert(*batch);
    database_.execute("COMMIT");
  } catch (const DatabaseBusy&) {
    take_back();
    return false;
  } catch (...) {
    take_back();
    throw;
  }
  for (const CaseResult& result : waiting_) there_[result.number - 1] = result.outcome;
  for (const auto& batch : batches_) note_cases(*batch, there_);
  waiting_.clear();
  batches_.clear();
  written_ = seconds();
  pause_ = std::clamp(5 * (written_ - start), kBatch, kLongestPause);
  busy_since_ = 0.0;
  return true;
}

void StudyWriter::insert(const CaseResult& result) {
  if (there_[result.number - 1]) inserts_->remove.bind(whole(result.number)).run();
  insert_case(*inserts_, plan_, result);
}

void StudyWriter::insert(const Database& batch) {
  CasesThere its(there_.size());
  for (const std::size_t i : note_cases(batch, its))
    if (there_[i]) inserts_->remove.bind(whole(i + 1)).run();
  for (const std::string& table : study_tables(batch))
    if (!describes_study(table)) copy_table(batch, database_, table);
}

void StudyWriter::take_back() {
  try {
    database_.execute("ROLLBACK");
  } catch (const std::exception&) {
    // it was taken back already
  }
}

void StudyWriter::wait_or_fail() {
  const double now = seconds();
  if (busy_since_ <= 0.0) busy_since_ = now;
  if (now - busy_since_ > kLongestWait)
    throw WriteError(
        fmt::format("{}: another program has read it for {:.0f} minutes; the same command goes on when it "
                    "has ended",
                    database_.path(), kLongestWait / 60));
  written_ = now;
}

}  // namespace dea
