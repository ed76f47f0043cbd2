#include <algorithm>
#include <cctype>

#include "cases/scene/read.h"

namespace flexmorph::cases {

using io::Table;

std::string read_word(const Table& t, const std::string& noun) {
  std::string name = t.string("name", noun);
  const auto is_word_letter = [](char c) { return std::isalnum(c) || c == '_'; };
  if (name.empty() || static_cast<unsigned char>(name[0]) > 127 || !std::isalpha(name[0]) ||
      !std::all_of(name.begin(), name.end(), is_word_letter))
    t.fail("name", noun + " begins with a letter; letters, digits and _ follow");
  return name;
}

std::string read_name(const Table& t, const std::string& noun, const Scene& scene) {
  std::string name = read_word(t, noun);
  if (name == "energy") t.fail("name", "'energy' names columns of motion.csv already");
  if (name == "ground") t.fail("name", "'ground' is what does not move");
  for (const std::vector<std::string>& taken :
       {names_of(scene.hubs), names_of(scene.bodies), names_of(scene.rigid_bodies)})
    for (const std::string& other : taken)
      if (name == other) t.fail("name", "there is another '" + name + "'");
  return name;
}

}  // namespace flexmorph::cases
