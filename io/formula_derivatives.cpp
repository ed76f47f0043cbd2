#include "io/formula_operations.h"

namespace flexmorph::io {
namespace {

constexpr int kZero = -1;  // in place of an operation: it is 0 at all times

/// Writes derivatives of operations; what is zero is not written.
class Differentiator {
 public:
  Differentiator(const std::string& text, std::vector<Operation>& operations)
      : text_(text), operations_(operations) {}

  std::array<int, 3> run(int value) {
    const size_t n = operations_.size();
    for (size_t i = 0; i < n; ++i) {
      const Operation o = operations_[i];  // a copy: the list grows
      const auto [rate, acceleration] = derivatives(o, static_cast<int>(i));
      rate_.push_back(rate);
      acceleration_.push_back(acceleration);
    }
    const auto place = static_cast<size_t>(value);
    return {value, written(rate_[place]), written(acceleration_[place])};
  }

 private:
  struct Derivatives {
    int rate = kZero, acceleration = kZero;
  };

  int push(const Operation& operation) {
    if (operations_.size() == kMostOperations) refuse_as_too_long(text_);
    operations_.push_back(operation);
    return static_cast<int>(operations_.size()) - 1;
  }
  int constant(double value) { return push({.op = Op::constant, .number = value}); }
  int written(int a) { return a == kZero ? constant(0) : a; }
  int sum(int a, int b) {
    if (a == kZero || b == kZero) return a == kZero ? b : a;
    return push({.op = Op::add, .a = a, .b = b});
  }
  int product(int a, int b) {
    if (a == kZero || b == kZero) return kZero;
    return push({.op = Op::multiply, .a = a, .b = b});
  }
  int times(double factor, int a) {
    if (a == kZero || factor == 0) return kZero;
    return factor == 1 ? a : product(constant(factor), a);
  }
  int power(int a, int exponent) {
    return push({.op = Op::whole_power, .a = a, .exponent = exponent});
  }
  int call(const std::string& name, int a) {
    return push({.op = Op::call, .a = a, .call = formula_functions().at(name)});
  }
  int rate(int a) const { return rate_[static_cast<size_t>(a)]; }
  int acceleration(int a) const { return acceleration_[static_cast<size_t>(a)]; }

  /// One of two, at the same times as `of`.
  int choice(const Operation& of, int b, int c) {
    if (b == kZero && c == kZero) return kZero;
    b = written(b);
    return push({.op = Op::choose, .a = of.a, .b = b, .c = written(c)});
  }

  Derivatives derivatives(const Operation& o, int self) {
    switch (o.op) {
      case Op::constant:
        return {};
      case Op::time:
        return {constant(1), kZero};
      case Op::add:
        return {sum(rate(o.a), rate(o.b)), sum(acceleration(o.a), acceleration(o.b))};
      case Op::multiply:
        return {sum(product(rate(o.a), o.b), product(o.a, rate(o.b))),
                sum(sum(product(acceleration(o.a), o.b), product(o.a, acceleration(o.b))),
                    times(2, product(rate(o.a), rate(o.b))))};
      case Op::whole_power:
        return of_whole_power(o);
      case Op::power:
        return of_power(o, self);
      case Op::call:
        return of_call(o, self);
      case Op::atan2:
        return of_atan2(o);
      case Op::choose:
        return {choice(o, rate(o.b), rate(o.c)), choice(o, acceleration(o.b), acceleration(o.c))};
    }
    return {};
  }

  /// Of f(x(t)): f' x', f' x" + f" x'².
  Derivatives chain(int x, int f1, int f2) {
    return {product(f1, rate(x)),
            sum(product(f1, acceleration(x)), product(f2, product(rate(x), rate(x))))};
  }

  Derivatives of_whole_power(const Operation& o) {
    const double n = o.exponent;
    if (rate(o.a) == kZero || n == 0) return {};
    const int f1 = times(n, power(o.a, o.exponent - 1));
    const int f2 = n == 1 ? kZero : times(n * (n - 1), power(o.a, o.exponent - 2));
    return chain(o.a, f1, f2);
  }

  /// a^b = exp(b log a): with s = (b log a)' its derivatives are a^b s and a^b (s² + s').
  /// Where b is constant, those of a power; they are good for a = 0 as well.
  Derivatives of_power(const Operation& o, int self) {
    if (rate(o.a) == kZero && rate(o.b) == kZero) return {};
    if (rate(o.b) == kZero) {
      const int b1 = sum(o.b, constant(-1)), b2 = sum(o.b, constant(-2));
      const int f1 = product(o.b, push({.op = Op::power, .a = o.a, .b = b1}));
      const int f2 = product(product(o.b, b1), push({.op = Op::power, .a = o.a, .b = b2}));
      return chain(o.a, f1, f2);
    }
    const int log = call("log", o.a), inverse = power(o.a, -1);
    const int a1 = product(rate(o.a), inverse);  // of log a
    const int a2 = sum(product(acceleration(o.a), inverse), times(-1, product(a1, a1)));
    const int s = sum(product(rate(o.b), log), product(o.b, a1));
    const int s1 = sum(sum(product(acceleration(o.b), log), product(o.b, a2)),
                       times(2, product(rate(o.b), a1)));
    return {product(self, s), product(self, sum(product(s, s), s1))};
  }

  Derivatives of_call(const Operation& o, int f) {
    if (rate(o.a) == kZero) return {};
    std::string name;
    for (const auto& [each, function] : formula_functions())
      if (function == o.call) name = each;
    const int x = o.a;
    const auto square = [&](int a) { return product(a, a); };
    const auto plus_one = [&](double factor, int a) { return sum(constant(1), times(factor, a)); };
    const auto by = [&](int f1, int f2) { return chain(x, f1, f2); };
    if (name == "sin") return by(call("cos", x), times(-1, f));
    if (name == "cos") return by(times(-1, call("sin", x)), times(-1, f));
    if (name == "sinh") return by(call("cosh", x), f);
    if (name == "cosh") return by(call("sinh", x), f);
    if (name == "exp") return by(f, f);
    int f1 = kZero;
    if (name == "tan" || name == "tanh") {
      const double sign = name == "tan" ? 1 : -1;
      f1 = plus_one(sign, square(f));
      return by(f1, times(2 * sign, product(f, f1)));
    }
    if (name == "log") {
      f1 = power(x, -1);
      return by(f1, times(-1, square(f1)));
    }
    if (name == "sqrt") {
      f1 = times(0.5, power(f, -1));
      return by(f1, times(-2, power(f1, 3)));
    }
    if (name == "atan") {
      f1 = power(plus_one(1, square(x)), -1);
      return by(f1, times(-2, product(x, square(f1))));
    }
    f1 = times(name == "asin" ? 1 : -1, power(call("sqrt", plus_one(-1, square(x))), -1));
    return by(f1, product(x, power(f1, 3)));
  }

  /// Of the angle of (x, y): (x y' - y x') / (x² + y²).
  Derivatives of_atan2(const Operation& o) {
    const int y = o.a, x = o.b;
    const int inverse = power(sum(product(x, x), product(y, y)), -1);
    const int turn = sum(product(x, rate(y)), times(-1, product(y, rate(x))));
    const int turn_rate = sum(product(x, acceleration(y)), times(-1, product(y, acceleration(x))));
    const int radius_rate = times(2, sum(product(x, rate(x)), product(y, rate(y))));
    const int r = product(turn, inverse);
    return {r, product(sum(turn_rate, times(-1, product(r, radius_rate))), inverse)};
  }

  const std::string& text_;
  std::vector<Operation>& operations_;
  std::vector<int> rate_, acceleration_;  // of each operation of the value
};

}  // namespace

std::array<int, 3> append_derivatives(const std::string& text, int value,
                                      std::vector<Operation>& operations) {
  return Differentiator(text, operations).run(value);
}

void refuse_as_too_long(const std::string& text) {
  refuse_formula(text, "it is too long: value, rate and acceleration take more than " +
                           std::to_string(kMostOperations) + " operations");
}

}  // namespace flexmorph::io
