#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace flexmorph::testing {

/// Changes texts at random, the same way for the same seed on every machine.
class Mutations {
 public:
  explicit Mutations(std::uint64_t seed) : state_(seed) {}

  /// A text with one to four changes: bytes, numbers, words, lines; lines and words of `other` too.
  std::string changed(const std::string& text, const std::string& other);

  /// A formula of operators, functions, numbers and the time, at most `depth` deep; sometimes not
  /// one at all.
  std::string formula(int depth);

  /// 0, ..., n - 1; n > 0.
  size_t below(size_t n);

 private:
  void change(std::string& text, const std::string& other);
  void change_word(std::string& text, const std::string& other);
  void change_line(std::string& text, const std::string& other);
  std::string number();

  std::uint64_t state_;
};

}  // namespace flexmorph::testing
