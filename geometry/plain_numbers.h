#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace flexmorph {

/// While it lives, printf, strtod and new C++ streams of the whole process write and read numbers
/// as the C locale does, with a decimal point, whatever language a host has asked for: for
/// libraries that leave no choice. Where that is how it is already, as everywhere in `flexmorph`,
/// it touches nothing: there several threads may use it, while others print. Else not.
class PlainNumbers {
 public:
  PlainNumbers() : c_(std::setlocale(LC_ALL, nullptr)) {
    changes_ = c_ != "C" || std::locale() != std::locale::classic();
    if (changes_) std::locale::global(std::locale::classic());
  }
  ~PlainNumbers() {
    if (!changes_) return;
    std::locale::global(cpp_);
    std::setlocale(LC_ALL, c_.c_str());
  }
  PlainNumbers(const PlainNumbers&) = delete;
  PlainNumbers& operator=(const PlainNumbers&) = delete;

 private:
  std::string c_;
  std::locale cpp_;  // what it was: the default constructor's
  bool changes_ = false;
};

}  // namespace flexmorph
