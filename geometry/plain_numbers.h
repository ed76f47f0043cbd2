#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace flexmorph {

/// A guard for calls of libraries that write and read numbers in the locale of the process. While
/// it exists, printf, strtod and new C++ streams of the whole process use the C locale, with a
/// decimal point. If the process already uses the C locale, as the program `flexmorph` does, the
/// guard changes nothing, and several threads may use it while others print. Otherwise only one
/// thread may use it.
class PlainNumbers {
 public:
  /// Sets the C locale if the process uses another one.
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
  std::locale cpp_;  // the previous locale (set by the default constructor)
  bool changes_ = false;
};

}  // namespace flexmorph
