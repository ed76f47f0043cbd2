#include "io/formula.h"

#include <ginac/ginac.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "geometry/base.h"
#include "io/formula_operations.h"
#include "io/formula_size.h"
#include "io/formula_words.h"

namespace flexmorph::io {
namespace {

/// What GiNaC says, without the place in its own source and its name.
std::string words_of(const std::exception& e) {
  std::string words = e.what();
  words = words.substr(0, words.find("\n["));
  for (const std::string start : {"GiNaC: ", "parse error at line 0, column 0: "})
    if (words.starts_with(start)) words = words.substr(start.size());
  if (words.find("division by zero") != std::string::npos)
    return "division by zero, or a power of 0 whose exponent is not positive at all times";
  if (words.find("::") != std::string::npos) return "it has no value";
  return words;
}

/// GiNaC's parse_error has no place, but its parser is one character behind the word it dislikes.
size_t place_of(std::istringstream& stream, const DecimalFormula& decimal,
                const std::exception& e) {
  const std::string words = words_of(e);
  const size_t got = words.find("got: \"");
  if (got == std::string::npos || words.ends_with("EOF")) return decimal.origin.back();
  const size_t length = words.rfind('"') - (got + 6);
  const bool at_end = stream.eof() || stream.fail();
  const size_t end = at_end ? decimal.text.size() : static_cast<size_t>(stream.tellg()) - 1;
  return decimal.origin[end - std::min(end, length)];
}

/// Functions that GiNaC does not look into: kChoose(x, a, b) is a where x >= 0, else b; kFrom(s, a,
/// b) is a from the time s on, b before.
constexpr const char *kChoose = "choose", *kFrom = "from";

unsigned serial_of(const char* name) {
  static const unsigned kOfChoose =
      GiNaC::function::register_new(GiNaC::function_options(kChoose, 3));
  static const unsigned kOfFrom = GiNaC::function::register_new(GiNaC::function_options(kFrom, 3));
  return name == kChoose ? kOfChoose : kOfFrom;
}

GiNaC::ex choose(const GiNaC::ex& x, const GiNaC::ex& a, const GiNaC::ex& b) {
  return GiNaC::function(serial_of(kChoose), x, a, b);
}

using Arguments = GiNaC::exvector;

GiNaC::ex smooth_step(const Arguments& x) {
  const GiNaC::ex& u = x[0];
  return choose(u, choose(u - 1, 1, u * u * (3 - 2 * u)), 0);
}

/// piecewise(x0, t1, x1, t2, x2): x0 until t1, x1 from there, x2 from t2.
GiNaC::ex piecewise(const Arguments& x) {
  GiNaC::ex out = x[0];
  double last = -std::numeric_limits<double>::infinity();
  for (size_t i = 1; i < x.size(); i += 2) {
    const GiNaC::ex time = x[i].evalf();
    if (!GiNaC::is_a<GiNaC::numeric>(time) || !GiNaC::ex_to<GiNaC::numeric>(time).is_real())
      throw std::invalid_argument("piecewise(x0, t1, x1, ...): its times are constants");
    const double from = GiNaC::ex_to<GiNaC::numeric>(time).to_double();
    if (!(from > last)) throw std::invalid_argument("piecewise(x0, t1, x1, ...): times increase");
    last = from;
    out = GiNaC::function(serial_of(kFrom), GiNaC::numeric(from), x[i + 1], out);
  }
  return out;
}

/// GiNaC's own functions, and those with kinks.
GiNaC::prototype_table prototypes() {
  constexpr size_t kMostPieces = 100;
  GiNaC::prototype_table out = GiNaC::get_default_reader();
  // The functions of version 1.8.8 have no default constructor, which operator[] would need.
  const auto add = [&out](const GiNaC::prototype& name, GiNaC::ex (*function)(const Arguments&)) {
    out.insert_or_assign(name, function);
  };
  add({"min", 2}, [](const Arguments& x) { return choose(x[1] - x[0], x[0], x[1]); });
  add({"max", 2}, [](const Arguments& x) { return choose(x[0] - x[1], x[0], x[1]); });
  add({"abs", 1}, [](const Arguments& x) { return choose(x[0], x[0], -x[0]); });
  add({"step", 1}, [](const Arguments& x) { return choose(x[0], 1, 0); });
  add({"smoothstep", 1}, smooth_step);
  for (size_t pieces = 2; pieces <= kMostPieces; ++pieces)
    add({"piecewise", 2 * pieces - 1}, piecewise);
  return out;
}

GiNaC::ex parsed(const std::string& text, const std::map<std::string, double>& constants,
                 const GiNaC::realsymbol& t) {
  check_formula_words(text, constants);
  check_formula_size(text);
  GiNaC::symtab names = {{"t", t}, {"pi", GiNaC::Pi}};
  for (const auto& [name, value] : constants) names[name] = GiNaC::numeric(value);
  const DecimalFormula decimal(text);
  std::istringstream stream(decimal.text);
  stream.imbue(std::locale::classic());
  try {
    static const GiNaC::prototype_table kPrototypes = prototypes();
    GiNaC::parser parser(names, true, kPrototypes);
    return parser(stream);
  } catch (const GiNaC::parse_error& e) {
    refuse_formula(text, place_of(stream, decimal, e), words_of(e));
  } catch (const std::exception& e) {
    refuse_formula(text, words_of(e));
  }
}

double whole_power(double x, int n) {
  double out = 1, square = n < 0 ? 1 / x : x;
  for (unsigned k = static_cast<unsigned>(std::abs(n)); k > 0; k >>= 1, square *= square)
    if (k & 1U) out *= square;
  return out;
}

}  // namespace

namespace {

/// Writes expressions as operations; equal ones once.
class Translator {
 public:
  Translator(const std::string& text, const GiNaC::realsymbol& t) : text_(text), t_(t) {}

  int translate(const GiNaC::ex& e) {
    const auto known = known_.find(e);
    if (known != known_.end()) return known->second;
    const int result = write(e);
    known_.emplace(e, result);
    return result;
  }

  std::vector<Operation> operations;
  bool chooses = false;  ///< has it parts that GiNaC does not differentiate?

 private:
  int push(const Operation& operation) {
    if (operations.size() == kMostOperations) refuse_as_too_long(text_);
    operations.push_back(operation);
    return static_cast<int>(operations.size()) - 1;
  }

  int constant(double value) {
    if (!std::isfinite(value)) refuse_formula(text_, "a number in it is too large");
    return push({.op = Op::constant, .number = value});
  }

  int call(const std::string& name, int argument) {
    return push({.op = Op::call, .a = argument, .call = formula_functions().at(name)});
  }

  int write(const GiNaC::ex& e) {
    if (GiNaC::is_a<GiNaC::numeric>(e)) {
      const GiNaC::numeric& number = GiNaC::ex_to<GiNaC::numeric>(e);
      if (!number.is_real()) refuse_formula(text_, "its value is no real number");
      return constant(number.to_double());
    }
    if (e.is_equal(t_)) return push({.op = Op::time});
    if (e.is_equal(GiNaC::Pi)) return constant(std::numbers::pi);
    if (GiNaC::is_a<GiNaC::add>(e)) return write_chain(e, Op::add);
    if (GiNaC::is_a<GiNaC::mul>(e)) return write_chain(e, Op::multiply);
    if (GiNaC::is_a<GiNaC::power>(e)) return write_power(e);
    if (GiNaC::is_a<GiNaC::function>(e)) return write_function(e);
    refuse_formula(text_, "a part of it has no value");
  }

  /// GiNaC keeps operands in an order that depends on where its library lies in memory; sums would
  /// be rounded in another way in every process.
  int write_chain(const GiNaC::ex& e, Op op) {
    std::vector<std::pair<std::uint64_t, GiNaC::ex>> operands;
    for (size_t i = 0; i < e.nops(); ++i) operands.emplace_back(mark_of(e.op(i)), e.op(i));
    std::stable_sort(operands.begin(), operands.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    int result = translate(operands.front().second);
    for (size_t i = 1; i < operands.size(); ++i)
      result = push({.op = op, .a = result, .b = translate(operands[i].second)});
    return result;
  }

  /// A number that depends on what an expression is, whatever the order of its operands.
  std::uint64_t mark_of(const GiNaC::ex& e) {
    const auto known = marks_.find(e);
    if (known != marks_.end()) return known->second;
    const bool commutes = GiNaC::is_a<GiNaC::add>(e) || GiNaC::is_a<GiNaC::mul>(e);
    std::vector<std::uint64_t> parts;
    for (size_t i = 0; i < e.nops(); ++i) parts.push_back(mark_of(e.op(i)));
    if (commutes) std::sort(parts.begin(), parts.end());
    std::uint64_t mark = mixed(0, e.nops());
    if (GiNaC::is_a<GiNaC::numeric>(e) && GiNaC::ex_to<GiNaC::numeric>(e).is_real())
      mark = mixed(1, std::bit_cast<std::uint64_t>(GiNaC::ex_to<GiNaC::numeric>(e).to_double()));
    else if (e.is_equal(t_))
      mark = mixed(2, 0);
    else if (GiNaC::is_a<GiNaC::add>(e))
      mark = mixed(3, 0);
    else if (GiNaC::is_a<GiNaC::mul>(e))
      mark = mixed(4, 0);
    else if (GiNaC::is_a<GiNaC::function>(e))
      for (const char c : GiNaC::ex_to<GiNaC::function>(e).get_name())
        mark = mixed(mark, static_cast<unsigned char>(c));
    for (const std::uint64_t part : parts) mark = mixed(mark, part);
    marks_.emplace(e, mark);
    return mark;
  }

  /// One more number into a mark: the finalizer of SplitMix64 (Steele, Lea & Flood 2014).
  static std::uint64_t mixed(std::uint64_t mark, std::uint64_t number) {
    std::uint64_t z = mark * 31 + number + 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  int write_power(const GiNaC::ex& e) {
    const int base = translate(e.op(0));
    if (GiNaC::is_a<GiNaC::numeric>(e.op(1)) && GiNaC::ex_to<GiNaC::numeric>(e.op(1)).is_real()) {
      const double n = GiNaC::ex_to<GiNaC::numeric>(e.op(1)).to_double();
      constexpr double kLargest = 64;
      if (n == std::round(n) && std::abs(n) <= kLargest)
        return push({.op = Op::whole_power, .a = base, .exponent = static_cast<int>(n)});
      if (2 * n == std::round(2 * n) && std::abs(n) <= kLargest) {
        const int root = translate_root(e.op(0), base);
        return push({.op = Op::whole_power, .a = root, .exponent = static_cast<int>(2 * n)});
      }
    }
    const int exponent = translate(e.op(1));
    return push({.op = Op::power, .a = base, .b = exponent});
  }

  /// The square root that powers with exponents 1/2, -1/2, -3/2 share.
  int translate_root(const GiNaC::ex& e, int base) {
    const auto [place, is_new] = roots_.try_emplace(e, 0);
    if (is_new) place->second = call("sqrt", base);
    return place->second;
  }

  int write_function(const GiNaC::ex& e) {
    const std::string name = GiNaC::ex_to<GiNaC::function>(e).get_name();
    if (name == "abs" || name == kChoose || name == kFrom) return write_choice(e, name);
    if (name == "atan2") {
      const int y = translate(e.op(0)), x = translate(e.op(1));
      return push({.op = Op::atan2, .a = y, .b = x});
    }
    if (!formula_functions().contains(name)) refuse_formula(text_, "it has no derivative");
    return call(name, translate(e.op(0)));
  }

  int write_choice(const GiNaC::ex& e, const std::string& name) {
    chooses = true;
    int x = translate(e.op(0));
    if (name == "abs") {  // of GiNaC's own making: sqrt(t^2)
      const int minus = push({.op = Op::multiply, .a = constant(-1), .b = x});
      return push({.op = Op::choose, .a = x, .b = x, .c = minus});
    }
    if (name == kFrom) {  // as exact as the time itself
      const int minus = constant(-operations[static_cast<size_t>(x)].number);
      x = push({.op = Op::add, .a = translate(t_), .b = minus});
    }
    const int a = translate(e.op(1)), b = translate(e.op(2));
    return push({.op = Op::choose, .a = x, .b = a, .c = b});
  }

  const std::string& text_;
  const GiNaC::realsymbol& t_;
  std::map<GiNaC::ex, int, GiNaC::ex_is_less> known_, roots_;
  std::map<GiNaC::ex, std::uint64_t, GiNaC::ex_is_less> marks_;
};

/// Nodes of an expression and of its derivatives as GiNaC writes them, at most.
struct Sizes {
  double of_value = 1, of_rate = 0, of_acceleration = 0;
};

/// More than this is not differentiated as an expression: the derivatives of a product of n factors
/// have n² and n³ of them.
constexpr double kMostSymbolic = 20'000;

Sizes size_of(const GiNaC::ex& e, const GiNaC::realsymbol& t) {
  if (e.is_equal(t)) return {1, 1, 1};
  Sizes out;
  double moving = 0;  // operands that depend on time
  for (size_t i = 0; i < e.nops(); ++i) {
    const Sizes part = size_of(e.op(i), t);
    out.of_value += part.of_value;
    out.of_rate += part.of_rate;
    out.of_acceleration += part.of_acceleration;
    moving += part.of_rate > 0 ? 1 : 0;
  }
  if (moving == 0 || GiNaC::is_a<GiNaC::add>(e)) return out;
  // Each moving operand: all others times its own derivative, of a function its derivative too.
  constexpr double kOfFunction = 5;
  const double factors = moving + (GiNaC::is_a<GiNaC::mul>(e) ? 0 : 1);
  out.of_acceleration += factors * (factors * (out.of_value + kOfFunction) + 2 * out.of_rate);
  out.of_rate += factors * (out.of_value + kOfFunction);
  return out;
}

}  // namespace

Formula::Formula(std::string text, const std::map<std::string, double>& constants)
    : text_(std::move(text)) {
  for (const auto& [name, value] : constants) {
    const std::string why = refusal_of_name(name);
    if (!why.empty()) throw Error::input("constant '" + name + "': " + why);
    if (!std::isfinite(value)) throw Error::input("constant '" + name + "': not a finite number");
  }
  const GiNaC::realsymbol t("t");
  const GiNaC::ex value = parsed(text_, constants, t);
  auto program = std::make_shared<Program>();
  Translator translator(text_, t);
  try {
    const int result = translator.translate(value);
    if (translator.chooses || size_of(value, t).of_acceleration > kMostSymbolic) {
      program->results = append_derivatives(text_, result, translator.operations);
    } else {
      const GiNaC::ex rate = value.diff(t), acceleration = rate.diff(t);
      program->results = {result, translator.translate(rate), translator.translate(acceleration)};
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    refuse_formula(text_, words_of(e));
  }
  program->operations = std::move(translator.operations);
  program_ = std::move(program);
}

void Formula::Program::run(double t, double* x) const {
  double* out = x;
  for (const Operation& o : operations) {
    switch (o.op) {
      case Op::constant:
        *out = o.number;
        break;
      case Op::time:
        *out = t;
        break;
      case Op::add:
        *out = x[o.a] + x[o.b];
        break;
      case Op::multiply:
        *out = x[o.a] * x[o.b];
        break;
      case Op::whole_power:
        *out = whole_power(x[o.a], o.exponent);
        break;
      case Op::power:
        *out = std::pow(x[o.a], x[o.b]);
        break;
      case Op::call:
        *out = o.call(x[o.a]);
        break;
      case Op::atan2:
        *out = std::atan2(x[o.a], x[o.b]);
        break;
      case Op::choose:
        *out = x[o.a] >= 0 ? x[o.b] : x[o.c];
        break;
    }
    ++out;
  }
}

Jet Formula::operator()(double t) const {
  double x[kMostOperations];  // NOLINT: no more of it is touched than the formula has operations
  program_->run(t, x);
  const auto& [value, rate, acceleration] = program_->results;
  return {x[value], x[rate], x[acceleration]};
}

int Formula::n_operations() const { return static_cast<int>(program_->operations.size()); }

}  // namespace flexmorph::io
