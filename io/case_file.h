#pragma once

#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geometry/base.h"

namespace flexmorph::io {

/// What a number in a case file may be; allowed() is the end of the message when it is not.
struct Quantity {
  std::string noun = {};  ///< "a thickness"
  std::string unit = {};  ///< "m"; empty for a pure number
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false, upper_open = false;  ///< is the limit itself excluded?

  bool holds(double value) const;  ///< finite and within the limits
  std::string allowed() const;     ///< "a thickness is positive [m]"
};
Quantity any_number(std::string noun, std::string unit = "");
Quantity positive(std::string noun, std::string unit = "");
Quantity not_negative(std::string noun, std::string unit = "");
Quantity between(std::string noun, std::string unit, double lower, double upper);

/// One table of a case file, and what was asked of it.
///
/// Every reader throws Error (input) with file, line, key, value and what is allowed:
///
///   cases/four_bar.toml:14: body.thickness = -0.002: a thickness is positive [m]
///
/// A `fallback` makes a key optional; without it a missing key is an error. Asking for a key makes
/// it known: CaseFile::finish() refuses all others. Copies are cheap and keep the file alive.
class Table {
 public:
  const std::string& path() const;               ///< "body.flow"; empty for the file itself
  std::string place() const;                     ///< "cases/four_bar.toml:14"
  bool has(const std::string& key) const;        ///< does the key exist? (makes it known)
  bool is_string(const std::string& key) const;  ///< is its value a string?
  bool is_list_of_strings(const std::string& key) const;
  std::vector<std::string> keys() const;  ///< in the order of the file (makes none known)

  /// Whole numbers are numbers; inf and nan are refused.
  double number(const std::string& key, const Quantity& quantity,
                std::optional<double> fallback = {}) const;
  int integer(const std::string& key, const std::string& noun, int lower, int upper,
              std::optional<int> fallback = {}) const;
  bool boolean(const std::string& key, std::optional<bool> fallback = {}) const;
  std::string string(const std::string& key, const std::string& noun,
                     std::optional<std::string> fallback = {}) const;
  /// One of the strings in `allowed`.
  std::string choice(const std::string& key, const std::string& noun,
                     std::span<const std::string> allowed,
                     std::optional<std::string> fallback = {}) const;
  /// One of the named values, for enumerations.
  template <class T>
  T choice(const std::string& key, const std::string& noun,
           std::initializer_list<std::pair<const char*, T>> named,
           std::optional<T> fallback = {}) const {
    if (fallback && !has(key)) return *fallback;
    std::vector<std::string> allowed;
    for (const auto& [name, value] : named) allowed.emplace_back(name);
    const std::string chosen = choice(key, noun, allowed);
    for (const auto& [name, value] : named)
      if (chosen == name) return value;
    fail(key, noun + " is unknown");
  }

  /// A list; `count` entries, or one or more if it is 0.
  std::vector<double> numbers(const std::string& key, const Quantity& each, int count = 0,
                              const std::optional<std::vector<double>>& fallback = {}) const;
  std::vector<int> integers(const std::string& key, const std::string& noun, int lower, int upper,
                            int count = 0,
                            const std::optional<std::vector<int>>& fallback = {}) const;
  /// A list of one or more lists of `columns` numbers each: [[0, 1], [2, 3]].
  std::vector<std::vector<double>> rows(const std::string& key, const Quantity& each,
                                        int columns) const;
  /// A list of one or more of the strings in `allowed`, none twice.
  std::vector<std::string> choices(const std::string& key, const std::string& noun,
                                   std::span<const std::string> allowed) const;
  /// A list of one or more strings.
  std::vector<std::string> strings(const std::string& key, const std::string& noun) const;

  /// @throws Error (input) when it is missing or not a table.
  Table table(const std::string& key) const;
  /// Entries of [[key]]; none when it is missing.
  std::vector<Table> tables(const std::string& key) const;

  /// Path of a file that the case names: relative names start at the folder of the case file.
  std::string beside(const std::string& name) const;

  /// @throws Error (input): "<file:line>: <path.key> = <value>: <allowed>".
  [[noreturn]] void fail(const std::string& key, const std::string& allowed) const;
  /// The same about the table as a whole: "<file:line>: <path>: <allowed>".
  [[noreturn]] void fail(const std::string& allowed) const;

 private:
  friend class CaseFile;
  struct Place;
  explicit Table(std::shared_ptr<const Place> place) : place_(std::move(place)) {}
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

  /// @throws Error (input) naming every key nobody asked for, with the nearest known one.
  void finish() const;

  /// The effective case: the file's own text, or the rewritten document when overrides changed it.
  std::string text() const;

 private:
  std::shared_ptr<const Table::Place> root_;
};

}  // namespace flexmorph::io
