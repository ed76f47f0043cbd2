#pragma once

/// Central differences of fourth order for every type that can be added and scaled.
namespace flexmorph::testing {

/// Returns f'(0); it is exact for polynomials up to degree 4.
template <class F>
auto first_difference(const F& f, double h) {
  using Value = decltype(f(h));
  const Value outer = f(2 * h) - f(-2 * h), inner = f(h) - f(-h);
  return Value((8 * inner - outer) / (12 * h));
}

/// Returns f''(0); it is exact for polynomials up to degree 5.
template <class F>
auto second_difference(const F& f, double h) {
  using Value = decltype(f(h));
  const Value outer = f(2 * h) + f(-2 * h), inner = f(h) + f(-h), middle = f(0.0);
  return Value((16 * inner - outer - 30 * middle) / (12 * h * h));
}

}  // namespace flexmorph::testing
