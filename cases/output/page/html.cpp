#include "cases/output/page/html.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "cases/output/page/assets.h"
#include "io/tables.h"

namespace flexmorph::cases {
namespace {

constexpr size_t kLongTable = 20;  // number of rows above which a table scrolls
constexpr size_t kSentence = 40;   // length of a text from which on a cell has a least width

/// A term of the glossary, in lower case, and its meaning.
struct GlossaryTerm {
  std::string name, meaning;
};

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// Removes the marks of Markdown for code, emphasis and links.
std::string plain(const std::string& markdown) {
  std::string out;
  for (size_t i = 0; i < markdown.size(); ++i) {
    const char c = markdown[i];
    if (c == '`' || c == '*') continue;
    if (c == '[') {  // a link, or a unit in brackets
      const size_t middle = markdown.find("](", i), close = markdown.find(']', i);
      if (middle != std::string::npos && middle == close) {
        out += plain(markdown.substr(i + 1, middle - i - 1));
        i = markdown.find(')', middle);
        if (i == std::string::npos) break;
        continue;
      }
    }
    out += c;
  }
  return out;
}

/// Returns the terms of the first table of the glossary, longest first.
std::vector<GlossaryTerm> read_glossary() {
  const std::string text = page_asset("glossary.md");
  std::vector<GlossaryTerm> out;
  size_t at = text.find("| --- |");
  for (at = text.find('\n', at) + 1; at < text.size() && text[at] == '|';
       at = text.find('\n', at) + 1) {
    const size_t middle = text.find(" | ", at), end = text.find(" |\n", at);
    const std::string meaning = plain(text.substr(middle + 3, end - middle - 3));
    std::string names = plain(text.substr(at + 1, middle - at - 1));
    std::erase_if(names, [](char c) { return c == '(' || c == ')'; });
    for (size_t begin = 0; begin < names.size();) {  // "MMA, GCMMA" are two terms
      const size_t comma = std::min(names.find(',', begin), names.size());
      const std::string name = trimmed(names.substr(begin, comma - begin));
      if (name.size() > 2) out.push_back({lower_case(name), meaning});
      begin = comma + 1;
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const GlossaryTerm& a, const GlossaryTerm& b) {
    return a.name.size() > b.name.size();
  });
  return out;
}

const std::vector<GlossaryTerm>& glossary() {
  static const std::vector<GlossaryTerm> kTerms = read_glossary();
  return kTerms;
}

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Returns the term that begins at a position of a text in lower case, and the length of the word
/// in the text, which may be a plural; null if there is none.
const GlossaryTerm* term_at(const std::string& text, size_t at, size_t& length) {
  if (at > 0 && is_letter(text[at - 1])) return nullptr;
  for (const GlossaryTerm& each : glossary()) {
    if (text.compare(at, each.name.size(), each.name) != 0) continue;
    length = each.name.size();
    if (at + length < text.size() && text[at + length] == 's') ++length;
    if (at + length >= text.size() || !is_letter(text[at + length])) return &each;
  }
  return nullptr;
}

bool is_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

std::string cell(const std::string& html, const char* tag = "td") {
  const bool is_sentence = html.size() > kSentence && html.find('<') == std::string::npos;
  return std::string("<") + tag +
         (is_number(html) ? " class=\"number\">"
          : is_sentence   ? " class=\"sentence\">"
                          : ">") +
         html + "</" + tag + ">";
}

std::string head_of(const HtmlColumn& column) {
  const bool has_unit = !column.unit.empty() && column.unit != "-";
  return term(spaced_name(column.name), column.meaning) +
         (has_unit ? " <span class=\"unit\">[" + escaped(column.unit) + "]</span>" : "");
}

}  // namespace

std::string escaped(const std::string& text) { return io::xml_escaped(text); }

std::string explained(const std::string& text) {
  const std::string lower = lower_case(text);
  std::set<std::string> marked;
  std::string out, rest;
  for (size_t i = 0; i < text.size();) {
    size_t length = 0;
    const GlossaryTerm* found = term_at(lower, i, length);
    if (!found || !marked.insert(found->name).second) {
      rest += text[i++];
      continue;
    }
    out += escaped(rest) + term(text.substr(i, length), found->meaning);
    rest.clear();
    i += length;
  }
  return out + escaped(rest);
}

std::string paragraph(const std::string& text) {
  return text.empty() ? "" : "<p>" + explained(text) + "</p>\n";
}

std::string term(const std::string& name, const std::string& meaning) {
  if (meaning.empty()) return escaped(name);
  return "<span class=\"term\" tabindex=\"0\" data-meaning=\"" + escaped(meaning) + "\">" +
         escaped(name) + "</span>";
}

std::string spaced_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string sortable_table(const std::vector<HtmlColumn>& columns,
                           const std::vector<std::vector<std::string>>& rows) {
  const bool is_long = rows.size() > kLongTable;
  std::string out = std::string("<div class=\"wide") + (is_long ? " long" : "") +
                    "\"><table class=\"sortable\">\n<thead><tr>";
  for (const HtmlColumn& column : columns) out += "<th>" + head_of(column) + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    out += "<tr>";
    for (const std::string& each : row) out += cell(each);
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string text_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<HtmlColumn> columns;
  for (const std::string& name : rows.front()) columns.push_back({name, "", ""});
  std::vector<std::vector<std::string>> cells(rows.begin() + 1, rows.end());
  for (std::vector<std::string>& row : cells)
    for (std::string& each : row) each = escaped(each);
  return sortable_table(columns, cells);
}

std::string quantity_table(const std::vector<std::string>& heads,
                           const std::vector<QuantityRow>& rows) {
  std::string out = "<div class=\"wide\"><table>\n";
  if (!heads.empty()) {
    out += "<thead><tr><th></th>";
    for (const std::string& head : heads) out += "<th>" + escaped(head) + "</th>";
    out += "</tr></thead>\n";
  }
  out += "<tbody>\n";
  for (const QuantityRow& row : rows) {
    if (std::all_of(row.values.begin(), row.values.end(),
                    [](const std::string& value) { return value.empty(); }))
      continue;
    out += "<tr><th scope=\"row\">" + head_of(row.quantity) + "</th>";
    for (const std::string& value : row.values) out += cell(escaped(value));
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string figure(const std::string& svg, const std::string& plot) {
  const std::string data = plot.empty() ? "" : " data-plot=\"" + escaped(plot) + "\"";
  return std::string("<figure class=\"plot") + (plot.empty() ? " picture\"" : "\"") + data +
         "><div class=\"static wide\">" + svg.substr(svg.find("<svg")) + "</div></figure>\n";
}

}  // namespace flexmorph::cases
