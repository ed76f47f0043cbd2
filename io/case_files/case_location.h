#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "io/case_files/case_document.h"
#include "io/case_files/case_file.h"
#include "io/case_files/case_forms.h"

namespace flexmorph::io {

/// The location of a Table in its document. Copies of the Table share it; it keeps the document in
/// memory.
struct Table::Location {
  std::shared_ptr<CaseDocument> document;  ///< Document that contains the table.
  const CaseNode* table;                   ///< Node of the table.
  std::string path;                        ///< Path of the table.
  std::string kind;  ///< Path without names and indices of entries, as in the declarations of keys.

  /// Returns the path of a key of the table.
  std::string full(const std::string& key) const { return path.empty() ? key : path + "." + key; }

  /// Returns the node of a key, or nullptr, and marks the key as known.
  const CaseNode* find(const std::string& key) const {
    table->visited = true;
    table->asked.insert(key);
    return table->find(key);
  }

  /// Throws an error about a missing key.
  /// @throws Error (input) that names the missing key, or the misspelt key that was probably meant.
  [[noreturn]] void fail_missing(const std::string& key, const std::string& allowed) const;
  /// Throws an error about the value of a key.
  /// @throws Error (input) with the location, the value and the allowed values.
  [[noreturn]] void fail(const std::string& key, const std::string& allowed) const;

  /// Returns the form with which a key is to be read.
  /// @throws std::logic_error for a key of another table, or of another form.
  const Form& form(const Key& key, Form::Kind kind, bool is_list = false) const;

  /// Stores a note about a key for the explained case.
  void note(const Key& key, const std::string& value) const {
    table->note({key.name, key.sentence, value,
                 key.fallback ? toml_text(*key.fallback) : std::string(), key.absence});
  }

  /// Returns the value of a key. If the file has the key, `read` converts its node and returns
  /// nothing for a value that is not allowed. If the file lacks it, the value is `computed` or else
  /// the declared fallback.
  template <class T, class Read>
  T value(const Key& key, const std::optional<T>& computed, const std::string& allowed,
          Read read) const {
    const CaseNode* node = find(key.name);
    const std::optional<T> missing = computed ? computed : fallback_of<T>(key);
    if (!node && !missing) fail_missing(key.name, allowed);
    const std::optional<T> found = node ? read(*node) : missing;
    if (!found) fail(key.name, allowed + refusal_of_number(*node, number_of(key)));
    if constexpr (std::is_constructible_v<Value, T>)
      note(key, node ? "" : toml_text(*found));
    else
      note(key, "");
    return *found;
  }

  /// Returns the entries of a list, each converted by `read`.
  template <class T, class Read>
  std::vector<T> list(const Key& key, const Form& form, const std::string& allowed,
                      const std::optional<std::vector<T>>& computed, Read read) const {
    using List = std::vector<T>;
    const std::string each = list_of(form) + allowed;
    return value<List>(key, computed, each, [&](const CaseNode& node) -> std::optional<List> {
      const size_t size = node.entries.size();
      if (node.kind != CaseNode::Kind::list ||
          size < static_cast<size_t>(std::max(form.least, 1)) ||
          (form.most > 0 && size > static_cast<size_t>(form.most)))
        return {};
      List values;
      for (const CaseNode& entry : node.entries) {
        const std::optional<T> one = read(entry);
        if (!one) return {};
        values.push_back(*one);
      }
      return values;
    });
  }

 private:
  /// Returns the limits of the numbers that a key takes.
  static Quantity number_of(const Key& key) {
    for (const Form& form : key.forms)
      if (form.kind == Form::Kind::number) return form.quantity;
    return {};
  }

  /// Returns the fallback with which a key is declared, if there is one.
  template <class T>
  static std::optional<T> fallback_of(const Key& key) {
    if constexpr (std::is_constructible_v<Value, T>) {
      if (!key.fallback) return {};
      if constexpr (std::is_same_v<T, double>)
        if (const int* whole = std::get_if<int>(&*key.fallback)) return *whole;
      // A key that takes a number or a word has a fallback of one kind only.
      if (const T* value = std::get_if<T>(&*key.fallback)) return *value;
    }
    return {};
  }
};

}  // namespace flexmorph::io
