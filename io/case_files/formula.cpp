#include "io/case_files/formula.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "geometry/base.h"
#include "geometry/text.h"
#include "io/case_files/formula_graph.h"

namespace flexmorph::io {
namespace {

constexpr size_t kMaxCharacters = 10'000;
constexpr int kMaxParentheses = 100;  // open at the same time
constexpr int kMaxSigns = 10;         // in a row
constexpr double kLargestExponent = 1e6;

using Nodes = std::vector<Node>;

Node smooth_step(const Nodes& x) {
  Graph& graph = *x[0].graph;
  const Node rising = power(x[0], 2) * (3 + -2 * x[0]);
  return choose(x[0], choose(-1 + x[0], graph.number(1), rising), graph.number(0));
}

/// Returns piecewise(x0, t1, x1, t2, x2): x0 until t1, x1 from there, x2 from t2.
Node piecewise(const Nodes& x) {
  Graph& graph = *x[0].graph;
  Node out = x[0];
  double last = -std::numeric_limits<double>::infinity();
  for (size_t i = 1; i < x.size(); i += 2) {
    if (!x[i].is_number())
      throw std::domain_error("the times t1, ... of piecewise(x0, t1, x1, ...) must be constants");
    const double from = x[i]->number;
    if (!(from > last))
      throw std::domain_error("the times t1, ... of piecewise(x0, t1, x1, ...) must increase");
    last = from;
    out = choose(-from + graph.time(), x[i + 1], out);
  }
  return out;
}

/// A function that consists of operations other than a call.
struct BuiltFunction {
  const char* name;
  size_t n_arguments;  // 0 means 3, 5, 7, ...
  Node (*build)(const Nodes& arguments);
};

const BuiltFunction kBuiltFunctions[] = {
    {"sqrt", 1, [](const Nodes& x) { return power(x[0], 0.5); }},
    {"atan2", 2, [](const Nodes& x) { return atan2(x[0], x[1]); }},
    {"abs", 1, [](const Nodes& x) { return choose(x[0], x[0], -x[0]); }},
    {"min", 2, [](const Nodes& x) { return choose(x[1] - x[0], x[0], x[1]); }},
    {"max", 2, [](const Nodes& x) { return choose(x[0] - x[1], x[0], x[1]); }},
    {"step", 1,
     [](const Nodes& x) { return choose(x[0], x[0].graph->number(1), x[0].graph->number(0)); }},
    {"smoothstep", 1, smooth_step},
    {"piecewise", 0, piecewise}};

const BuiltFunction* find_built_function(const std::string& name) {
  for (const BuiltFunction& function : kBuiltFunctions)
    if (name == function.name) return &function;
  return nullptr;
}

bool is_function(const std::string& name) {
  return find_built_function(name) || is_elementary_function(name);
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads a formula by recursive descent and writes it as nodes of a graph:
///
///   sum      product {(+|-) product}
///   product  {+|-} power {(*|/) {+|-} power}
///   power    operand [^ {+|-} operand]
///   operand  number | name | function(sum {, sum}) | (sum)
class Parser {
 public:
  /// @param open  names of the formulas that are being read, each a part of the one before
  Parser(const std::string& text, const std::map<std::string, double>& constants,
         const NamedFunctions& functions, Graph& graph, std::vector<std::string> open = {})
      : text_(text),
        constants_(constants),
        functions_(functions),
        graph_(graph),
        open_(std::move(open)) {}

  Node run() {
    if (text_.size() > kMaxCharacters)
      throw Error::input("a formula has at most " + std::to_string(kMaxCharacters) + " characters");
    try {
      const Node out = sum();
      if (peek() != '\0')
        refuse("the formula must end here or continue with an operator, but " + token() +
               " follows");
      return out;
    } catch (const std::domain_error& e) {  // from the operation that is being created
      refuse(written_, e.what());
    }
  }

 private:
  [[noreturn]] void refuse(size_t location, const std::string& why) const {
    refuse_formula(text_, "character " + std::to_string(location + 1) + ": " + why);
  }
  [[noreturn]] void refuse(const std::string& why) const { refuse(at_, why); }

  /// Returns the next character that is not blank; 0 at the end.
  char peek() {
    while (at_ < text_.size() && std::string_view(" \t\n").find(text_[at_]) != std::string::npos)
      ++at_;
    if (at_ == text_.size()) return '\0';
    const char c = text_[at_];
    if (static_cast<unsigned char>(c) > 127)
      refuse("a formula contains no letters other than a to z, A to Z and _");
    if (!is_letter(c) && !is_digit(c) && std::string_view("+-*/^(),.").find(c) == std::string::npos)
      refuse(std::string("the character '") + c + "' is not allowed in a formula");
    return c;
  }

  /// Returns the next name or character in quotes.
  std::string token() {
    if (peek() == '\0') return "the end of the formula";
    size_t end = at_;
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
    return '"' + text_.substr(at_, std::max<size_t>(end - at_, 1)) + '"';
  }

  Node sum() {
    Node out = product();
    for (char c = peek(); c == '+' || c == '-'; c = peek()) {
      const size_t location = at_++;
      const Node next = product();
      written_ = location;
      out = c == '+' ? out + next : out - next;
    }
    return out;
  }

  Node product() {
    Node out = after_signs(&Parser::power);
    for (char c = peek(); c == '*' || c == '/'; c = peek()) {
      const size_t location = at_++;
      const Node next = after_signs(&Parser::power);
      written_ = location;
      out = io::product(out, next, c == '*' ? 1 : -1);
    }
    return out;
  }

  /// Reads signs, and their operand with `read`.
  Node after_signs(Node (Parser::*read)()) {
    bool negative = false;
    for (int n = 1; peek() == '+' || peek() == '-'; ++n, ++at_) {
      if (n > kMaxSigns)
        refuse("there are more than " + std::to_string(kMaxSigns) + " signs in a row");
      negative ^= text_[at_] == '-';
    }
    const Node out = (this->*read)();
    return negative ? -out : out;
  }

  Node power() {
    const Node base = operand();
    if (peek() != '^') return base;
    const size_t location = at_++;
    const Node exponent = after_signs(&Parser::operand);
    if (peek() == '^') refuse("a^b^c needs parentheses: (a^b)^c or a^(b^c)");
    if (exponent.is_number() && std::abs(exponent->number) > kLargestExponent)
      refuse(location, "an exponent is at most 1e6");
    written_ = location;
    return io::power(base, exponent);
  }

  Node operand() {
    const char c = peek();
    if (c == '(') return in_parentheses(1)[0];
    if (is_digit(c) || c == '.') return number();
    if (is_letter(c)) return name();
    refuse("a number, a name or '(' is needed here, but " + token() + " follows");
  }

  /// Reads at most `most` sums between parentheses, separated by commas.
  Nodes in_parentheses(size_t most) {
    if (++depth_ > kMaxParentheses)
      refuse("more than " + std::to_string(kMaxParentheses) + " parentheses are open");
    const size_t location = at_++;
    if (peek() == ')') refuse(location, "these parentheses are empty");
    Nodes out = {sum()};
    for (; peek() == ',' && out.size() < most; out.push_back(sum())) ++at_;
    if (peek() != ')') refuse("')' is needed here, but " + token() + " follows");
    ++at_;
    --depth_;
    return out;
  }

  Node number() {
    double value = 0;
    const char *begin = text_.data() + at_, *text_end = text_.data() + text_.size();
    auto [end, error] = std::from_chars(begin, text_end, value);
    for (; end != text_end && (is_digit(*end) || *end == '.'); ++end)
      error = std::errc::invalid_argument;  // a second decimal point
    if (error != std::errc()) refuse("'" + std::string(begin, end) + "' is not a number");
    at_ += static_cast<size_t>(end - begin);
    return graph_.number(value);
  }

  Node name() {
    const size_t start = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string name = text_.substr(start, at_ - start);
    if (peek() == '(') return called(name, start);
    if (is_function(name))
      refuse(start, "the function '" + name + "' needs its argument in parentheses");
    if (name == "t") return graph_.time();
    if (name == "pi") return graph_.number(std::numbers::pi);
    const auto constant = constants_.find(name);
    const auto formula = functions_.formulas.find(name);
    const auto function = functions_.functions.find(name);
    const bool is_constant = constant != constants_.end(),
               is_formula = formula != functions_.formulas.end(),
               is_function = function != functions_.functions.end();
    if (is_constant && (is_formula || is_function))
      refuse(start, "'" + name + "' is the name of a constant and of a drive; rename one of them");
    if (is_constant) return graph_.number(constant->second);
    if (is_formula) return used(name, formula->second, start);
    if (is_function) return graph_.external(function->second);
    refuse(start, "'" + name +
                      "' is unknown: a formula may contain the time t, pi, the constants and the "
                      "other drives of the case");
  }

  /// Returns the node of another formula that this one uses.
  Node used(const std::string& name, const std::string& text, size_t location) {
    const auto cycle = std::find(open_.begin(), open_.end(), name);
    if (cycle != open_.end()) {
      const std::vector<std::string> names(cycle, open_.end());
      refuse(location, names.size() == 1
                           ? "the drive '" + name + "' uses itself"
                           : "the drives " + joined(names, ", ", "'") + " use each other");
    }
    const auto known = graph_.named.find(name);
    if (known != graph_.named.end()) return {&graph_, known->second};
    std::vector<std::string> open = open_;
    open.push_back(name);
    try {
      const Node out = Parser(text, constants_, functions_, graph_, std::move(open)).run();
      graph_.named.emplace(name, out.index);
      return out;
    } catch (const Error& error) {
      if (!open_.empty()) throw;  // only the outermost formula adds the name
      refuse(location, "drive '" + name + "': " + error.what());
    }
  }

  Node called(const std::string& name, size_t location) {
    if (!is_function(name)) refuse(location, "there is no function '" + name + "'");
    const Nodes x = in_parentheses(text_.size());
    const BuiltFunction* built = find_built_function(name);
    const size_t wanted = built ? built->n_arguments : 1;
    if (wanted == 0 ? x.size() < 3 || x.size() % 2 == 0 : x.size() != wanted)
      refuse(location, "the function '" + name + "' cannot have " + std::to_string(x.size()) +
                           (x.size() == 1 ? " argument" : " arguments"));
    written_ = location;
    return built ? built->build(x) : call(name, x[0]);
  }

  const std::string& text_;
  const std::map<std::string, double>& constants_;
  const NamedFunctions& functions_;
  Graph& graph_;
  std::vector<std::string> open_;
  // positions of the next character and of the operation being created
  size_t at_ = 0, written_ = 0;
  int depth_ = 0;  // number of open parentheses
};

}  // namespace

void refuse_formula(const std::string& text, const std::string& why) {
  throw Error::input("formula '" + text + "': " + why);
}

std::string Formula::refusal_of_name(const std::string& name) {
  if (name.empty() || !is_letter(name[0]) || name[0] == '_')
    return "the name of a constant begins with a letter";
  for (const char c : name)
    if (!is_letter(c) && !is_digit(c))
      return "the name of a constant contains only letters, digits and _";
  if (name == "t") return "the name t is reserved for the time";
  if (is_function(name)) return "this name is reserved for a function";
  for (const char* taken : {"pi", "I", "Pi", "Euler", "Catalan"})
    if (name == taken) return "this name is reserved in formulas";
  return "";
}

Formula::Formula(std::string text, const std::map<std::string, double>& constants,
                 const NamedFunctions& functions)
    : text_(std::move(text)) {
  for (const auto& [name, value] : constants) {
    const std::string why = refusal_of_name(name);
    if (!why.empty()) throw Error::input("constant '" + name + "': " + why);
    if (!std::isfinite(value))
      throw Error::input("constant '" + name + "': its value is not a finite number");
  }
  Graph graph;
  const Node value = Parser(text_, constants, functions, graph).run();
  try {
    program_ = std::make_shared<const Program>(differentiated(value));
  } catch (const std::logic_error& e) {
    refuse_formula(text_, e.what());
  }
}

Jet Formula::operator()(double t) const {
  double x[kMaxOperations];  // NOLINT: only as many entries are used as the formula has operations
  program_->run(t, x);
  const auto& [value, rate, acceleration] = program_->results;
  return {x[value], x[rate], x[acceleration]};
}

double constant_value(const std::string& text, const std::map<std::string, double>& constants) {
  Graph graph;
  const Node value = Parser(text, constants, {}, graph).run();
  if (!value.is_number()) refuse_formula(text, "a number cannot contain the time t");
  return value->number;
}

int Formula::n_operations() const { return static_cast<int>(program_->operations.size()); }

}  // namespace flexmorph::io
