#pragma once

#include <string>

namespace flexmorph::io {

/// Refuses formulas whose exact numbers would grow beyond all memory: GiNaC evaluates powers of
/// whole numbers exactly, and moves whole factors out of powers, before anybody can stop it.
///
/// Bounds the bits of numerators and denominators from above, without computing them: they add up
/// in sums, products and quotients, and a whole exponent n takes n times the bits of its base. The
/// text is one that check_formula_words() has passed, so nothing here is deep; where it is no
/// formula at all, GiNaC says so.
///
/// @throws Error (input) naming formula, place and the limit.
void check_formula_size(const std::string& text);

}  // namespace flexmorph::io
