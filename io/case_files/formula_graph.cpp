#include "io/case_files/formula_graph.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace flexmorph::io {

/// A function of one argument, and its derivative at x as a node, where f is the node of its value.
struct ElementaryFunction {
  const char* name;
  double (*value)(double);
  Node (*derivative)(Node x, Node f);
};

namespace {

constexpr const char* kNoQuotient =
    "it contains a division by zero, or a power of 0 whose exponent is not always positive";
constexpr double kLargestWhole = 64;  // largest exponent that is computed by multiplications
constexpr double kLargestLog = 200;  // limit for the factor of a power, so that no double overflows

// sqrt has no derivative here, because it is differentiated as a power.
const ElementaryFunction kFunctions[] = {
    {"sin", std::sin, [](Node x, Node) { return call("cos", x); }},
    {"cos", std::cos, [](Node x, Node) { return -call("sin", x); }},
    {"tan", std::tan, [](Node, Node f) { return 1 + f * f; }},
    {"asin", std::asin, [](Node x, Node) { return power(1 + -(x * x), -0.5); }},
    {"acos", std::acos, [](Node x, Node) { return -power(1 + -(x * x), -0.5); }},
    {"atan", std::atan, [](Node x, Node) { return power(1 + x * x, -1); }},
    {"sinh", std::sinh, [](Node x, Node) { return call("cosh", x); }},
    {"cosh", std::cosh, [](Node x, Node) { return call("sinh", x); }},
    {"tanh", std::tanh, [](Node, Node f) { return 1 + -(f * f); }},
    {"exp", std::exp, [](Node, Node f) { return f; }},
    {"log", std::log, [](Node x, Node) { return power(x, -1); }},
    {"sqrt", std::sqrt, nullptr}};

const ElementaryFunction* find_function(const std::string& name) {
  for (const ElementaryFunction& function : kFunctions)
    if (name == function.name) return &function;
  return nullptr;
}

double total_power(double x, int n) {
  if (n == 2) return x * x;
  if (n == -1) return 1 / x;
  double out = 1;
  for (; n > 0; n >>= 1, x *= x)
    if (n & 1) out *= x;
  return out;
}

double evaluate(const Operation& o, double t, const double* x) {
  switch (o.op) {
    case Op::constant:
      return o.number;
    case Op::time:
      return t;
    case Op::add:
      return x[o.a] + x[o.b];
    case Op::multiply:
      return x[o.a] * x[o.b];
    case Op::scale:
      return o.number * x[o.a];
    case Op::total_power:
      return total_power(x[o.a], o.exponent);
    case Op::power:
      return std::pow(x[o.a], x[o.b]);
    case Op::call:
      return o.function->value(x[o.a]);
    case Op::external: {
      const Jet jet = (*o.external)(t);
      return o.exponent == 0 ? jet.value : o.exponent == 1 ? jet.rate : jet.acceleration;
    }
    case Op::atan2:
      return std::atan2(x[o.a], x[o.b]);
    case Op::choose:
      return x[o.a] >= 0 ? x[o.b] : x[o.c];
  }
  return 0;
}

bool is_whole(double x) { return x == std::round(x); }

/// Returns the base and the exponent of a node that is a power of another one.
std::pair<Node, double> as_power(Node x) {
  static const ElementaryFunction* const kRoot = find_function("sqrt");
  double exponent = 1;
  for (;; x = x.at(x->a)) {
    if (x->op == Op::total_power)
      exponent *= x->exponent;
    else if (x->op == Op::call && x->function == kRoot)
      return {x.at(x->a), 0.5 * exponent};
    else if (x->op == Op::power && x.at(x->b).is_number())
      return {x.at(x->a), x.at(x->b)->number * exponent};
    else
      return {x, exponent};
  }
}

/// Returns the number and the other node of a node that is a multiple of another one.
std::pair<double, Node> as_multiple(Node x) {
  if (x.is_number() && !x.is(0)) return {x->number, x.graph->number(1)};
  if (x->op == Op::scale) return {x->number, x.at(x->a)};
  return {1, x};
}

/// Multiplies `factor` into the factor of the product x that is a power of the same base. Returns
/// false if there is no such factor.
bool take_in(Node& x, Node factor) {
  const auto [base, exponent] = as_power(x);
  const auto [other_base, other_exponent] = as_power(factor);
  if (base == other_base) {
    x = power(base, exponent + other_exponent);
    return true;
  }
  if (x->op != Op::multiply) return false;
  Node a = x.at(x->a), b = x.at(x->b);
  if (!take_in(a, factor) && !take_in(b, factor)) return false;
  x = a * b;
  return true;
}

}  // namespace

Node operator+(Node a, Node b) {
  if (a.is(0)) return b;
  if (b.is(0)) return a;
  if (a == b) return 2 * a;
  const auto [first, second] = std::minmax(a.index, b.index);
  return a.graph->push({.op = Op::add, .a = first, .b = second});
}

Node operator*(Node a, Node b) {
  if (a.is_number()) return a->number * b;
  if (b.is_number()) return b->number * a;
  if (a == b) return power(a, 2);
  const auto [first, second] = std::minmax(a.index, b.index);
  return a.graph->push({.op = Op::multiply, .a = first, .b = second});
}

Node operator*(double a, Node b) {
  const auto [number, x] = as_multiple(b);
  const double both = a * number;
  if (both == 0 || !std::isfinite(both) || x.is(1)) return b.graph->number(both);
  return both == 1 ? x : b.graph->push({.op = Op::scale, .a = x.index, .number = both});
}

Node operator+(double a, Node b) { return b.graph->number(a) + b; }
Node operator-(Node a) { return -1 * a; }
Node operator-(Node a, Node b) { return a + -b; }

Node power(Node x, double exponent) {
  Graph& graph = *x.graph;
  if (x.is(0) && exponent <= 0) throw std::domain_error(kNoQuotient);
  if (exponent == 0) return graph.number(1);
  if (exponent == 1) return x;
  if (x.is_number()) return graph.number(std::pow(x->number, exponent));
  const auto [base, inner] = as_power(x);
  if (x != base && (is_whole(exponent) || std::abs(inner) < 1))
    return power(base, inner * exponent);
  const auto [number, rest] = as_multiple(x);
  const double factor = std::pow(number, exponent);
  if (number != 1 && std::abs(std::log(std::abs(factor))) < kLargestLog)
    return factor * power(rest, exponent);
  if (!is_whole(2 * exponent) || std::abs(exponent) > kLargestWhole)
    return graph.push({.op = Op::power, .a = x.index, .b = graph.number(exponent).index});
  const bool is_root = !is_whole(exponent);
  if (is_root) x = call("sqrt", x);
  if (exponent < 0) x = graph.push({.op = Op::total_power, .a = x.index, .exponent = -1});
  const int whole = static_cast<int>(std::abs(is_root ? 2 * exponent : exponent));
  return whole == 1 ? x : graph.push({.op = Op::total_power, .a = x.index, .exponent = whole});
}

Node power(Node x, Node exponent) {
  if (exponent.is_number()) return power(x, exponent->number);
  if (x.is(0)) throw std::domain_error(kNoQuotient);
  return x.graph->push({.op = Op::power, .a = x.index, .b = exponent.index});
}

Node product(Node a, Node b, int exponent) {
  auto [m, x] = as_multiple(a);
  auto [n, y] = as_multiple(b);
  y = power(y, exponent);
  if (!take_in(x, y)) x = take_in(y, x) ? y : x * y;
  return (exponent < 0 ? m / n : m * n) * x;
}

Node atan2(Node y, Node x) { return y.graph->push({.op = Op::atan2, .a = y.index, .b = x.index}); }

Node choose(Node x, Node a, Node b) {
  if (x.is_number()) return x->number >= 0 ? a : b;
  if (a == b) return a;
  return x.graph->push({.op = Op::choose, .a = x.index, .b = a.index, .c = b.index});
}

Node call(const std::string& name, Node x) {
  return x.graph->push({.op = Op::call, .a = x.index, .function = find_function(name)});
}

bool is_elementary_function(const std::string& name) { return find_function(name) != nullptr; }

Node Graph::number(double value) {
  if (std::isnan(value)) throw std::domain_error("its value is not a real number");
  if (std::isinf(value)) throw std::domain_error("it contains a number that is too large");
  return push({.op = Op::constant, .number = value});
}

Node Graph::external(const std::shared_ptr<const NamedFunctions::Function>& function) {
  externals.push_back(function);
  return push({.op = Op::external, .external = function.get()});
}

Node Graph::push(const Operation& operation) {
  std::array<double, 3> x{};
  Operation of_numbers = operation;
  bool folds = operation.a >= 0;
  int n = 0;
  for (int* operand : {&of_numbers.a, &of_numbers.b, &of_numbers.c}) {
    if (*operand < 0) break;
    const Node node = {this, std::exchange(*operand, n)};
    folds = folds && node.is_number();
    x[static_cast<size_t>(n++)] = node->number;
  }
  if (folds) return number(evaluate(of_numbers, 0, x.data()));
  const auto [location, is_new] =
      locations.try_emplace(operation, static_cast<int>(operations.size()));
  if (is_new) operations.push_back(operation);
  return {this, location->second};
}

namespace {

/// Returns 1 for operations that contribute to the results, 0 for all others.
std::vector<char> needed_for(const std::vector<Node>& results) {
  const std::deque<Operation>& operations = results[0].graph->operations;
  std::vector<char> out(operations.size(), 0);
  for (const Node node : results) out[static_cast<size_t>(node.index)] = 1;
  for (size_t i = operations.size(); i-- > 0;)
    for (const int operand : {operations[i].a, operations[i].b, operations[i].c})
      if (out[i] && operand >= 0) out[static_cast<size_t>(operand)] = 1;
  return out;
}

/// Returns the time derivative of a node from the derivatives of earlier nodes, given by their
/// index.
Node chain_rule(Node f, const std::map<int, Node>& derivatives) {
  const Node a = f.at(f->a), b = f.at(f->b), c = f.at(f->c);
  const auto rate = [&](Node x) { return derivatives.at(x.index); };
  const auto [x, n] = as_power(f);
  if (x != f) return n * power(x, n - 1) * rate(x);
  if (f->op == Op::constant) return f.graph->number(0);
  if (f->op == Op::time) return f.graph->number(1);
  if (f->op == Op::external)
    return f.graph->push(
        {.op = Op::external, .exponent = f->exponent + 1, .external = f->external});
  if (f->op == Op::add) return rate(a) + rate(b);
  if (f->op == Op::multiply) return rate(a) * b + a * rate(b);
  if (f->op == Op::scale) return f->number * rate(a);
  if (f->op == Op::choose) return choose(a, rate(b), rate(c));
  if (f->op == Op::atan2) return (b * rate(a) - a * rate(b)) * power(b * b + a * a, -1);
  if (f->op == Op::power)  // f = exp(b log a)
    return f * (rate(b) * call("log", a) + b * (rate(a) * power(a, -1)));
  return f->function->derivative(a, f) * rate(a);
}

Node derivative(Node node, std::map<int, Node>& derivatives) {
  const std::vector<char> needed = needed_for({node});
  for (int i = 0; i <= node.index; ++i)
    if (needed[static_cast<size_t>(i)] && !derivatives.contains(i))
      derivatives.emplace(i, chain_rule(node.at(i), derivatives));
  return derivatives.at(node.index);
}

}  // namespace

Formula::Program differentiated(Node value) {
  std::map<int, Node> derivatives;
  const Node rate = derivative(value, derivatives), acceleration = derivative(rate, derivatives);
  const std::vector<char> needed = needed_for({value, rate, acceleration});
  Formula::Program out;
  std::vector<int> locations(needed.size());
  const auto location_of = [&](int i) { return i < 0 ? i : locations[static_cast<size_t>(i)]; };
  for (size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i]) continue;
    locations[i] = static_cast<int>(out.operations.size());
    Operation& o = out.operations.emplace_back(value.graph->operations[i]);
    for (int* operand : {&o.a, &o.b, &o.c}) *operand = location_of(*operand);
  }
  if (out.operations.size() > kMaxOperations)
    throw std::length_error("it is too long: its value, rate and acceleration need more than " +
                            std::to_string(kMaxOperations) + " operations");
  out.externals = value.graph->externals;
  out.results = {location_of(value.index), location_of(rate.index),
                 location_of(acceleration.index)};
  return out;
}

void Formula::Program::run(double t, double* x) const {
  double* out = x;
  for (const Operation& o : operations) *out++ = evaluate(o, t, x);
}

}  // namespace flexmorph::io
