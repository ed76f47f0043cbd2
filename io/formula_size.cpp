#include "io/formula_size.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "io/formula_words.h"

namespace flexmorph::io {
namespace {

constexpr double kMostBits = 20'000;      // of an exact number; a double has 53
constexpr double kLargestExponent = 1e6;  // of a power, whatever its base

/// What is known of a part of a formula.
struct Part {
  double bits = 0;       // of the largest exact number in it, at most
  double size = 0;       // of its value where it is a constant, at most
  bool constant = true;  // has neither t nor names in it
};

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  void run() { sum(); }

 private:
  char peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n'))
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  static Part both(const Part& a, const Part& b, double size) {
    return {a.bits + b.bits + 1, size, a.constant && b.constant};
  }

  Part sum() {
    Part out = product();
    while (peek() == '+' || peek() == '-') {
      ++at_;
      const Part next = product();
      out = both(out, next, out.size + next.size);
    }
    return out;
  }

  Part product() {
    Part out = power();
    while (peek() == '*' || peek() == '/') {
      const bool divides = text_[at_++] == '/';
      const Part next = power();
      // A quotient of whole numbers may be larger than its parts are, never than its bits say.
      const double factor = divides ? std::exp2(std::min(next.bits, 1000.0)) : next.size;
      out = both(out, next, out.size * factor);
    }
    return out;
  }

  Part power() {
    Part out = operand();
    while (peek() == '^') {
      const size_t place = at_++;
      const Part exponent = operand();
      if (exponent.constant && !(exponent.size <= kLargestExponent))
        refuse_formula(text_, place, "an exponent is at most 1e6");
      const double times = exponent.constant ? std::max(1.0, exponent.size) : 1;
      out = {out.bits * times + exponent.bits, std::pow(std::max(1.0, out.size), times),
             out.constant && exponent.constant};
      if (out.bits > kMostBits)
        refuse_formula(text_, place,
                       "this power takes more than 20000 bits as an exact number: a smaller "
                       "exponent, or a base with a decimal point");
    }
    return out;
  }

  Part operand() {
    while (peek() == '+' || peek() == '-') ++at_;
    const char c = peek();
    if (c == '(') return inside();
    const size_t start = at_;
    if ((c >= '0' && c <= '9') || c == '.') return number();
    while (at_ < text_.size() && std::string("+-*/^(), \t\n").find(text_[at_]) == std::string::npos)
      ++at_;
    const std::string name = text_.substr(start, at_ - start);
    if (peek() == '(') {
      Part argument = inside();
      // Of exact arguments some functions have exact values: abs(3), exp(0), sqrt(4).
      argument.size = std::max(1.0, std::exp2(std::min(argument.bits, 1000.0)));
      return argument;
    }
    return {.constant = false};
  }

  /// Of parentheses, with all that commas separate.
  Part inside() {
    ++at_;
    Part out = sum();
    while (peek() == ',') {
      ++at_;
      const Part next = sum();
      out = both(out, next, out.size + next.size);
    }
    if (peek() == ')') ++at_;
    return out;
  }

  Part number() {
    const size_t start = at_;
    double value = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    at_ = std::max(start + 1, static_cast<size_t>(end - text_.data()));
    const std::string word = text_.substr(start, at_ - start);
    const bool whole = word.find_first_not_of("0123456789") == std::string::npos;
    // Long ones, and those directly before ^, are read as decimal numbers (DecimalFormula).
    const bool decimal = !whole || peek() == '^' || word.size() > 6;
    return {decimal ? 0 : std::log2(value + 1), std::abs(value), true};
  }

  const std::string& text_;
  size_t at_ = 0;
};

}  // namespace

void check_formula_size(const std::string& text) { Reader(text).run(); }

}  // namespace flexmorph::io
