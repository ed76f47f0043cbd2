#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>

#include "fem/section.h"
#include "fem/shapes/strain.h"
#include "fem/term.h"

/// The table of terms, of which bodies are composed. One row (TermRow) describes one term
/// completely; it is defined in the source file of the term (terms/), and terms.cpp lists all rows.
namespace flexmorph::fem {

/// Kinds of bodies that a term may belong to.
enum class TermDomain { plane, space, beam };

/// A number that a term reads from the definition of its body.
struct TermKey {
  std::string name, noun, unit;  ///< Key of the number, noun for messages, and unit.

  /// Smallest and largest permitted value.
  double low = 0, high = std::numeric_limits<double>::infinity();
  bool low_open = false;           ///< True if `low` itself is not permitted.
  bool whole = false;              ///< True if the number is an integer.
  std::optional<double> fallback;  ///< Default value; absent if the body has to give the number.
  std::string sentence;            ///< Description of the number for the documentation of the keys.
};

struct TermRow;

/// The data from which a term is created.
struct TermData {
  PlaneSection section;  ///< Thickness and material of the body.

  /// Numbers by TermKey::name; default values apply to absent ones.
  std::map<std::string, double> numbers;
  std::vector<const TermRow*> terms;  ///< All terms of the body.
};

/// The description of one term: its name, the bodies it may belong to, and the functions that
/// create it.
struct TermRow {
  std::string name;      ///< Name of the term.
  std::string sentence;  ///< Description of the term in one sentence.

  /// Role of the term; a body has at most one term of each role.
  std::string role;
  std::vector<TermDomain> domains;      ///< Kinds of bodies that the term may belong to.
  std::vector<TermDomain> required_in;  ///< Kinds of bodies that need a term of this role.
  bool moves = false;                   ///< True if a body that moves needs a term of this role.
  bool designable = false;              ///< True if the term makes it possible to design its body.
  bool acts_on_elastic = false;      ///< True if the term needs an elastic term in the same body.
  bool on_cells = false;             ///< True if the term supports plates of cells (q4).
  bool eulerian_lines = true;        ///< True if the term supports free material lines.
  std::vector<TermKey> keys;         ///< Numbers that the term reads.
  std::vector<std::string> columns;  ///< Columns that the term writes to motion.csv.

  /// Returns the densities of an elastic term; null for other terms.
  std::vector<ElasticPart> (*elastic)(const TermData&) = nullptr;
  /// Creates the term from the data of its body.
  /// @throws Error (input) where the data do not suffice.
  std::unique_ptr<Term> (*make)(const TermData&) = nullptr;

  /// Returns true if the term may belong to the given kind of body.
  bool may_stand_in(TermDomain domain) const;
  /// Returns true if the term reads the number with the given key.
  bool reads(const std::string& key) const;
};

/// Returns all rows, in the order in which messages list them.
std::span<const TermRow* const> term_rows();
/// Adds a row, see Registry::add().
void register_term(const TermRow& row);
/// Returns the names of all terms for the given kind of body.
std::vector<std::string> term_names(TermDomain domain);
/// Returns the row of a term.
/// @throws Error (input) naming the known terms.
const TermRow& term_row(const std::string& name);
/// Returns the names of all other terms with the role of the given term, for the given kind of
/// body.
std::vector<std::string> alternatives(const TermRow& row, TermDomain domain);

/// Returns the reason why a body cannot have this combination of terms; empty if it can.
/// @param moves  false if the body is static
std::string refusal_of_terms(TermDomain domain, std::span<const std::string> names, bool moves);

/// Creates the terms with the given names, in their order.
/// @throws Error (input) naming the known terms.
std::vector<std::unique_ptr<Term>> make_terms(std::span<const std::string> names,
                                              const PlaneSection& section,
                                              const std::map<std::string, double>& numbers);
/// Creates one term, with all numbers at their default values.
std::unique_ptr<Term> make_term(const std::string& name, const PlaneSection& section);

/// Returns a number of a row from the data, or its default value.
/// @throws Error (input) where there is neither.
double number_of(const TermRow& row, const std::string& key, const TermData& data);

/// Creates the inertia of a plate or beam.
std::unique_ptr<Term> make_inertia(const PlaneSection& section);
/// Creates the membrane term of a plate.
std::unique_ptr<Term> make_membrane(const PlaneSection& section);
/// Creates the membrane term with assumed strains, which is free of locking in thin bending
/// (terms/membrane_invariant.h).
std::unique_ptr<Term> make_assumed_membrane(const PlaneSection& section);
/// Creates the elastic term of a fully parameterized beam in the plane (elements/ancf_beam.h) by
/// general continuum mechanics in plane stress; section.thickness is the width of the beam normal
/// to the plane. The strains of the axis are assumed (terms/beam_strains.h); the row "gcm_full" has
/// the strains of the displacements.
std::unique_ptr<Term> make_beam_gcm(const PlaneSection& section);
/// Creates the elastic term of a fully parameterized beam by enhanced continuum mechanics, which is
/// free of Poisson locking (terms/beam.cpp); otherwise see make_beam_gcm(). The row "ecm_full" has
/// the strains of the displacements.
std::unique_ptr<Term> make_beam_ecm(const PlaneSection& section);
/// Creates the bending term of a thin plate in space, with n x n Gauss points per element (relative
/// error of the force 5e-4 for 5 points at strong deformation, 4e-7 for 7; 9 where a plate folds,
/// fem/README.md, Bending).
/// @throws Error (input) at prepare() for a body in the plane.
std::unique_ptr<Term> make_bending(const PlaneSection& section, int n_points = 9);

}  // namespace flexmorph::fem
