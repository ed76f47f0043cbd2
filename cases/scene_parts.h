#pragma once

#include <string>
#include <vector>

#include "cases/scene.h"

/// The two halves of read_scene(): what moves, and what is designed.
namespace flexmorph::cases {

/// [time], gravity, [[hub]], [[body]], [[joint]], [[point_mass]].
void read_motion(const io::Table& root, const Vocabulary& words, Scene& scene);

/// [domain], [[support]], [[load]]: a plate at rest.
void read_static(const io::Table& root, Scene& scene);

/// [[design]], [esl], [optimizer], [cycle], [verify]; needs what read_motion() read.
void read_designs(const io::Table& root, const Vocabulary& words, Scene& scene);

/// Is the ratio a whole number, up to the rounding of decimal input?
bool is_whole(double ratio);

template <class T>
std::vector<std::string> names_of(const std::vector<T>& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const T& each : list) names.push_back(each.name);
  return names;
}

}  // namespace flexmorph::cases
