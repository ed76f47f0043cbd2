#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// A table of rows with names, such as all kinds of joints: those of Flexmorph, and those that a
/// program adds. Rows are added before cases are read, by one thread.
template <class Row>
class Registry {
 public:
  /// @param noun  what messages call a row: "joint"
  /// @param name  returns the name of a row, by which it is told from all others
  Registry(std::string noun, std::string (*name)(const Row&),
           std::initializer_list<const Row*> rows)
      : noun_(std::move(noun)), name_(name), rows_(rows) {}

  /// Returns all rows, in the order in which messages list them.
  std::span<const Row* const> rows() const { return rows_; }

  /// Returns the row of this name; null where there is none.
  const Row* find(std::string_view name) const {
    const auto found =
        std::ranges::find_if(rows_, [&](const Row* row) { return name_(*row) == name; });
    return found == rows_.end() ? nullptr : *found;
  }

  /// Adds a row, which is not copied and lives as long as the program.
  /// @throws Error (input) where the name is empty or another row has it
  void add(const Row& row) {
    const std::string name = name_(row);
    if (name.empty()) throw Error::input("a " + noun_ + " has a name");
    if (find(name)) throw Error::input("there is another " + noun_ + " '" + name + "'");
    rows_.push_back(&row);
  }

 private:
  std::string noun_;
  std::string (*name_)(const Row&);
  std::vector<const Row*> rows_;
};

}  // namespace flexmorph
