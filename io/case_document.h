#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace flexmorph::io {

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

  std::string place;                    ///< "cases/four_bar.toml:14", or "--set KEY=VALUE"
  std::string shown;                    ///< as it was written: "-0.002", "[10, 2]"
  unsigned line = 0;                    ///< to sort messages
  bool is_option = false;               ///< the very value of a --set option
  mutable std::set<std::string> asked;  ///< keys of a table that somebody asked for
  mutable bool visited = false;         ///< did anybody look into this table?

  const CaseNode* find(const std::string& wanted) const;
  CaseNode* find(const std::string& wanted);
};

/// A case file as a tree.
struct CaseDocument {
  explicit CaseDocument(const std::string& file);  ///< @throws Error (input)

  /// Carries out one "KEY=VALUE" of the command line; "KEY=" takes KEY away. @throws Error (input)
  void apply(const std::string& change);

  void refuse_unknown_keys() const;  ///< @throws Error (input)
  std::string effective_text() const;

  std::string path, text;
  std::vector<std::string> changes;
  CaseNode root;
};

/// "cases/four_bar.toml:14: body.thickness = -0.002"; of a table its path only.
std::string located(const CaseNode& node, const std::string& key_path);

/// How an entry of a list of tables is called: its name, else the body it is about, else its index.
std::string entry_label(const CaseNode& list, size_t index);

/// Path of an entry of the list at `list_path`: a lone entry needs no label.
std::string entry_path(const CaseNode& list, size_t index, const std::string& list_path);

/// The known word a misspelt one probably meant; empty when none is near.
std::string nearest(const std::string& word, std::span<const std::string> known);

/// May it be a key without quotes?
bool is_bare_key(const std::string& word);

}  // namespace flexmorph::io
