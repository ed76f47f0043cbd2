#pragma once

#include <string>
#include <vector>

#include "cases/assembly/operating_point.h"

namespace flexmorph::cases {

/// Natural modes of a case at one time, as the command `modes` writes them.
struct ModeTable {
  double time = 0;                  ///< Time [s], or load factor of a [static] analysis.
  std::string state;                ///< Text about the equilibrium.
  std::vector<std::string> bodies;  ///< Names of the bodies of the model.
  fem::NaturalModes found;          ///< Modes, rigid ones first.
  std::vector<std::string> notes;   ///< Sentences about what the numbers do not contain.
};

/// Computes the lowest natural modes at an operating point.
/// @param count  largest number of modes, rigid ones included
ModeTable mode_table(const Scene& scene, double time, OperatingPoint& point, int count);

/// Returns the damping ratio of a mode; 0 if it is not larger than the error of the eigenvalues.
double damping_of(const fem::NaturalMode& mode);

/// Returns the share of kinetic energy of the bodies that move most, such as "arm 93 %, rod 7 %".
/// @param most  largest number of bodies
std::string moving_bodies(const ModeTable& table, const fem::NaturalMode& mode, size_t most);

/// Returns the rows of a table for screen and report; the first one is the header.
std::vector<std::vector<std::string>> mode_rows(const ModeTable& table);

/// Returns sentences about the number of degrees of freedom, rigid modes and modes that grow.
std::vector<std::string> mode_remarks(const ModeTable& table);

/// Returns the frequencies of the lowest modes in one text: "3 modes of frequency 0, 12.3, 40.1
/// Hz".
/// @param most  largest number of frequencies other than 0
std::string frequencies_text(const ModeTable& table, int most);

}  // namespace flexmorph::cases
