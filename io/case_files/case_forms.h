#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/case_files/case_document.h"
#include "io/case_files/key.h"

/// Values of a case file against the forms that their keys are declared with.
namespace flexmorph::io {

/// The value, where the node is one of this form.
std::optional<double> read_number(const CaseNode& node, const Quantity& quantity);
std::optional<int> read_integer(const CaseNode& node, const Form& form);
std::optional<std::string> read_text(const CaseNode& node);

/// What is allowed, as messages end: "a count is a whole number between 1 and 9".
std::string number_or_name(const Form& form);
std::string whole_number(const Form& form);
/// "a term is one of 'inertia', 'membrane'".
std::string one_of(const std::string& noun, std::span<const std::string> allowed);
/// The same, with the word that was probably meant.
std::string one_of(const std::string& noun, std::span<const std::string> allowed,
                   const std::string& found);
/// Behind what a number may be, where a text stands in its place.
inline constexpr const char* kNoQuotes = "; a number stands without quotes";

/// A complaint about a case file: its line, how it begins, and how it goes on.
struct Complaint {
  unsigned line;
  std::string subject;  ///< "cases/four_bar.toml:14:13: body.thickness = -0.002"
  std::string words;    ///< ": a thickness is positive [m]"
};
/// One text of all of them in the order of the file, at most twenty lines.
std::string complaints_text(std::vector<Complaint> complaints, const std::string& file);

/// Everything in a case that cannot be, whatever the rest of it says: values that fit no form of
/// their keys in the book, keys that are not in the book, and keys that are missing although every
/// such table has them. Tables of which the book has no key are not looked into.
struct BookCheck {
  std::vector<Complaint> values, unknown, missing;
};
BookCheck check_by_book(const CaseNode& root);

}  // namespace flexmorph::io
