#pragma once

#include <cstdint>
#include <list>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace flexmorph::io {

/// What a reader found out about a key of a table.
struct CaseNote {
  std::string key, sentence;
  std::string value;  ///< as TOML, of a key that is not in the file; empty: it is, or has none
};

/// One value of a case file, with the place it came from.
struct CaseNode {
  enum class Kind { table, list, text, integer, number, boolean, other };

  std::string key;  ///< in its table; empty in lists
  Kind kind = Kind::table;
  std::string text;               ///< kind text: its contents
  double number = 0;              ///< kinds integer and number
  int64_t integer = 0;            ///< kinds integer and boolean (0, 1)
  bool is_inline = false;         ///< a table in braces
  std::vector<CaseNode> entries;  ///< of tables and lists

  std::string place;                    ///< "cases/four_bar.toml:14:13", or "--set KEY=VALUE"
  std::string shown;                    ///< as it was written: "-0.002", "[10, 2]"
  unsigned line = 0;                    ///< to sort messages
  bool is_option = false;               ///< the very value of a --set option
  mutable std::set<std::string> asked;  ///< keys of a table that somebody asked for
  mutable bool visited = false;         ///< did anybody look into this table?
  mutable std::vector<CaseNote> notes;  ///< in the order in which keys were read
  mutable std::list<CaseNode> assumed;  ///< tables that are not in the file, but were read as empty

  const CaseNode* find(const std::string& wanted) const;
  CaseNode* find(const std::string& wanted);
  /// Keeps a note, in place of an older one of the same key.
  void note(const std::string& about, const std::string& sentence, const std::string& value) const;
};

/// A case file as a tree.
struct CaseDocument {
  explicit CaseDocument(const std::string& file);  ///< @throws Error (input)

  /// Carries out one "KEY=VALUE" of the command line; "KEY=" takes KEY away. @throws Error (input)
  void apply(const std::string& change);

  void refuse_unknown_keys() const;  ///< @throws Error (input)
  /// How far a dotted path leads: one entry goes by its label, its number, or nothing where it is
  /// the only one.
  struct Looked {
    const CaseNode* node;    ///< the last one on the way
    std::string path, next;  ///< its path; the key that it does not have
    bool whole = false;      ///< did it lead to the end?
  };
  Looked look(const std::string& key_path) const;
  /// See CaseFile::where().
  std::string where(const std::string& key_path) const;
  std::string effective_text() const;
  /// The effective case with the values that readers took for missing keys, a sentence to each.
  std::string explained_text() const;

  std::string path, text;
  std::vector<std::string> changes;
  CaseNode root;
};

/// "cases/four_bar.toml:14:13: body.thickness = -0.002"; of a table its path only.
std::string located(const CaseNode& node, const std::string& key_path);

/// How the entries of a list of tables are called: by their name, else the body they are about,
/// else their index, which stands for what is no word or is said twice as well.
std::vector<std::string> entry_labels(const CaseNode& list);

/// Paths of the entries of the list at `list_path`: a lone entry needs no label.
std::vector<std::string> entry_paths(const CaseNode& list, const std::string& list_path);

/// The known word a misspelt one probably meant; empty when none is near.
std::string nearest(const std::string& word, std::span<const std::string> known);

/// May it be a key without quotes?
bool is_bare_key(const std::string& word);

}  // namespace flexmorph::io
