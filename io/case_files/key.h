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

/// Keys of case files, each declared once, beside the code that reads it:
///
///   const io::Key& kIterations = io::key("optimizer", "max_iterations")
///                                    .integer("a number of iterations", 0, 1'000'000)
///                                    .otherwise(300)
///                                    .says("Iterations of every stage; 0 analyses the start.");
///
/// Readers (io::Table) take keys, so what is read is declared; messages, the reference, the schema
/// and completion are made from the same declarations.
namespace flexmorph::io {

using Words = std::vector<std::string>;
/// Words, and a sentence to each.
using Glossary = std::vector<std::pair<std::string, std::string>>;

/// One way to write the value of a key.
struct Form {
  enum class Kind { number, integer, boolean, text, word, table, tables };

  Kind kind = Kind::number;
  Quantity quantity = {};               ///< of numbers; of other kinds its noun: "an optimizer"
  int lower = 0, upper = 0;             ///< of integers
  std::function<Words()> allowed = {};  ///< of words; empty: names that the case gives
  bool is_list = false;                 ///< [...] of values, or of rows of `columns` numbers
  int least = 1, most = 0;              ///< entries of a list; most = 0: any number of them
  int columns = 0;                      ///< of a list of rows
  std::string or_name = {};  ///< of a list of numbers: what an entry may name instead; empty: none

  Words words() const { return allowed ? allowed() : Words(); }
  /// Of the list when its length is fixed, else 0.
  int count() const { return least == most ? least : 0; }
};

/// A value that is not in the file.
using Value = std::variant<bool, int, double, std::string, std::vector<double>, std::vector<int>>;
/// As TOML says it.
std::string toml_text(const Value& value);

/// The declaration of a key. All but the last group of functions complete it and return it.
class Key {
 public:
  std::vector<std::string> tables;  ///< "optimizer", "body.flow", "" for the file itself
  std::string name;                 ///< "max_iterations"; "*" in tables whose keys are free
  std::vector<Form> forms;
  std::optional<Value> fallback;  ///< what is taken where the key is missing
  std::string absence;            ///< or in words: "the longest length", "nothing is limited"
  std::string condition;          ///< when it may be there: `type = "weld"`; empty: always
  std::string sentence;
  std::function<Glossary()> meanings;  ///< of its words, where they need one; may be empty
  std::source_location place;          ///< of the declaration
  bool is_named = false;               ///< its name is free, and this is one of them

  Key& number(Quantity quantity);
  Key& integer(std::string noun, int lower, int upper);
  Key& boolean();
  Key& text(std::string noun);
  Key& word(std::string noun, Words allowed);
  Key& word(std::string noun, std::function<Words()> allowed);
  Key& word(std::string noun, std::function<Glossary()> allowed);  ///< rows of a table
  Key& name_of(std::string noun);  ///< of something that the case gives a name

  /// Lists of `least` to `most` entries; of one or more without them.
  Key& numbers(Quantity each, int least = 1, int most = 0);
  /// The same where every entry may be the name of something instead.
  Key& numbers_or_names(Quantity each, std::string noun, int least, int most);
  Key& integers(std::string noun, int lower, int upper, int least = 1, int most = 0);
  Key& texts(std::string noun);
  Key& words(std::string noun, Words allowed);
  Key& words(std::string noun, std::function<Words()> allowed);
  Key& words(std::string noun, std::function<Glossary()> allowed);
  Key& names_of(std::string noun, int least = 1, int most = 0);
  Key& rows(Quantity each, int columns);

  Key& table();      ///< [name]
  Key& tables_of();  ///< [[name]]

  Key& otherwise(Value value);
  Key& otherwise_as(std::string words);
  Key& when(std::string words);
  Key& says(std::string words);

  /// Has it a value wherever it may be there? Then it must be written.
  bool is_needed() const { return !fallback && absence.empty(); }
  /// The form of this kind. @throws std::logic_error when the key is declared without it.
  const Form& form(Form::Kind kind, bool is_list = false) const;

  /// The key as it is in one case, where that depends on other keys: in other limits, ...
  Key within(double lower, double upper) const;
  Key called(std::string noun) const;
  Key measured_in(std::string unit) const;
  Key counted(int entries) const;
  Key named(std::string name) const;  ///< of a table whose keys are free

 private:
  Key& add(Form form);
};

/// A new key in the book.
Key& key(std::string table, std::string name,
         std::source_location place = std::source_location::current());
/// One that several tables have.
Key& shared_key(std::vector<std::string> tables, std::string name,
                std::source_location place = std::source_location::current());

/// All keys that the program declares, in no order: that of the linker.
const std::deque<Key>& all_keys();

/// A key whose words mean values of an enumeration (or others).
template <class T>
class Choice {
 public:
  Choice(Key& key, std::string noun, std::initializer_list<std::pair<const char*, T>> named)
      : key_(key), named_(named.begin(), named.end()) {
    Words words;
    for (const auto& [word, value] : named_) words.push_back(word);
    key.word(std::move(noun), std::move(words));
  }
  operator const Key&() const { return key_; }

  T value_of(const std::string& word) const {
    for (const auto& [known, value] : named_)
      if (known == word) return value;
    return {};  // words are checked when they are read
  }
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
