#include "io/case_files/unit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/drawings/length_unit.h"

namespace flexmorph::io {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Dimension kPureNumber{}, kLength{1}, kMass{0, 1}, kTime{0, 0, 1},
    kTemperature{0, 0, 0, 1}, kAngle{0, 0, 0, 0, 1}, kRate{0, 0, -1}, kForce{1, 1, -2},
    kPressure{-1, 1, -2}, kEnergy{2, 1, -2}, kPower{2, 1, -3}, kTurning{0, 0, -1, 0, 1};
constexpr const char *kMicro = "\xc2\xb5", *kMu = "\xce\xbc", *kDegree = "\xc2\xb0",
                     *kDot = "\xc2\xb7", *kSquare = "\xc2\xb2", *kCube = "\xc2\xb3";

// The pound-force is the weight of 0.45359237 kg under the standard gravity 9.80665 m/s^2.
constexpr double kPound = 0.45359237, kPoundForce = kPound * 9.80665,
                 kPoundPerInch2 = kPoundForce / (0.0254 * 0.0254);

struct Named {
  std::string_view name;
  Unit unit;
  bool takes_prefix = false;
};
const Named kNamed[] = {{"1", {1, 1, kPureNumber}},
                        {"m", {1, 1, kLength}, true},
                        {"g", {1, 1000, kMass}, true},
                        {"t", {1000, 1, kMass}},
                        {"s", {1, 1, kTime}, true},
                        {"min", {60, 1, kTime}},
                        {"h", {3600, 1, kTime}},
                        {"K", {1, 1, kTemperature}},
                        {"rad", {1, 1, kAngle}, true},
                        {"deg", {kPi, 180, kAngle}},
                        {kDegree, {kPi, 180, kAngle}},
                        {"rev", {2 * kPi, 1, kAngle}},
                        {"rpm", {kPi, 30, kTurning}},
                        {"Hz", {1, 1, kRate}, true},
                        {"N", {1, 1, kForce}, true},
                        {"Pa", {1, 1, kPressure}, true},
                        {"bar", {100000, 1, kPressure}},
                        {"J", {1, 1, kEnergy}, true},
                        {"W", {1, 1, kPower}, true},
                        {"lb", {kPound, 1, kMass}},
                        {"lbf", {kPoundForce, 1, kForce}},
                        {"psi", {kPoundPerInch2, 1, kPressure}},
                        {"ksi", {1000 * kPoundPerInch2, 1, kPressure}}};

struct Prefix {
  std::string_view name;
  double numerator, denominator;
};
const Prefix kPrefixes[] = {{"n", 1, 1e9}, {"u", 1, 1e6}, {kMicro, 1, 1e6}, {kMu, 1, 1e6},
                            {"m", 1, 1e3}, {"c", 1, 100}, {"d", 1, 10},     {"k", 1e3, 1},
                            {"M", 1e6, 1}, {"G", 1e9, 1}};

/// Units that messages suggest, if their dimension fits.
constexpr const char* kSuggested[] = {
    "m",     "mm",     "cm",     "in",        "s",         "ms",      "min",     "kg",
    "g",     "t",      "N",      "kN",        "Pa",        "MPa",     "GPa",     "N/mm^2",
    "rad",   "deg",    "rev",    "rad/s",     "deg/s",     "rpm",     "rad/s^2", "m/s",
    "mm/s",  "km/h",   "m/s^2",  "mm/s^2",    "kg/m^3",    "g/cm^3",  "N m",     "N mm",
    "kN m",  "J",      "mJ",     "N/m",       "N/mm",      "N m/rad", "N m/deg", "N mm/rad",
    "N s/m", "N s/mm", "kg m^2", "kg mm^2",   "g mm^2",    "kg m",    "m^2",     "mm^2",
    "1/K",   "K",      "Hz",     "N m s/rad", "N mm s/rad"};

/// Divides both parts of a unit by their greatest common divisor if they are whole numbers.
Unit reduced(Unit unit) {
  constexpr double kLargestWhole = 1LL << 53;
  double a = unit.numerator, b = unit.denominator;
  if (a != std::round(a) || b != std::round(b) || std::max(a, b) > kLargestWhole) return unit;
  while (b != 0) a = std::exchange(b, std::fmod(a, b));
  return {unit.numerator / a, unit.denominator / a, unit.dimension};
}

/// Returns a * b, or a / b.
Unit product(const Unit& a, const Unit& b, bool divides) {
  Unit out = a;
  out.numerator *= divides ? b.denominator : b.numerator;
  out.denominator *= divides ? b.numerator : b.denominator;
  for (size_t k = 0; k < out.dimension.size(); ++k)
    out.dimension[k] += divides ? -b.dimension[k] : b.dimension[k];
  return reduced(out);
}

std::optional<Unit> named_unit(std::string_view name) {
  for (const Named& each : kNamed)
    if (each.name == name) return each.unit;
  for (const Prefix& prefix : kPrefixes)
    for (const Named& each : kNamed)
      if (each.takes_prefix && name.starts_with(prefix.name) &&
          name.substr(prefix.name.size()) == each.name)
        return product({prefix.numerator, prefix.denominator, kPureNumber}, each.unit, false);
  if (const LengthUnit* length = find_length_unit(std::string(name)))
    return Unit{length->metres, 1, kLength};
  return {};
}

/// Reads a unit by recursive descent:
///
///   product  {/} factor {[*] {/} factor}
///   factor   (name | ( product )) [[^] [-] digit]
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::optional<Unit> run() {
    const std::optional<Unit> out = product();
    return at_ == text_.size() ? out : std::nullopt;
  }

 private:
  bool sees(std::string_view word) const { return text_.substr(at_).starts_with(word); }
  bool takes(std::string_view word) {
    if (!sees(word)) return false;
    at_ += word.size();
    return true;
  }
  void skip_blanks() {
    while (takes(" ")) {
    }
  }

  std::optional<Unit> product() {
    Unit out;
    for (bool first = true;; first = false) {
      skip_blanks();
      if (!first && (at_ == text_.size() || sees(")"))) return out;
      const bool divides = takes("/");
      if (!divides && !first && !takes("*")) takes(kDot);
      skip_blanks();
      const std::optional<Unit> next = factor();
      if (!next) return {};
      out = io::product(out, *next, divides);
    }
  }

  std::optional<Unit> factor() {
    constexpr int kMaxParentheses = 10;
    std::optional<Unit> out;
    if (takes("(")) {
      if (++depth_ > kMaxParentheses) return {};
      out = product();
      --depth_;
      if (!takes(")")) return {};
    } else {
      const size_t start = at_;
      if (at_ < text_.size()) ++at_;  // the name "1"
      while (at_ < text_.size() && !ends_name()) ++at_;
      out = named_unit(text_.substr(start, at_ - start));
    }
    return out ? raised(*out) : out;
  }

  bool ends_name() const {
    return std::string_view(" */^()-0123456789").find(text_[at_]) != std::string_view::npos ||
           sees(kDot) || sees(kSquare) || sees(kCube);
  }

  /// Returns the unit raised to the exponent that follows.
  std::optional<Unit> raised(const Unit& unit) {
    int exponent = takes(kSquare) ? 2 : takes(kCube) ? 3 : 0;
    if (exponent == 0) {
      const bool marked = takes("^"), negative = marked && takes("-");
      const bool digit = at_ < text_.size() && text_[at_] >= '1' && text_[at_] <= '9';
      if (!digit) return marked ? std::nullopt : std::optional(unit);
      exponent = (negative ? -1 : 1) * (text_[at_++] - '0');
    }
    Unit out;
    for (int k = 0; k < std::abs(exponent); ++k) out = io::product(out, unit, exponent < 0);
    return out;
  }

  std::string_view text_;
  size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

std::optional<Unit> read_unit(std::string_view text) { return Parser(text).run(); }

std::string units_like(const std::string& unit) {
  const std::optional<Unit> wanted = read_unit(unit);
  std::string out = unit;
  for (const char* each : kSuggested)
    if (wanted && each != unit && read_unit(each)->dimension == wanted->dimension)
      out += std::string(", ") + each;
  return out;
}

}  // namespace flexmorph::io
