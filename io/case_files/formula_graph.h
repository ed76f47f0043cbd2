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

/// Kinds of operations, which combine the results a, b, c of earlier operations.
enum class Op {
  constant,
  time,
  add,          ///< a + b
  multiply,     ///< a b
  scale,        ///< number a
  total_power,  ///< a^exponent, the exponent -1 or from 2 to 128
  power,        ///< a^b
  call,         ///< function(a)
  external,     ///< the derivative of order `exponent` of a function of time
  atan2,        ///< the angle of the point (b, a)
  choose        ///< b where a >= 0, else c
};

/// One operation; its operands are indices of earlier operations in the list.
struct Operation {
  Op op;                       ///< Kind of the operation.
  int a = -1, b = -1, c = -1;  ///< Indices of the operands; -1: none.
  int exponent = 0;            ///< Exponent of total_power, order of the derivative of external.
  double number = 0;           ///< Number of constant and scale.
  const ElementaryFunction* function = nullptr;        ///< Function of call.
  const NamedFunctions::Function* external = nullptr;  ///< Function of external.

  /// Compares all members, for the search of equal operations.
  auto operator<=>(const Operation&) const = default;
};

/// The operations that compute value, rate and acceleration, in the order of evaluation.
struct Formula::Program {
  std::vector<Operation> operations;  ///< All operations.
  std::array<int, 3> results{};       ///< Indices of value, rate and acceleration.

  /// Functions of the operations `external`, which must exist as long as the program.
  std::vector<std::shared_ptr<const NamedFunctions::Function>> externals;

  /// Evaluates all operations at the time t [s].
  /// @param x  results of the operations (n_operations)
  void run(double t, double* x) const;
};

struct Graph;

/// A node of an expression graph. Functions of nodes create new nodes. They evaluate operations on
/// constants, create equal operations only once, and create neither sums with 0 nor products with 0
/// or 1. All of them throw std::domain_error if a constant has no real value or is not finite.
struct Node {
  Graph* graph;  ///< Graph that contains the node.
  int index;     ///< Index of its operation in the graph.

  /// Returns another node of the graph.
  Node at(int other) const { return {graph, other}; }
  /// Returns the operation of the node.
  const Operation* operator->() const;
  /// Returns true if the node is a constant.
  bool is_number() const { return (*this)->op == Op::constant; }
  /// Returns true if the node is the constant `number`.
  bool is(double number) const { return is_number() && (*this)->number == number; }
  /// Compares graph and index of two nodes.
  bool operator==(const Node&) const = default;
};

/// Returns the sum of two nodes.
Node operator+(Node a, Node b);
/// Returns the product of two nodes.
Node operator*(Node a, Node b);
/// Returns the sum of a number and a node.
Node operator+(double a, Node b);
/// Returns the product of a number and a node.
Node operator*(double a, Node b);
/// Returns the negative of a node.
Node operator-(Node a);
/// Returns the difference of two nodes.
Node operator-(Node a, Node b);
/// Returns x^exponent. A power of a power becomes one power: (√x)² is x.
Node power(Node x, double exponent);
Node power(Node x, Node exponent);
/// Returns a b or a/b, where `exponent` is 1 or -1. Powers of one base become one power: √x x² is
/// x^2.5, whose acceleration at 0 is finite.
Node product(Node a, Node b, int exponent);
/// Returns the angle of the point (x, y) [rad].
Node atan2(Node y, Node x);
/// Returns a where x >= 0, else b.
Node choose(Node x, Node a, Node b);
/// Returns an elementary function of one argument: sin, cos, tan, asin, acos, atan, sinh, cosh,
/// tanh, exp, log or sqrt. No other name is allowed.
Node call(const std::string& name, Node x);
/// Returns true if call() has a function of this name.
bool is_elementary_function(const std::string& name);

/// The operations that nodes refer to.
struct Graph {
  /// All operations; a deque, because references to them must stay valid.
  std::deque<Operation> operations;
  std::map<Operation, int> locations;  ///< Index of each operation.
  std::map<std::string, int> named;    ///< Index of the value of each named formula.
  /// Functions of the operations `external`.
  std::vector<std::shared_ptr<const NamedFunctions::Function>> externals;

  /// Returns the node of a constant.
  Node number(double value);
  /// Returns the node of the time t.
  Node time() { return push({.op = Op::time}); }
  /// Returns the node of a function of time.
  Node external(const std::shared_ptr<const NamedFunctions::Function>& function);
  /// Returns the node of an operation; it is a constant if all operands are constants.
  Node push(const Operation& operation);
};

/// Returns the operation of the node.
inline const Operation* Node::operator->() const {
  return &graph->operations[static_cast<size_t>(index)];
}

constexpr size_t kMaxOperations = 8192;  ///< Largest number of operations of a program.

/// Returns the program of a node and its first two time derivatives. The chain rule is applied
/// operation by operation (forward automatic differentiation), therefore each operation adds a
/// bounded number of operations.
/// @throws std::length_error when there are more than kMaxOperations.
Formula::Program differentiated(Node value);

/// Throws an error about a formula.
/// @throws Error (input) "formula '<text>': <why>".
[[noreturn]] void refuse_formula(const std::string& text, const std::string& why);

}  // namespace flexmorph::io
