#pragma once

#include <array>
#include <compare>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "io/case_files/formula.h"

/// Expression graphs of formulas, their derivatives, and the programs that evaluate them.
namespace flexmorph::io {

struct ElementaryFunction;

/// What one operation computes from the results a, b, c of earlier ones.
enum class Op {
  constant,
  time,
  add,          ///< a + b
  multiply,     ///< a b
  scale,        ///< number a
  whole_power,  ///< a^exponent, the exponent -1 or from 2 to 128
  power,        ///< a^b
  call,         ///< function(a)
  atan2,        ///< the angle of the point (b, a)
  choose        ///< b where a >= 0, else c
};

/// One operation; its operands are places of earlier operations in the list.
struct Operation {
  Op op;
  int a = -1, b = -1, c = -1;  // -1: none
  int exponent = 0;
  double number = 0;  // of constant and scale
  const ElementaryFunction* function = nullptr;

  auto operator<=>(const Operation&) const = default;
};

/// The operations that compute value, rate and acceleration, in the order of evaluation.
struct Formula::Program {
  std::vector<Operation> operations;
  std::array<int, 3> results{};  // places of value, rate and acceleration

  /// Evaluates all operations at the time t [s].
  /// @param x  results of the operations (n_operations)
  void run(double t, double* x) const;
};

class Graph;

/// A node of an expression graph. The functions of nodes write nodes: they fold numbers, write
/// equal operations once, and neither sums with 0 nor products with 0 or 1. All of them throw
/// std::domain_error where a number has no value or is not finite.
struct Node {
  Graph* graph;
  int index;

  Node at(int other) const { return {graph, other}; }
  const Operation* operator->() const;
  bool is_number() const { return (*this)->op == Op::constant; }
  bool is(double number) const { return is_number() && (*this)->number == number; }
  bool operator==(const Node&) const = default;
};

Node operator+(Node a, Node b);
Node operator*(Node a, Node b);
Node operator+(double a, Node b);
Node operator*(double a, Node b);
Node operator-(Node a);
Node operator-(Node a, Node b);
/// x^exponent. A power of a power becomes one power: (√x)² is x.
Node power(Node x, double exponent);
Node power(Node x, Node exponent);
/// a b or a/b, where `exponent` is 1 or -1. Powers of one base become one power: √x x² is x^2.5,
/// whose acceleration at 0 is finite.
Node product(Node a, Node b, int exponent);
Node atan2(Node y, Node x);
/// a where x >= 0, else b.
Node choose(Node x, Node a, Node b);
/// An elementary function of one argument: sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp,
/// log. No other name is allowed.
Node call(const std::string& name, Node x);
bool is_elementary_function(const std::string& name);

/// The operations that nodes stand for.
struct Graph {
  std::deque<Operation> operations;  // references to them stay valid
  std::map<Operation, int> places;

  Node number(double value);
  Node time() { return push({.op = Op::time}); }
  /// Returns the node of an operation: a number where its operands are numbers.
  Node push(const Operation& operation);
};

inline const Operation* Node::operator->() const {
  return &graph->operations[static_cast<size_t>(index)];
}

constexpr size_t kMaxOperations = 8192;  // of value, rate and acceleration together

/// Returns the program of a node and its first two time derivatives. The chain rule goes from one
/// operation to the next (automatic differentiation, forward), so each of them adds a bounded
/// number of operations.
/// @throws std::length_error when there are more than kMaxOperations.
Formula::Program differentiated(Node value);

/// @throws Error (input): "formula '<text>': <why>".
[[noreturn]] void refuse_formula(const std::string& text, const std::string& why);

}  // namespace flexmorph::io
