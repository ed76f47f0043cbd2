#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace flexmorph {

/// While it lives, printf, strtod and new C++ streams of the whole process write and read numbers
/// as the C locale does, with a decimal point, whatever language a host has asked for: for
/// libraries that leave no choice. Not for several threads at once.
class PlainNumbers {
 public:
  PlainNumbers()
      : c_(std::setlocale(LC_ALL, nullptr)), cpp_(std::locale::global(std::locale::classic())) {}
  ~PlainNumbers() {
    std::locale::global(cpp_);
    std::setlocale(LC_ALL, c_.c_str());
  }
  PlainNumbers(const PlainNumbers&) = delete;
  PlainNumbers& operator=(const PlainNumbers&) = delete;

 private:
  std::string c_;
  std::locale cpp_;
};

}  // namespace flexmorph
