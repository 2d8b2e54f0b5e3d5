#include "io/study/database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <system_error>

#include "io/files/system.h"

namespace dea {

namespace {

constexpr int kPatience = 10000;  // ms

/// `left`: errno after the call; SQLite does not always keep it.
std::string reason(sqlite3* handle, int code, int left) {
  const int kind = code & 0xff, kept = handle != nullptr ? sqlite3_system_errno(handle) : 0;
  const std::error_code of_system =
      kept != 0 ? std::error_code(kept, std::system_category())
                : std::error_code(failed_to_write(left) ? left : 0, std::generic_category());
  if (kind == SQLITE_NOTADB) return "found no SQLite database";
  if (kind == SQLITE_CORRUPT) return "found a damaged database";
  if ((kind == SQLITE_IOERR || kind == SQLITE_CANTOPEN) && of_system) return reason_of(of_system);
  return handle != nullptr ? sqlite3_errmsg(handle) : sqlite3_errstr(code);
}

}  // namespace

Database::Database(const std::string& path, For what) : path_(path), what_(what) {
  const int write = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  int code = open(path, what == For::Writing ? write : SQLITE_OPEN_READONLY);
  // a program that was killed while it wrote: what it had begun is taken back, which is writing
  if (what == For::Reading && (code == SQLITE_READONLY_ROLLBACK || code == SQLITE_READONLY_RECOVERY ||
                               code == SQLITE_READONLY_CANTLOCK || code == SQLITE_CANTOPEN))
    code = open(path, SQLITE_OPEN_READWRITE);
  if (code != SQLITE_OK) fail(code);
  if (what == For::Reading) execute("PRAGMA query_only=ON");
}

Database::Database(const std::string& name, const std::string& bytes) : path_(name), what_(For::Reading) {
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  int code = open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  if (code != SQLITE_OK) fail(code);
  auto* copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size() + 1));
  if (copy == nullptr) fail(SQLITE_NOMEM);
  std::copy(bytes.begin(), bytes.end(), copy);
  // the copy is SQLite's from here on, also where this fails
  code = sqlite3_deserialize(handle(), "main", copy, size, size, SQLITE_DESERIALIZE_FREEONCLOSE);
  if (code != SQLITE_OK) fail(code);
  execute("PRAGMA query_only=ON; SELECT count(*) FROM sqlite_master");
}

void Database::Close::operator()(sqlite3* handle) const { sqlite3_close(handle); }

int Database::open(const std::string& path, int flags) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags | SQLITE_OPEN_EXRESCODE, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) return code;
  sqlite3_busy_timeout(handle, kPatience);
  // what is wrong with the file shows when it is read
  return sqlite3_exec(handle, "PRAGMA foreign_keys=ON; PRAGMA user_version; SELECT count(*) FROM sqlite_master",
                      nullptr, nullptr, nullptr);
}

void Database::fail(int code) const {
  const std::string text = reason(handle(), code, errno);
  const int kind = code & 0xff;
  if (kind == SQLITE_BUSY || kind == SQLITE_LOCKED)
    throw DatabaseBusy(
        fmt::format("{}: another program keeps it from being {}", path_, what_ == For::Writing ? "written" : "read"));
  if (what_ == For::Writing && kind != SQLITE_NOTADB && kind != SQLITE_CORRUPT)
    throw WriteError(fmt::format("{}: {}", path_, text));
  throw InputError(fmt::format("{}: {}, expected a study's file (dea study -o FILE.db)", path_, text));
}

void Database::execute(const std::string& sql) const {
  const int code = sqlite3_exec(handle(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

std::string Database::bytes() const {
  sqlite3_int64 size = 0;
  unsigned char* all = sqlite3_serialize(handle(), "main", &size, 0);
  if (all == nullptr) fail(SQLITE_NOMEM);
  std::string copy(reinterpret_cast<const char*>(all), static_cast<std::size_t>(size));
  sqlite3_free(all);
  return copy;
}

void Database::wait_for_others(int milliseconds) { sqlite3_busy_timeout(handle(), milliseconds); }

Statement::Statement(const Database& database, const std::string& sql) : database_(database) {
  check(sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

void Statement::check(int code) {
  if (code != SQLITE_OK) database_.fail(code);
}

Statement& Statement::bind(double value) {
  check(std::isfinite(value) ? sqlite3_bind_double(statement_, next_, value) : sqlite3_bind_null(statement_, next_));
  ++next_;
  return *this;
}

Statement& Statement::bind(std::int64_t value) {
  check(sqlite3_bind_int64(statement_, next_++, value));
  return *this;
}

Statement& Statement::bind(const std::string& text) {
  check(sqlite3_bind_text(statement_, next_++, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_bytes(const std::string& bytes) {
  check(sqlite3_bind_blob64(statement_, next_++, bytes.data(), bytes.size(), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_null() {
  check(sqlite3_bind_null(statement_, next_++));
  return *this;
}

Statement& Statement::bind(const Statement& from, int column) {
  check(sqlite3_bind_value(statement_, next_++, sqlite3_column_value(from.statement_, column)));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) {
    reset();
    database_.fail(code);
  }
  return code == SQLITE_ROW;
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

void Statement::reset() {
  sqlite3_reset(statement_);
  next_ = 1;
}

int Statement::columns() const { return sqlite3_column_count(statement_); }
std::string Statement::name(int column) const { return sqlite3_column_name(statement_, column); }
bool Statement::is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
bool Statement::is_number(int column) const {
  const int type = sqlite3_column_type(statement_, column);
  return type == SQLITE_FLOAT || type == SQLITE_INTEGER;
}
std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }
double Statement::number(int column) const {
  return is_null(column) ? std::numeric_limits<double>::quiet_NaN() : sqlite3_column_double(statement_, column);
}
std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
}
std::string Statement::bytes(int column) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
  return bytes == nullptr ? std::string()
                          : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
}

std::vector<std::string> column_names(const Database& database, const std::string& query) {
  const Statement rows(database, query);
  std::vector<std::string> names;
  for (int i = 0; i < rows.columns(); ++i) names.push_back(rows.name(i));
  return names;
}

std::string insert_sql(const Database& database, const std::string& table, const char* other) {
  std::string marks = "?";
  const Statement row(database, "SELECT * FROM " + table);
  for (int i = 1; i < row.columns(); ++i) marks += ",?";
  return fmt::format("INSERT {} INTO {} VALUES ({})", other, table, marks);
}

std::string quoted_name(const std::string& name) {
  std::string quoted(1, '"');
  for (const char c : name) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace dea
