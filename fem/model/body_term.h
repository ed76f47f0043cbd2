#pragma once

#include <memory>

#include "fem/load_term.h"
#include "fem/strain_term.h"
#include "fem/term.h"

namespace flexmorph::fem {

/// A term of a body, and what it can do besides: asked for once, when the term is added.
struct BodyTerm {
  /// Takes a term, which a list of terms of a body does by itself.
  BodyTerm(std::unique_ptr<Term> term = nullptr);
  BodyTerm(std::unique_ptr<StrainTerm> term) : BodyTerm(std::unique_ptr<Term>(std::move(term))) {}

  Term* operator->() const { return term.get(); }
  Term& operator*() const { return *term; }

  /// Adds forces and tangents of eight elements, one by one where the term is no BatchTerm.
  void add_forces(const Batch& x, Lanes* force) const;
  void add_tangents(const Batch& x, const Weights& w, Lanes* tangent) const;
  /// Returns the term as one with free lines, or a mean force. @throws Error (input) where it has
  /// none
  const FreeLineTerm& with_free_lines() const;
  const MeanForceTerm& with_mean_force() const;

  std::unique_ptr<Term> term;
  // The term as what it is besides, null where it is not.
  const BatchTerm* batch;
  const MeanForceTerm* mean;
  const FreeLineTerm* free_lines;
  const DesignedTerm* designed;
  const ElasticEnergy* elastic;
  const FlowTerm* flow;
  ScaledLoad* scaled;
  LoadTerm* load;
  StrainTerm* strain;
  HeatedTerm* heated;
};

}  // namespace flexmorph::fem
