#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/case_files/key.h"

/// The keys of case files as people and programs read about them. All that is said here comes from
/// the declarations beside the readers (io/case_files/key.h).
namespace flexmorph::cases {

/// The keys of one table, or of several that have the same ones.
struct KeyTable {
  std::vector<std::string> paths;    ///< "body.flow"; "" is the file itself
  std::vector<const io::Key*> keys;  ///< by file and line of their declarations
  const io::Key* own = nullptr;      ///< the key of the table itself; none of the file
  /// "[time]", "[[design.solid]], [[design.void]]", "top of the file".
  std::string title() const;
};

/// All tables, in the order of tables::order().
/// @throws std::logic_error when a table has no keys: its reader is not part of the program.
const std::vector<KeyTable>& key_book();

/// The table of this path ("top" is the file itself).
/// @throws Error (input) naming the nearest one.
const KeyTable& table_of_keys(const std::string& path);
/// Their paths.
std::vector<std::string> key_table_names();

/// "number > 0 [m], or name of a drive".
std::string type_words(const io::Key& key);
/// "required", "0.8", or in words.
std::string default_words(const io::Key& key);
/// The sentence, after the condition under which the key may be there.
std::string sentence_of(const io::Key& key);
/// What the words of its keys mean, by key and word; empty where that is plain.
std::vector<std::array<std::string, 3>> meanings_of(const KeyTable& table);
/// As it is written in a case: NAME where the name is free.
std::string shown_name(const io::Key& key);

/// All of it, or one table, in columns for a screen of this width.
std::string keys_for_terminal(const std::string& table, size_t width);
/// The reference in cases/README.md.
std::string keys_as_markdown();
/// Replaces a generated section of a Markdown file, between the lines that mark it.
/// @param name  of the section in these lines: "keys"
/// @throws Error (input) for a file without these lines
std::string with_section(const std::string& text, const std::string& name,
                         const std::string& section);
/// JSON schema (draft-07) of a case.
std::string keys_as_schema();

}  // namespace flexmorph::cases
