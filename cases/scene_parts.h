#pragma once

#include <string>
#include <vector>

#include "cases/scene.h"

/// The two halves of read_scene(): what moves, and what is designed.
namespace flexmorph::cases {

/// [time] or [static], gravity, [[hub]], [[body]], [[joint]], [[point_mass]], [[load]],
/// [[observe]].
void read_motion(const io::Table& root, const Vocabulary& words, Scene& scene);

/// [[joint]] and what must fit together with them; needs hubs and bodies.
void read_joints(const io::Table& root, const Vocabulary& words, Scene& scene);

/// [[load]] on bodies, [[observe]].
void read_loads(const io::Table& root, Scene& scene);

/// [static].
StaticAnalysis read_analysis(const io::Table& t);

/// [[body.line]].
std::vector<BodyLine> read_lines(const io::Table& body_table, const Body& body);

/// A name that becomes part of column names and file names, so: a letter, then letters, digits,
/// underscores.
std::string read_word(const io::Table& t, const std::string& noun);

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
