#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/base.h"
#include "io/case_files/key.h"
#include "io/case_files/setting.h"

namespace flexmorph::io {

struct CaseDocument;
struct CaseNode;

/// One entry of a list that contains numbers and names.
struct NumberOrName {
  std::string name;   ///< Name; empty if the entry is a number.
  double number = 0;  ///< Value of the number.
};

/// One table of a case file, with functions that read its keys.
///
/// All reading functions throw Error (input) with file, line, column, key, value and allowed
/// values:
///
///   cases/four_bar.toml:14:13: body.thickness = -0.002: a thickness is positive [m]
///
/// A missing key has the value `computed` of the call, or else the fallback of its declaration. If
/// there is neither, a missing key is an error. Reading a key marks it as known, and
/// CaseFile::finish() rejects all keys that are not known. Reading a key that is declared for
/// another table or with another form throws std::logic_error. Copies of a table are cheap and keep
/// the document in memory.
class Table {
 public:
  /// Returns the path of the table, such as "body.flow"; empty for the root table.
  const std::string& path() const;
  /// Returns the location of the table, such as "cases/four_bar.toml:14:1".
  std::string location() const;
  /// Returns the keys of the table in the order of the file, without marking them as known.
  std::vector<std::string> keys() const;
  /// Returns true if the file has the key, and marks it as known.
  bool has(const Key& key) const;
  /// Returns true if the value of the key is a string.
  bool is_string(const Key& key) const;
  /// Returns true if the value of the key is a list of one or more strings.
  bool is_list_of_strings(const Key& key) const;
  /// Returns true if the value of the key is a string out of `words`.
  bool says_one_of(const Key& key, std::span<const std::string> words) const;

  /// Returns a number; an integer in the file is a number, too. inf and nan are rejected.
  double number(const Key& key, std::optional<double> computed = {}) const;
  /// Returns an integer within the declared limits.
  int integer(const Key& key, std::optional<int> computed = {}) const;
  /// Returns a boolean value.
  bool boolean(const Key& key, std::optional<bool> computed = {}) const;
  /// Returns a string of any content.
  std::string string(const Key& key, const std::optional<std::string>& computed = {}) const;
  /// Returns one of the words with which the key is declared.
  std::string choice(const Key& key, const std::optional<std::string>& computed = {}) const;
  /// Returns one of the names in `allowed`, which depend on the case.
  std::string choice(const Key& key, std::span<const std::string> allowed,
                     const std::optional<std::string>& computed = {}) const;
  /// Returns the value that the word of a key stands for.
  template <class T>
  T choice(const Choice<T>& choice, std::optional<T> computed = {}) const {
    std::optional<std::string> word;
    if (computed) word = choice.word_of(*computed);
    const Key& key = choice;
    return choice.value_of(this->choice(key, key.form(Form::Kind::word).words(), word));
  }

  /// Returns a list of numbers of the declared length.
  std::vector<double> numbers(const Key& key,
                              const std::optional<std::vector<double>>& computed = {}) const;
  /// Returns a list of numbers and of names out of `allowed`, for a key with numbers_or_names().
  std::vector<NumberOrName> numbers_or_names(const Key& key,
                                             std::span<const std::string> allowed) const;
  /// Returns a list of integers of the declared length.
  std::vector<int> integers(const Key& key,
                            const std::optional<std::vector<int>>& computed = {}) const;
  /// Returns a list of rows with the declared number of columns (n_rows x n_columns).
  std::vector<std::vector<double>> rows(const Key& key) const;
  /// Returns one or more different words, out of the declared ones or out of the names in
  /// `allowed`.
  std::vector<std::string> choices(const Key& key) const;
  std::vector<std::string> choices(const Key& key, std::span<const std::string> allowed) const;
  /// Returns a list of strings of any content.
  std::vector<std::string> strings(const Key& key) const;

  /// Returns the table of a key.
  /// @throws Error (input) when it is missing or not a table.
  Table table(const Key& key) const;
  /// Returns the table of a key, or an empty table if the key is missing.
  Table table_or_empty(const Key& key) const;
  /// Returns the entries of the list of tables [[key]]; none if the key is missing.
  std::vector<Table> tables(const Key& key) const;

  /// Records the value of a missing key that is computed only later, for the text of explained().
  void record(const Key& key, const Value& value) const;

  /// Returns the beginning of a sentence about the value of a key:
  /// "<file:line:column>: <path.key> = <value>".
  std::string subject_of(const Key& key) const;
  /// Throws an error about the value of a key.
  /// @throws Error (input) "<file:line:column>: <path.key> = <value>: <allowed>".
  [[noreturn]] void fail(const Key& key, const std::string& allowed) const;
  /// Throws an error about the table.
  /// @throws Error (input) "<file:line:column>: <path>: <allowed>".
  [[noreturn]] void fail(const std::string& allowed) const;

  /// Returns the path of the file that a key names. Relative names in the case file start at its
  /// folder; relative names in a --set option start at the working directory, as other paths on the
  /// command line.
  std::string path_of(const Key& key) const;
  /// Returns the absolute path of the file that a key names, see path_of().
  std::string absolute(const Key& key) const;

 private:
  friend class CaseFile;
  struct Location;
  explicit Table(std::shared_ptr<const Location> location) : location_(std::move(location)) {}
  Table opened(const CaseNode& node, const std::string& path, const std::string& kind) const;
  std::shared_ptr<const Location> location_;
};

/// A case file (TOML) with the overrides of the command line.
class CaseFile {
 public:
  /// Reads a file and applies the overrides, each of the form "KEY=VALUE". KEY is a dotted path. An
  /// entry of a list of tables is named by its label or its index, and a single entry needs no
  /// name: body.plate.thickness, body.0.thickness, body.thickness. VALUE is written in TOML; a bare
  /// word is a string. Without VALUE the key is removed if it exists.
  /// @throws Error (input) for a missing or unreadable file, a syntax error (file:line), or an
  ///         override that names no location in the case.
  explicit CaseFile(const std::string& path, std::span<const std::string> overrides = {});
  /// Reads the text of a case and applies overrides as the constructor does.
  /// @param path  name in messages, which need not exist as a file; files that the case names are
  ///              relative to its folder
  /// @throws Error (input) as the constructor
  static CaseFile of_text(const std::string& text, const std::string& path,
                          std::span<const std::string> overrides = {});

  /// Returns the path of the file.
  const std::string& path() const;
  /// Returns the root table.
  Table root() const;

  /// Returns the first complaint of a reader together with all other errors that can be found
  /// without interpreting the case: values out of their limits and unknown keys. If the first
  /// complaint is one of these errors, missing keys that every table of their kind must have are
  /// added (check_by_book()). Each error has one line; there are at most twenty lines.
  std::string with_others(const std::string& complaint) const;

  /// Returns the location to which a dotted path of keys leads (entries of lists as in overrides),
  /// in the form in which messages begin: "cases/four_bar.toml:14:8: time.step = 0.001". For a key
  /// that is not in the file it returns the location of its table and the value that was used.
  std::string where(const std::string& key_path) const;
  /// Returns true if the file or an override gives the key.
  bool gives(const std::string& key_path) const;

  /// Returns the warnings about former names of keys and words that the file or an override uses.
  const std::vector<std::string>& former_names() const;

  /// Checks that readers have accessed every key.
  /// @throws Error (input) with every unknown key and the most similar known one.
  void finish() const;

  /// Returns the values that differ from their defaults, as far as readers have accessed them, and
  /// all values that overrides gave.
  std::vector<Setting> settings() const;
  /// Returns the other values of the file whose defaults depend on the case, with their defaults
  /// in words, as far as readers have accessed them.
  std::vector<Setting> dependent_settings() const;
  /// Returns all values that the case gives, as far as readers have accessed them.
  std::vector<Setting> values() const;

  /// Returns the effective case: the text of the file, or the rewritten document if earlier
  /// overrides or `overrides` have changed it.
  std::string text(std::span<const std::string> overrides = {}) const;
  /// Returns the case as it was read: with the values used for missing keys, and a sentence to each
  /// key.
  std::string explained(std::span<const std::string> overrides = {}) const;

 private:
  CaseFile(std::shared_ptr<CaseDocument> document, std::span<const std::string> overrides);

  std::shared_ptr<const Table::Location> root_;
};

}  // namespace flexmorph::io
