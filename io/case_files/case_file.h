#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/base.h"
#include "io/case_files/key.h"

namespace flexmorph::io {

struct CaseNode;

struct NumberOrName {
  std::string name;  ///< empty: a number
  double number = 0;
};

/// One table of a case file, and what was asked of it.
///
/// Every reader throws Error (input) with file, line, column, key, value and what is allowed:
///
///   cases/four_bar.toml:14:13: body.thickness = -0.002: a thickness is positive [m]
///
/// A missing key has the value that its declaration or the reader (`computed`) says; without either
/// it is an error. Asking for a key makes it known: CaseFile::finish() refuses all others. Reading
/// a key that is declared for another table, or as something else, is a std::logic_error. Copies
/// are cheap and keep the file alive.
class Table {
 public:
  const std::string& path() const;        ///< "body.flow"; empty for the file itself
  std::string place() const;              ///< "cases/four_bar.toml:14:1"
  std::vector<std::string> keys() const;  ///< in the order of the file (makes none known)
  bool has(const Key& key) const;         ///< is it in the file? (makes it known)
  bool is_string(const Key& key) const;   ///< is its value a string?
  bool is_list_of_strings(const Key& key) const;
  bool says_one_of(const Key& key, std::span<const std::string> words) const;  ///< as its string

  /// Whole numbers are numbers; inf and nan are refused.
  double number(const Key& key, std::optional<double> computed = {}) const;
  int integer(const Key& key, std::optional<int> computed = {}) const;
  bool boolean(const Key& key, std::optional<bool> computed = {}) const;
  std::string string(const Key& key, std::optional<std::string> computed = {}) const;
  /// One of the words it is declared with.
  std::string choice(const Key& key, std::optional<std::string> computed = {}) const;
  /// One of the names in `allowed`, which the case gives.
  std::string choice(const Key& key, std::span<const std::string> allowed,
                     std::optional<std::string> computed = {}) const;
  template <class T>
  T choice(const Choice<T>& choice, std::optional<T> computed = {}) const {
    std::optional<std::string> word;
    if (computed) word = choice.word_of(*computed);
    const Key& key = choice;
    return choice.value_of(this->choice(key, key.form(Form::Kind::word).words(), word));
  }

  /// Lists of as many entries as the key is declared with.
  std::vector<double> numbers(const Key& key,
                              const std::optional<std::vector<double>>& computed = {}) const;
  /// Of a key with numbers_or_names(): numbers, and names out of `allowed`.
  std::vector<NumberOrName> numbers_or_names(const Key& key,
                                             std::span<const std::string> allowed) const;
  std::vector<int> integers(const Key& key,
                            const std::optional<std::vector<int>>& computed = {}) const;
  std::vector<std::vector<double>> rows(const Key& key) const;
  /// One or more of the words it is declared with, or of the names in `allowed`, none twice.
  std::vector<std::string> choices(const Key& key) const;
  std::vector<std::string> choices(const Key& key, std::span<const std::string> allowed) const;
  std::vector<std::string> strings(const Key& key) const;

  /// @throws Error (input) when it is missing or not a table.
  Table table(const Key& key) const;
  /// An empty one when it is missing.
  Table table_or_empty(const Key& key) const;
  /// Entries of [[key]]; none when it is missing.
  std::vector<Table> tables(const Key& key) const;

  /// What a missing key came to in the end, where that is known only later: for the explained case.
  void settle(const Key& key, const Value& value) const;

  /// @throws Error (input): "<file:line:column>: <path.key> = <value>: <allowed>".
  [[noreturn]] void fail(const Key& key, const std::string& allowed) const;
  /// The same about the table as a whole: "<file:line:column>: <path>: <allowed>".
  [[noreturn]] void fail(const std::string& allowed) const;

  /// Path of the file that a key names: relative names start at the folder of the case file, those
  /// of a --set option at the working directory, as others on the command line.
  std::string path_of(const Key& key) const;
  /// The same from the root of the file system.
  std::string absolute(const Key& key) const;

 private:
  friend class CaseFile;
  struct Place;
  explicit Table(std::shared_ptr<const Place> place) : place_(std::move(place)) {}
  Table opened(const CaseNode& node, const std::string& path, const std::string& kind) const;
  std::shared_ptr<const Place> place_;
};

/// A case file (TOML) with the changes of the command line.
class CaseFile {
 public:
  /// Reads the file and applies `overrides`, each "KEY=VALUE": KEY a dotted path (an entry of a
  /// list of tables goes by its name, its index, or nothing when it is the only one:
  /// body.plate.thickness, body.0.thickness, body.thickness), VALUE as in TOML; a bare word is
  /// taken as a string; without VALUE the key is taken away, where it is there.
  /// @throws Error (input) for a missing or unreadable file, a syntax error (file:line), or an
  ///         override that names no place.
  explicit CaseFile(const std::string& path, std::span<const std::string> overrides = {});

  const std::string& path() const;
  Table root() const;

  /// What a reader complained of first, and what else is wrong in the file whatever it means, so
  /// that all is said at once: values out of their ranges, unknown keys, and, if the first
  /// complaint is of that kind, keys that every such table must have (check_by_book). A line to
  /// each, twenty at most.
  std::string with_others(const std::string& complaint) const;

  /// Where a dotted path of keys leads (entries of lists as in overrides), as messages begin:
  /// "cases/four_bar.toml:14:8: time.step = 0.001". Of a key that is not in the file, its table and
  /// the value that was taken for it.
  std::string where(const std::string& key_path) const;
  bool gives(const std::string& key_path) const;  ///< is the key in the file, or set?

  /// @throws Error (input) naming every key nobody asked for, with the nearest known one.
  void finish() const;

  /// The effective case: the file's own text, or the rewritten document when overrides changed it,
  /// those from before and these.
  std::string text(std::span<const std::string> overrides = {}) const;
  /// The case as it was read: with the values taken for missing keys, and a sentence to each key.
  std::string explained(std::span<const std::string> overrides = {}) const;

 private:
  std::shared_ptr<const Table::Place> root_;
};

}  // namespace flexmorph::io
