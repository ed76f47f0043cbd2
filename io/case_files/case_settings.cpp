#include <algorithm>
#include <cstdlib>

#include "io/case_files/case_document.h"

namespace flexmorph::io {
namespace {

/// Returns a text without blanks.
std::string without_blanks(std::string text) {
  std::erase(text, ' ');
  return text;
}

/// Returns the entries of a list without blanks: "[0,[1,2]]" has "0" and "[1,2]".
std::vector<std::string> entries_of(const std::string& list) {
  std::vector<std::string> out;
  int depth = 0;
  for (const char c : list) {
    if (c == ']') {
      if (depth > 1) out.back() += c;
      --depth;
      continue;
    }
    if (depth == 1 && (out.empty() || c == ',')) out.emplace_back();
    if (depth > 1 || (depth == 1 && c != ',')) out.back() += c;
    if (c == '[') ++depth;
  }
  return out;
}

/// Tells whether a value of the file is the default of its key, which has no blanks.
bool is_fallback(const CaseNode& node, const std::string& fallback) {
  if (node.kind == CaseNode::Kind::number || node.kind == CaseNode::Kind::integer) {
    char* end = nullptr;
    const double number = std::strtod(fallback.c_str(), &end);
    return end != fallback.c_str() && *end == '\0' && node.number == number;
  }
  if (node.kind == CaseNode::Kind::list && fallback.starts_with('[')) {
    const std::vector<std::string> all = entries_of(fallback);
    return std::ranges::equal(node.entries, all, is_fallback);
  }
  const bool is_text = node.kind == CaseNode::Kind::text;
  return without_blanks(is_text ? "\"" + node.text + "\"" : node.shown) == fallback;
}

/// Tells whether a value is listed; its note belongs to its key.
using Wanted = bool (*)(const CaseNode& value, const CaseNote& note);

bool is_changed(const CaseNode& value, const CaseNote& note) {
  return value.is_option ||
         (!note.fallback.empty() && !is_fallback(value, without_blanks(note.fallback)));
}
/// The entries of a list of tables are listed, not the list.
bool is_given(const CaseNode& value, const CaseNote&) {
  return value.entries.empty() || value.entries.front().kind != CaseNode::Kind::table;
}
/// Tells whether the default of a value that is_changed() does not list depends on the
/// case. Required values have no default.
bool has_dependent_default(const CaseNode& value, const CaseNote& note) {
  return !value.is_option && is_given(value, note) && note.fallback.empty() &&
         !note.absence.empty() && !note.absence.starts_with("required");
}

void add_settings(const CaseNode& node, const std::string& path, Wanted wanted,
                  std::vector<Setting>& out);

void add_table(const CaseNode& table, const std::string& path, Wanted wanted,
               std::vector<Setting>& out) {
  for (const CaseNode& child : table.entries) {
    const std::string full = path.empty() ? child.key : path + "." + child.key;
    if (child.kind == CaseNode::Kind::table || !child.entries.empty())
      add_settings(child, full, wanted, out);
    for (const CaseNote& note : table.notes)
      if (note.key == child.key && child.kind != CaseNode::Kind::table && wanted(child, note))
        out.push_back({full, child.shown, note.fallback.empty() ? note.absence : note.fallback,
                       note.sentence, child.is_option});
  }
}

void add_settings(const CaseNode& node, const std::string& path, Wanted wanted,
                  std::vector<Setting>& out) {
  if (node.kind == CaseNode::Kind::table) return add_table(node, path, wanted, out);
  const std::vector<std::string> paths = entry_paths(node, path);
  for (size_t i = 0; i < node.entries.size(); ++i)
    if (node.entries[i].kind == CaseNode::Kind::table)
      add_table(node.entries[i], paths[i], wanted, out);
}

}  // namespace

std::vector<Setting> CaseDocument::settings() const {
  std::vector<Setting> out;
  add_table(root, "", is_changed, out);
  return out;
}

std::vector<Setting> CaseDocument::dependent_settings() const {
  std::vector<Setting> out;
  add_table(root, "", has_dependent_default, out);
  return out;
}

std::vector<Setting> CaseDocument::values() const {
  std::vector<Setting> out;
  add_table(root, "", is_given, out);
  return out;
}

}  // namespace flexmorph::io
