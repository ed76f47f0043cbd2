#pragma once

#include <cstdint>
#include <list>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/case_files/setting.h"

namespace flexmorph::io {

/// The information that a reader attaches to a key of a table, for the explained case.
struct CaseNote {
  std::string key, sentence;  ///< Name of the key, and the sentence that explains it.

  /// Value in TOML that was used because the file has no such key; empty if the file has it.
  std::string value;
  std::string fallback;  ///< Value in TOML that a missing key has; empty if it depends on the case.
  std::string absence;   ///< Meaning of a missing key in words; empty for a required key.
};

/// One value of a case file, with its location in the file.
struct CaseNode {
  /// Type of the value; `other` means dates and times.
  enum class Kind { table, list, text, integer, number, boolean, other };

  std::string key;                ///< Name of the key in its table; empty for entries of lists.
  Kind kind = Kind::table;        ///< Type of the value.
  std::string text;               ///< Contents of a text, also of one that gives a number.
  double number = 0;              ///< Value of an integer or a number.
  int64_t integer = 0;            ///< Value of an integer or a boolean (0, 1).
  bool is_inline = false;         ///< True for a table in braces.
  std::vector<CaseNode> entries;  ///< Entries of a table or a list.

  std::string location;  ///< Location, such as "cases/four_bar.toml:14:13", or "--set KEY=VALUE".
  std::string shown;     ///< Value as it is written in the file: "-0.002", "[10, 2]".
  unsigned line = 0;     ///< Line in the file, by which messages are sorted.
  std::string unit;      ///< Unit of a number that a text gives, such as "mm"; else empty.

  /// Why a text is not a number, although its key takes numbers; else empty.
  std::string problem;
  bool is_option = false;               ///< True if the value was set by a --set option.
  mutable std::set<std::string> asked;  ///< Keys of a table that readers have read or looked for.
  mutable bool visited = false;         ///< True if a reader has accessed this table.
  mutable std::vector<CaseNote> notes;  ///< Notes of readers, in the order in which keys were read.

  /// Tables that are missing in the file and were read as empty ones.
  mutable std::list<CaseNode> assumed;

  /// Returns the entry of a key, or null if there is none.
  const CaseNode* find(const std::string& wanted) const;
  CaseNode* find(const std::string& wanted);
  /// Stores a note. It replaces an older note about the same key.
  void note(CaseNote note) const;
};

/// A case file as a tree of values.
struct CaseDocument {
  /// Reads and parses a file.
  /// @throws Error (input) for a file that cannot be read or parsed
  explicit CaseDocument(const std::string& file);
  /// Parses the text of a case.
  /// @param file  name of the text in messages, which need not exist as a file
  /// @throws Error (input) for a text that cannot be parsed
  CaseDocument(const std::string& file, std::string text);

  /// Applies one override "KEY=VALUE" of the command line; "KEY=" removes KEY.
  /// @throws Error (input) when the override is not valid
  void apply(const std::string& change);

  /// Checks that readers have accessed every key in the tables that they have read.
  /// @throws Error (input) with a message for each unknown key
  void refuse_unknown_keys() const;
  /// The result of following a dotted path of keys as far as possible. An entry of a list is named
  /// by its label or its index; the only entry of a list needs no name.
  struct Looked {
    const CaseNode* node;    ///< Last node that was found.
    std::string path, next;  ///< Path of this node, and the first key that was not found in it.
    bool whole = false;      ///< True if the whole path was found.
  };
  /// Returns how far a dotted path of keys can be followed.
  Looked look(const std::string& key_path) const;
  /// Returns the location of a key for messages, see CaseFile::where().
  std::string where(const std::string& key_path) const;
  /// Returns the text of the file, or the rewritten document if overrides have changed it.
  std::string effective_text() const;
  /// Returns the effective case, including the values that readers used for missing keys, with the
  /// sentence of each key as a comment.
  std::string explained_text() const;

  /// Returns the values that differ from their defaults, as far as readers have accessed them, and
  /// all values that --set options gave.
  std::vector<Setting> settings() const;
  /// Returns the other values of the file whose defaults depend on the case, with their defaults
  /// in words, as far as readers have accessed them.
  std::vector<Setting> dependent_settings() const;
  /// Returns all values that the case gives, as far as readers have accessed them.
  std::vector<Setting> values() const;

  /// Replaces texts by numbers wherever keys take numbers: formulas of [constants], and numbers
  /// with a unit, which are converted to SI units. All overrides must have been applied.
  void read_number_texts();
  /// Replaces former names of keys and words by their present names, with a warning for each.
  void rename_former_names();

  std::string path, text;            ///< Path of the file, and its text.
  std::vector<std::string> changes;  ///< Overrides in the order in which they were applied.
  CaseNode root;                     ///< Root table.
  /// Warnings that name the location, the former and the present name of a key or a word.
  std::vector<std::string> former_names;
};

/// Returns a value with its location, "cases/four_bar.toml:14:13: body.thickness = -0.002". If a
/// text gives a number, the number follows in parentheses. For a table the text contains only its
/// path.
std::string located(const CaseNode& node, const std::string& key_path);

/// Returns the labels of the entries in a list of tables. The label is the `name` of the entry, or
/// else the `body` that it refers to. The index replaces a label that is not a bare key or occurs
/// more than once.
std::vector<std::string> entry_labels(const CaseNode& list);

/// Returns the paths of the entries of the list at `list_path`. A single entry has the path of the
/// list.
std::vector<std::string> entry_paths(const CaseNode& list, const std::string& list_path);

/// Returns the known word that is most similar to a misspelt one, or an empty text if none is
/// similar.
std::string nearest(const std::string& word, std::span<const std::string> known);

/// Returns true if a word may be a TOML key without quotes.
bool is_bare_key(const std::string& word);

}  // namespace flexmorph::io
