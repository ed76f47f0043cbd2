#pragma once

#include <deque>
#include <functional>
#include <initializer_list>
#include <optional>
#include <source_location>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/case_files/quantity.h"

/// Keys of case files. Each key is declared once, next to the code that reads it:
///
///   const io::Key& kIterations = io::key("optimizer", "max_iterations")
///                                    .integer("a number of iterations", 0, 1'000'000)
///                                    .otherwise(300)
///                                    .says("Iterations of every stage; 0 analyses the start.");
///
/// The functions of io::Table take keys as arguments, therefore every key that is read is declared.
/// Messages, the reference, the schema and the completion use the same declarations.
namespace flexmorph::io {

/// A list of words that a key allows.
using Words = std::vector<std::string>;
/// A list of words with a sentence that explains each.
using Glossary = std::vector<std::pair<std::string, std::string>>;

/// One form in which the value of a key can be written.
struct Form {
  /// Type of the value; `word` is one of several words, `tables` is a list of tables.
  enum class Kind { number, integer, boolean, text, word, table, tables };

  Kind kind = Kind::number;  ///< Type of the value.

  /// Limits of a number; for other types its noun only, such as "an optimizer".
  Quantity quantity = {};
  int lower = 0, upper = 0;  ///< Limits of an integer.

  /// Allowed words; empty if the case gives the allowed names.
  std::function<Words()> allowed = {};
  bool is_list = false;  ///< True for a list of values, or of rows with `columns` numbers.

  /// Smallest and largest number of entries in a list; most = 0 means no upper limit.
  int least = 1, most = 0;
  int columns = 0;  ///< Number of columns in a list of rows; 0 for other lists.

  /// Noun of the object that an entry may name instead of a number; empty if none.
  std::string or_name = {};

  /// Returns the allowed words; none if the case gives the allowed names.
  Words words() const { return allowed ? allowed() : Words(); }
  /// Returns the length of the list if it is fixed, else 0.
  int count() const { return least == most ? least : 0; }
};

/// A value that is used for a key which the file does not have.
using Value = std::variant<bool, int, double, std::string, std::vector<double>, std::vector<int>>;
/// Returns a value as TOML text.
std::string toml_text(const Value& value);

/// The declaration of a key. Functions that return Key& complete the declaration.
class Key {
 public:
  /// Tables that may have the key: "optimizer", "body.flow", "" for the root table.
  std::vector<std::string> tables;
  /// Name, such as "max_iterations"; "*" in tables in which the user chooses the keys.
  std::string name;
  std::vector<Form> forms;        ///< Forms in which the value can be written.
  std::optional<Value> fallback;  ///< Value that is used if the key is missing.

  /// Meaning of a missing key in words: "the longest length", "nothing is limited".
  std::string absence;
  /// Condition under which the key is allowed, such as `type = "weld"`; empty: always.
  std::string condition;
  std::string sentence;  ///< Sentence that explains the key.

  /// Explanations of the words, if they need any; may be empty.
  std::function<Glossary()> meanings;
  std::vector<std::string> former_names;  ///< Names of the key in the last version.
  /// Words of the last version (of a table with free names: its names) and their present names.
  Glossary renamings;
  std::source_location location;  ///< Location of the declaration in the source code.
  bool is_named = false;          ///< True if the user chose the name, and this is one of the keys.

  /// Adds the form of a number within the limits of a quantity.
  Key& number(Quantity quantity);
  /// Adds the form of an integer between two limits.
  Key& integer(std::string noun, int lower, int upper);
  /// Adds the form of a boolean.
  Key& boolean();
  /// Adds the form of a text of any content.
  Key& text(std::string noun);
  /// Adds the form of one of several words. They are given as a list, as a function that returns
  /// them, or as the rows of a table that also explains them.
  Key& word(std::string noun, Words allowed);
  Key& word(std::string noun, std::function<Words()> allowed);
  Key& word(std::string noun, std::function<Glossary()> allowed);
  /// Adds the form of a name that the case gives to something.
  Key& name_of(std::string noun);

  /// Adds the form of a list of `least` to `most` numbers; most = 0 means no upper limit.
  Key& numbers(Quantity each, int least = 1, int most = 0);
  /// Adds the form of a list in which every entry is a number or the name of something.
  Key& numbers_or_names(Quantity each, std::string noun, int least, int most);
  /// Adds the form of a list of `least` to `most` integers between two limits.
  Key& integers(std::string noun, int lower, int upper, int least = 1, int most = 0);
  /// Adds the form of a list of one or more texts.
  Key& texts(std::string noun);
  /// Adds the form of a list of one or more different words. The words are given as for word().
  Key& words(std::string noun, Words allowed);
  Key& words(std::string noun, std::function<Words()> allowed);
  Key& words(std::string noun, std::function<Glossary()> allowed);
  /// Adds the form of a list of `least` to `most` names that the case gives.
  Key& names_of(std::string noun, int least = 1, int most = 0);
  /// Adds the form of a list of rows with `columns` numbers each.
  Key& rows(Quantity each, int columns);

  /// Adds the form of a table [name].
  Key& table();
  /// Adds the form of a list of tables [[name]].
  Key& tables_of();

  /// Sets the value that is used if the key is missing.
  Key& otherwise(Value value);
  /// Sets the words that explain what a missing key means.
  Key& otherwise_as(std::string words);
  /// Sets the condition under which the key is allowed.
  Key& when(std::string words);
  /// Sets the sentence that explains the key.
  Key& description(std::string words);

  /// Adds a name that the key had in the last version. It is read with a warning.
  Key& formerly(std::string name_of_last_version);
  /// Adds words of the last version and their present names. They are read with a warning.
  Key& renames(Glossary words_and_present_names);

  /// Returns true if the key is required wherever it is allowed, because there is no value for a
  /// missing key.
  bool is_needed() const { return !fallback && absence.empty(); }
  /// Returns the form of a type.
  /// @throws std::logic_error when the key is not declared with this form.
  const Form& form(Form::Kind kind, bool is_list = false) const;

  /// Returns a copy of the key with other limits. The copy is for one case, in which the limits
  /// depend on other keys.
  Key within(double lower, double upper) const;
  /// Returns a copy of the key with another noun.
  Key called(const std::string& noun) const;
  /// Returns a copy of the key with another unit.
  Key measured_in(const std::string& unit) const;
  /// Returns a copy of the key with a fixed number of entries.
  Key counted(int entries) const;
  /// Returns a copy of the key with a name that the user chose, for tables with free keys.
  Key named(std::string name) const;

 private:
  Key& add(Form form);
};

/// Declares a key of one table and adds it to all_keys().
Key& key(std::string table, std::string name,
         std::source_location location = std::source_location::current());
/// Declares a key that several tables have and adds it to all_keys().
Key& shared_key(std::vector<std::string> tables, std::string name,
                std::source_location location = std::source_location::current());

/// Returns all keys that the program declares. Their order depends on the linker.
const std::deque<Key>& all_keys();

/// A key whose words stand for values, for example of an enumeration.
template <class T>
class Choice {
 public:
  /// Adds the form of one of the words to a key.
  /// @param named  words with their values
  Choice(Key& key, std::string noun, std::initializer_list<std::pair<const char*, T>> named)
      : key_(key), named_(named.begin(), named.end()) {
    Words words;
    for (const auto& [word, value] : named_) words.push_back(word);
    key.word(std::move(noun), std::move(words));
  }
  /// Returns the declaration of the key.
  operator const Key&() const { return key_; }

  /// Returns the value of a word, or a default value if the word is unknown.
  T value_of(const std::string& word) const {
    for (const auto& [known, value] : named_)
      if (known == word) return value;
    return {};  // unknown words are rejected when the file is read
  }
  /// Returns the word of a value, or an empty text if it has none.
  std::string word_of(const T& wanted) const {
    for (const auto& [word, value] : named_)
      if (value == wanted) return word;
    return "";
  }

 private:
  const Key& key_;
  std::vector<std::pair<std::string, T>> named_;
};

}  // namespace flexmorph::io
