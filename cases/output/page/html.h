#pragma once

#include <string>
#include <vector>

#include "io/plots.h"

/// Parts of pages as HTML.
namespace flexmorph::cases {

/// Returns text as HTML in which the terms of cases/docs/glossary.md are explained when the pointer
/// is on them; each term is marked once.
std::string explained(const std::string& text);
/// Returns a paragraph; see explained(). Returns nothing for an empty text.
std::string paragraph(const std::string& text);
/// Returns a name as HTML that is explained by a sentence; the name alone without a sentence.
std::string term(const std::string& name, const std::string& meaning);
/// Returns the name of a quantity as words: "crisp_compliance" becomes "crisp compliance".
std::string spaced_name(std::string name);

/// A column of a table.
struct HtmlColumn {
  std::string name, unit, meaning;  ///< Name, unit ("-" or empty: none), and explaining sentence.
};
/// Returns a table whose rows the reader can sort by any column.
/// @param rows  cells as HTML, as many per row as there are columns
std::string sortable_table(const std::vector<HtmlColumn>& columns,
                           const std::vector<std::vector<std::string>>& rows);

/// Returns a table whose first row is the header; cells are text.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// A row of a table of quantities: the quantity, and a value as text for every column.
struct QuantityRow {
  HtmlColumn quantity;              ///< Name, unit and meaning of the quantity.
  std::vector<std::string> values;  ///< Values as text.
};
/// Returns a table with a row per quantity. Rows without any value are left out.
/// @param heads  headings of the columns of values, as text; empty: none
std::string quantity_table(const std::vector<std::string>& heads,
                           const std::vector<QuantityRow>& rows);

/// Returns a figure with a picture (SVG).
/// @param plot  name of the plot in the data of the page, which replaces the picture where scripts
///              run; empty: the picture stays
std::string figure(const std::string& svg, const std::string& plot = "");

/// Returns text in which HTML has no meaning.
std::string escaped(const std::string& text);

}  // namespace flexmorph::cases
