// io/study/database.h – SQLite, as far as the file of a study needs it. The one place that knows its errors.
#pragma once
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/base/error.h"

struct sqlite3;
struct sqlite3_stmt;

namespace dea {

/// Another program is at the database; the same may be tried again.
struct DatabaseBusy : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The same for who only reads a study's file.
struct StudyBusy : InputError {
  using InputError::InputError;
};

/// An open database file. Faults: WriteError if it was opened to be written, InputError if to be read, with its path;
/// DatabaseBusy.
class Database {
 public:
  enum class For { Reading, Writing };
  /// Writing: it is made if it is not there.
  Database(const std::string& path, For what);
  /// A database as `bytes` has it, in memory, to be read. `name`: in place of a path.
  Database(const std::string& name, const std::string& bytes);
  Database(Database&&) = delete;

  void execute(const std::string& sql) const;
  /// The whole database, for the constructor that takes bytes.
  std::string bytes() const;
  /// A fault of the last call, whose result was `code`.
  [[noreturn]] void fail(int code) const;
  /// How long a call waits for other programs.
  void wait_for_others(int milliseconds);

  sqlite3* handle() const { return handle_.get(); }
  const std::string& path() const { return path_; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  int open(const std::string& path, int flags);

  std::string path_;
  For what_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// One SQL statement, made once, run often: bind all, then step, then reset.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  ~Statement();
  Statement(Statement&&) = delete;

  /// The next parameter, from the first on. NaN and infinity are NULL.
  Statement& bind(double value);
  Statement& bind(std::int64_t value);
  Statement& bind(const std::string& text);
  Statement& bind_bytes(const std::string& bytes);
  Statement& bind_null();
  /// The value of another statement's column.
  Statement& bind(const Statement& from, int column);

  /// True: a row is there.
  bool step();
  /// Steps to the end and makes it ready to be bound again.
  void run();
  void reset();

  int columns() const;
  std::string name(int column) const;
  bool is_null(int column) const;
  bool is_number(int column) const;
  std::int64_t integer(int column) const;
  double number(int column) const;  ///< NaN: NULL
  std::string text(int column) const;
  std::string bytes(int column) const;

 private:
  void check(int code);

  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int next_ = 1;
};

/// The columns of a table, view or query, by their names.
std::vector<std::string> column_names(const Database& database, const std::string& query);

/// "INSERT INTO NAME VALUES (?, ?, ...)", of all columns of the table. `other`: "OR IGNORE" and its like.
std::string insert_sql(const Database& database, const std::string& table, const char* other = "");

/// A name as SQL wants it, whatever is in it.
std::string quoted_name(const std::string& name);

}  // namespace dea
