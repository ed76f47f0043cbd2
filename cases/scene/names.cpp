#include <algorithm>
#include <cctype>

#include "cases/scene/read.h"

namespace flexmorph::cases {

using io::Table;

namespace {

constexpr size_t kLongestName = 64;  // because names become parts of file names

}  // namespace

std::string read_word(const Table& t, const io::Key& key) {
  std::string name = t.string(key);
  const auto is_word_letter = [](char c) { return std::isalnum(c) || c == '_'; };
  if (name.empty() || static_cast<unsigned char>(name[0]) > 127 || !std::isalpha(name[0]) ||
      !std::all_of(name.begin(), name.end(), is_word_letter) || name.size() > kLongestName)
    t.fail(key, key.form(io::Form::Kind::text).quantity.noun +
                    " begins with a letter, followed by letters, digits and _, with at most " +
                    std::to_string(kLongestName) + " characters in total");
  return name;
}

std::string read_flexible(const Table& t, const io::Key& key, const Scene& scene) {
  const std::vector<std::string> known = names_of(scene.bodies);
  const auto refuse_other = [&](const std::vector<std::string>& others, const char* what) {
    if (t.says_one_of(key, others))
      t.fail(key, std::string("this is ") + what + "; " +
                      key.form(io::Form::Kind::word).quantity.noun +
                      " is a plate or beam ([[body]])");
  };
  refuse_other(names_of(scene.rigid_bodies), "a rigid body");
  refuse_other(names_of(scene.hubs), "a hub");
  return t.choice(key, known);
}

std::string read_name(const Table& t, const io::Key& key, const Scene& scene) {
  std::string name = read_word(t, key);
  if (name == "energy") t.fail(key, "'energy' is the name of columns of motion.csv");
  if (name == "ground") t.fail(key, "'ground' is the name of the fixed ground");
  for (const std::vector<std::string>& taken :
       {names_of(scene.hubs), names_of(scene.bodies), names_of(scene.rigid_bodies)})
    for (const std::string& other : taken)
      if (name == other) t.fail(key, "another body or hub has the name '" + name + "'");
  return name;
}

}  // namespace flexmorph::cases
