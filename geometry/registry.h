#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// A table of named rows, such as all kinds of joints: the rows of Flexmorph, and the rows that a
/// program adds. One thread adds rows before cases are read.
template <class Row>
class Registry {
 public:
  /// Creates a table with its first rows.
  /// @param noun  the name of a row in messages, for example "joint"
  /// @param name  returns the unique name of a row
  Registry(std::string noun, std::string (*name)(const Row&),
           std::initializer_list<const Row*> rows)
      : noun_(std::move(noun)), name_(name), rows_(rows) {}

  /// Returns all rows, in the order in which messages list them.
  std::span<const Row* const> rows() const { return rows_; }

  /// Returns the row of a name, or null if there is none.
  const Row* find(std::string_view name) const {
    const auto found =
        std::ranges::find_if(rows_, [&](const Row* row) { return name_(*row) == name; });
    return found == rows_.end() ? nullptr : *found;
  }

  /// Adds a row. It is not copied, therefore it must exist as long as the program.
  /// @throws Error (input) when the name is empty or another row has it
  void add(const Row& row) {
    const std::string name = name_(row);
    if (name.empty()) throw Error::input("a " + noun_ + " must have a name");
    if (find(name)) throw Error::input("the " + noun_ + " '" + name + "' exists already");
    rows_.push_back(&row);
  }

 private:
  std::string noun_;
  std::string (*name_)(const Row&);
  std::vector<const Row*> rows_;
};

}  // namespace flexmorph
