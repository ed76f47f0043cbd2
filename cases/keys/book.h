#pragma once

#include <string>
#include <vector>

#include "io/case_files/key.h"

/// The reference of the keys of case files, for users and for programs. All texts come from the
/// declarations next to the code that reads the keys (io/case_files/key.h).
namespace flexmorph::cases {

/// The keys of one table of case files, or of several tables with equal keys.
struct KeyTable {
  std::vector<std::string> paths;    ///< Paths, such as "body.flow"; "" is the file itself.
  std::vector<const io::Key*> keys;  ///< Keys: name, type, then by file and line of declaration.
  const io::Key* own = nullptr;      ///< Key of the table itself; null for the file.

  /// Returns the title: "[time]", "[[design.solid]], [[design.void]]", "top of the file".
  std::string title() const;
};

/// Returns all tables in the order of tables::order().
/// @throws std::logic_error when a table has no keys: its reader is not part of the program.
const std::vector<KeyTable>& key_book();

/// Returns the table of a path ("top" is the file itself).
/// @throws Error (input) with the most similar path if there is no such table.
const KeyTable& table_of_keys(const std::string& path);
/// Returns the paths of all tables; "top" is the file itself.
std::vector<std::string> key_table_names();

/// Returns the type of a key as text, such as "number > 0 [m], or name of a drive".
std::string type_text(const io::Key& key);
/// Returns the default of a key as text: "required", a value such as "0.8", or words.
std::string default_text(const io::Key& key);
/// Returns the sentence of a key, after the condition under which the key is allowed.
std::string sentence_of(const io::Key& key);
/// Explanations of the words that one key of a table allows.
struct WordMeanings {
  std::string key;        ///< Name of the key.
  io::Glossary words;     ///< Words and sentences; empty if an earlier table explains them.
  std::string explained;  ///< Title of the earlier table that explains the words; may be empty.

  /// Returns the sentence that refers to the earlier table; empty if there is none.
  std::string reference() const;
};

/// Returns the explanations of the words that the keys of a table allow. The words of keys that
/// have the same name and the same words in several tables are explained in the first one only.
/// Keys whose words need no explanation are left out.
std::vector<WordMeanings> meanings_of(const KeyTable& table);
/// Returns the name of a key as it is shown: NAME if the user chooses the name.
std::string shown_name(const io::Key& key);

/// Explains what is accepted as a number.
inline constexpr const char* kNumbersSentence =
    "Numbers are in the unit in brackets. In quotes, a number may be a formula of [constants], "
    "such "
    "as \"2*h\", or have another unit, such as \"12 mm\", \"30 deg\" or \"7.85 g/cm^3\".";

/// Returns the reference of one table, of all tables if `word` is empty, or of all keys with the
/// word in their name or sentence if no table has this name, in columns.
/// @param word   path of a table, or part of a name or of a sentence
/// @param width  width of the screen [characters]
/// @throws Error (input) with the most similar table if nothing is found.
std::string keys_for_terminal(const std::string& word, size_t width);
/// Returns the reference of all tables as Markdown, for cases/docs/keys.md.
std::string keys_as_markdown();
/// Replaces a generated section of a Markdown file between the two lines that mark it.
/// @param text  content of the file
/// @param name  name of the section in these lines: "keys"
/// @returns the new content
/// @throws Error (input) for a file without these lines
std::string with_section(const std::string& text, const std::string& name,
                         const std::string& section);
/// Returns the JSON schema (draft-07) of case files.
std::string keys_as_schema();

}  // namespace flexmorph::cases
