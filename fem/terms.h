#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>

#include "fem/section.h"
#include "fem/shapes/strain.h"
#include "fem/term.h"

/// The table of terms: what a body is made of. A row says all there is to say about one; it stands
/// in the file of its term (terms/), and terms.cpp lists it.
namespace flexmorph::fem {

/// Bodies that terms may belong to.
enum class TermPlace { plane, space, beam };

/// A number that a term takes from its body.
struct TermKey {
  std::string name, noun, unit;
  double low = 0, high = std::numeric_limits<double>::infinity();
  bool low_open = false;           ///< is `low` itself too low?
  bool whole = false;              ///< a whole number
  std::optional<double> fallback;  ///< absent: the body must say it
  std::string sentence;
};

struct TermRow;

/// What a term is made from.
struct TermData {
  PlaneSection section;
  std::map<std::string, double> numbers;  ///< by TermKey::name; fallbacks where there is none
  std::vector<const TermRow*> terms;      ///< all terms of the body
};

struct TermRow {
  std::string name;
  std::string sentence;  ///< what it is
  /// Of terms with the same role a body has one at most.
  std::string role;
  std::vector<TermPlace> places;
  std::vector<TermPlace> required_in;  ///< where a body does not hold together without its role
  bool moves = false;                  ///< does a body that moves need its role?
  bool designable = false;             ///< is it what a designed body is made of?
  bool acts_on_elastic = false;        ///< is there nothing to it without an elastic term?
  bool on_cells = false;               ///< does it know plates of cells (q4)?
  bool free_lines = true;              ///< does it know free material lines?
  std::vector<TermKey> keys;           ///< that it reads
  std::vector<std::string> columns;    ///< that it writes to motion.csv
  /// The densities of an elastic term; null for others.
  std::vector<ElasticPart> (*elastic)(const TermData&) = nullptr;
  /// @throws Error (input) where the data do not make one.
  std::unique_ptr<Term> (*make)(const TermData&) = nullptr;

  bool may_stand_in(TermPlace place) const;
  bool reads(const std::string& key) const;
};

/// All rows, in the order in which messages list them.
std::span<const TermRow* const> term_rows();
/// Adds a row, see Registry::add().
void register_term(const TermRow& row);
std::vector<std::string> term_names(TermPlace place);
/// @throws Error (input) naming the known terms.
const TermRow& term_row(const std::string& name);
/// The other terms of the same role that may stand in its place.
std::vector<std::string> alternatives(const TermRow& row, TermPlace place);

/// Why these terms together make no body; empty where they do.
/// @param moves  false: nothing moves
std::string refusal_of_terms(TermPlace place, std::span<const std::string> names, bool moves);

/// All of these terms, in their order.
/// @throws Error (input) naming the known terms.
std::vector<std::unique_ptr<Term>> make_terms(std::span<const std::string> names,
                                              const PlaneSection& section,
                                              const std::map<std::string, double>& numbers);
/// One of them, with all numbers at their fallbacks.
std::unique_ptr<Term> make_term(const std::string& name, const PlaneSection& section);

/// A row's number from the data, or its fallback.
/// @throws Error (input) where there is neither.
double number_of(const TermRow& row, const std::string& key, const TermData& data);

std::unique_ptr<Term> make_inertia(const PlaneSection& section);
std::unique_ptr<Term> make_membrane(const PlaneSection& section);
/// The membrane with assumed strains: does not lock in thin bending (terms/membrane_invariant.h).
std::unique_ptr<Term> make_assumed_membrane(const PlaneSection& section);
/// Fully parameterized beam in the plane (elements/ancf_beam.h), section.thickness: its width
/// across the plane. General continuum mechanics, plane stress; and enhanced continuum mechanics,
/// which does not lock by Poisson's effect (terms/beam.cpp). Strains of the axis are assumed
/// (terms/beam_strains.h); the rows "gcm_full" and "ecm_full" have those of the displacements.
std::unique_ptr<Term> make_beam_gcm(const PlaneSection& section);
std::unique_ptr<Term> make_beam_ecm(const PlaneSection& section);
/// Bending of a thin plate in space, n x n Gauss points per element (5: force to 5e-4 at strong
/// deformation; 7: 4e-7; 9: where a plate folds, fem/README.md, Bending). @throws Error (input) at
/// prepare() for a body in the plane.
std::unique_ptr<Term> make_bending(const PlaneSection& section, int n_points = 9);

}  // namespace flexmorph::fem
